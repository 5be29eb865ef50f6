//! Builds without splits: a tree that follows the bits of sorted codes.
//!
//! ```text
//! codes -> sorted keys -> top: split where the highest bit changes, down to tasks
//!                      -> tasks: each in one pass from the leaves up
//!                      -> joined
//! ```
//!
//! References are sorted by codes along a curve. No path is longer than the number of bits in a
//! key, which is at most [`MAX_DEPTH`](crate::MAX_DEPTH): each step down settles one bit.

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

/// Prefetch distance, in references.
const AHEAD: usize = 32;

/// Builds the subtree over references, no deeper than `depth`.
///
/// Requires as many codes as references, and at least one. `depth` bits must be enough for the
/// place of a reference.
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
    // Children are stored after their parents.
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

/// The references that keys stand for, and the largest leaf.
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
    /// The length of the longest path down to a leaf, in steps.
    pub height: usize,
}

impl<S: Scalar> Order<'_, S> {
    /// Appends the tree over sorted keys to `subtree`, and returns its root.
    ///
    /// Requires at least one key. In the new nodes, the numbers of nodes and slots are counted from
    /// the first one appended. `open` is scratch memory, empty before and after.
    ///
    /// A node ends where neighbouring keys differ in a higher bit than any two keys inside. Keys
    /// are visited from right to left. Nodes that wait for the part on their left are on a stack.
    /// So right sides are made first and parents last, which in reverse is depth first.
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
        // Reversed: numbers are counted from the last node made.
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

    /// Returns the node above two parts, or a leaf of both.
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

    /// Returns the root of a part that does not grow any more.
    fn settled(&self, part: Part<S>, keys: &[u64]) -> Root<S> {
        let leaf = || Root {
            child: Child::leaf(part.keys.clone()),
            aabb: self.bounds(&keys[part.keys.clone()]),
            height: 0,
        };
        part.root.unwrap_or_else(leaf)
    }

    /// Returns the box around the references of keys.
    pub fn bounds(&self, keys: &[u64]) -> Aabb<S> {
        bounds(keys.iter().map(|key| self.reference(key)))
    }

    pub fn reference(&self, key: &u64) -> &PrimRef<S> {
        &self.references[self.curve.place(*key)]
    }

    /// Returns the references of keys, in the order of the keys.
    pub fn sorted(&self, keys: &[u64]) -> Vec<PrimRef<S>> {
        let ahead = keys.iter().skip(AHEAD).map(Some).chain(core::iter::repeat(None));
        let in_order = keys.iter().zip(ahead).map(|(key, ahead)| {
            ahead.inspect(|key| self.ask_for(key));
            *self.reference(key)
        });
        in_order.collect()
    }

    /// Prefetches a reference: references are stored in the order of the input.
    #[inline(always)]
    fn ask_for(&self, key: &u64) {
        prefetch(core::ptr::from_ref(self.reference(key)).cast(), size_of::<PrimRef<S>>());
    }
}
