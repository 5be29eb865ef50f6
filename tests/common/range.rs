//! The documented ranges of the modes.

use super::modes::Mode;
use bvhkit::{Fast, Precise, Triangle, Watertight};

/// A mode's documented range of coordinates, distances and lengths of directions.
pub trait Range: Mode {
    const RANGE: [f64; 2];
}

impl Range for Fast<Triangle> {
    const RANGE: [f64; 2] = [1e-12, 1e12];
}

impl Range for Watertight<Triangle> {
    const RANGE: [f64; 2] = [1e-30, 1e37];
}

impl Range for Precise<Triangle> {
    const RANGE: [f64; 2] = [1e-30, 1e37];
}

impl Range for Fast<Triangle<f64>> {
    const RANGE: [f64; 2] = [1e-100, 1e100];
}

impl Range for Watertight<Triangle<f64>> {
    const RANGE: [f64; 2] = [1e-100, 1e100];
}
