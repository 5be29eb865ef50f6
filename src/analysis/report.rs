//! The report on a tree: counts, depths, leaf sizes, SAH cost, bytes.

use crate::geometry::{Aabb, Scalar};
use crate::layout::{Encoding, Outline, Part, WideTree};
use crate::tree::Tree;
use alloc::vec::Vec;
use core::fmt;

/// The shape and the estimated cost of a hierarchy.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TreeReport {
    /// The number of primitives in leaves.
    pub primitives: usize,
    /// The number of references in leaves.
    ///
    /// Each primitive counts as often as it is in a leaf. Spatial splits add references.
    pub references: usize,
    /// The number of nodes with children.
    ///
    /// A node has two children in a [`Tree`](crate::Tree), up to N in a
    /// [`WideTree`](crate::WideTree).
    pub inner_nodes: usize,
    /// The number of leaves; 0 for an empty tree.
    pub leaves: usize,
    /// The depth of the deepest leaf; the root has depth 0.
    pub max_depth: usize,
    /// The mean depth of the leaves, unweighted.
    pub mean_leaf_depth: f64,
    /// The number of primitives per leaf: minimum, maximum, mean and histogram.
    pub leaf_sizes: LeafSizes,
    /// The expected cost of a ray by the surface area heuristic (SAH).
    ///
    /// The ray meets the root's box and hits nothing (Goldsmith and Salmon 1987, MacDonald and
    /// Booth 1990). The cost is a sum over nodes: 1 for an inner node, the number of primitives for
    /// a leaf. Each term is weighted with the surface area of the node over that of the root. One
    /// unit is a step through an inner node, or the test of a primitive.
    pub sah_cost: f64,
    /// The number of bytes of nodes, indices, and primitive data copied to leaves.
    pub memory_bytes: usize,
}

/// The number of primitives per leaf.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LeafSizes {
    /// The number in the smallest leaf; 0 for an empty tree.
    pub min: usize,
    /// The number in the largest leaf; 0 for an empty tree.
    pub max: usize,
    /// The mean number; 0 for an empty tree.
    pub mean: f64,
    /// The number of leaves with n primitives is `histogram[n]`, for n up to 16.
    ///
    /// The last element counts all larger leaves.
    pub histogram: [usize; 18],
}

impl TreeReport {
    /// Walks a hierarchy once, and returns the report on it.
    pub(crate) fn new<S: Scalar, H: Outline<S>>(hierarchy: &H) -> Self {
        // In f64, and halved before the difference: an extent may overflow its own scalar.
        let halved = |aabb: &Aabb<S>| Aabb {
            min: aabb.min.map(|x| x.to_f64() * 0.5),
            max: aabb.max.map(|x| x.to_f64() * 0.5),
        };
        let root = hierarchy.aabb();
        let scale = halved(&root).area_scale();
        let area = |aabb: &Aabb<S>| halved(aabb).scaled_half_area(scale);
        let root_area = area(&root);
        // A root without area is a point or a segment: a ray that meets it meets everything in it.
        let weight = |aabb: &Aabb<S>| if root_area > 0.0 { area(aabb) / root_area } else { 1.0 };

        let len = hierarchy.len();
        let (mut inner_nodes, mut leaves, mut max_depth, mut depths, mut sah_cost) = (0, 0, 0, 0, 0.0);
        let mut sizes = LeafSizes { min: len, ..LeafSizes::default() };
        let mut open: Vec<_> = hierarchy.root().map(|place| (place, root, 0)).into_iter().collect();
        while let Some((place, aabb, depth)) = open.pop() {
            let mut size = 0;
            hierarchy.open(place, |part| match part {
                Part::Child(aabb, place) => open.push((place, aabb, depth + 1)),
                Part::Primitive(_) => size += 1,
            });
            if size > 0 {
                leaves += 1;
                depths += depth;
                max_depth = max_depth.max(depth);
                sah_cost += weight(&aabb) * size as f64;
                sizes.min = sizes.min.min(size);
                sizes.max = sizes.max.max(size);
                sizes.histogram[size.min(sizes.histogram.len() - 1)] += 1;
            } else {
                inner_nodes += 1;
                sah_cost += weight(&aabb);
            }
        }
        let per_leaf = |total: usize| if leaves > 0 { total as f64 / leaves as f64 } else { 0.0 };
        sizes.mean = per_leaf(hierarchy.references());
        Self {
            primitives: len,
            references: hierarchy.references(),
            inner_nodes,
            leaves,
            max_depth,
            mean_leaf_depth: per_leaf(depths),
            leaf_sizes: sizes,
            sah_cost,
            memory_bytes: hierarchy.bytes(),
        }
    }
}

impl fmt::Display for TreeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "primitives   {}, {} references", self.primitives, self.references)?;
        writeln!(f, "inner nodes  {}", self.inner_nodes)?;
        let LeafSizes { min, max, mean, .. } = self.leaf_sizes;
        writeln!(f, "leaves       {} of {min} to {max} primitives, mean {mean:.2}", self.leaves)?;
        writeln!(f, "depth        {} at most, mean {:.1}", self.max_depth, self.mean_leaf_depth)?;
        writeln!(f, "SAH cost     {:.2}", self.sah_cost)?;
        write!(f, "memory       {} bytes", self.memory_bytes)
    }
}

impl<S: Scalar> Tree<S> {
    /// Returns the shape and the estimated cost of the tree.
    pub fn report(&self) -> TreeReport {
        TreeReport::new(self)
    }
}

impl<S: Scalar, const N: usize, F: Encoding<S, N>> fmt::Debug for WideTree<S, N, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideTree").field("report", &TreeReport::new(self)).finish_non_exhaustive()
    }
}
