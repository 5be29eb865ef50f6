//! The invariants that queries rely on, checked one by one.

use super::{MAX_DEPTH, Tree};
use crate::geometry::{Aabb, Scalar};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

/// The first invariant of a tree found broken. A tree that this crate built has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvariantError {
    /// A child refers to an inner node or to a slot that does not exist.
    DanglingChild {
        /// What it refers to.
        index: usize,
    },
    /// A node is the child of two parents, or its own ancestor.
    SharedNode {
        /// The node.
        node: usize,
    },
    /// A node is nobody's child.
    OrphanNode {
        /// The node.
        node: usize,
    },
    /// A slot is in no leaf, or in several.
    SlotCoverage {
        /// The slot.
        slot: usize,
        /// In how many leaves it is.
        leaves: usize,
    },
    /// A leaf is deeper than [`MAX_DEPTH`].
    TooDeep {
        /// Its depth.
        depth: usize,
    },
    /// A box does not contain what is below it.
    LooseBox {
        /// The inner node that stores the box; none for the box around the whole tree.
        node: Option<usize>,
    },
    /// The indices are not each number below their count once.
    NotAPermutation {
        /// The first slot whose index is too large or was seen before.
        slot: usize,
    },
}

impl fmt::Display for InvariantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DanglingChild { index } => write!(f, "a child refers to {index}, which does not exist"),
            Self::SharedNode { node } => write!(f, "node {node} has more than one parent"),
            Self::OrphanNode { node } => write!(f, "node {node} has no parent"),
            Self::SlotCoverage { slot, leaves } => write!(f, "slot {slot} is in {leaves} leaves, not in one"),
            Self::TooDeep { depth } => write!(f, "a leaf has depth {depth}, the bound is {MAX_DEPTH}"),
            Self::LooseBox { node: Some(node) } => {
                write!(f, "a box in node {node} does not contain what is below it")
            }
            Self::LooseBox { node: None } => f.write_str("the tree's box does not contain the tree"),
            Self::NotAPermutation { slot } => {
                write!(f, "the index in slot {slot} is out of range or occurs twice")
            }
        }?;
        f.write_str(": a primitive's box changed after the build, or differs from call to call")
    }
}

impl core::error::Error for InvariantError {}

impl<S: Scalar> Tree<S> {
    /// Checks every invariant, with `aabb_of(slot)` the box of the primitive in a slot.
    ///
    /// Terminates for any content, in O(nodes + slots).
    pub(crate) fn check(&self, aabb_of: impl Fn(usize) -> Aabb<S>) -> Result<(), InvariantError> {
        self.check_indices()?;
        let mut node_seen = vec![false; self.nodes.len()];
        let mut slot_leaves = vec![0usize; self.len];
        let mut open: Vec<_> = self.root().map(|root| (root, self.aabb, None, 0)).into_iter().collect();
        while let Some((child, aabb, parent, depth)) = open.pop() {
            if depth > MAX_DEPTH {
                return Err(InvariantError::TooDeep { depth });
            }
            let below = if child.is_leaf() {
                let slots = child.slots();
                if slots.end > self.len {
                    return Err(InvariantError::DanglingChild { index: slots.end - 1 });
                }
                slots.fold(Aabb::EMPTY, |below, slot| {
                    slot_leaves[slot] += 1;
                    below.union(aabb_of(slot))
                })
            } else {
                let index = child.first as usize;
                let Some(node) = self.nodes.get(index) else {
                    return Err(InvariantError::DanglingChild { index });
                };
                if core::mem::replace(&mut node_seen[index], true) {
                    return Err(InvariantError::SharedNode { node: index });
                }
                for side in [0, 1] {
                    open.push((node.children[side], node.aabb(side), Some(index), depth + 1));
                }
                node.aabb(0).union(node.aabb(1))
            };
            if !aabb.contains(&below) {
                return Err(InvariantError::LooseBox { node: parent });
            }
        }
        if let Some(node) = node_seen.iter().position(|&seen| !seen) {
            return Err(InvariantError::OrphanNode { node });
        }
        match slot_leaves.iter().position(|&leaves| leaves != 1) {
            Some(slot) => Err(InvariantError::SlotCoverage { slot, leaves: slot_leaves[slot] }),
            None => Ok(()),
        }
    }

    fn check_indices(&self) -> Result<(), InvariantError> {
        let mut seen = vec![false; self.indices.len()];
        for (slot, &index) in self.indices.iter().enumerate() {
            match seen.get_mut(index as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(InvariantError::NotAPermutation { slot }),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Child, Node};
    use crate::{Bvh, Sphere};

    fn spheres() -> Vec<Sphere> {
        (0..20u8).map(|i| Sphere::new([f32::from(i), f32::from(i % 7), 0.0], 0.25)).collect()
    }

    /// Builds a good tree, breaks it, and says what the check finds.
    fn broken(change: impl FnOnce(&mut Tree)) -> InvariantError {
        let spheres = spheres();
        let bvh = Bvh::builder().max_leaf_size(2).build(&spheres).unwrap();
        let mut tree = bvh.tree().clone();
        let aabb_of = |slot: usize| {
            use crate::Primitive;
            spheres[bvh.tree().indices[slot] as usize].aabb()
        };
        assert_eq!(tree.check(aabb_of), Ok(()));
        change(&mut tree);
        tree.check(aabb_of).unwrap_err()
    }

    fn leaf_of(tree: &mut Tree) -> &mut Child {
        tree.nodes.iter_mut().flat_map(|node| &mut node.children).find(|child| child.is_leaf()).unwrap()
    }

    #[test]
    fn each_broken_invariant_is_named() {
        assert!(matches!(
            broken(|t| t.nodes[0].planes[0][0][1] += 1.0),
            InvariantError::LooseBox { node: Some(0) }
        ));
        assert_eq!(broken(|t| t.aabb.max[1] -= 1.0), InvariantError::LooseBox { node: None });
        assert_eq!(broken(|t| t.indices[3] = t.indices[4]), InvariantError::NotAPermutation { slot: 4 });
        assert_eq!(broken(|t| t.indices[3] = 99), InvariantError::NotAPermutation { slot: 3 });
        assert!(matches!(broken(|t| leaf_of(t).first = 77), InvariantError::DanglingChild { .. }));
        assert_eq!(
            broken(|t| t.nodes[1].children[0] = Child::inner(500)),
            InvariantError::DanglingChild { index: 500 }
        );
        assert!(matches!(broken(|t| leaf_of(t).count = 0), InvariantError::SharedNode { .. }));
        assert!(matches!(broken(|t| t.nodes.push(t.nodes[0])), InvariantError::OrphanNode { .. }));
        assert!(matches!(
            broken(|t| {
                let other = t.nodes.iter().flat_map(|n| n.children).rfind(|c| c.is_leaf()).unwrap();
                *leaf_of(t) = other;
                let everything = Node::new([t.aabb; 2]).planes;
                t.nodes.iter_mut().for_each(|n| n.planes = everything);
            }),
            InvariantError::SlotCoverage { .. }
        ));
        assert!(matches!(
            broken(|t| {
                // A chain of nodes, each with a leaf and the next.
                let mut node = Node::new([t.aabb; 2]);
                node.children = [Child::leaf(0..1); 2];
                t.nodes = (1..100).map(|i| Node { children: [Child::leaf(0..1), Child::inner(i)], ..node }).collect();
                t.nodes.push(node);
                t.root = Child::inner(0);
            }),
            InvariantError::TooDeep { depth } if depth == MAX_DEPTH + 1
        ));
    }
}
