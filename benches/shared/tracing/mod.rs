//! Rays of every kind, traced through several hierarchies side by side.

pub mod check;
pub mod family;
pub mod kinds;
mod ours;
mod peer;
pub mod speed;
pub mod tracer;
