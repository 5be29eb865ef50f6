//! Splits of clusters.

use super::{BuildNode, Heuristic, Own, Proposal, Split};
use crate::builders::Optimise;
use crate::geometry::Scalar;

/// Splits clusters of neighbours along the curve of [`Morton`](super::Morton).
///
/// `heuristic` splits clusters as it would split primitives, and the curve settles the inside
/// of each cluster. The wide layouts make a node of leaves of each cluster, divided where
/// that is cheapest.
///
/// A cluster has as many neighbours as one subtree of the curve's tree, up to `size`. It is
/// small itself, or its primitives have similar areas. So a large primitive among small ones is
/// split by itself.
///
/// With clusters of up to 128 below [`BinnedSah`](super::BinnedSah), rays visit 17 % more nodes and
/// leaves than with [`Quality::Balanced`](crate::Quality), in the mean over six scenes.
/// [`Morton`](super::Morton)'s tree with reinsertion takes longer to build, and rays visit more
/// (measured: docs/decisions.md, 16).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clustered<H> {
    /// Maximum number of primitives in a cluster; 1 for no clusters.
    ///
    /// If no leaf size is set, a cluster has no more primitives than the leaves of one node hold:
    /// 128 in the default layout, where each leaf holds up to 8. If a leaf size is set, or in the
    /// binary [`Tree`](crate::Tree), it has no more than 4,096.
    pub size: usize,
    /// The heuristic that splits the clusters.
    pub heuristic: H,
}

impl<S: Scalar, H: Heuristic<S>> Heuristic<S> for Clustered<H> {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        self.heuristic.split(node)
    }

    fn proposal(&self, node: &BuildNode<'_, S>, own: Own) -> Proposal<S> {
        self.heuristic.proposal(node, own)
    }

    fn cluster_size(&self) -> usize {
        self.size
    }

    fn optimise(&self) -> Option<Optimise> {
        self.heuristic.optimise()
    }

    fn extra_references(&self, clusters: usize) -> usize {
        self.heuristic.extra_references(clusters)
    }
}
