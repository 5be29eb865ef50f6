//! Nodes whose children have boxes of 8 bits per plane, and leaves of slots.
//!
//! ```text
//! blocks:  | node | node | ... |       depth first
//! node:    origin x, y, z; scale x, y, z;
//!          quantized planes of N children: x min, x max, y min, y max, z min, z max;
//!          N references; the lanes that have children
//! indices: of all primitives, by slot
//! ```
//!
//! The quantized plane q stands for origin + q * scale: see [`Grid`]. The format follows Ylitie,
//! Karras and Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG
//! 2017, with two differences. Origin and scales are whole scalars, ready for use. Each child has a
//! reference, because leaves are not stored next to each other.
//!
//! Leaves hold no operands. The leaf test gathers the operands from the primitives
//! into rows on the thread's stack, and tests the rows all at once. Refused
//! (measured: docs/decisions.md, 23):
//!
//! - testing the primitives one by one;
//! - gathering the next 8 slots whatever the size of the leaf, without a branch: more
//!   primitives are touched;
//! - 8 children per node instead of 16: 10 to 21 % slower;
//! - leaves as full as packed leaves.

use super::collapse_cost::LeafCost;
use super::encoding::{Encoding, Node};
use super::quantize::Grid;
use super::wide::{NO_PRIMITIVE, Reference, WideTree};
use crate::geometry::{Aabb, Scalar, min};
use crate::leaf::{GATHERED, LEAF_WIDTH};
use crate::simd::Lanes;
use alloc::vec::Vec;

/// The encoding for few bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Compact {
    /// The input index of each slot's primitive, then [`LEAF_WIDTH`] more entries.
    ///
    /// So [`LEAF_WIDTH`] entries can be read from the first slot of any leaf on.
    indices: Vec<u32>,
}

/// An inner node.
///
/// For 16 children in `f32` it takes three cache lines, where a packed node takes seven.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CompactNode<S, const N: usize> {
    grid: Grid<S>,
    /// The quantized planes by axis: the minima, then the maxima.
    places: [[[u8; N]; 2]; 3],
    children: [Reference; N],
    /// A bit for each lane that has a child.
    lanes: u64,
}

/// Returns whether a node has no padding.
const fn is_plain<S, const N: usize>() -> bool {
    size_of::<CompactNode<S, N>>() == 6 * size_of::<S>() + 6 * N + 4 * N + 8
}

const _: () = assert!(is_plain::<f32, 16>() && is_plain::<f32, 8>() && is_plain::<f32, 4>());
const _: () = assert!(is_plain::<f64, 16>() && is_plain::<f64, 8>() && is_plain::<f64, 4>());
const _: () = assert!(size_of::<CompactNode<f32, 16>>() == 192 && size_of::<CompactNode<f32, 8>>() == 112);

// SAFETY: a node consists of scalars and integers, so any bytes are a node. It has no padding, as
// the assertions on `is_plain` above ensure.
unsafe impl<S: Scalar, const N: usize> Node<S, N> for CompactNode<S, N> {
    const ALIGN: usize = 64;

    fn new(children: &[(Aabb<S>, Reference)]) -> Self {
        let everything = children.iter().fold(Aabb::EMPTY, |all, (aabb, _)| all.union(*aabb));
        let grid = Grid::over(&everything);
        let mut node = Self {
            grid,
            places: [[[0; N]; 2]; 3],
            children: [Reference::NONE; N],
            lanes: (1 << children.len()) - 1,
        };
        for (lane, (aabb, child)) in children.iter().enumerate() {
            for (axis, [min, max]) in node.grid.around(aabb).into_iter().enumerate() {
                node.places[axis][0][lane] = min;
                node.places[axis][1][lane] = max;
            }
            node.children[lane] = *child;
        }
        node
    }

    #[inline(always)]
    fn children(&self) -> &[Reference; N] {
        &self.children
    }

    #[inline(always)]
    fn lanes(&self) -> u32 {
        self.lanes as u32
    }

    #[inline(always)]
    fn planes<L: Lanes<S>>(&self, isa: L::Isa, axis: usize, first: usize) -> [L; 2] {
        const { assert!(N == L::COUNT) }
        let rows = &self.places[axis];
        let (origin, scale) = (L::splat(isa, self.grid.origin[axis]), L::splat(isa, self.grid.scale[axis]));
        let (one, other) = (L::from_bytes(isa, &rows[first & 1]), L::from_bytes(isa, &rows[first & 1 ^ 1]));
        [origin + one * scale, origin + other * scale]
    }

    fn child(&self, lane: usize) -> Option<(Aabb<S>, Reference)> {
        let at = |side: usize| [0, 1, 2].map(|axis| self.grid.at(axis, self.places[axis][side][lane]));
        // A child's box is never infinite, but a decoded maximum may be.
        let aabb = Aabb { min: at(0), max: at(1).map(|max| min(max, S::MAX)) };
        (self.lanes >> lane & 1 != 0).then_some((aabb, self.children[lane]))
    }
}

impl<S: Scalar, const N: usize> Encoding<S, N> for Compact {
    type Node = CompactNode<S, N>;
    const COPIES: bool = false;

    fn new(indices: &mut Vec<u32>, _: usize) -> Self {
        let mut indices = core::mem::take(indices);
        indices.reserve_exact(LEAF_WIDTH);
        indices.extend([NO_PRIMITIVE; LEAF_WIDTH]);
        indices.shrink_to_fit();
        Self { indices }
    }

