//! The costs of the surface area heuristic.

use super::{BuildNode, Proposal, Split};
use crate::geometry::Scalar;

/// The costs that the surface area heuristic weighs against each other.
///
/// A ray that meets a node's box meets a child's box with a probability of about the ratio of their
/// surface areas (Goldsmith and Salmon 1987). So a split costs
///
/// ```text
/// traversal + intersection * (area(left) * n_left + area(right) * n_right) / area(node)
/// ```
///
/// and a leaf costs `intersection * n`, or `intersection * ceil(n / 8)` where eight are tested at
/// once. Only the ratio of the two costs matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SahCost {
    /// The cost of a step through an inner node.
    ///
    /// A step consists of two box tests and the choice between the children.
    pub traversal: f64,
    /// The cost of one primitive's test.
    pub intersection: f64,
}

impl Default for SahCost {
    /// Returns the costs 1 of a step and 0.7 of a test.
    ///
    /// With this crate's traversal, trees have a tenth fewer nodes than with equal costs. They are
    /// built sooner, and traced as fast or faster (measured: docs/decisions.md, 21).
    fn default() -> Self {
        Self { traversal: 1.0, intersection: 0.7 }
    }
}

impl SahCost {
    /// Returns the best proposal, or a leaf where it is allowed and costs no more.
    ///
    /// `weighted_area` is the sum of the sides' areas times their numbers of primitives, for
    /// `best`. All areas are scaled by the node's own `area_scale`.
    pub(super) fn split_or_leaf<S: Scalar>(
        &self,
        node: &BuildNode<'_, S>,
        best: Proposal<S>,
        weighted_area: f64,
    ) -> Proposal<S> {
        let n = node.references.len();
        if n > node.max_leaf_size {
            return best;
        }
        let area = node.aabb.scaled_half_area(node.aabb.area_scale()).to_f64();
        let leaf_cost = self.intersection * n.div_ceil(node.block_size) as f64 * area;
        let tests = self.intersection * weighted_area / node.block_size as f64;
        if leaf_cost <= self.traversal * area + tests { Split::Leaf.into() } else { best }
    }

    /// Returns whether one block holds all references.
    ///
    /// No split makes such a node cheaper.
    pub(super) fn is_block<S: Scalar>(node: &BuildNode<'_, S>) -> bool {
        node.references.len() <= node.block_size.min(node.max_leaf_size)
    }
}
