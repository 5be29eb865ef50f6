//! Nodes with their children's boxes in 8 bits a plane, and leaves that are ranges of slots.
//!
//! ```text
//! blocks:  | node | node | ... |                           depth first
//! node:    origin x, y, z; scale x, y, z; places of N children: x min, x max, y min, y max, z min, z max;
//!          N references; which lanes have children
//! indices: those of all primitives, by slot
//! ```
//!
//! A plane lies at origin + place * scale: see [`Grid`]. Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs, HPG 2017; but that the whole origin and scales as scalars are kept, which are ready to be
//! used, and a reference for each child, since leaves do not lie beside each other.
//!
//! What lies in no leaf is fetched from the primitives: the leaf's test writes their operands into rows on the thread's stack,
//! in which they are tested all at once. Refused, with shares of the rate in `Fast` mode on sponza and dragon:
//!
//! - asking them one by one: 0 to -14 % in trees with leaves of 6 primitives, +3 to -8 % with leaves of 3.4, in part noise;
//! - gathering the next 8 slots whatever the leaf's size, without a branch: 0 to -8 %, for more primitives are touched;
//! - 8 children a node instead of 16: -10 to -21 %, and a byte a triangle more;
//! - leaves as full as those that lie packed: -22 % on sponza's shadow rays, else within the noise, and 0.8 bytes less.

use super::collapse_cost::LeafCost;
use super::encoding::{Encoding, Node};
use super::quantize::Grid;
use super::wide::{NO_PRIMITIVE, Reference, WideTree};
use crate::geometry::{Aabb, Scalar, min};
use crate::leaf::{GATHERED, LEAF_WIDTH};
use crate::simd::Lanes;
use alloc::vec::Vec;

/// The form for few bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Compact {
    /// The input's index of each slot's primitive, and [`LEAF_WIDTH`] more, so that as many follow the first slot of any leaf.
    indices: Vec<u32>,
}

/// An inner node: for 16 children in `f32` three cache lines, where there were seven.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CompactNode<S, const N: usize> {
    grid: Grid<S>,
    /// By axis; minima, then maxima.
    places: [[[u8; N]; 2]; 3],
    children: [Reference; N],
    /// Bits of the lanes with children.
    lanes: u64,
}

/// Without gaps.
const fn is_plain<S, const N: usize>() -> bool {
    size_of::<CompactNode<S, N>>() == 6 * size_of::<S>() + 6 * N + 4 * N + 8
}

const _: () = assert!(is_plain::<f32, 16>() && is_plain::<f32, 8>() && is_plain::<f32, 4>());
const _: () = assert!(is_plain::<f64, 16>() && is_plain::<f64, 8>() && is_plain::<f64, 4>());
const _: () = assert!(size_of::<CompactNode<f32, 16>>() == 192 && size_of::<CompactNode<f32, 8>>() == 112);

// SAFETY: scalars and integers, without gaps: see above.
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
        // No box of a child is infinite.
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
        // Checked: it takes no time beside what leaves gather.
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

    /// The planes of a node in lanes: by axis, minima, then maxima.
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

    /// Boxes of all sizes along a diagonal, each axis with its own scale.
    fn boxes<S: Scalar>(count: usize, scale: f64) -> Vec<(Aabb<S>, Reference)> {
        let corner = |x: f64| [0.37, 1.0, -1e-3].map(|axis| S::from_f64(scale * axis * x));
        let aabb = |k: usize| Aabb::of_points([corner(k as f64 / 7.0 - 0.9), corner((k * k) as f64 / 50.0)]);
        (0..count).map(|k| (aabb(k), Reference::node(64 * k))).collect()
    }

    /// Lanes compute what scalars do, and both a box around the child's, on every instruction set.
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
