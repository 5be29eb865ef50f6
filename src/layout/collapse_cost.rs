//! The plan of the collapse from the binary tree to the wide tree.
//!
//! The plan selects the nodes that become the children of one wide node, and the
//! subtrees that become one leaf.
//!
//! It uses dynamic programming over the surface area heuristic (Ylitie, Karras and Laine, Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, HPG 2017). For each binary node
//! and each k up to N, it computes the least cost of everything below the node if a forest of at
//! most k roots represents it.
//!
//! ```text
//! forest(n, 1)  = min(leaf(n), node(n))
//! forest(n, k)  = min(forest(n, k - 1), split(n, k))
//! split(n, k)   = min over j of forest(left, j) + forest(right, k - j)
//! node(n)       = area(n) * NODE + split(n, N)
//! leaf(n)       = area(n) * LEAF, if its primitives fit into one leaf
//! ```
//!
//! Refused: opening the largest child until a node is full, as most collapses do. Closest hits are
//! found at 0.94 to 0.95 of the rate (measured: docs/decisions.md, 22).

use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::memory::{Word, lent};
use crate::parallel;
use crate::tree::{Child, MAX_DEPTH, Tree};
use alloc::vec::Vec;
use core::ops::Range;

/// The cost of a visit to a node: the unit of all costs.
const NODE: f32 = 1.0;

/// The cost of a visit to a leaf.
#[derive(Clone, Copy)]
pub struct LeafCost {
    /// The cost of each block of primitives that are tested at once.
    pub block: f32,
    /// The cost of each primitive.
    pub primitive: f32,
}

impl LeafCost {
    /// The cost of a leaf whose primitives are tested one by one.
    pub const ONE_BY_ONE: Self = Self { block: 0.0, primitive: 0.5 };

    fn of(self, count: u32) -> f32 {
        self.block * count.div_ceil(LEAF_WIDTH as u32) as f32 + self.primitive * count as f32
    }
}

/// The maximum number of nodes in a subtree that is weighed as one parallel task.
const SUBTREE: usize = 1 << 11;

/// The binary tree, with the costs of the wide trees that it may become.
pub(super) struct Plan<'t, S, const N: usize> {
    pub tree: &'t Tree<S>,
    /// The weight of each inner node.
    weights: &'t [Weight<N>],
    /// The scale of areas: 1 / (the largest extent of the tree's box).
    scale: S,
    leaf: LeafCost,
}

/// The costs and the slots of everything below a binary node.
#[derive(Clone, Copy)]
pub(super) struct Weight<const N: usize> {
    /// At index k - 1, the least cost of a forest of at most k roots.
    ///
    /// This is the SAH cost times the area of the tree's root.
    forest: [f32; N],
    /// The maximum number of roots: more roots are no cheaper.
    roots: usize,
    /// The number of primitives, and the first slot.
    slots: (u32, u32),
}

impl<'t, S: Scalar, const N: usize> Plan<'t, S, N> {
    /// Computes the weights of a tree, in memory whose content is not needed.
    pub fn new(tree: &'t Tree<S>, leaf: LeafCost, memory: &'t mut Vec<Word>) -> Self {
        let unknown = Weight { forest: [0.0; N], roots: 0, slots: (0, 0) };
        let weights = lent(memory, tree.nodes.len(), unknown);
        let plan = Self { tree, weights: &[], scale: tree.aabb.area_scale(), leaf };
        let (top, subtrees) = plan.divide();
        let (mut parts, mut rest, mut done) = (Vec::with_capacity(subtrees.len()), &mut *weights, 0);
        for nodes in subtrees {
            let (part, behind) = rest[nodes.start - done..].split_at_mut(nodes.len());
            parts.push((nodes.start, part));
            (rest, done) = (behind, nodes.end);
        }
        // Children are stored behind their parents, so each subtree is weighed from its end.
        parallel::each(&mut parts, |(first, weights)| {
            for place in (0..weights.len()).rev() {
                let (until, below) = weights.split_at_mut(place + 1);
                until[place] = plan.weight(*first + place, below);
            }
        });
        for index in top.into_iter().rev() {
            let (until, below) = weights.split_at_mut(index + 1);
            until[index] = plan.weight(index, below);
        }
        Self { weights, ..plan }
    }

    /// Returns the nodes above the small subtrees, and the small subtrees.
    ///
    /// Both are in the order of the nodes. A tree stores its nodes depth first: behind a node are
    /// the nodes of its left side, then the nodes of its right side.
    fn divide(&self) -> (Vec<usize>, Vec<Range<usize>>) {
        let (mut top, mut subtrees) = (Vec::new(), Vec::new());
        let mut open = alloc::vec![0..self.tree.nodes.len()];
        while let Some(nodes) = open.pop() {
            if nodes.len() <= SUBTREE {
                subtrees.push(nodes);
                continue;
            }
            let right = self.tree.nodes[nodes.start].children[1];
            let border = if right.is_leaf() { nodes.end } else { right.first as usize };
            top.push(nodes.start);
            open.push(border..nodes.end);
            open.push(nodes.start + 1..border);
        }
        (top, subtrees)
    }

