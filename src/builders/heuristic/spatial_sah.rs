//! The surface area heuristic with spatial splits.

use super::{BinnedSah, BuildNode, Heuristic, Own, Proposal, SahCost, Split};
use crate::builders::spatial_split::halves;
use crate::geometry::{Aabb, Axis, Scalar};

/// [`BinnedSah`], with planes that cut references in two.
///
/// Such a plane is chosen where the sides of [`BinnedSah`]'s plane overlap and the cut is cheaper
/// (Stich, Friedrich and Dietrich, Spatial Splits in Bounding Volume Hierarchies, HPG 2009).
///
/// For scenes of large primitives beside small ones; on scans it changes nothing. A primitive may
/// be in several leaves, and is one answer. Boxes of references are cut, not primitives, so answers
/// stay those of the naive loop to the bit.
///
/// Nodes of 16 children, tested all at once, leave it little to gain: with the same reinsertion,
/// rays are 0.93 to 1.05 times as fast as with [`BinnedSah`], depending on the scene. To cut
/// triangles in place of their boxes, as Stich does, makes little difference (measured:
/// docs/decisions.md, 20).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialSah {
    /// The planes between centroids, and the costs.
    pub planes: BinnedSah,
    /// Least overlap of the sides for which a cut is tried.
    ///
    /// The overlap is the area that the sides of the best plane between centroids have in common,
    /// as a fraction of the scene's area.
    pub overlap: f64,
    /// Maximum number of extra references, as a fraction of the primitives.
    ///
    /// From 0 to [`MAX_GROWTH`](Self::MAX_GROWTH). It bounds the memory, which is
    /// allocated at the start.
    pub growth: f64,
}

impl SpatialSah {
    /// The largest growth; larger values are clamped.
    pub const MAX_GROWTH: f64 = 4.0;
}

impl Default for SpatialSah {
    /// Returns a heuristic with 16 bins that adds at most half as many references.
    ///
    /// A cut is tried where a hundredth of the scene's area overlaps.
    fn default() -> Self {
        Self { planes: BinnedSah::default(), overlap: 1e-2, growth: 0.5 }
    }
}

/// Number of slices of space on each axis.
const SLICES: usize = 16;

impl<S: Scalar> Heuristic<S> for SpatialSah {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        self.proposal(node, Own::BUILD).split
    }

    fn proposal(&self, node: &BuildNode<'_, S>, _: Own) -> Proposal<S> {
        S::spatial(self, node)
    }

    fn extra_references(&self, primitives: usize) -> usize {
        (primitives as f64 * self.growth.clamp(0.0, Self::MAX_GROWTH)) as usize
    }
}

impl SpatialSah {
    pub(in crate::builders) fn propose<S: Scalar>(&self, node: &BuildNode<'_, S>) -> Proposal<S> {
        if SahCost::is_block(node) {
            return Split::Leaf.into();
        }
        let scale = node.aabb.area_scale();
        let plane = self.planes.plane(node);
        let (mut best, mut weighted_area) = match &plane {
            Some(plane) => (plane.proposal, plane.weighted_area),
            None => (Split::Leaf.into(), S::INFINITY),
        };
        let least = self.overlap * node.scene.scaled_half_area(scale).to_f64();
        if node.extra_references > 0 && plane.is_none_or(|plane| plane.overlap.to_f64() > least) {
            for axis in Axis::ALL {
                if let Some((position, cost)) =
                    Slices::of(node, axis).and_then(|slices| slices.best(node, scale))
                    && cost < weighted_area
                {
                    (best, weighted_area) = (Split::Spatial { axis, position }.into(), cost);
                }
            }
        }
        self.planes.cost.split_or_leaf(node, best, weighted_area.to_f64())
    }
}

