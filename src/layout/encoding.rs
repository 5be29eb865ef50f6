//! How the nodes and leaves of a wide tree are written: what the traversal, which is the same for all, asks of them.

use super::collapse_cost::LeafCost;
use super::wide::{Reference, WideTree};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::simd::Lanes;
use alloc::vec::Vec;

/// A way to write nodes and leaves.
pub trait Encoding<S: Scalar, const N: usize>: Clone + PartialEq + Send + Sync + 'static {
    type Node: Node<S, N>;
    /// Whether leaves are blocks with copies of their primitives' operands; else they are ranges of slots.
    const COPIES: bool;

    /// For a tree with these primitives by slot, of so many operands each. Takes them if it keeps them.
    fn new(indices: &mut Vec<u32>, operands: usize) -> Self;

    /// What it took.
    fn into_indices(self) -> Vec<u32>;

    /// How many scalars of each primitive lie in its leaf.
    fn operands(&self) -> usize;

    /// Whether leaves have so many of each primitive, or will have them gathered.
    fn has_operands(&self, operands: usize) -> bool;

    /// Bytes of memory beside the blocks.
    fn bytes(&self) -> usize;

    /// What it costs to visit a leaf of such primitives.
    fn leaf_cost(operands: usize) -> LeafCost;

    /// PackedQuery for a node or a leaf to be brought into the cache.
    fn prefetch(tree: &WideTree<S, N, Self>, place: Reference);

    /// The input's indices of a leaf's primitives, in the lanes that it [`has`](Self::has).
    ///
    /// # Safety
    /// `leaf` is one of the tree's leaves, and `operands` is what the tree keeps of each primitive in its leaf.
    unsafe fn indices(tree: &WideTree<S, N, Self>, leaf: Reference, operands: usize) -> &[u32; LEAF_WIDTH];

    /// The same of any leaf; none if the tree has no such.
    fn indices_at(tree: &WideTree<S, N, Self>, leaf: Reference) -> Option<&[u32; LEAF_WIDTH]>;

    /// Whether there is a primitive in a lane, where `index` lies.
    fn has(leaf: Reference, lane: usize, index: u32) -> bool;

    /// So many operands of a leaf's primitives, row by row, NaN where there is no primitive; none if they would have to be
    /// gathered.
    ///
    /// # Safety
    /// As for [`indices`](Self::indices).
    unsafe fn rows(tree: &WideTree<S, N, Self>, leaf: Reference, operands: usize) -> &[[S; LEAF_WIDTH]];
}

/// An inner node.
///
/// # Safety
/// Plain data: any bytes are a node, and a node is all bytes, without gaps.
pub unsafe trait Node<S: Scalar, const N: usize>: Copy + Send + Sync {
    /// Where nodes begin.
    const ALIGN: usize;
    /// With these children in the lowest lanes.
    fn new(children: &[(Aabb<S>, Reference)]) -> Self;

    fn children(&self) -> &[Reference; N];

    /// Bits of the lanes in which there may be children: no ray meets the boxes in others of them.
    fn lanes(&self) -> u32;

    /// The two rows of planes across an axis, 0, 1 or 2: the minima before the maxima if `first` is 0, after them if it is 1.
    fn planes<L: Lanes<S>>(&self, isa: L::Isa, axis: usize, first: usize) -> [L; 2];

    /// The box and the place of a child; none if there is none in this lane.
    fn child(&self, lane: usize) -> Option<(Aabb<S>, Reference)>;
}
