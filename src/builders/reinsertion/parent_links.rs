//! A tree whose nodes are linked to their parents.

use super::search::Move;
use crate::geometry::{Aabb, Scalar};
use crate::memory::{Word, lent};
use crate::tree::{Child, LeafRange, MAX_DEPTH, Node, Tree};
use alloc::vec::Vec;
use core::mem::take;

/// A tree whose nodes know their parents, boxes and heights.
///
/// Inner nodes come first, then leaves.
pub(super) struct Linked<'m, S> {
    nodes: &'m mut [LinkedNode<S>],
    /// The children of each inner node.
    children: Vec<[u32; 2]>,
    /// The slots of each leaf.
    leaves: Vec<Child>,
    /// The scale for [`Aabb::scaled_half_area`]: 1 / the largest extent.
    scale: S,
}

#[derive(Clone, Copy)]
struct LinkedNode<S> {
    aabb: Aabb<S>,
    parent: u32,
    /// The length of the longest path down to a leaf, in steps.
    height: u32,
}

/// A move that was applied, with the data to undo it.
struct Moved {
    /// The decrease of the sum of areas.
    gain: f64,
    /// The children of the node's parent before the move.
    children: [u32; 2],
    /// The nodes that the move concerns.
    ///
    /// In this order: the node, its parent, its sibling, its grandparent, the new sibling, and the
    /// parent that the new sibling had before the move.
    concerned: [u32; 6],
}

impl<'m, S: Scalar> Linked<'m, S> {
    /// The number of the root, which is an inner node.
    pub const ROOT: u32 = 0;

