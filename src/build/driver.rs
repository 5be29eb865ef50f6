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

use super::divide::{Rules, Set};
use super::heuristic::Heuristic;
use super::reference::{PrimRef, bounds};
use super::watch::{Pace, Watch};
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
    set: Set<'r, S>,
    /// The inner node and the side that will refer to it; none for the root.
    parent: Option<(usize, usize)>,
}

/// What is the same for all nodes.
struct Build<'h, S, H: ?Sized> {
    rules: &'h Rules<'h, H>,
    watch: &'h Watch<'h>,
    scene: Aabb<S>,
}

impl<S: Scalar, H: Heuristic<S> + ?Sized> Build<'_, S, H> {
    /// Two sets of one, or the set itself if it is to be a leaf.
    fn divide<'r>(&self, set: Set<'r, S>, pace: Pace) -> Result<[Set<'r, S>; 2], Set<'r, S>> {
        match pace {
            Pace::Steady => set.divide(self.rules, &self.scene),
            Pace::Hurry => set.halve(self.rules),
            Pace::Stop => Err(set),
        }
    }
}

/// Nodes with the child that refers to the first of them, and the indices in the slots of their leaves.
struct Subtree<S> {
    nodes: Vec<Node<S>>,
    root: Child,
    indices: Vec<u32>,
}

impl<S: Scalar> Subtree<S> {
    fn with_capacity(nodes: usize, indices: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(nodes),
            root: Child::default(),
            indices: Vec::with_capacity(indices),
        }
    }

    fn refer(&mut self, parent: Option<(usize, usize)>, child: Child) {
        match parent {
            Some((node, side)) => self.nodes[node].children[side] = child,
            None => self.root = child,
        }
    }

    /// Makes the inner node above two sides.
    fn push<'r>(&mut self, parent: Option<(usize, usize)>, sides: [Set<'r, S>; 2]) -> [OpenNode<'r, S>; 2] {
        let index = self.nodes.len();
        self.refer(parent, Child::inner(index));
        self.nodes.push(Node::new([sides[0].aabb, sides[1].aabb]));
        let [left, right] = sides;
        [OpenNode { set: left, parent: Some((index, 0)) }, OpenNode { set: right, parent: Some((index, 1)) }]
    }

    /// Makes a leaf.
    fn push_leaf(&mut self, parent: Option<(usize, usize)>, references: &[PrimRef<S>]) {
        let first = self.indices.len();
        self.indices.extend(references.iter().map(|reference| reference.index));
        self.refer(parent, Child::leaf(first..self.indices.len()));
    }
}

/// Builds the tree over valid references; none if it was told to stop.
pub(crate) fn build_tree<S: Scalar, H: Heuristic<S> + ?Sized>(
    mut references: Vec<PrimRef<S>>,
    rules: &Rules<'_, H>,
    watch: &Watch<'_>,
) -> Option<Tree<S>> {
    let aabb = bounds(&references);
    let primitives = references.len();
    if references.is_empty() {
        return Some(Tree {
            nodes: Vec::new(),
            root: Child::default(),
            aabb,
            indices: Vec::new(),
            primitives,
        });
    }
    rules.heuristic.prepare(&mut references, &aabb);
    // Slots have 32 bits.
    let most = primitives.saturating_add(rules.heuristic.spare(primitives)).min(u32::MAX as usize);
    references.resize(most, PrimRef::new(Aabb::EMPTY, u32::MAX));
    let build = Build { rules, watch, scene: aabb };
    let root = Set { memory: &mut references, len: primitives, aabb, depth: 0 };
    let (top, tasks) = build_top(OpenNode { set: root, parent: None }, &build);
    let subtrees = parallel::map(tasks, |task| build_subtree(task, &build));
    if watch.ask() == Pace::Stop {
        return None;
    }
    let Subtree { nodes, root, indices } = join(top, &subtrees);
    Some(Tree { nodes, root, aabb, indices, primitives })
}

/// Instead of the number of a node, in the top: the number of a task, counted from the end.
fn task_child(task: usize) -> Child {
    Child::inner(u32::MAX as usize - task)
}

/// Divides all sets of more than [`TASK_SIZE`] references, and returns the others as tasks.
fn build_top<'r, S: Scalar, H: Heuristic<S> + ?Sized>(
    root: OpenNode<'r, S>,
    build: &Build<'_, S, H>,
) -> (Subtree<S>, Vec<Set<'r, S>>) {
    let mut top = Subtree::with_capacity(0, 0);
    let mut tasks = Vec::new();
    let mut level = vec![root];
    while !level.is_empty() {
        let (large, small): (Vec<_>, Vec<_>) = level.into_iter().partition(|node| node.set.len > TASK_SIZE);
        for task in small {
            top.refer(task.parent, task_child(tasks.len()));
            tasks.push(task.set);
        }
        let parents: Vec<_> = large.iter().map(|node| node.parent).collect();
        level = Vec::new();
        let divided = parallel::map(large, |node| build.divide(node.set, build.watch.ask()));
        for (parent, divided) in parents.into_iter().zip(divided) {
            match divided {
                Ok(sides) => level.extend(top.push(parent, sides)),
                Err(set) => top.push_leaf(parent, set.references()),
            }
        }
    }
    (top, tasks)
}

/// Builds everything below one set, depth first: a left child is the node after its parent.
fn build_subtree<S: Scalar, H: Heuristic<S> + ?Sized>(
    root: Set<'_, S>,
    build: &Build<'_, S, H>,
) -> Subtree<S> {
    let (pace, len) = (build.watch.ask(), root.len);
    let mut subtree = Subtree::with_capacity(len / 4, len);
    let mut open = vec![OpenNode { set: root, parent: None }];
    while let Some(OpenNode { set, parent }) = open.pop() {
        match build.divide(set, pace) {
            Ok(sides) => {
                let [left, right] = subtree.push(parent, sides);
                open.push(right);
                open.push(left);
            }
            Err(set) => subtree.push_leaf(parent, set.references()),
        }
    }
    build.watch.place(len);
    subtree
}

/// The top and the subtrees of its tasks as one tree, a left child the node after its parent everywhere, and slots in the
/// order of the leaves.
fn join<S: Scalar>(top: Subtree<S>, subtrees: &[Subtree<S>]) -> Subtree<S> {
    let sum = |count: fn(&Subtree<S>) -> usize| subtrees.iter().map(count).sum::<usize>() + count(&top);
    let mut joined =
        Subtree::with_capacity(sum(|subtree| subtree.nodes.len()), sum(|subtree| subtree.indices.len()));
    let mut open = vec![(None, top.root)];
    while let Some((parent, child)) = open.pop() {
        let (base, first) = (joined.nodes.len(), joined.indices.len());
        if child.is_leaf() {
            joined.indices.extend_from_slice(&top.indices[child.slots()]);
            joined.refer(parent, Child::leaf(first..joined.indices.len()));
        } else if let Some(node) = top.nodes.get(child.first as usize) {
            joined.refer(parent, Child::inner(base));
            joined.nodes.push(*node);
            open.extend([1, 0].map(|side| (Some((base, side)), node.children[side])));
        } else {
            let subtree = &subtrees[(u32::MAX - child.first) as usize];
            let moved = |child: Child| Child {
                first: child.first + if child.is_leaf() { first } else { base } as u32,
                ..child
            };
            joined.refer(parent, moved(subtree.root));
            joined.indices.extend_from_slice(&subtree.indices);
            let nodes = subtree.nodes.iter();
            joined.nodes.extend(nodes.map(|node| Node { children: node.children.map(moved), ..*node }));
        }
    }
    joined
}
