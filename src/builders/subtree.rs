//! Subtrees that were built separately, and the tree that joins them.

use super::buffers::Buffers;
use crate::geometry::{Aabb, Scalar};
use crate::memory::fitting;
use crate::parallel;
use crate::tree::{Child, LeafRange, Node};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// Maximum number of references in a task.
///
/// Small enough to keep threads evenly busy, large enough to make handing out work free.
pub(super) const TASK_SIZE: usize = 4096;

/// A subtree: its nodes, its root and the primitive indices of its leaves.
pub(super) struct Subtree<S> {
    pub nodes: Vec<Node<S>>,
    pub root: Child,
    pub indices: Vec<u32>,
    /// The leaf ranges of large leaves, in the order of the slots.
    pub leaf_ranges: Vec<LeafRange<S>>,
}

/// A subtree that is stored among others.
#[derive(Clone, Copy)]
pub(super) struct Piece<'s, S> {
    pub nodes: &'s [Node<S>],
    pub root: Child,
    pub indices: &'s [u32],
    pub leaf_ranges: &'s [LeafRange<S>],
}

/// The inner node and the side that refer to a child; `None` for the root.
pub(super) type Parent = Option<(usize, usize)>;

impl<S: Scalar> Subtree<S> {
    pub fn with_capacity(nodes: usize, indices: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(nodes),
            root: Child::default(),
            indices: Vec::with_capacity(indices),
            leaf_ranges: Vec::new(),
        }
    }

    pub fn refer(&mut self, parent: Parent, child: Child) {
        match parent {
            Some((node, side)) => self.nodes[node].children[side] = child,
            None => self.root = child,
        }
    }

    /// Returns the whole subtree as a piece.
    pub fn all(&self) -> Piece<'_, S> {
        Piece { nodes: &self.nodes, root: self.root, indices: &self.indices, leaf_ranges: &self.leaf_ranges }
    }

    /// Appends an inner node above children with these boxes; returns its number.
    pub fn push(&mut self, parent: Parent, boxes: [Aabb<S>; 2]) -> usize {
        let index = self.nodes.len();
        self.refer(parent, Child::inner(index));
        self.nodes.push(Node::new(boxes));
        index
    }

    /// Appends a leaf with these primitive indices.
    pub fn push_leaf(&mut self, parent: Parent, indices: impl Iterator<Item = u32>) {
        let first = self.indices.len();
        self.indices.extend(indices);
        self.refer(parent, Child::leaf(first..self.indices.len()));
    }
}

/// Returns the child that stands for a task in the top.
///
/// In place of the number of a node, it has the number of the task, counted down from `u32::MAX`.
pub(super) fn task_child(task: usize) -> Child {
    Child::inner(u32::MAX as usize - task)
}

/// Returns the number of the task that a child of the top stands for, if any.
pub(super) fn task_of<S>(child: Child, top: &Subtree<S>) -> Option<usize> {
    let is_task = !child.is_leaf() && child.first as usize >= top.nodes.len();
    is_task.then(|| (u32::MAX - child.first) as usize)
}

/// Joins the top and the subtrees of its tasks into one tree.
///
/// The top has no leaves. In the result, a left child is the node after its parent everywhere, and
/// slots are in the order of the leaves.
pub(super) fn join<S: Scalar>(
    mut top: Subtree<S>,
    subtrees: &[Piece<'_, S>],
    buffers: &mut Buffers<S>,
) -> Subtree<S> {
    // The lists of nodes, slots and leaf ranges to join, in order. The numbers in the lists of a
    // subtree grow by the offset beside them.
    let (mut nodes, mut slots) = (Vec::<(Range<usize>, Option<usize>, Move)>::new(), Vec::<&[u32]>::new());
    let mut leaf_ranges = Vec::<(&[LeafRange<S>], Move)>::new();
    let mut end = Move { node: 0, slot: 0 };
    let mut open = vec![(None, top.root)];
    while let Some((parent, child)) = open.pop() {
        let moved = if let Some(task) = task_of(child, &top) {
            let Piece { nodes: inner, root, indices, leaf_ranges: parts } = subtrees[task];
            let root = end.of(root);
            if !parts.is_empty() {
                leaf_ranges.push((parts, end));
            }
            nodes.push((0..inner.len(), Some(task), end));
            slots.push(indices);
            end = Move { node: end.node + inner.len() as u32, slot: end.slot + indices.len() as u32 };
            root
        } else {
            let node = child.first as usize;
            open.extend([1, 0].map(|side| (Some((node, side)), top.nodes[node].children[side])));
            nodes.push((node..node + 1, None, Move { node: 0, slot: 0 }));
            end.node += 1;
            Child::inner(end.node as usize - 1)
        };
        top.refer(parent, moved);
    }
    let lens: Vec<_> = slots.iter().map(|slots| slots.len()).collect();
    let indices =
        parallel::concat(fitting(&mut buffers.indices, lens.iter().sum()), &lens, &|part, places| {
            places.extend(slots[part].iter().copied());
        });
    let lens: Vec<_> = nodes.iter().map(|(range, ..)| range.len()).collect();
    let moved = parallel::concat(fitting(&mut buffers.nodes, lens.iter().sum()), &lens, &|part, places| {
        let (range, task, by) = &nodes[part];
        let nodes = &task.map_or(&top.nodes[..], |task| subtrees[task].nodes)[range.clone()];
        let moved = |node: &Node<S>| Node { children: node.children.map(|child| by.of(child)), ..*node };
        places.extend(nodes.iter().map(moved));
    });
    let lens: Vec<_> = leaf_ranges.iter().map(|(leaf_ranges, _)| leaf_ranges.len()).collect();
    let leaf_ranges =
        parallel::concat(fitting(&mut buffers.leaf_ranges, lens.iter().sum()), &lens, &|part, places| {
            let (leaf_ranges, by) = leaf_ranges[part];
            places.extend(leaf_ranges.iter().map(|run| LeafRange { leaf: by.of(run.leaf), ..*run }));
        });
    Subtree { nodes: moved, root: top.root, indices, leaf_ranges }
}

/// Offsets that are added to the numbers of nodes and of slots.
#[derive(Clone, Copy)]
struct Move {
    node: u32,
    slot: u32,
}

impl Move {
    fn of(self, child: Child) -> Child {
        Child { first: child.first + if child.is_leaf() { self.slot } else { self.node }, ..child }
    }
}
