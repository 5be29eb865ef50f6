//! Builders: from primitives to a tree, with one driver for every heuristic.
//!
//! ```text
//! primitives -> references (box, index) -> driver -> tree -> reinsertion
//!                                          asks the heuristic for splits,
//!                                          or for codes along a curve,
//!                                          or for splits above and a curve below
//! ```
//!
//! The driver alone partitions references, bounds the depth and falls back to equal halves. So a
//! bad heuristic makes a slow tree, never a broken one.

mod buffers;
mod clusters;
mod compiled;
mod driver;
pub mod heuristic;
mod lbvh;
mod leaf_partition;
mod morton_order;
mod partition;
mod progress;
mod radix;
mod reference;
mod reinsertion;
mod spatial_split;
mod subtree;

pub(crate) use buffers::Buffers;
pub use compiled::CompiledBuilders;
pub(crate) use driver::build_tree;
pub(crate) use partition::Rules;
pub use progress::BuildControl;
pub(crate) use progress::{Progress, ProgressCallback};
pub use reference::{InvalidBox, PrimRef};
pub use reinsertion::{Optimise, OptimiseStats};
