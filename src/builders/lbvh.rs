//! The build without splits: references are sorted by codes along a curve, and the tree follows the codes' bits.
//!
//! ```text
//! codes -> curve -> top, split where the highest bit changes, down to tasks -> tasks, each in one pass from the leaves up
//!       -> joined
//! ```
//!
//! No path is longer than a key has bits, of which there are [`MAX_DEPTH`](crate::MAX_DEPTH) at the most: each step down
//! settles one.

use super::buffers::Buffers;
use super::morton_order::{Curve, difference};
use super::progress::{BuildControl, Progress};
use super::reference::{PrimRef, bounds};
use super::subtree::{Subtree, join, task_of};
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::simd::prefetch;
use crate::tree::{Child, Node};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// How many references before one's turn it is asked for.
const AHEAD: usize = 32;

/// The subtree over references, as many as there are codes, and at least one, no deeper than `depth`, in which there is
/// room for as many.
pub(super) fn build<S: Scalar>(
    references: &[PrimRef<S>],
    mut codes: Vec<u64>,
    depth: usize,
    max_leaf_size: usize,
    progress: &Progress<'_>,
    buffers: &mut Buffers<S>,
) -> Subtree<S> {
    let mut spare = vec![0; codes.len()];
    let curve = Curve::new(&mut codes, &mut spare, depth);
    let (mut top, tasks) = curve.divide();
    let order = Order { references, curve: &curve, max_leaf_size };
    let built = parallel::map(tasks, |task: Range<usize>| {
        if progress.poll() == BuildControl::Stop {
            return (Subtree::with_capacity(0, 0), Aabb::EMPTY);
        }
        progress.place(task.len());
        let mut subtree = Subtree::with_capacity(task.len() / 4, task.len());
        let root = order.build(&curve.keys[task], &mut subtree, &mut Vec::new());
        subtree.root = root.child;
        (subtree, root.aabb)
    });
    let (subtrees, boxes): (Vec<_>, Vec<_>) = built.into_iter().unzip();
    // Children lie behind their parents.
    for index in (0..top.nodes.len()).rev() {
        let children = top.nodes[index].children;
        let boxes = children.map(|child| match task_of(child, &top) {
            Some(task) => boxes[task],
            None => top.nodes[child.first as usize].union(),
        });
        top.nodes[index] = Node { children, ..Node::new(boxes) };
    }
    join(top, &subtrees.iter().map(Subtree::all).collect::<Vec<_>>(), buffers)
}

/// What the keys stand for.
pub(super) struct Order<'r, S> {
    pub references: &'r [PrimRef<S>],
    pub curve: &'r Curve<'r>,
    pub max_leaf_size: usize,
}

/// Neighbouring keys below one node, or in one leaf that may still grow.
pub(super) struct Part<S> {
    keys: Range<usize>,
    root: Option<Root<S>>,
}

/// The root of a finished tree.
#[derive(Clone, Copy)]
pub(super) struct Root<S> {
    pub child: Child,
    pub aabb: Aabb<S>,
    /// Of the longest path below, in steps.
    pub height: usize,
}

impl<S: Scalar> Order<'_, S> {
    /// Appends the tree over sorted keys, at least one, to the nodes and the indices of `subtree`: numbers in it are counted from
    /// there. `open` is memory, empty before and after.
    ///
    /// A node ends where neighbouring keys differ in a higher bit than any two inside. Keys come from the right, and the
    /// nodes that await what is on their left lie on a stack: so nodes are made right side first and parents last,
    /// which backwards is depth first.
    pub fn build(&self, keys: &[u64], subtree: &mut Subtree<S>, open: &mut Vec<Part<S>>) -> Root<S> {
        let start = subtree.nodes.len();
        for first in (0..keys.len()).rev() {
            if let Some(ahead) = first.checked_sub(AHEAD) {
                self.ask_for(&keys[ahead]);
            }
            let mut part = Part { keys: first..first + 1, root: None };
            let on_the_left = difference(keys, first);
            while difference(keys, part.keys.end) < on_the_left
                && let Some(right) = open.pop()
            {
                part = self.above(part, right, keys, start, &mut subtree.nodes);
            }
            open.push(part);
        }
        let mut root = self.settled(open.pop().unwrap_or(Part { keys: 0..0, root: None }), keys);
        subtree.indices.extend(keys.iter().map(|key| self.reference(key).index));
        // Numbers are counted from the last node made.
        let nodes = &mut subtree.nodes[start..];
        let last = nodes.len().wrapping_sub(1) as u32;
        let turned =
            |child: Child| if child.is_leaf() { child } else { Child { first: last - child.first, ..child } };
        nodes.reverse();
        for node in nodes {
            node.children = node.children.map(turned);
        }
        root.child = turned(root.child);
        root
    }

    /// The node above two parts, or a leaf of both.
    fn above(
        &self,
        left: Part<S>,
        right: Part<S>,
        keys: &[u64],
        start: usize,
        nodes: &mut Vec<Node<S>>,
    ) -> Part<S> {
        let both = left.keys.start..right.keys.end;
        if both.len() <= self.max_leaf_size {
            return Part { keys: both, root: None };
        }
        let (left, right) = (self.settled(left, keys), self.settled(right, keys));
        let child = Child::inner(nodes.len() - start);
        nodes.push(Node { children: [left.child, right.child], ..Node::new([left.aabb, right.aabb]) });
        let height = 1 + left.height.max(right.height);
        Part { keys: both, root: Some(Root { child, aabb: left.aabb.union(right.aabb), height }) }
    }

    /// A part that does not grow any more.
    fn settled(&self, part: Part<S>, keys: &[u64]) -> Root<S> {
        let leaf = || Root {
            child: Child::leaf(part.keys.clone()),
            aabb: self.bounds(&keys[part.keys.clone()]),
            height: 0,
        };
        part.root.unwrap_or_else(leaf)
    }

    /// The box around what keys stand for.
    pub fn bounds(&self, keys: &[u64]) -> Aabb<S> {
        bounds(keys.iter().map(|key| self.reference(key)))
    }

    pub fn reference(&self, key: &u64) -> &PrimRef<S> {
        &self.references[self.curve.place(*key)]
    }

    /// Those of keys, in their order.
    pub fn sorted(&self, keys: &[u64]) -> Vec<PrimRef<S>> {
        let ahead = keys.iter().skip(AHEAD).map(Some).chain(core::iter::repeat(None));
        let in_order = keys.iter().zip(ahead).map(|(key, ahead)| {
            ahead.inspect(|key| self.ask_for(key));
            *self.reference(key)
        });
        in_order.collect()
    }

    /// PackedQuery for a reference to be brought into the cache: they lie in the input's order.
    #[inline(always)]
    fn ask_for(&self, key: &u64) {
        prefetch(core::ptr::from_ref(self.reference(key)).cast(), size_of::<PrimRef<S>>());
    }
}
