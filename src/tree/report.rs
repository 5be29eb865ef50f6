//! What a tree looks like: counts, depths, leaf sizes, SAH cost, bytes.

use super::{Node, Tree};
use crate::geometry::{Aabb, Scalar};
use alloc::vec::Vec;
use core::fmt;

/// The shape and the estimated cost of a [`Tree`].
#[derive(Clone, Debug, PartialEq)]
pub struct TreeReport {
    /// Primitives in leaves.
    pub primitives: usize,
    /// Nodes with two children.
    pub inner_nodes: usize,
    /// Leaves: one more than inner nodes, or 0 for an empty tree.
    pub leaves: usize,
    /// The depth of the deepest leaf; the root has depth 0.
    pub max_depth: usize,
    /// The mean depth of the leaves, unweighted.
    pub mean_leaf_depth: f64,
    /// How many primitives leaves have.
    pub leaf_sizes: LeafSizes,
    /// The expected cost of a ray that meets the root's box and hits nothing, by the surface area
    /// heuristic (Goldsmith and Salmon 1987, MacDonald and Booth 1990): the sum over inner nodes
    /// of 1 and over leaves of their number of primitives, each weighted with the node's surface
    /// area over the root's. One unit is a step through an inner node, or a primitive's test.
    pub sah_cost: f64,
    /// Bytes of the nodes and of the indices. Primitives are not counted.
    pub memory_bytes: usize,
}

/// The number of primitives per leaf.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeafSizes {
    /// In the smallest leaf; 0 for an empty tree.
    pub min: usize,
    /// In the largest leaf; 0 for an empty tree.
    pub max: usize,
    /// The mean; 0 for an empty tree.
    pub mean: f64,
    /// `histogram[n]` leaves have n primitives, for n up to 16; the last element counts all larger.
    pub histogram: [usize; 18],
}

impl<S: Scalar> Tree<S> {
    /// Walks the tree once and reports on it.
    pub fn report(&self) -> TreeReport {
        // In f64, and halved before the difference: an extent may overflow its own scalar.
        let halved = |aabb: &Aabb<S>| Aabb {
            min: aabb.min.map(|x| x.to_f64() * 0.5),
            max: aabb.max.map(|x| x.to_f64() * 0.5),
        };
        let scale = halved(&self.aabb).area_scale();
        let area = |aabb: &Aabb<S>| halved(aabb).scaled_half_area(scale);
        let root_area = area(&self.aabb);
        // A root without area is a point or a segment: what meets it meets everything in it.
        let weight = |aabb: &Aabb<S>| if root_area > 0.0 { area(aabb) / root_area } else { 1.0 };

        let (mut leaves, mut max_depth, mut depths, mut sah_cost) = (0, 0, 0, 0.0);
        let mut sizes = LeafSizes { min: self.len, ..LeafSizes::default() };
        let mut open: Vec<_> = self.root().map(|root| (root, self.aabb, 0)).into_iter().collect();
        while let Some((child, aabb, depth)) = open.pop() {
            if child.is_leaf() {
                let size = child.slots().len();
                leaves += 1;
                depths += depth;
                max_depth = max_depth.max(depth);
                sah_cost += weight(&aabb) * size as f64;
                sizes.min = sizes.min.min(size);
                sizes.max = sizes.max.max(size);
                sizes.histogram[size.min(sizes.histogram.len() - 1)] += 1;
            } else {
                let node = &self.nodes[child.first as usize];
                sah_cost += weight(&aabb);
                open.extend([0, 1].map(|side| (node.children[side], node.aabb(side), depth + 1)));
            }
        }
        let per_leaf = |total: usize| if leaves > 0 { total as f64 / leaves as f64 } else { 0.0 };
        sizes.mean = per_leaf(self.len);
        TreeReport {
            primitives: self.len,
            inner_nodes: self.nodes.len(),
            leaves,
            max_depth,
            mean_leaf_depth: per_leaf(depths),
            leaf_sizes: sizes,
            sah_cost,
            memory_bytes: size_of::<Node<S>>() * self.nodes.len() + size_of::<u32>() * self.indices.len(),
        }
    }
}

impl fmt::Display for TreeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "primitives   {}", self.primitives)?;
        writeln!(f, "inner nodes  {}", self.inner_nodes)?;
        let LeafSizes { min, max, mean, .. } = self.leaf_sizes;
        writeln!(f, "leaves       {} of {min} to {max} primitives, mean {mean:.2}", self.leaves)?;
        writeln!(f, "depth        {} at most, mean {:.1}", self.max_depth, self.mean_leaf_depth)?;
        writeln!(f, "SAH cost     {:.2}", self.sah_cost)?;
        write!(f, "memory       {} bytes", self.memory_bytes)
    }
}
