//! From primitives to a tree: one driver for every heuristic.
//!
//! ```text
//! primitives -> references (box, index) -> driver, asking the heuristic for splits -> tree -> reinsertion
//!                                          or for codes along a curve
//!                                          or for splits above, a curve below
//! ```
//!
//! The driver alone partitions references, bounds the depth and falls back to equal halves, so
//! that a bad heuristic makes a slow tree, never a broken one.

mod buffers;
mod clusters;
mod curve;
mod cut;
mod divide;
mod driver;
pub mod heuristic;
mod linear;
mod optimise;
mod radix;
mod reference;
mod runs;
mod scalar;
mod subtree;
mod watch;

pub(crate) use buffers::Buffers;
pub(crate) use divide::Rules;
pub(crate) use driver::build_tree;
pub use optimise::{Gain, Optimise};
pub use reference::{Flaw, PrimRef};
pub use scalar::{BuildScalar, LayOut};
pub use watch::Pace;
pub(crate) use watch::{Watch, Watcher};
