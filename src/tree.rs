//! The binary tree: nodes and indices, never primitives.

use crate::geometry::{Aabb, Scalar};
use alloc::vec::Vec;
use core::ops::Range;

/// The maximum depth of a leaf; the root has depth 0.
///
/// No heuristic and no data exceed it, so stacks of this size never overflow.
pub const MAX_DEPTH: usize = 64;

/// An inner node: the boxes of its two children side by side, and their places.
///
/// For `f32` it is one cache line. `planes[axis][0]` holds the two minima, and
/// `planes[axis][1]` the two maxima. So the slab test chooses the pair of near planes by the
/// ray's sign, as an address.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Node<S> {
    pub planes: [[[S; 2]; 2]; 3],
    pub children: [Child; 2],
}

const _: () = assert!(size_of::<Node<f32>>() == 64 && size_of::<Node<f64>>() == 128);

/// The place of a child: a leaf or an inner node.
///
/// If `count` is 0, the child is the inner node number `first`. Else it is a leaf with `count`
/// primitives from slot `first` on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Child {
    pub first: u32,
    pub count: u32,
}

impl Child {
    pub fn inner(node: usize) -> Self {
        Self { first: node as u32, count: 0 }
    }

    pub fn leaf(slots: Range<usize>) -> Self {
        Self { first: slots.start as u32, count: slots.len() as u32 }
    }

    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.count != 0
    }

    #[inline(always)]
    pub fn slots(self) -> Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

/// A leaf range: a part of a large leaf, as a leaf by itself with its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeafRange<S> {
    pub aabb: Aabb<S>,
    pub leaf: Child,
}

impl<S: Scalar> Node<S> {
    pub fn aabb(&self, side: usize) -> Aabb<S> {
        Aabb { min: self.planes.map(|axis| axis[0][side]), max: self.planes.map(|axis| axis[1][side]) }
    }

    /// Returns the box around both children.
    pub fn union(&self) -> Aabb<S> {
        self.aabb(0).union(self.aabb(1))
    }

    pub fn new(boxes: [Aabb<S>; 2]) -> Self {
        let [left, right] = boxes;
        let pair = |axis: usize| [[left.min[axis], right.min[axis]], [left.max[axis], right.max[axis]]];
        Self { planes: [pair(0), pair(1), pair(2)], children: [Child::default(); 2] }
    }
}

/// A binary bounding volume hierarchy that knows primitives by their index alone.
///
/// Two trees are equal if they have the same nodes in the same places. A build makes equal
/// trees on any number of threads. As a layout of [`Bvh`](crate::Bvh) the tree is traced as it
/// was built: `Bvh<P, Tree>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree<S = f32> {
    pub(crate) nodes: Vec<Node<S>>,
    pub(crate) root: Child,
    pub(crate) aabb: Aabb<S>,
    /// The input index of each slot's primitive.
    ///
    /// Leaves are ranges of slots. A primitive may be in several leaves.
    pub(crate) indices: Vec<u32>,
    /// The leaf ranges of all large leaves, in the order of the slots.
    ///
    /// They are for layouts that can divide large leaves.
    pub(crate) leaf_ranges: Vec<LeafRange<S>>,
    /// The number of primitives.
    pub(crate) primitives: usize,
}

impl<S: Scalar> Default for Tree<S> {
    /// Returns an empty tree.
    fn default() -> Self {
        let (nodes, indices, leaf_ranges) = (Vec::new(), Vec::new(), Vec::new());
        Self { nodes, root: Child::default(), aabb: Aabb::EMPTY, indices, leaf_ranges, primitives: 0 }
    }
}

impl<S: Scalar> Tree<S> {
    /// Returns the number of primitives in leaves.
    pub fn len(&self) -> usize {
        self.primitives
    }

    /// Returns whether there are no primitives in the tree.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Returns the box around all primitives, or [`Aabb::EMPTY`] if there are none.
    pub fn aabb(&self) -> Aabb<S> {
        self.aabb
    }

    /// Returns the memory of nodes, indices and leaf ranges, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Node<S>>() * self.nodes.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<LeafRange<S>>() * self.leaf_ranges.capacity()
    }

    /// Returns the leaf ranges of a leaf.
    ///
    /// There are none if the build did not cut the leaf.
    pub(crate) fn leaf_ranges(&self, leaf: Child) -> &[LeafRange<S>] {
        let leaf_ranges =
            &self.leaf_ranges[self.leaf_ranges.partition_point(|run| run.leaf.first < leaf.first)..];
        let slots = leaf.slots();
        &leaf_ranges
            [..leaf_ranges.iter().take_while(|run| slots.contains(&(run.leaf.first as usize))).count()]
    }

    /// Returns the root, or `None` if the tree is empty.
    pub(crate) fn root(&self) -> Option<Child> {
        (!self.is_empty()).then_some(self.root)
    }
}
