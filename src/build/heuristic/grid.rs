//! Cells in a box, as many on each axis.

use crate::build::reference::{PrimRef, three};
use crate::geometry::Scalar;
use crate::simd::Lanes;
use fearless_simd::Simd;

/// Where cells lie, a lane for each axis.
#[derive(Clone, Copy)]
pub(super) struct Grid<S: Scalar, I: Simd> {
    origin: S::Times4<I>,
    /// Cells per unit of length; 0 on an axis without extent.
    scale: S::Times4<I>,
    half: S::Times4<I>,
    zero: S::Times4<I>,
    last: S::Times4<I>,
    /// The first three lanes.
    used: <S::Times4<I> as Lanes<S>>::Mask,
}

impl<S: Scalar, I: Simd> Grid<S, I> {
    /// `count` cells on each axis of a box, from 1 to 2^16, that begins at an origin; see `Aabb::per_unit`.
    #[inline(always)]
    pub fn new(isa: I, [x, y, z]: [S; 3], [a, b, c]: [S; 3], count: usize) -> Self {
        let zero = S::Times4::splat(isa, S::ZERO);
        let four = [[x, y, z, S::ZERO], [a, b, c, S::ZERO], [S::ONE, S::ONE, S::ONE, S::ZERO]];
        // SAFETY: four scalars each.
        let [origin, scale, used] = unsafe {
            [
                S::Times4::load(isa, four[0].as_ptr()),
                S::Times4::load(isa, four[1].as_ptr()),
                S::Times4::load(isa, four[2].as_ptr()),
            ]
        };
        let last = S::Times4::splat(isa, S::from_count(count as i32 - 1));
        Self { origin, scale, half: S::Times4::splat(isa, S::HALF), zero, last, used: zero.lt(used) }
    }

    /// The box's minimum, and its maximum with zero in the fourth lane: an index there is a subnormal number, with which
    /// computing is slow.
    #[inline(always)]
    pub fn corners(&self, isa: I, reference: &PrimRef<S>) -> [S::Times4<I>; 2] {
        let [min, max] = reference.corners::<I>(isa);
        [min, max.where_else(self.used, self.zero)]
    }

    /// The cell of the middle of a box with these corners, on each axis.
    #[inline(always)]
    pub fn cells(&self, min: S::Times4<I>, max: S::Times4<I>) -> [i32; 3] {
        // As `Aabb::center` rounds; and in this order a NaN, as in the fourth lane, becomes zero.
        let middle = min * self.half + max * self.half;
        let cells = ((middle - self.origin) * self.scale).max(self.zero).min(self.last);
        let [x, y, z] = three(cells);
        // SAFETY: from 0 to the last cell.
        unsafe { [x.to_small_integer(), y.to_small_integer(), z.to_small_integer()] }
    }
}
