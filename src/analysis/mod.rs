//! Inspection of a hierarchy: its invariants, its shape, and its quality.

mod check;
mod epo;
mod report;

pub use check::InvariantError;
pub(crate) use check::check;
pub(crate) use epo::epo;
pub use report::{LeafSizes, TreeReport};
