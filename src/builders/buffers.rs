//! Memory that one build leaves to the next.

use super::reference::PrimRef;
use crate::memory::keep_larger;
use crate::tree::{LeafRange, Node, Tree};
use alloc::vec::Vec;

/// The large buffers of a build; what is left in them is of no use. Small ones, of which there are many, come from the allocator
/// every time.
pub(crate) struct Buffers<S> {
    /// What the tree is to be built of: the input of a build.
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
    /// Takes over what is left of a tree.
    pub fn reclaim(&mut self, tree: Tree<S>) {
        let Tree { nodes, indices, leaf_ranges, .. } = tree;
        keep_larger(&mut self.nodes, nodes);
        keep_larger(&mut self.indices, indices);
        keep_larger(&mut self.leaf_ranges, leaf_ranges);
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of::<PrimRef<S>>() * self.references.capacity()
            + size_of::<Node<S>>() * self.nodes.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<LeafRange<S>>() * self.leaf_ranges.capacity()
    }
}