    /// Returns the weight of node `index`.
    ///
    /// `below` holds the weights of the nodes that follow.
    fn weight(&self, index: usize, below: &[Weight<N>]) -> Weight<N> {
        let node = &self.tree.nodes[index];
        let weight = |side: usize| match node.children[side] {
            leaf if leaf.is_leaf() => self.weight_of_leaf(leaf, self.area(&node.aabb(side))),
            inner => below[inner.first as usize - index - 1],
        };
        let (left, right) = (weight(0), weight(1));
        let slots = (left.slots.0 + right.slots.0, left.slots.1.min(right.slots.1));
        let roots = (left.roots + right.roots).min(N);
        let area = self.area(&node.union());
        let mut forest = [f32::INFINITY; N];
        for (j, cost) in left.forest[..left.roots].iter().enumerate() {
            for (total, other) in forest[1..].iter_mut().skip(j).zip(&right.forest[..right.roots]) {
                *total = total.min(cost + other);
            }
        }
        forest[0] = (area * NODE + forest[roots - 1]).min(self.leaf_cost(area, slots.0));
        for k in 1..N {
            forest[k] = forest[k].min(forest[k - 1]);
        }
        Weight { forest, roots, slots }
    }

    fn weight_of_leaf(&self, leaf: Child, area: f32) -> Weight<N> {
        let cost = self.leaf.of(leaf.count);
        Weight { forest: [area * cost; N], roots: 1, slots: (leaf.count, leaf.first) }
    }

    /// Returns the cost of everything below an inner node as one leaf.
    fn leaf_cost(&self, area: f32, count: u32) -> f32 {
        if count as usize > LEAF_WIDTH { f32::INFINITY } else { area * self.leaf.of(count) }
    }

    pub fn area(&self, aabb: &Aabb<S>) -> f32 {
        aabb.scaled_half_area(self.scale).to_f64() as f32
    }

    /// Returns the number of primitives below a child, and the first slot.
    pub fn slots(&self, child: Child) -> (u32, u32) {
        if child.is_leaf() { (child.count, child.first) } else { self.weights[child.first as usize].slots }
    }

    /// Returns whether everything below a root becomes one leaf.
    pub fn is_leaf(&self, child: Child, aabb: &Aabb<S>) -> bool {
        let (count, _) = self.slots(child);
        count as usize <= LEAF_WIDTH
            && (child.is_leaf()
                || self.leaf_cost(self.area(aabb), count) <= self.weights[child.first as usize].forest[0])
    }

    /// Appends the roots that replace the children of a binary node, with their boxes.
    ///
    /// There are at most `N` of them.
    pub fn cheapest(&self, node: usize, roots: &mut Vec<(Child, Aabb<S>)>) {
        // The subtrees to split, each with its maximum number of roots.
        let mut open = Vec::with_capacity(MAX_DEPTH + 1);
        self.split(node, N, &mut open);
        while let Some((child, aabb, k)) = open.pop() {
            if child.is_leaf() {
                roots.push((child, aabb));
                continue;
            }
            let forest = &self.weights[child.first as usize].forest;
            // The smallest number of roots of that cost. Fewer roots never cost less, and more
            // roots never cost more.
            let fewest = 1 + forest.iter().filter(|&&cost| cost > forest[k - 1]).count();
            if fewest == 1 {
                roots.push((child, aabb));
            } else {
                self.split(child.first as usize, fewest, &mut open);
            }
        }
    }

    /// Distributes k roots over the two children of a node.
    fn split(&self, node: usize, k: usize, open: &mut Vec<(Child, Aabb<S>, usize)>) {
        let node = &self.tree.nodes[node];
        let side = |side: usize| match node.children[side] {
            leaf if leaf.is_leaf() => (&[0.0; N], 1),
            inner => {
                let weight = &self.weights[inner.first as usize];
                (&weight.forest, weight.roots)
            }
        };
        // The cost of a leaf is the same for every distribution, so leaving
        // it out changes no order.
        let ((left, most_left), (right, most_right)) = (side(0), side(1));
        let k = k.min(most_left + most_right);
        let (mut best, mut least) = (1, f32::INFINITY);
        for j in k.saturating_sub(most_right).max(1)..=most_left.min(k - 1) {
            let cost = left[j - 1] + right[k - j - 1];
            if cost < least {
                (best, least) = (j, cost);
            }
        }
        open.push((node.children[1], node.aabb(1), k - best));
        open.push((node.children[0], node.aabb(0), best));
    }

    /// Appends the roots at a fixed depth below a binary node.
    ///
    /// The depth is the number of levels that `N` roots have room for. A leaf above this
    /// depth is a root too. This function replaces [`cheapest`](Self::cheapest) in a tree
    /// that is too deep for it.
    pub fn by_levels(&self, node: usize, roots: &mut Vec<(Child, Aabb<S>)>) {
        let mut open = alloc::vec![(Child::inner(node), self.tree.aabb, 0)];
        while let Some((child, aabb, depth)) = open.pop() {
            if depth == N.ilog2() || (depth > 0 && self.is_leaf(child, &aabb)) || child.is_leaf() {
                roots.push((child, aabb));
            } else {
                let node = &self.tree.nodes[child.first as usize];
                open.extend([1, 0].map(|side| (node.children[side], node.aabb(side), depth + 1)));
            }
        }
    }
}
