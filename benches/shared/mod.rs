//! Modules of the benches that print times only of checked answers.

pub mod agreement;
pub mod columns;
pub mod criterion;
pub mod environment;
pub mod extent;
#[expect(unused_imports, reason = "the loader's unit tests are left out here")]
pub mod file;
pub mod obvhs;
pub mod timing;