/// Equal slices of a node's box along an axis, with their content.
///
/// For each slice, the box around the parts of references in it, and the numbers of references that
/// begin and end there.
struct Slices<S> {
    axis: usize,
    boxes: [Aabb<S>; SLICES],
    begin: [usize; SLICES],
    end: [usize; SLICES],
    /// The planes before each slice; the first is before all.
    planes: [S; SLICES],
}

impl<S: Scalar> Slices<S> {
    /// Fills the slices of a node; `None` if no plane between them may pay.
    fn of(node: &BuildNode<'_, S>, axis: Axis) -> Option<Self> {
        let i = axis.index();
        let (origin, extent) = (node.aabb.min[i], node.aabb.extent()[i]);
        let width = extent / S::from_count(SLICES as i32);
        let per_unit = S::ONE / width;
        let mut slices = Self {
            axis: i,
            boxes: [Aabb::EMPTY; SLICES],
            begin: [0; SLICES],
            end: [0; SLICES],
            planes: core::array::from_fn(|slice| origin + width * S::from_count(slice as i32)),
        };
        if !per_unit.is_finite() {
            return None;
        }
        let slice_of = |x: S| (((x - origin) * per_unit).to_f64() as usize).min(SLICES - 1);
        let slices_of = |aabb: &Aabb<S>| (slice_of(aabb.min[i]), slice_of(aabb.max[i]));
        for reference in node.references {
            let (first, last) = slices_of(&reference.aabb);
            slices.begin[first] += 1;
            slices.end[last] += 1;
        }
        if !slices.may_pay(node.references.len()) {
            return None;
        }
        for reference in node.references {
            let mut rest = reference.aabb;
            let (first, last) = slices_of(&rest);
            for slice in first..last {
                let [left, right] = halves(&rest, axis, slices.planes[slice + 1]);
                slices.boxes[slice] = slices.boxes[slice].union(left.unwrap_or(Aabb::EMPTY));
                rest = right.unwrap_or(Aabb::EMPTY);
            }
            slices.boxes[last] = slices.boxes[last].union(rest);
        }
        Some(slices)
    }

    /// Returns whether a plane has references on both sides and cuts at most half.
    ///
    /// In a heap of large primitives no plane does. The boxes, which take most of the time, would
    /// be computed in vain at every node.
    fn may_pay(&self, references: usize) -> bool {
        let (mut begun, mut ended) = (0, 0);
        (1..SLICES).any(|slice| {
            begun += self.begin[slice - 1];
            ended += self.end[slice - 1];
            begun > 0 && ended < references && begun - ended <= references / 2
        })
    }

    /// Returns the cheapest possible plane, and its cost.
    ///
    /// A plane is possible if it has references on both sides and there is room for all of them.
    fn best(&self, node: &BuildNode<'_, S>, scale: S) -> Option<(S, S)> {
        let cost = |aabb: &Aabb<S>, count: usize| aabb.scaled_half_area(scale) * S::from_count(count as i32);
        let mut right_cost = [(S::ZERO, 0); SLICES];
        let (mut aabb, mut count) = (Aabb::EMPTY, 0);
        for slice in (1..SLICES).rev() {
            (aabb, count) = (aabb.union(self.boxes[slice]), count + self.end[slice]);
            right_cost[slice] = (cost(&aabb, count), count);
        }
        let (mut aabb, mut left) = (Aabb::EMPTY, 0);
        let mut best: Option<(S, S)> = None;
        let inside = node.aabb.min[self.axis]..node.aabb.max[self.axis];
        for slice in 1..SLICES {
            (aabb, left) = (aabb.union(self.boxes[slice - 1]), left + self.begin[slice - 1]);
            let (right_cost, right) = right_cost[slice];
            let is_possible = left > 0
                && right > 0
                && left + right <= node.references.len() + node.extra_references
                && inside.contains(&self.planes[slice]);
            let cost = cost(&aabb, left) + right_cost;
            if is_possible && best.is_none_or(|(_, least)| cost < least) {
                best = Some((self.planes[slice], cost));
            }
        }
        best
    }
}
