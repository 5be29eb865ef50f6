//! Splits of clusters.

use super::{BuildNode, Heuristic, Own, Proposal, Split};
use crate::builders::Optimise;
use crate::geometry::Scalar;

/// Splits clusters of neighbours along [`Morton`](super::Morton)'s curve as `heuristic` would split primitives, and leaves what
/// is inside of them to the curve: the wide layouts make a node of leaves of each, cut where that is cheapest.
///
/// A cluster is as many neighbours as one subtree of the curve's tree holds, up to `size`, and
/// either small itself or of primitives about as large as one another: so what is large among small ones is split by itself.
///
/// With clusters of up to 128 below [`BinnedSah`](super::BinnedSah) rays visit 17 % more nodes and leaves than with
/// [`Quality::Balanced`](crate::Quality), in the mean over six scenes (10 to 33 %), in [`Morton`](super::Morton)'s tree with
/// reinsertion, which takes longer to build, 20 % more (5 to 36 %).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clustered<H> {
    /// The most primitives in a cluster; 1 for none. Unless a leaf size is set, no more than a node's leaves hold:
    /// 128 in the default layout, where each holds up to 8. Else no more than 4,096.
    pub size: usize,
    /// What splits them.
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
