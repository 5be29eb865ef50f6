//! The binary tree: nodes and indices, never primitives.

use crate::geometry::{Aabb, Scalar};
use alloc::vec::Vec;
use core::ops::Range;

/// No leaf is deeper than this below the root, which has depth 0, whatever the heuristic and the
/// data: stacks of this size never overflow.
pub const MAX_DEPTH: usize = 64;

/// An inner node: the boxes of its two children side by side, and where the children are.
///
/// One cache line for f32. `planes[axis][0]` holds the two minima, `planes[axis][1]` the two maxima,
/// so that the slab test chooses the pair of near planes by the ray's sign, as an address.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Node<S> {
    pub planes: [[[S; 2]; 2]; 3],
    pub children: [Child; 2],
}

const _: () = assert!(size_of::<Node<f32>>() == 64 && size_of::<Node<f64>>() == 128);

/// Where a child is: a leaf with `count` primitives from slot `first` on, or, if `count` is 0, the
/// inner node number `first`.
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

/// A part of a large leaf: a leaf by itself, and its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeafRange<S> {
    pub aabb: Aabb<S>,
    pub leaf: Child,
}

impl<S: Scalar> Node<S> {
    pub fn aabb(&self, side: usize) -> Aabb<S> {
        Aabb { min: self.planes.map(|axis| axis[0][side]), max: self.planes.map(|axis| axis[1][side]) }
    }

    /// The box around both children.
    pub fn union(&self) -> Aabb<S> {
        self.aabb(0).union(self.aabb(1))
    }

    pub fn new(boxes: [Aabb<S>; 2]) -> Self {
        let [left, right] = boxes;
        let pair = |axis: usize| [[left.min[axis], right.min[axis]], [left.max[axis], right.max[axis]]];
        Self { planes: [pair(0), pair(1), pair(2)], children: [Child::default(); 2] }
    }
}

/// A binary bounding volume hierarchy over primitives known by their index alone.
///
/// Two trees are equal if they have the same nodes in the same places: what a build promises for
/// any number of threads. As a layout of [`Bvh`](crate::Bvh) it is traced as it was built: `Bvh<P, Tree>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree<S = f32> {
    pub(crate) nodes: Vec<Node<S>>,
    pub(crate) root: Child,
    pub(crate) aabb: Aabb<S>,
    /// The input's index of each slot's primitive. Leaves are ranges of slots; a primitive may be in several.
    pub(crate) indices: Vec<u32>,
    /// The parts that large leaves are cut into, for a layout that can divide them; in the order of the slots.
    pub(crate) leaf_ranges: Vec<LeafRange<S>>,
    /// How many there are.
    pub(crate) primitives: usize,
}

impl<S: Scalar> Default for Tree<S> {
    /// Over nothing.
    fn default() -> Self {
        let (nodes, indices, leaf_ranges) = (Vec::new(), Vec::new(), Vec::new());
        Self { nodes, root: Child::default(), aabb: Aabb::EMPTY, indices, leaf_ranges, primitives: 0 }
    }
}

impl<S: Scalar> Tree<S> {
    /// The number of primitives in its leaves.
    pub fn len(&self) -> usize {
        self.primitives
    }

    /// No primitives in it.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// The box around everything; [`Aabb::EMPTY`] if there is nothing.
    pub fn aabb(&self) -> Aabb<S> {
        self.aabb
    }

    /// Bytes of the nodes, of the indices, and of what a layout is to know of large leaves.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Node<S>>() * self.nodes.capacity()
            + size_of::<u32>() * self.indices.capacity()
            + size_of::<LeafRange<S>>() * self.leaf_ranges.capacity()
    }

    /// The parts of a leaf; none if it has no runs.
    pub(crate) fn leaf_ranges(&self, leaf: Child) -> &[LeafRange<S>] {
        let leaf_ranges =
            &self.leaf_ranges[self.leaf_ranges.partition_point(|run| run.leaf.first < leaf.first)..];
        let slots = leaf.slots();
        &leaf_ranges
            [..leaf_ranges.iter().take_while(|run| slots.contains(&(run.leaf.first as usize))).count()]
    }

    /// The root, if the tree is not empty.
    pub(crate) fn root(&self) -> Option<Child> {
        (!self.is_empty()).then_some(self.root)
    }
}
