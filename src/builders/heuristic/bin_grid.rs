//! Cells in a box, the same number on each axis.

use crate::geometry::Scalar;
use crate::simd::Lanes;
use crate::simd::{Isa, KernelLanes};

/// A grid of cells, with a lane for each axis.
#[derive(Clone, Copy)]
pub(super) struct Grid<S: Scalar, I: Isa> {
    origin: S::Times4<I>,
    /// Cells per unit of length; 0 on an axis without extent.
    scale: S::Times4<I>,
    half: S::Times4<I>,
    zero: S::Times4<I>,
    last: S::Times4<I>,
}

impl<S: Scalar, I: Isa> Grid<S, I> {
    /// Makes a grid of `count` cells on each axis, from 1 to 2^16.
    ///
    /// The first three numbers are the origin of the box, the others the cells per unit of length;
    /// see `Aabb::per_unit`.
    #[inline(always)]
    pub fn new(isa: I, [x, y, z]: [S; 3], [a, b, c]: [S; 3], count: usize) -> Self {
        let four = [[x, y, z, S::ZERO], [a, b, c, S::ZERO]];
        let [origin, scale] = four.map(|row| S::Times4::from_slice(isa, &row));
        let splat = |value: S| S::Times4::splat(isa, value);
        let last = splat(S::from_count(count as i32 - 1));
        Self { origin, scale, half: splat(S::HALF), zero: splat(S::ZERO), last }
    }

    /// Returns the cell of the middle of a box, on each axis.
    ///
    /// `min` and `max` are the corners of the box.
    #[inline(always)]
    pub fn cells(&self, min: S::Times4<I>, max: S::Times4<I>) -> [i32; 3] {
        // Rounded as in `Aabb::center`. In this order of operations, NaN becomes zero.
        let middle = min * self.half + max * self.half;
        ((middle - self.origin) * self.scale).max(self.zero).min(self.last).to_integers()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use crate::simd::{Backend, Kernel};

    /// The cell of a point, among cells of a box with length 1 on each axis.
    struct Cell<S>([S; 3], usize);

    impl<S: Scalar> Kernel for Cell<S> {
        const IS_WIDE: bool = true;
        type Output = [i32; 3];

        #[inline(always)]
        fn run<I: Isa>(self, isa: I) -> [i32; 3] {
            let Self([x, y, z], count) = self;
            let grid = Grid::<S, I>::new(isa, [S::ZERO; 3], [S::from_count(count as i32); 3], count);
            let point = S::Times4::from_slice(isa, &[x, y, z, S::ZERO]);
            grid.cells(point, point)
        }
    }

    /// Checks the cells of points, with every instruction set.
    fn check<S: Scalar>() {
        for backend in InstructionSet::available().filter_map(Backend::of) {
            let cells = |point: [f64; 3], count| backend.run(Cell(point.map(S::from_f64), count));
            assert_eq!(cells([0.0, 0.124, 0.125], 8), [0, 0, 1], "{backend:?}");
            assert_eq!(cells([0.874, 0.875, 1.0], 8), [6, 7, 7], "{backend:?}");
            assert_eq!(cells([-1e30, f64::NAN, 1e30], 8), [0, 0, 7], "{backend:?}");
            assert_eq!(cells([0.5, 0.99999, 0.25], 1 << 16), [1 << 15, 65535, 1 << 14], "{backend:?}");
        }
    }

    #[test]
    fn points_lie_in_the_cells_that_begin_at_them_or_before() {
        check::<f32>();
        check::<f64>();
    }
}
