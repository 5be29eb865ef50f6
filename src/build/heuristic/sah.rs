//! The surface area heuristic's costs.

use crate::geometry::Scalar;

/// The costs that the surface area heuristic weighs against each other.
///
/// A ray that meets a node's box meets a child's with a probability of about the ratio of their
/// surface areas (Goldsmith and Salmon 1987). So a split costs
///
/// ```text
/// traversal + intersection * (area(left) * n_left + area(right) * n_right) / area(node)
/// ```
///
/// and a leaf `intersection * n`. Only the ratio of the two matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SahCost {
    /// Of a step through an inner node: two box tests and the choice between them.
    pub traversal: f64,
    /// Of one primitive's test.
    pub intersection: f64,
}

impl Default for SahCost {
    /// Both 1.
    fn default() -> Self {
        Self { traversal: 1.0, intersection: 1.0 }
    }
}

impl SahCost {
    /// Whether a leaf of `n` costs no more than the best split, whose sides' areas times numbers
    /// of primitives sum to `weighted_area`.
    pub(super) fn prefers_leaf<S: Scalar>(&self, n: usize, area: S, weighted_area: S) -> bool {
        let split = self.traversal * area.to_f64() + self.intersection * weighted_area.to_f64();
        self.intersection * n as f64 * area.to_f64() <= split
    }
}
