//! What the benches share that print times only of what was checked.

pub mod agreement;
pub mod columns;
pub mod criterion;
pub mod extent;
pub mod file;
pub mod obvhs;
pub mod timing;
