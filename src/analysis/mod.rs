//! What a hierarchy looks like: its invariants, its shape, and how good it is.

mod check;
mod epo;
mod report;

pub use check::InvariantError;
pub(crate) use check::check;
pub(crate) use epo::epo;
pub use report::{LeafSizes, TreeReport};
