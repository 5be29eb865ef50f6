//! Equal halves by length.

use super::{BuildNode, Heuristic, Split};
use crate::geometry::Scalar;

/// Splits the longest axis of the box around the centroids in its middle.
///
/// The box is that of the centroids, not that of the node. So each side has a centroid, unless all
/// centroids coincide or are adjacent numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Midpoint;

impl<S: Scalar> Heuristic<S> for Midpoint {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        if node.references.len() <= node.max_leaf_size {
            return Split::Leaf;
        }
        let centroids = node.centroids();
        let axis = centroids.longest_axis();
        Split::Plane { axis, position: centroids.center()[axis.index()] }
    }
}
