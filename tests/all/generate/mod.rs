//! Proptest's strategies.

pub mod numbers;
pub mod primitives;
pub mod rays;
pub mod scenes;
