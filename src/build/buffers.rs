//! Memory that one build leaves to the next.

use super::reference::PrimRef;
use crate::tree::{Node, Run, Tree};
use alloc::vec::Vec;
use core::mem::take;

/// The large buffers of a build; what is left in them is of no use. Small ones, of which there are many, come from the allocator
/// every time.
pub(crate) struct Buffers<S> {
    /// What the tree is to be built of: the input of a build.
    pub references: Vec<PrimRef<S>>,
    /// Codes, which become sorted keys.
    pub(super) keys: Vec<u64>,
    /// Where keys are sorted to.
    pub(super) spare_keys: Vec<u64>,
    pub(super) nodes: Vec<Node<S>>,
    pub(super) indices: Vec<u32>,
    pub(super) runs: Vec<Run<S>>,
    /// For another build; else they are freed as soon as they are not needed.
    pub are_kept: bool,
}

impl<S> Default for Buffers<S> {
    fn default() -> Self {
        let (keys, spare_keys) = (Vec::new(), Vec::new());
        let (nodes, indices, runs) = (Vec::new(), Vec::new(), Vec::new());
        Self { references: Vec::new(), keys, spare_keys, nodes, indices, runs, are_kept: false }
    }
}

impl<S> Buffers<S> {
    /// Takes over what is left of a tree.
    pub fn reclaim(&mut self, tree: Tree<S>) {
        let Tree { nodes, indices, runs, .. } = tree;
        keep_larger(&mut self.nodes, nodes);
        keep_larger(&mut self.indices, indices);
        keep_larger(&mut self.runs, runs);
    }

    /// Frees all, unless they are kept.
    pub fn are_done(&mut self) {
        if !self.are_kept {
            *self = Self::default();
        }
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
/// than it has to. In place of one that is too small, one that is larger by an eighth, for what goes on to grow.
pub(crate) fn fitting<T>(kept: &mut Vec<T>, len: usize) -> Vec<T> {
    kept.clear();
    match kept.capacity() {
        capacity if capacity == 0 || capacity > 2 * len => Vec::with_capacity(len),
        capacity if capacity >= len => take(kept),
        _ => {
            drop(take(kept));
            Vec::with_capacity(len + len / 8)
        }
    }
}

/// Keeps the larger of two buffers, whatever is in them.
pub(crate) fn keep_larger<T>(kept: &mut Vec<T>, other: Vec<T>) {
    if other.capacity() > kept.capacity() {
        *kept = other;
    }
}
