//! Splits along a space-filling curve.

use super::bin_grid::Grid;
use super::{BuildNode, Heuristic, Median, Split};
use crate::builders::reference::PrimRef;
use crate::builders::subtree::TASK_SIZE;
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::simd::Isa;
use crate::simd::{Backend, Kernel, prefetch_ahead};
use alloc::vec;
use alloc::vec::Vec;

/// Splits along the Morton curve, where the highest bit of the codes changes.
///
/// References are sorted once, by their Morton codes (Lauterbach et al., Fast BVH Construction on
/// GPUs, 2009: the linear hierarchy).
///
/// A quick build, for scenes that change each frame. It is blind to sizes, so rays visit more
/// nodes; [`Optimise`](crate::Optimise) saves some of them. The curve has at most 65,536 cells on
/// each axis, fewer for more than 65,536 primitives. Primitives in the same cell stay in the order
/// of the input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Morton;

/// Bits of a code for each axis.
const BITS: u32 = 16;

impl<S: Scalar> Heuristic<S> for Morton {
    fn codes(&self, references: &[PrimRef<S>], scene: &Aabb<S>) -> Option<Vec<u64>> {
        Some(S::codes(references, scene))
    }

    /// Splits into equal halves.
    ///
    /// This is for heuristics that call this `split` without forwarding the codes.
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        Median.split(node)
    }
}

/// Returns the Morton code of each reference: its place on the curve in a box.
pub(in crate::builders) fn new_codes<S: Scalar>(references: &[PrimRef<S>], scene: &Aabb<S>) -> Vec<u64> {
    let mut numbers = vec![0; references.len()];
    codes(references, scene, &mut numbers);
    numbers
}

/// Writes the Morton code of each reference to `codes`.
pub(in crate::builders) fn codes<S: Scalar>(references: &[PrimRef<S>], scene: &Aabb<S>, codes: &mut [u64]) {
    let mut parts: Vec<_> = references.chunks(TASK_SIZE).zip(codes.chunks_mut(TASK_SIZE)).collect();
    parallel::each(&mut parts, |(references, codes)| {
        Backend::best().run(Codes { references, scene, codes });
    });
}

struct Codes<'r, S> {
    references: &'r [PrimRef<S>],
    scene: &'r Aabb<S>,
    codes: &'r mut [u64],
}

impl<S: Scalar> Kernel for Codes<'_, S> {
    const IS_WIDE: bool = false;
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let grid = Grid::<S, I>::new(isa, self.scene.min, self.scene.per_unit(1 << BITS), 1 << BITS);
        for (code, reference) in self.codes.iter_mut().zip(self.references) {
            prefetch_ahead(reference);
            let [min, max] = reference.corners::<I>(isa);
            let [x, y, z] = grid.cells(min, max).map(|cell| spread(cell as u32));
            *code = x << 2 | y << 1 | z;
        }
    }
}

/// Puts two zeros before each of the lowest 16 bits.
///
/// A code interleaves the bits of three numbers.
#[inline(always)]
fn spread(bits: u32) -> u64 {
    let [low, high] = [bits, bits >> 8].map(|byte| u64::from(SPREAD[byte as usize % SPREAD.len()]));
    high << 24 | low
}

/// The spread bits of each byte.
const SPREAD: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut bit = 0;
        while bit < 8 {
            table[byte] |= (byte as u32 >> bit & 1) << (3 * bit);
            bit += 1;
        }
        byte += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for bits in [0, 1, 0b1011, 0x8001, 0xffff, 0x5a5a] {
            let expected = (0..16).fold(0, |sum, k| sum | u64::from(bits >> k & 1) << (3 * k));
            assert_eq!(spread(bits), expected, "{bits:x}");
        }
    }

    #[test]
    fn codes_go_from_the_boxs_one_corner_to_the_other() {
        let scene = Aabb::new([-1.0, 2.0, 0.0], [3.0, 2.5, 9.0]);
        let at = |point: [f32; 3]| PrimRef::new(Aabb::new(point, point), u32::MAX);
        let corners = [at(scene.min), at(scene.center()), at(scene.max)];
        // No bit, the highest bit on each axis and no other, all bits.
        let mut found = [7; 3];
        codes(&corners, &scene, &mut found);
        assert_eq!(found, [0, 0b111 << 45, (1 << 48) - 1]);
        let flat = Aabb::new([5.0; 3], [5.0; 3]);
        codes(&[at([5.0; 3])], &flat, &mut found[..1]);
        assert_eq!(found[0], 0);
    }
}
