//! The order of the build: large nodes level by level, the many small ones as tasks of their own.
//!
//! 1. **Top.** All open nodes of a level are divided at once, on all threads; those with at most
//!    [`TASK_SIZE`] references become tasks.
//! 2. **Tasks.** Each builds its subtree into a list of its own, depth first.
//! 3. **Join.** The lists are laid one after another behind the top's nodes.
//!
//! Every result has a place that follows from the data alone, never from the threads: the tree is
//! the same on any number of them. Nothing recurses: neither stack depth nor time hang on a
//! heuristic's good will.

use super::divide::{Rules, divide};
use super::heuristic::Heuristic;
use super::parallel;
use super::reference::{Extent, PrimRef};
use crate::geometry::Scalar;
use crate::tree::{Child, Node, Tree};
use alloc::vec;
use alloc::vec::Vec;

/// References in a task at the most: small enough to keep threads evenly busy, large enough to
/// make handing out work free.
const TASK_SIZE: usize = 4096;

/// A set of references that is to become a subtree.
struct OpenNode<'r, S> {
    references: &'r mut [PrimRef<S>],
    /// The slot of its first reference.
    first: usize,
    extent: Extent<S>,
    depth: usize,
    /// The inner node and the side that will refer to it; none for the root.
    parent: Option<(usize, usize)>,
}

impl<S: Scalar> OpenNode<'_, S> {
    fn leaf(&self) -> Child {
        Child::leaf(self.first..self.first + self.references.len())
    }
}

impl<'r, S: Scalar> OpenNode<'r, S> {
    /// Divides the set in two, or answers `Err` with itself if it is to be a leaf.
    fn divide<H: Heuristic<S> + ?Sized>(self, rules: &Rules<'_, H>) -> Result<[Self; 2], Self> {
        let Some(division) = divide(self.references, &self.extent, self.depth, rules) else {
            return Err(self);
        };
        let depth = self.depth + 1;
        let (left, right) = self.references.split_at_mut(division.middle);
        let [left_extent, right_extent] = division.sides;
        let first = self.first + division.middle;
        Ok([
            OpenNode { references: left, first: self.first, extent: left_extent, depth, parent: None },
            OpenNode { references: right, first, extent: right_extent, depth, parent: None },
        ])
    }
}

/// Nodes with the child that refers to the first of them.
struct Subtree<S> {
    nodes: Vec<Node<S>>,
    root: Child,
}

impl<S: Scalar> Subtree<S> {
    fn with_capacity(nodes: usize) -> Self {
        Self { nodes: Vec::with_capacity(nodes), root: Child::default() }
    }

    fn refer(&mut self, parent: Option<(usize, usize)>, child: Child) {
        match parent {
            Some((node, side)) => self.nodes[node].children[side] = child,
            None => self.root = child,
        }
    }

    /// Makes the inner node above two sides and tells them of it.
    fn push(&mut self, parent: Option<(usize, usize)>, sides: &mut [OpenNode<'_, S>; 2]) {
        let index = self.nodes.len();
        self.refer(parent, Child::inner(index));
        self.nodes.push(Node::new([sides[0].extent.aabb, sides[1].extent.aabb]));
        for (side, node) in sides.iter_mut().enumerate() {
            node.parent = Some((index, side));
        }
    }
}

/// Builds the tree over valid references, and reorders them as its slots are. `indices` of the
/// result are those of the references.
pub(crate) fn build_tree<S: Scalar, H: Heuristic<S> + ?Sized>(
    references: &mut [PrimRef<S>],
    heuristic: &H,
    max_leaf_size: usize,
) -> Tree<S> {
    if references.is_empty() {
        let aabb = Extent::EMPTY.aabb;
        return Tree { nodes: Vec::new(), root: Child::default(), aabb, indices: Vec::new() };
    }
    let rules = Rules { heuristic, max_leaf_size };
    let extent = Extent::of(references);
    let (mut tree, tasks) =
        build_top(OpenNode { references, first: 0, extent, depth: 0, parent: None }, &rules);
    let parents: Vec<_> = tasks.iter().map(|task| task.parent).collect();
    let subtrees = parallel::map(tasks, |task| build_subtree(task, &rules));
    for (parent, subtree) in parents.into_iter().zip(subtrees) {
        join(&mut tree, parent, subtree);
    }
    let indices = references.iter().map(|reference| reference.index).collect();
    Tree { nodes: tree.nodes, root: tree.root, aabb: extent.aabb, indices }
}

/// Divides all sets of more than [`TASK_SIZE`] references, and returns the others as tasks.
fn build_top<'r, S: Scalar, H: Heuristic<S> + ?Sized>(
    root: OpenNode<'r, S>,
    rules: &Rules<'_, H>,
) -> (Subtree<S>, Vec<OpenNode<'r, S>>) {
    let mut top = Subtree::with_capacity(0);
    let mut tasks = Vec::new();
    let mut level = vec![root];
    while !level.is_empty() {
        let (large, small): (Vec<_>, Vec<_>) =
            level.into_iter().partition(|node| node.references.len() > TASK_SIZE);
        tasks.extend(small);
        let parents: Vec<_> = large.iter().map(|node| node.parent).collect();
        level = Vec::new();
        for (parent, divided) in parents.into_iter().zip(parallel::map(large, |node| node.divide(rules))) {
            match divided {
                Ok(mut sides) => {
                    top.push(parent, &mut sides);
                    level.extend(sides);
                }
                Err(node) => top.refer(parent, node.leaf()),
            }
        }
    }
    (top, tasks)
}

/// Builds everything below one set, depth first: a left child is the node after its parent.
fn build_subtree<S: Scalar, H: Heuristic<S> + ?Sized>(
    root: OpenNode<'_, S>,
    rules: &Rules<'_, H>,
) -> Subtree<S> {
    let mut subtree = Subtree::with_capacity(root.references.len() / 2);
    let mut open = vec![OpenNode { parent: None, ..root }];
    while let Some(node) = open.pop() {
        let parent = node.parent;
        match node.divide(rules) {
            Ok(mut sides) => {
                subtree.push(parent, &mut sides);
                let [left, right] = sides;
                open.push(right);
                open.push(left);
            }
            Err(node) => subtree.refer(parent, node.leaf()),
        }
    }
    subtree
}

/// Appends a subtree's nodes and makes `parent` refer to them.
fn join<S: Scalar>(tree: &mut Subtree<S>, parent: Option<(usize, usize)>, subtree: Subtree<S>) {
    let base = tree.nodes.len();
    let moved =
        |child: Child| if child.is_leaf() { child } else { Child::inner(base + child.first as usize) };
    tree.refer(parent, moved(subtree.root));
    tree.nodes
        .extend(subtree.nodes.into_iter().map(|node| Node { children: node.children.map(moved), ..node }));
}
