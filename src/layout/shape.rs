//! What a collapse asks of a tree's form and of its primitives, by reference.

use super::collapse_cost::LeafCost;
use super::encoding::{Encoding, Node};
use super::node_arena::{NodeArena, Part};
use super::wide::{NO_PRIMITIVE, Reference};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;

/// What the leaves of a wide tree take of the primitives.
pub trait Contents<S>: Sync {
    /// Writes scalars of each, for primitives with these input indices, a row for each: a lane for
    /// each primitive, NaN in the others.
    fn put(&self, indices: &[u32], rows: &mut [[S; LEAF_WIDTH]]);
    /// The box of the primitive with an input index.
    fn aabb(&self, index: u32) -> Aabb<S>;
    /// PackedQuery for the primitive with an input index to be brought into the cache.
    fn prefetch(&self, index: u32);
}

/// How the blocks of a wide tree are written: what a form knows, as values, so that one collapse is
/// compiled for all.
pub struct Shape<S> {
    /// Whether leaves are blocks with copies of their primitives' operands; else they are ranges of
    /// slots.
    pub has_leaves: bool,
    /// How many scalars of each primitive.
    operands: usize,
    /// What it costs to visit a leaf.
    pub cost: LeafCost,
    /// Bytes of a node, and of what its place is a multiple.
    node: (usize, usize),
    pub put_node: PutNode<S>,
}

/// Writes a node with these children at an offset.
type PutNode<S> = fn(&mut Part<'_>, usize, &[(Aabb<S>, Reference)]);

impl<S: Scalar> Shape<S> {
    /// With so many operands of each primitive.
    pub(super) fn of<const N: usize, F: Encoding<S, N>>(operands: usize) -> Self {
        Self {
            has_leaves: F::COPIES,
            operands,
            cost: F::leaf_cost(operands),
            node: (size_of::<F::Node>(), F::Node::ALIGN),
            put_node: |part, offset, children| {
                // SAFETY: nodes are plain data without gaps, see `Node`.
                unsafe { part.put(offset, F::Node::new(children)) }
            },
        }
    }

    /// How many bytes a block takes, and of what its place is a multiple.
    pub(super) fn extent(&self, kind: Kind) -> (usize, usize) {
        match kind {
            Kind::Node => self.node,
            Kind::Leaf => {
                let bytes = self.operands * size_of::<[S; LEAF_WIDTH]>() + size_of::<[u32; LEAF_WIDTH]>();
                let align =
                    if self.operands > 0 { size_of::<[S; LEAF_WIDTH]>().min(NodeArena::ALIGN) } else { 32 };
                (bytes, align)
            }
        }
    }

    /// Writes a leaf: the rows of operands, NaN where there is no primitive, then the indices.
    pub(super) fn put_leaf(
        &self,
        part: &mut Part<'_>,
        offset: usize,
        indices: &[u32],
        contents: &dyn Contents<S>,
    ) {
        // SAFETY: scalars are any bytes, and any bytes are some.
        contents.put(indices, unsafe { part.get_mut(offset, self.operands) });
        let mut places = [NO_PRIMITIVE; LEAF_WIDTH];
        places[..indices.len()].copy_from_slice(indices);
        // SAFETY: integers are any bytes, and any bytes are some.
        unsafe { part.put(offset + self.operands * size_of::<[S; LEAF_WIDTH]>(), places) }
    }
}

/// What there is in memory.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A node, with some of the section's children.
    Node,
    /// A leaf, with the primitives of some slots.
    Leaf,
}
