//! Nodes that store their children's boxes as scalars, and packed leaves.
//!
//! ```text
//! blocks: | node | leaf leaf leaf | node | leaf ... |  depth first, leaves right behind their node
//! node:   planes of N children: x min, x max, y min, y max, z min, z max; N references
//! leaf:   operands of 8 primitives, row by row; their 8 indices
//! ```
//!
//! Lanes without a child have boxes that no ray meets. Lanes without a primitive have operands NaN.

use super::collapse_cost::LeafCost;
use super::encoding::{Encoding, Node};
use super::wide::{NO_PRIMITIVE, Reference, WideTree};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::simd::Lanes;
use alloc::vec::Vec;

/// The encoding for speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// The number of operands of each primitive that a leaf stores.
    operands: usize,
}

/// An inner node.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct WideNode<S, const N: usize> {
    /// The planes by axis: the minima, then the maxima.
    planes: [[[S; N]; 2]; 3],
    children: [Reference; N],
}

/// Returns whether a node has no padding.
const fn has_no_gaps<S: Scalar, const N: usize>() -> bool {
    size_of::<WideNode<S, N>>() == N * (6 * size_of::<S>() + size_of::<Reference>())
}

const _: () = assert!(has_no_gaps::<f32, 4>() && has_no_gaps::<f32, 8>() && has_no_gaps::<f32, 16>());
const _: () = assert!(has_no_gaps::<f64, 4>() && has_no_gaps::<f64, 8>() && has_no_gaps::<f64, 16>());

// SAFETY: a node consists of scalars and integers, so any bytes are a node. It has no padding in
// the widths that are used, as the assertions on `has_no_gaps` above ensure.
unsafe impl<S: Scalar, const N: usize> Node<S, N> for WideNode<S, N> {
    /// Rows of planes that are as long as a cache line begin at one.
    const ALIGN: usize = if size_of::<[S; N]>() >= 64 { 64 } else { 32 };

    fn new(children: &[(Aabb<S>, Reference)]) -> Self {
        let nothing = [[S::INFINITY; N], [S::NEG_INFINITY; N]];
        let mut node = Self { planes: [nothing; 3], children: [Reference::NONE; N] };
        for (lane, &(aabb, child)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.planes[axis][0][lane] = aabb.min[axis];
                node.planes[axis][1][lane] = aabb.max[axis];
            }
            node.children[lane] = child;
        }
        node
    }

    #[inline(always)]
    fn children(&self) -> &[Reference; N] {
        &self.children
    }

    #[inline(always)]
    fn lanes(&self) -> u32 {
        u32::MAX
    }

    #[inline(always)]
    fn planes<L: Lanes<S>>(&self, isa: L::Isa, axis: usize, first: usize) -> [L; 2] {
        const { assert!(N == L::COUNT) }
        let rows = &self.planes[axis];
        [L::from_slice(isa, &rows[first & 1]), L::from_slice(isa, &rows[first & 1 ^ 1])]
    }

    fn child(&self, lane: usize) -> Option<(Aabb<S>, Reference)> {
        let aabb =
            Aabb { min: self.planes.map(|axis| axis[0][lane]), max: self.planes.map(|axis| axis[1][lane]) };
        (!aabb.is_empty()).then_some((aabb, self.children[lane]))
    }
}

impl<S: Scalar, const N: usize> Encoding<S, N> for Packed {
    type Node = WideNode<S, N>;
    const COPIES: bool = true;

    fn new(_: &mut Vec<u32>, operands: usize) -> Self {
        Self { operands }
    }

    fn into_indices(self) -> Vec<u32> {
        Vec::new()
    }

    fn operands(&self) -> usize {
        self.operands
    }

    #[inline(always)]
    fn has_operands(&self, operands: usize) -> bool {
        self.operands == operands
    }

    fn bytes(&self) -> usize {
        0
    }

    fn leaf_cost(operands: usize) -> LeafCost {
        if operands > 0 { LeafCost { block: 0.5, primitive: 0.0 } } else { LeafCost::ONE_BY_ONE }
    }

    #[inline(always)]
    fn prefetch(tree: &WideTree<S, N>, place: Reference) {
        tree.arena.prefetch(place.offset(), size_of::<WideNode<S, N>>());
    }

    #[inline(always)]
    unsafe fn indices(tree: &WideTree<S, N>, leaf: Reference, operands: usize) -> &[u32; LEAF_WIDTH] {
        debug_assert_eq!(tree.encoding.operands, operands);
        // SAFETY: any bytes are indices. The caller ensures that a leaf is there, whose indices
        // follow its rows of operands. `Shape::extent` aligns leaves.
        unsafe { tree.arena.get(leaf.offset() + operands * size_of::<[S; LEAF_WIDTH]>()) }
    }

    fn indices_at(tree: &WideTree<S, N>, leaf: Reference) -> Option<&[u32; LEAF_WIDTH]> {
        let rows = tree.encoding.operands.checked_mul(size_of::<[S; LEAF_WIDTH]>())?;
        let offset = leaf.offset().checked_add(rows)?;
        let fits = offset.checked_add(size_of::<[u32; LEAF_WIDTH]>())? <= tree.arena.len();
        // SAFETY: any bytes are indices. These are inside the arena, as checked above, and aligned:
        // offsets of leaves and sizes of rows are multiples of 8.
        fits.then(|| unsafe { tree.arena.get(offset) })
    }

    #[inline(always)]
    fn has(_: Reference, _: usize, index: u32) -> bool {
        index != NO_PRIMITIVE
    }

    #[inline(always)]
    unsafe fn rows(tree: &WideTree<S, N>, leaf: Reference, operands: usize) -> &[[S; LEAF_WIDTH]] {
        debug_assert_eq!(tree.encoding.operands, operands);
        // SAFETY: any bytes are scalars. The caller ensures that a leaf is there, which begins with
        // its rows of operands. `Shape::extent` aligns leaves.
        unsafe { tree.arena.get_slice(leaf.offset(), operands) }
    }
}
