//! Encodings: how the nodes and leaves of a wide tree are written.
//!
//! All encodings share one traversal, which sees nodes and leaves through these traits.

use super::collapse_cost::LeafCost;
use super::wide::{Reference, WideTree};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::simd::Lanes;
use alloc::vec::Vec;

/// An encoding of nodes and leaves.
pub trait Encoding<S: Scalar, const N: usize>: Clone + PartialEq + Send + Sync + 'static {
    type Node: Node<S, N>;
    /// Whether leaves are blocks with copies of their primitives' operands.
    ///
    /// If not, leaves are ranges of slots.
    const COPIES: bool;

    /// Creates the encoding of a tree.
    ///
    /// `indices` are the primitives by slot: the encoding takes them if it keeps them. `operands`
    /// is the number of operands of each primitive.
    fn new(indices: &mut Vec<u32>, operands: usize) -> Self;

    /// Returns the indices that [`new`](Self::new) took.
    fn into_indices(self) -> Vec<u32>;

    /// Returns the number of operands of each primitive that a leaf stores.
    fn operands(&self) -> usize;

    /// Returns whether a leaf test gets `operands` operands of each primitive.
    ///
    /// Either the leaves store them, or the test gathers them.
    fn has_operands(&self, operands: usize) -> bool;

    /// Returns the memory that the encoding takes beside the blocks, in bytes.
    fn bytes(&self) -> usize;

    /// Returns the cost of a visit to a leaf, by the operands of each primitive.
    fn leaf_cost(operands: usize) -> LeafCost;

    /// Prefetches a node or a leaf into the cache.
    fn prefetch(tree: &WideTree<S, N, Self>, place: Reference);

    /// Returns the input indices of a leaf's primitives, by lane.
    ///
    /// Only the lanes that the leaf [`has`](Self::has) count.
    ///
    /// # Safety
    ///
    /// `leaf` is one of the tree's leaves, and `operands` is the number of operands of each
    /// primitive that the tree's leaves store.
    unsafe fn indices(tree: &WideTree<S, N, Self>, leaf: Reference, operands: usize) -> &[u32; LEAF_WIDTH];

    /// Returns the indices at any leaf, or `None` if the tree has no such leaf.
    fn indices_at(tree: &WideTree<S, N, Self>, leaf: Reference) -> Option<&[u32; LEAF_WIDTH]>;

    /// Returns whether a leaf has a primitive in a lane, whose entry is `index`.
    fn has(leaf: Reference, lane: usize, index: u32) -> bool;

    /// Returns the operands of a leaf's primitives: a row for each operand.
    ///
    /// Lanes without a primitive hold NaN. There are no rows if the operands have to be gathered.
    ///
    /// # Safety
    ///
    /// As for [`indices`](Self::indices).
    unsafe fn rows(tree: &WideTree<S, N, Self>, leaf: Reference, operands: usize) -> &[[S; LEAF_WIDTH]];
}

/// An inner node of a wide tree.
///
/// # Safety
///
/// A node is plain data: any bytes are a node, and a node has no padding.
pub unsafe trait Node<S: Scalar, const N: usize>: Copy + Send + Sync {
    /// The alignment of nodes, in bytes.
    const ALIGN: usize;
    /// Creates a node with these children in the lowest lanes.
    fn new(children: &[(Aabb<S>, Reference)]) -> Self;

    fn children(&self) -> &[Reference; N];

    /// Returns a bit for each lane that may have a child.
    ///
    /// If such a lane has no child, no ray meets its box.
    fn lanes(&self) -> u32;

    /// Returns the two rows of planes of axis 0, 1 or 2.
    ///
    /// The minima are first if `first` is 0, and the maxima are first if it is 1.
    fn planes<L: Lanes<S>>(&self, isa: L::Isa, axis: usize, first: usize) -> [L; 2];

    /// Returns a child's box and reference, or `None` if the lane has no child.
    fn child(&self, lane: usize) -> Option<(Aabb<S>, Reference)>;
}
