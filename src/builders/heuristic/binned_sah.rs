//! The surface area heuristic on a few planes.

use super::bins::{Bins, Plane};
use super::{BuildNode, Heuristic, Own, Proposal, SahCost, Split};
use crate::geometry::Scalar;
use crate::simd::Backend;

/// The surface area heuristic on equally spaced planes.
///
/// The cheapest of `bins - 1` planes on each axis is chosen (Wald, On fast Construction of
/// SAH-based Bounding Volume Hierarchies, 2007).
///
/// Centroids are counted into bins over the node's box, and each bin has the box around its
/// primitives. A sweep over the bins finds the best plane between two bins. If all centroids are in
/// one bin, the bins span the box around the centroids instead.
///
/// The builder also gets the boxes of both sides, and the side on which each reference was counted.
/// A heuristic of your own that returns the result of this one's `split` does not pass these on.
/// Then a build takes a tenth longer, and a reference within a rounding error of the plane may go
/// to the other side.
///
/// Wald's bins span the box around the centroids from the start. Bins over the node's box put
/// planes where the scene has its walls: rays visit fewer nodes in interiors, and other scenes
/// hardly change (measured: docs/decisions.md, 17). Refused: the centroids' box on the axes
/// where it is much smaller than the node's box, which loses all of the gain. Refused: to count
/// only a sample of the references in large nodes, which saves some time and may choose a worse
/// plane near the root (measured: docs/decisions.md, 18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinnedSah {
    /// Number of bins on each axis, 2 to [`MAX_BINS`](Self::MAX_BINS).
    ///
    /// Values outside are clamped.
    pub bins: usize,
    /// The costs of a step and of a test.
    pub cost: SahCost,
}

impl BinnedSah {
    /// The largest number of bins.
    pub const MAX_BINS: usize = 32;

    /// Makes a heuristic with `bins` bins and the default costs.
    pub fn new(bins: usize) -> Self {
        Self { bins, cost: SahCost::default() }
    }
}

impl Default for BinnedSah {
    /// Returns a heuristic with 16 bins and the default costs.
    fn default() -> Self {
        Self::new(16)
    }
}

impl<S: Scalar> Heuristic<S> for BinnedSah {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        self.proposal(node, Own::BUILD).split
    }

    fn proposal(&self, node: &BuildNode<'_, S>, _: Own) -> Proposal<S> {
        S::binned(self, node)
    }
}

impl BinnedSah {
    pub(in crate::builders) fn propose<S: Scalar>(&self, node: &BuildNode<'_, S>) -> Proposal<S> {
        if SahCost::is_block(node) {
            return Split::Leaf.into();
        }
        self.plane(node).map_or(Split::Leaf.into(), |best| {
            self.cost.split_or_leaf(node, best.proposal, best.weighted_area.to_f64())
        })
    }

    /// Returns the cheapest plane; `None` if no plane separates the centroids.
    pub(super) fn plane<S: Scalar>(&self, node: &BuildNode<'_, S>) -> Option<Plane<S>> {
        // Bins are cleared and swept for every node, so there are no more bins than pay. Half the
        // bins for few references save a tenth of the build, and cost rays hardly anything
        // (measured: docs/decisions.md, 19).
        let bins = self.bins.clamp(2, Self::MAX_BINS);
        let is_small = node.references.len() <= 2 * bins;
        match if is_small { bins.div_ceil(2).max(2) } else { bins } {
            bins @ ..=8 => Self::plane_of::<S, 8>(node, bins),
            bins @ 9..=16 => Self::plane_of::<S, 16>(node, bins),
            bins => Self::plane_of::<S, { Self::MAX_BINS }>(node, bins),
        }
    }

    fn plane_of<S: Scalar, const N: usize>(node: &BuildNode<'_, S>, count: usize) -> Option<Plane<S>> {
        let (references, area_scale) = (node.references, node.aabb.area_scale());
        // A loop, so that there is one call for both spans.
        let mut span = node.aabb;
        for is_last in [false, true] {
            let bins = Bins::<S, N> { references, span: &span, count, area_scale };
            let plane = Backend::best().run(bins);
            if is_last || plane.is_some() {
                return plane;
            }
            span = node.centroids();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::reference::{PrimRef, bounds};
    use crate::geometry::{Aabb, Axis};
    use alloc::vec::Vec;

    fn split_of(references: &[PrimRef], heuristic: BinnedSah, max_leaf_size: usize) -> Split {
        let aabb = bounds(references);
        let (depth, block_size, extra_references) = (0, 1, 0);
        heuristic.split(&BuildNode {
            aabb,
            references,
            depth,
            max_leaf_size,
            block_size,
            scene: aabb,
            extra_references,
        })
    }

    fn unit_boxes(positions: &[f32]) -> Vec<PrimRef> {
        positions
            .iter()
            .enumerate()
            .map(|(i, &x)| PrimRef::new(Aabb::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]), i as u32))
            .collect()
    }

    /// Twelve unit boxes, `step` apart.
    fn row(step: f32) -> Vec<PrimRef> {
        unit_boxes(&(0..12u8).map(|i| f32::from(i) * step).collect::<Vec<_>>())
    }

    #[test]
    fn two_clusters_are_separated() {
        let clusters: Vec<f32> = (0..12u8).map(|i| f32::from(i) + if i < 5 { 0.0 } else { 100.0 }).collect();
        match split_of(&unit_boxes(&clusters), BinnedSah::default(), 1) {
            Split::Plane { axis: Axis::X, position } => assert!(position > 4.5 && position < 105.5),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn overlapping_boxes_are_left_together_only_where_a_leaf_may_hold_them() {
        let references = row(0.001);
        assert_eq!(split_of(&references, BinnedSah::default(), 12), Split::Leaf);
        assert!(matches!(split_of(&references, BinnedSah::default(), 11), Split::Plane { .. }));
    }

    #[test]
    fn a_dear_test_splits_what_a_dear_step_leaves_together() {
        let with = |traversal, intersection| BinnedSah {
            cost: SahCost { traversal, intersection },
            ..BinnedSah::new(8)
        };
        assert_eq!(split_of(&row(0.5), with(9.0, 1.0), 12), Split::Leaf);
        assert!(matches!(split_of(&row(0.5), with(0.1, 1.0), 12), Split::Plane { .. }));
    }

    #[test]
    fn coincident_centroids_and_absurd_bin_counts_are_answered() {
        assert_eq!(split_of(&row(0.0), BinnedSah::default(), 2), Split::Leaf);
        for bins in [0, 1, usize::MAX] {
            assert!(matches!(split_of(&row(9.0), BinnedSah::new(bins), 1), Split::Plane { .. }));
        }
    }

    #[test]
    fn dust_beside_a_giant_is_binned_over_its_own_extent() {
        let mut references = row(0.01);
        references.push(PrimRef::new(Aabb::new([-1e6; 3], [1e6; 3]), 12));
        assert!(matches!(split_of(&references, BinnedSah::default(), 4), Split::Plane { .. }));
    }
}
