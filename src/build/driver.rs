//! The order of the build: large nodes level by level, the many small ones as tasks of their own.
//!
//! 1. **Top.** All open nodes of a level are divided at once, on all threads; those with at most
//!    [`TASK_SIZE`] references become tasks.
//! 2. **Tasks.** Each builds its subtree into a list of its own, depth first.
//! 3. **Join.** The top and the lists are laid out depth first.
//!
//! Every result has a place that follows from the data alone, never from the threads: the tree is
//! the same on any number of them. Nothing recurses: neither stack depth nor time hang on a
//! heuristic's good will.

use super::divide::{Rules, divide};
use super::heuristic::Heuristic;
use super::reference::{PrimRef, bounds};
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
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
    aabb: Aabb<S>,
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
        let Some(division) = divide(self.references, &self.aabb, self.depth, rules) else {
            return Err(self);
        };
        let depth = self.depth + 1;
        let (left, right) = self.references.split_at_mut(division.middle);
        let [left_aabb, right_aabb] = division.sides;
        let first = self.first + division.middle;
        Ok([
            OpenNode { references: left, first: self.first, aabb: left_aabb, depth, parent: None },
            OpenNode { references: right, first, aabb: right_aabb, depth, parent: None },
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
        self.nodes.push(Node::new([sides[0].aabb, sides[1].aabb]));
        for (side, node) in sides.iter_mut().enumerate() {
            node.parent = Some((index, side));
        }
    }
}

/// Builds the tree over valid references, and reorders them as its slots are. `indices` of the
/// result are those of the references.
pub(crate) fn build_tree<S: Scalar, H: Heuristic<S> + ?Sized>(
    references: &mut [PrimRef<S>],
    rules: &Rules<'_, H>,
) -> Tree<S> {
    let aabb = bounds(references);
    if references.is_empty() {
        return Tree { nodes: Vec::new(), root: Child::default(), aabb, indices: Vec::new() };
    }
    let (top, tasks) = build_top(OpenNode { references, first: 0, aabb, depth: 0, parent: None }, rules);
    let subtrees = parallel::map(tasks, |task| build_subtree(task, rules));
    let Subtree { nodes, root } = join(top, &subtrees);
    let indices = references.iter().map(|reference| reference.index).collect();
    Tree { nodes, root, aabb, indices }
}

/// Instead of the number of a node, in the top: the number of a task, counted from the end.
fn task_child(task: usize) -> Child {
    Child::inner(u32::MAX as usize - task)
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
        for task in small {
            top.refer(task.parent, task_child(tasks.len()));
            tasks.push(task);
        }
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

/// The top and the subtrees of its tasks as one tree, a left child the node after its parent everywhere.
fn join<S: Scalar>(top: Subtree<S>, subtrees: &[Subtree<S>]) -> Subtree<S> {
    let count = subtrees.iter().fold(top.nodes.len(), |count, subtree| count + subtree.nodes.len());
    let mut joined = Subtree::with_capacity(count);
    let mut open = vec![(None, top.root)];
    while let Some((parent, child)) = open.pop() {
        let base = joined.nodes.len();
        let moved = |child: Child| {
            if child.is_leaf() { child } else { Child::inner(base + child.first as usize) }
        };
        if child.is_leaf() {
            joined.refer(parent, child);
        } else if let Some(node) = top.nodes.get(child.first as usize) {
            joined.refer(parent, Child::inner(base));
            joined.nodes.push(*node);
            open.extend([1, 0].map(|side| (Some((base, side)), node.children[side])));
        } else {
            let subtree = &subtrees[(u32::MAX - child.first) as usize];
            joined.refer(parent, moved(subtree.root));
            let nodes = subtree.nodes.iter();
            joined.nodes.extend(nodes.map(|node| Node { children: node.children.map(moved), ..*node }));
        }
    }
    joined
}
