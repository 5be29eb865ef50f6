//! The encoding and the primitives, as a collapse that knows no types sees them.

use super::collapse_cost::LeafCost;
use super::encoding::{Encoding, Node};
use super::node_arena::{NodeArena, Part};
use super::wide::{NO_PRIMITIVE, Reference};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;

/// The primitives, as the leaves of a wide tree use them.
pub trait Contents<S>: Sync {
    /// Writes the operands of the primitives with these input indices.
    ///
    /// There is a row for each operand, and a lane for each primitive. The other lanes become NaN.
    fn put(&self, indices: &[u32], rows: &mut [[S; LEAF_WIDTH]]);
    /// Returns the box of the primitive with an input index.
    fn aabb(&self, index: u32) -> Aabb<S>;
    /// Prefetches the primitive with an input index into the cache.
    fn prefetch(&self, index: u32);
}

/// The encoding of a wide tree, as values: how its blocks are written.
///
/// One compiled collapse serves all encodings.
pub struct Shape<S> {
    /// Whether leaves are blocks with copies of their primitives' operands.
    ///
    /// If not, leaves are ranges of slots.
    pub has_leaves: bool,
    /// The number of operands of each primitive.
    operands: usize,
    /// The cost of a visit to a leaf.
    pub cost: LeafCost,
    /// The size and the alignment of a node, in bytes.
    node: (usize, usize),
    pub put_node: PutNode<S>,
}

/// A function that writes a node with these children at an offset.
type PutNode<S> = fn(&mut Part<'_>, usize, &[(Aabb<S>, Reference)]);

impl<S: Scalar> Shape<S> {
    /// Returns the shape of an encoding, with `operands` operands per primitive.
    pub(super) fn of<const N: usize, F: Encoding<S, N>>(operands: usize) -> Self {
        Self {
            has_leaves: F::COPIES,
            operands,
            cost: F::leaf_cost(operands),
            node: (size_of::<F::Node>(), F::Node::ALIGN),
            put_node: |part, offset, children| {
                // SAFETY: nodes are plain data without padding, by the contract of `Node`.
                unsafe { part.put(offset, F::Node::new(children)) }
            },
        }
    }

    /// Returns the size and the alignment of a block, in bytes.
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

    /// Writes a leaf: the rows of operands, then the indices.
    ///
    /// Operands are NaN where there is no primitive.
    pub(super) fn put_leaf(
        &self,
        part: &mut Part<'_>,
        offset: usize,
        indices: &[u32],
        contents: &dyn Contents<S>,
    ) {
        // SAFETY: any bytes are scalars, and scalars have no padding.
        contents.put(indices, unsafe { part.get_mut(offset, self.operands) });
        let mut places = [NO_PRIMITIVE; LEAF_WIDTH];
        places[..indices.len()].copy_from_slice(indices);
        // SAFETY: integers have no padding.
        unsafe { part.put(offset + self.operands * size_of::<[S; LEAF_WIDTH]>(), places) }
    }
}

/// The kind of a block.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A node, whose children are a range of the section's children.
    Node,
    /// A leaf, whose primitives are those of a range of slots.
    Leaf,
}
