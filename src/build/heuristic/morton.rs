//! Splits along a space-filling curve.

use super::{BuildNode, Heuristic, Median, Split};
use crate::build::reference::PrimRef;
use crate::geometry::{Aabb, Scalar, max, min};
use crate::parallel;
use alloc::vec::Vec;

/// Sorts references once along Morton's curve, and splits where the highest bit changes (Lauterbach et al., Fast BVH
/// Construction on GPUs, 2009: the linear hierarchy).
///
/// The quickest build, for scenes that change each frame; blind to sizes, so rays visit more nodes, some of which
/// [`Optimise`](crate::Optimise) saves. What lies in one of 65,536 cells on each axis stays in the input's order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Morton;

/// Bits of a code on each axis.
const BITS: u32 = 16;

impl<S: Scalar> Heuristic<S> for Morton {
    fn codes(&self, references: &[PrimRef<S>], scene: &Aabb<S>) -> Option<Vec<u64>> {
        Some(codes(references, scene))
    }

    /// Of a heuristic that asks this one but does not pass its codes on: equal halves.
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        Median.split(node)
    }
}

/// Each reference's place on the curve through a box.
pub(in crate::build) fn codes<S: Scalar>(references: &[PrimRef<S>], scene: &Aabb<S>) -> Vec<u64> {
    let grid = Grid::new(scene);
    parallel::collect(references, |_, reference| grid.code(reference))
}

/// Cells in a box.
struct Grid<S> {
    origin: [S; 3],
    /// Cells per unit of length; 0 on an axis without extent.
    scale: [S; 3],
}

impl<S: Scalar> Grid<S> {
    fn new(scene: &Aabb<S>) -> Self {
        Self { origin: scene.min, scale: scene.per_unit(1 << BITS) }
    }

    /// The bits of the cell's three coordinates in turns.
    fn code(&self, reference: &PrimRef<S>) -> u64 {
        let center = reference.centroid();
        let coordinate = |axis: usize| {
            let cell = (center[axis] - self.origin[axis]) * self.scale[axis];
            let cell = min(max(cell, S::ZERO), S::from_count((1 << BITS) - 1));
            // SAFETY: from 0, which NaN becomes, to the last cell.
            u64::from(unsafe { cell.to_small_integer() } as u32)
        };
        spread(coordinate(0)) << 2 | spread(coordinate(1)) << 1 | spread(coordinate(2))
    }
}

/// Two zeros before each of the lowest 16 bits.
fn spread(bits: u64) -> u64 {
    let bits = (bits | bits << 16) & 0x0000_0000_ff00_00ff;
    let bits = (bits | bits << 8) & 0x0000_00f0_0f00_f00f;
    let bits = (bits | bits << 4) & 0x0000_0c30_c30c_30c3;
    (bits | bits << 2) & 0x0000_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bits in [0u64, 1, 0b1011, 0x8001, 0xffff, 0x5a5a] {
            let expected = (0..16).fold(0, |sum, k| sum | (bits >> k & 1) << (3 * k));
            assert_eq!(spread(bits), expected, "{bits:x}");
        }
    }
}
