//! Equal halves by number.

use super::{BuildNode, Heuristic, Split};
use crate::geometry::Scalar;

/// Splits the longest axis of the node's box in equal halves by number.
///
/// Both sides have equally many primitives. It is the simplest heuristic to explain, and the most
/// even in depth (ceil(log2(n / leaf size))). It is blind to empty space, so rays visit many nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Median;

impl<S: Scalar> Heuristic<S> for Median {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        match node.references.len() {
            n if n <= node.max_leaf_size => Split::Leaf,
            n => Split::Count { axis: node.aabb.longest_axis(), left: n / 2 },
        }
    }
}
