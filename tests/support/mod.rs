//! Procedural scenes and rays, for tests and benches.
//!
//! [`scenes::all`] and [`rays::Rays`] reach everything here.

pub mod rays;
pub mod scenes;
