//! Memory that one build leaves to the next.

use super::reference::PrimRef;
use crate::tree::{Node, Run, Tree};
use alloc::vec::Vec;

/// The large buffers of a build. Small ones, of which there are many, come from
/// the allocator every time.
#[derive(Debug)]
pub(crate) struct Buffers<S> {
    pub references: Vec<PrimRef<S>>,
    /// Whatever was in them.
    pub(super) keys: Vec<u64>,
    /// Where keys are sorted to.
    pub(super) spare_keys: Vec<u64>,
    pub(super) nodes: Vec<Node<S>>,
    pub(super) indices: Vec<u32>,
    pub(super) runs: Vec<Run<S>>,
}

impl<S> Default for Buffers<S> {
    fn default() -> Self {
        let (keys, spare_keys) = (Vec::new(), Vec::new());
        let (nodes, indices, runs) = (Vec::new(), Vec::new(), Vec::new());
        Self { references: Vec::new(), keys, spare_keys, nodes, indices, runs }
    }
}

impl<S> Buffers<S> {
    /// Takes over what is left of a tree.
    pub fn reclaim(&mut self, tree: Tree<S>) {
        let Tree { nodes, indices, runs, .. } = tree;
        keep(&mut self.nodes, nodes);
        keep(&mut self.indices, indices);
        keep(&mut self.runs, runs);
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of::<PrimRef<S>>() * self.references.capacity()
            + size_of::<u64>() * (self.keys.capacity() + self.spare_keys.capacity())
            + size_of::<Node<S>>() * self.nodes.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<Run<S>>() * self.runs.capacity()
    }
}

/// An empty buffer for so many: the kept one, unless it is too small, or so large that what is made of it would take much more
/// than it has to.
pub(super) fn buffer<T>(kept: &mut Vec<T>, len: usize) -> Vec<T> {
    if (len..=2 * len).contains(&kept.capacity()) { core::mem::take(kept) } else { Vec::with_capacity(len) }
}

/// Keeps the larger of two buffers, empty.
fn keep<T>(kept: &mut Vec<T>, left: Vec<T>) {
    if left.capacity() > kept.capacity() {
        *kept = left;
    }
    kept.clear();
}