    /// Links the nodes of a tree; `None` if it has fewer than three leaves.
    ///
    /// In a smaller tree nothing can be moved. `memory` holds the nodes; its old content is lost.
    pub fn new(tree: &Tree<S>, memory: &'m mut Vec<Word>) -> Option<Self> {
        let inner = tree.nodes.len();
        if inner < 2 {
            return None;
        }
        let unknown = LinkedNode { aabb: tree.aabb, parent: u32::MAX, height: 0 };
        let mut linked = Self {
            nodes: lent(memory, 2 * inner + 1, unknown),
            children: Vec::with_capacity(inner),
            leaves: Vec::with_capacity(inner + 1),
            scale: tree.aabb.area_scale(),
        };
        for (parent, node) in (0..).zip(&tree.nodes) {
            let mut link = |side: usize| {
                let child = match node.children[side] {
                    leaf if leaf.is_leaf() => {
                        linked.leaves.push(leaf);
                        (inner + linked.leaves.len() - 1) as u32
                    }
                    inner => inner.first,
                };
                linked.nodes[child as usize] = LinkedNode { aabb: node.aabb(side), parent, height: 0 };
                child
            };
            let children = [link(0), link(1)];
            linked.children.push(children);
        }
        // Children are stored after their parents.
        for node in (0..inner).rev() {
            linked.nodes[node].height = linked.height_above(linked.children[node]);
        }
        Some(linked)
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    #[inline(always)]
    pub fn aabb(&self, node: u32) -> &Aabb<S> {
        &self.nodes[node as usize].aabb
    }

    #[inline(always)]
    pub fn area_of(&self, aabb: &Aabb<S>) -> S {
        aabb.scaled_half_area(self.scale)
    }

    #[inline(always)]
    pub fn area(&self, node: u32) -> S {
        self.area_of(self.aabb(node))
    }

    #[inline(always)]
    pub fn parent(&self, node: u32) -> u32 {
        self.nodes[node as usize].parent
    }

    /// Returns the children of an inner node; `None` for a leaf.
    #[inline(always)]
    pub fn children(&self, node: u32) -> Option<[u32; 2]> {
        self.children.get(node as usize).copied()
    }

    /// Returns the other child of the node's parent.
    #[inline(always)]
    pub fn sibling(&self, node: u32) -> u32 {
        let [left, right] = self.children[self.parent(node) as usize];
        if left == node { right } else { left }
    }

    /// Returns the sum of the inner nodes' areas, in units of the root's area.
    ///
    /// If the root's area is zero or infinite, returns the number of inner nodes.
    pub fn cost(&self) -> f64 {
        let area = |node: &LinkedNode<S>| self.area_of(&node.aabb).to_f64();
        let root = area(&self.nodes[0]);
        let sum: f64 = self.nodes[..self.children.len()].iter().map(area).sum();
        if root > 0.0 && root.is_finite() { sum / root } else { self.children.len() as f64 }
    }

    fn height_above(&self, children: [u32; 2]) -> u32 {
        let height = |child: u32| self.nodes[child as usize].height;
        1 + height(children[0]).max(height(children[1]))
    }

    /// Moves a node beside its new sibling, if that lowers the sum of areas.
    ///
    /// Returns the decrease. It may differ from the gain of `found`, since other nodes were moved
    /// in the meantime.
    pub fn improve(&mut self, found: &Move<S>, touched: &mut [bool]) -> Option<f64> {
        let moved = self.apply(found, touched)?;
        // NaN is no gain: the areas are too large to be compared.
        if moved.gain > 0.0 {
            return Some(moved.gain);
        }
        self.undo(&moved, touched);
        None
    }

    /// Moves a node beside its new sibling; `None` if the move is not possible.
    ///
    /// It is not possible if one of the nodes concerned was touched before, or if it would make a
    /// cycle or a path longer than [`MAX_DEPTH`].
    fn apply(&mut self, found: &Move<S>, touched: &mut [bool]) -> Option<Moved> {
        let Move { node, beside, .. } = *found;
        let (parent, sibling) = (self.parent(node), self.sibling(node));
        let (above, target) = (self.parent(parent), self.parent(beside));
        let concerned = [node, parent, sibling, above, beside, target];
        if concerned.iter().any(|&node| touched[node as usize]) {
            return None;
        }
        let depth = self.depth_outside(beside, node)?;
        let height = self.height_above([node, beside]) as usize;
        if depth + height > MAX_DEPTH {
            return None;
        }
        for node in concerned {
            touched[node as usize] = true;
        }
        // The parent moves along, and the sibling takes its place.
        let children = self.children[parent as usize];
        self.replace(above, parent, sibling);
        self.replace(target, beside, parent);
        self.adopt(parent, [beside, node]);
        let gain = self.refit(above) + self.refit(parent);
        Some(Moved { gain, children, concerned })
    }

    /// Moves a node back to its old place, if it was the last node moved.
    fn undo(&mut self, moved: &Moved, touched: &mut [bool]) {
        let [_, parent, sibling, above, beside, target] = moved.concerned;
        self.replace(target, parent, beside);
        self.replace(above, sibling, parent);
        self.adopt(parent, moved.children);
        self.refit(target);
        self.refit(parent);
        for node in moved.concerned {
            touched[node as usize] = false;
        }
    }

    /// Returns the depth of a place; `None` if it is in the subtree of `node`.
    fn depth_outside(&self, mut place: u32, node: u32) -> Option<usize> {
        let mut depth = 0;
        while place != Self::ROOT {
            if place == node {
                return None;
            }
            place = self.parent(place);
            depth += 1;
        }
        Some(depth)
    }

    fn replace(&mut self, parent: u32, child: u32, other: u32) {
        let children = &mut self.children[parent as usize];
        children[usize::from(children[1] == child)] = other;
        self.nodes[other as usize].parent = parent;
    }

    fn adopt(&mut self, parent: u32, children: [u32; 2]) {
        self.children[parent as usize] = children;
        for child in children {
            self.nodes[child as usize].parent = parent;
        }
    }

    /// Updates boxes and heights from a node up to the root.
    ///
    /// Returns the decrease of the sum of areas.
    fn refit(&mut self, mut node: u32) -> f64 {
        let mut gain = 0.0;
        loop {
            let children = self.children[node as usize];
            let aabb = self.aabb(children[0]).union(*self.aabb(children[1]));
            let height = self.height_above(children);
            gain += self.area(node).to_f64() - self.area_of(&aabb).to_f64();
            let refitted = &mut self.nodes[node as usize];
            (refitted.aabb, refitted.height) = (aabb, height);
            if node == Self::ROOT {
                return gain;
            }
            node = refitted.parent;
        }
    }

    /// Writes the nodes and the slots to `tree`, depth first.
    pub fn write(&self, tree: &mut Tree<S>) {
        let mut nodes = take(&mut tree.nodes);
        nodes.clear();
        let mut indices = Vec::with_capacity(tree.indices.len());
        let mut leaf_ranges = Vec::with_capacity(tree.leaf_ranges.len());
        let mut open: Vec<(Option<(usize, usize)>, u32)> = alloc::vec![(None, Self::ROOT)];
        while let Some((parent, node)) = open.pop() {
            let child = if let Some(children) = self.children(node) {
                let index = nodes.len();
                nodes.push(Node::new(children.map(|child| *self.aabb(child))));
                open.extend([1, 0].map(|side| (Some((index, side)), children[side])));
                Child::inner(index)
            } else {
                let leaf = self.leaves[node as usize - self.children.len()];
                let (slots, first) = (leaf.slots(), indices.len());
                let moved = |child: Child| Child { first: child.first - leaf.first + first as u32, ..child };
                leaf_ranges.extend(
                    tree.leaf_ranges(leaf).iter().map(|run| LeafRange { leaf: moved(run.leaf), ..*run }),
                );
                indices.extend_from_slice(&tree.indices[slots]);
                Child::leaf(first..indices.len())
            };
            if let Some((parent, side)) = parent {
                nodes[parent].children[side] = child;
            }
        }
        (tree.nodes, tree.indices, tree.leaf_ranges) = (nodes, indices, leaf_ranges);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristic::{BuildNode, Heuristic, Split};
    use crate::{Axis, Bvh, Sphere};

    /// Splits in two halves, then one by one: two chains.
    struct Chains;

    impl Heuristic<f32> for Chains {
        fn split(&self, node: &BuildNode<'_>) -> Split {
            Split::Count { axis: Axis::X, left: if node.depth == 0 { node.references.len() / 2 } else { 1 } }
        }
    }

    #[test]
    fn what_gains_nothing_is_put_back() {
        let spheres = (0..40u16).map(|i| Sphere::new([f32::from(i * 7 % 40), f32::from(i % 5), 0.0], 0.5));
        let builder = Bvh::builder().max_leaf_size(1).layout::<Tree>();
        let (bvh, mut memory) = (builder.build(spheres).unwrap(), Vec::new());
        let mut linked = Linked::new(bvh.layout(), &mut memory).unwrap();
        let all = |linked: &Linked<'_, f32>| {
            let nodes: Vec<_> = linked.nodes.iter().map(|n| (n.aabb, n.parent, n.height)).collect();
            (nodes, linked.children.clone())
        };
        let (mut improved, mut put_back, mut touched) = (0, 0, alloc::vec![false; linked.len()]);
        for node in 1..linked.len() as u32 {
            for beside in 1..linked.len() as u32 {
                let known = [node, linked.parent(node), linked.sibling(node)];
                if linked.parent(node) == Linked::<f32>::ROOT || known.contains(&beside) {
                    continue;
                }
                let (before, cost) = (all(&linked), linked.cost());
                let root = linked.area(Linked::<f32>::ROOT).to_f64();
                // The promised gain does not matter.
                if let Some(gain) = linked.improve(&Move { node, beside, gain: 1.0 }, &mut touched) {
                    assert!((cost - linked.cost() - gain / root).abs() < 1e-6 * cost && linked.cost() < cost);
                    touched.fill(false);
                    improved += 1;
                } else {
                    assert!(all(&linked) == before && touched.iter().all(|touched| !touched));
                    put_back += 1;
                }
            }
        }
        assert!(improved > 0 && put_back > 1000, "{improved} {put_back}");
    }

    #[test]
    fn no_move_makes_a_circle_or_too_long_a_path() {
        let spheres = (0..100u8).map(|i| Sphere::new([f32::from(i), 0.0, 0.0], 0.5));
        let builder = Bvh::builder().heuristic(Chains).max_leaf_size(1).layout::<Tree>();
        let (bvh, mut memory) = (builder.build(spheres).unwrap(), Vec::new());
        let mut linked = Linked::new(bvh.layout(), &mut memory).unwrap();
        let depth = |linked: &Linked<'_, f32>, node| linked.depth_outside(node, u32::MAX).unwrap();
        let mut apply = |node: fn(&Linked<'_, f32>) -> u32| {
            let mut touched = alloc::vec![false; linked.len()];
            let leaves = linked.children.len() as u32..linked.len() as u32;
            let below_right =
                leaves.filter(|&leaf| linked.depth_outside(leaf, linked.children[0][0]).is_some());
            let beside = below_right.max_by_key(|&leaf| depth(&linked, leaf)).unwrap();
            let moved = linked.apply(&Move { node: node(&linked), beside, gain: 1.0 }, &mut touched);
            (moved.is_some(), linked.nodes[0].height as usize, depth(&linked, beside))
        };
        let right_chain = |linked: &Linked<'_, f32>| linked.children[linked.children[0][1] as usize][1];
        assert!(!apply(right_chain).0, "the end of the right chain is below it");
        let second_of_the_left = |linked: &Linked<'_, f32>| {
            let left = linked.children[0][0] as usize;
            linked.children[linked.children[left][1] as usize][0]
        };
        // The right chain grows by one each time, until it reaches the depth bound.
        let mut moves = 0;
        loop {
            let (moved, height, depth) = apply(second_of_the_left);
            assert_eq!(height, depth);
            if !moved {
                break;
            }
            moves += 1;
        }
        assert_eq!((moves, linked.nodes[0].height as usize), (MAX_DEPTH - 50, MAX_DEPTH));
    }
}