    fn into_indices(self) -> Vec<u32> {
        self.indices
    }

    fn operands(&self) -> usize {
        0
    }

    #[inline(always)]
    fn has_operands(&self, operands: usize) -> bool {
        operands <= GATHERED
    }

    fn bytes(&self) -> usize {
        size_of::<u32>() * self.indices.capacity()
    }

    fn leaf_cost(_: usize) -> LeafCost {
        LeafCost { block: 0.5, primitive: 0.1 }
    }

    #[inline(always)]
    fn prefetch(tree: &WideTree<S, N, Self>, place: Reference) {
        if !place.is_leaf() {
            tree.arena.prefetch(place.offset(), size_of::<CompactNode<S, N>>());
        }
    }

    #[inline(always)]
    unsafe fn indices(tree: &WideTree<S, N, Self>, leaf: Reference, _: usize) -> &[u32; LEAF_WIDTH] {
        // The bounds are checked: the check takes no time compared with the gathering.
        tree.encoding.indices[leaf.slots().0..].first_chunk().expect("so many follow any slot")
    }

    fn indices_at(tree: &WideTree<S, N, Self>, leaf: Reference) -> Option<&[u32; LEAF_WIDTH]> {
        tree.encoding.indices.get(leaf.slots().0..)?.first_chunk()
    }

    #[inline(always)]
    fn has(leaf: Reference, lane: usize, _: u32) -> bool {
        lane < leaf.slots().1
    }

    #[inline(always)]
    unsafe fn rows(_: &WideTree<S, N, Self>, _: Reference, _: usize) -> &[[S; LEAF_WIDTH]] {
        &[]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use crate::simd::{Backend, Count, Kernel, Width};
    use crate::simd::{Isa, KernelLanes};
    use core::array::from_fn;

    /// A kernel that decodes the planes of a node, by axis: minima, then maxima.
    struct Planes<'a, S: Scalar, const N: usize>(&'a CompactNode<S, N>);

    impl<S: Scalar, const N: usize> Kernel for Planes<'_, S, N>
    where
        Count<N>: Width,
    {
        const IS_WIDE: bool = true;
        type Output = [[[S; N]; 2]; 3];

        #[inline(always)]
        fn run<I: Isa>(self, isa: I) -> Self::Output {
            from_fn(|axis| {
                let planes = self.0.planes::<<Count<N> as Width>::Lanes<S, I>>(isa, axis, 0);
                planes.map(|planes| {
                    let mut scalars = [S::ZERO; N];
                    planes.store(&mut scalars);
                    scalars
                })
            })
        }
    }

    /// Returns boxes of all sizes along a diagonal; each axis has its own scale.
    fn boxes<S: Scalar>(count: usize, scale: f64) -> Vec<(Aabb<S>, Reference)> {
        let corner = |x: f64| [0.37, 1.0, -1e-3].map(|axis| S::from_f64(scale * axis * x));
        let aabb = |k: usize| Aabb::of_points([corner(k as f64 / 7.0 - 0.9), corner((k * k) as f64 / 50.0)]);
        (0..count).map(|k| (aabb(k), Reference::node(64 * k))).collect()
    }

    /// Checks that lanes and scalars decode the same boxes on every instruction set.
    ///
    /// Each box contains the child's box.
    fn check<S: Scalar, const N: usize>(scale: f64)
    where
        Count<N>: Width,
    {
        for count in 1..=N {
            let children = boxes::<S>(count, scale);
            let node = CompactNode::<S, N>::new(&children);
            let planes: Vec<_> = InstructionSet::available()
                .filter_map(Backend::of)
                .map(|backend| backend.run(Planes(&node)))
                .collect();
            assert_eq!(node.lanes(), (1 << count) - 1);
            for (lane, &(aabb, reference)) in children.iter().enumerate() {
                let (decoded, place) = node.child(lane).unwrap();
                assert!(decoded.contains(&aabb) && decoded.is_valid(), "{aabb:?} {decoded:?}");
                assert_eq!(place, reference);
                for planes in &planes {
                    let in_lane = |side: usize| [0, 1, 2].map(|axis| planes[axis][side][lane]);
                    let [low, high] = [in_lane(0), in_lane(1)];
                    assert_eq!((low, high.map(|x| min(x, S::MAX))), (decoded.min, decoded.max));
                }
            }
            assert!((count..N).all(|lane| node.child(lane).is_none()));
        }
    }

    #[test]
    fn lanes_and_scalars_decode_a_box_around_each_child() {
        for scale in [1e-45, 1e-30, 1e-3, 1.0, 1e15, 1e30, 1e37] {
            check::<f32, 4>(scale);
            check::<f32, 8>(scale);
            check::<f32, 16>(scale);
            check::<f64, 16>(scale * scale * scale * scale);
        }
    }

    #[test]
    fn a_leaf_tells_its_slots() {
        for (first, count) in [(0, 1), (5, 8), ((1 << 28) - 1, 3)] {
            let leaf = Reference::of_slots(first, count).unwrap();
            assert!(leaf.is_leaf());
            assert_eq!(leaf.slots(), (first as usize, count as usize));
        }
        assert!(Reference::of_slots(1 << 28, 1).is_none() && Reference::of_slots(0, 9).is_none());
    }
}
