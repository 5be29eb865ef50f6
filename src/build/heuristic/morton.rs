//! Splits along a space-filling curve.

use super::{BuildNode, Heuristic, SahCost, Split};
use crate::build::reference::PrimRef;
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use alloc::vec;
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
    fn prepare(&self, references: &mut Vec<PrimRef<S>>, scene: &Aabb<S>) {
        let grid = Grid::new(scene);
        let codes = parallel::collect(references, |place, reference| (grid.code(reference), place as u32));
        let sorted = sorted(codes);
        *references = parallel::collect(&sorted, |_, &(_, place)| references[place as usize]);
    }

    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        let (references, n) = (node.references, node.references.len());
        if SahCost::is_block(node) || n <= node.max_leaf_size {
            return Split::Leaf;
        }
        let grid = Grid::new(&node.scene);
        let (first, last) = (grid.code(&references[0]), grid.code(&references[n - 1]));
        let changed = first ^ last;
        if changed == 0 {
            return Split::InOrder { left: n / 2 };
        }
        let highest = 1 << changed.ilog2();
        let left = references.partition_point(|reference| grid.code(reference) & highest == 0);
        Split::InOrder { left }
    }
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
            let cell = ((center[axis] - self.origin[axis]) * self.scale[axis]).to_f64();
            u64::from((cell as u32).min((1 << BITS) - 1))
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

/// By code, those of equal codes as they lie: a radix sort, eleven bits at a time from the lowest on.
fn sorted(mut codes: Vec<(u64, u32)>) -> Vec<(u64, u32)> {
    const DIGIT: u32 = 11;
    let mut other = vec![(0, 0); codes.len()];
    for shift in (0..3 * BITS).step_by(DIGIT as usize) {
        let digit = |code: u64| (code >> shift) as usize & ((1 << DIGIT) - 1);
        let mut places = [0u32; 1 << DIGIT];
        for &(code, _) in &codes {
            places[digit(code)] += 1;
        }
        let mut sum = 0;
        for place in &mut places {
            sum += core::mem::replace(place, sum);
        }
        for &item in &codes {
            let place = &mut places[digit(item.0)];
            other[*place as usize] = item;
            *place += 1;
        }
        core::mem::swap(&mut codes, &mut other);
    }
    codes
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

    #[test]
    fn sorting_keeps_the_order_of_equals() {
        let mut state = 1u64;
        let codes: Vec<(u64, u32)> = (0..10_000)
            .map(|i| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                // Few different ones, in all digits.
                (((state >> 60) * 0x1111_1111_1111) & ((1 << 48) - 1), i)
            })
            .collect();
        let mut expected = codes.clone();
        expected.sort();
        assert_eq!(sorted(codes), expected);
    }
}
