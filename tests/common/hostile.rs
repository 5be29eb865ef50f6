//! The most hostile heuristic.

use bvhkit::heuristic::{BuildNode, Heuristic, Split};
use bvhkit::{Axis, Scalar};

/// Proposes splits that could break a driver, a different one at each node.
pub struct Hostile;

impl<S: Scalar> Heuristic<S> for Hostile {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        let n = node.references.len();
        let axis = Axis::ALL[node.depth % 3];
        let count = |left| Split::Count { axis, left };
        let plane = |position| Split::Plane { axis, position };
        match (n + node.depth) % 9 {
            0 => count(0),
            1 => count(n),
            2 => count(usize::MAX),
            3 => count(1),
            4 => count(n - 1),
            5 => plane(S::from_f64(f64::NAN)),
            6 => plane(S::NEG_INFINITY),
            7 => plane(node.centroids().max[axis.index()]),
            _ => Split::Leaf,
        }
    }
}
