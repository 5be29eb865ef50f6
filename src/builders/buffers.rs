//! Memory that one build passes on to the next.

use super::reference::PrimRef;
use crate::memory::keep_larger;
use crate::tree::{LeafRange, Node, Tree};
use alloc::vec::Vec;

/// The large buffers of a build.
///
/// Their remaining content has no meaning. Small buffers, of which there are many, come from the
/// allocator each time.
pub(crate) struct Buffers<S> {
    /// The references that the tree is built over: the input of a build.
    pub references: Vec<PrimRef<S>>,
    pub(super) nodes: Vec<Node<S>>,
    pub(super) indices: Vec<u32>,
    pub(super) leaf_ranges: Vec<LeafRange<S>>,
}

impl<S> Default for Buffers<S> {
    fn default() -> Self {
        Self { references: Vec::new(), nodes: Vec::new(), indices: Vec::new(), leaf_ranges: Vec::new() }
    }
}

impl<S> Buffers<S> {
    /// Takes over the buffers of a tree.
    pub fn reclaim(&mut self, tree: Tree<S>) {
        let Tree { nodes, indices, leaf_ranges, .. } = tree;
        keep_larger(&mut self.nodes, nodes);
        keep_larger(&mut self.indices, indices);
        keep_larger(&mut self.leaf_ranges, leaf_ranges);
    }

    /// Returns the size of the buffers, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<PrimRef<S>>() * self.references.capacity()
            + size_of::<Node<S>>() * self.nodes.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<LeafRange<S>>() * self.leaf_ranges.capacity()
    }
}
