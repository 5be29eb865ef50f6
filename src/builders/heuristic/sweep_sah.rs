//! The surface area heuristic on all splits.

use super::{BuildNode, Heuristic, SahCost, Split};
use crate::builders::reference::PrimRef;
use crate::geometry::{Aabb, Axis, Scalar};
use crate::parallel;
use alloc::vec;
use alloc::vec::Vec;

/// The three axes are swept in parallel from this number of references on.
const PARALLEL: usize = 1 << 13;

/// The surface area heuristic on all splits by number.
///
/// The cheapest split of the references in the order of their centroids, on all three axes, is
/// chosen (MacDonald and Booth, Heuristics for Ray Tracing Using Space Subdivision, 1990).
///
/// It is exact where [`BinnedSah`](super::BinnedSah) samples. Each node sorts its references on
/// each axis, so a build takes O(n log^2 n).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepSah {
    /// The costs of a step and of a test.
    pub cost: SahCost,
}

impl SweepSah {
    /// Up to this many references are swept without an allocation.
    pub(super) const SMALL: usize = 8;
}

impl<S: Scalar> Heuristic<S> for SweepSah {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        S::sweep(self, node)
    }
}

impl SweepSah {
    pub(in crate::builders) fn propose<S: Scalar>(&self, node: &BuildNode<'_, S>) -> Split<S> {
        let n = node.references.len();
        if n < 2 || SahCost::is_block(node) {
            return Split::Leaf;
        }
        let (scale, centroids) = (node.aabb.area_scale(), node.centroids());
        let best = |axis: Axis, memory: &mut [Place]| {
            if centroids.min[axis.index()] < centroids.max[axis.index()] {
                best_count(node.references, axis, scale, memory)
            } else {
                // All centroids are equal on this axis: there is no order to sweep in.
                Best { left: n / 2, weighted_area: f64::INFINITY }
            }
        };
        let sweeps = if n <= Self::SMALL {
            let mut memory = [Place::default(); Self::SMALL];
            Axis::ALL.map(|axis| best(axis, &mut memory[..n]))
        } else if n < PARALLEL {
            let mut memory = vec![Place::default(); n];
            Axis::ALL.map(|axis| best(axis, &mut memory))
        } else {
            let sweeps =
                parallel::map(Vec::from(Axis::ALL), |axis| best(axis, &mut vec![Place::default(); n]));
            [sweeps[0], sweeps[1], sweeps[2]]
        };
        // Of equal costs, the first axis is taken.
        let (mut axis, mut best) = (Axis::X, sweeps[0]);
        for (next, sweep) in [(Axis::Y, sweeps[1]), (Axis::Z, sweeps[2])] {
            if sweep.weighted_area < best.weighted_area {
                (axis, best) = (next, sweep);
            }
        }
        let best_split = Split::Count { axis, left: best.left };
        self.cost.split_or_leaf(node, best_split.into(), best.weighted_area).split
    }
}

#[derive(Clone, Copy)]
struct Best {
    left: usize,
    weighted_area: f64,
}

/// A place in the order of the centroids along an axis.
#[derive(Clone, Copy, Default)]
struct Place {
    /// The centroid as ordered bits, then the primitive's index.
    ///
    /// Places are sorted in the order by which [`Split::Count`] counts.
    key: (u64, u32),
    /// The reference's position in the node.
    position: u32,
    /// The cost of all references from this place on.
    right_cost: f64,
}

/// Returns the cheapest split by number along an axis.
///
/// `memory` has a place for each reference.
fn best_count<S: Scalar>(references: &[PrimRef<S>], axis: Axis, scale: S, memory: &mut [Place]) -> Best {
    let n = references.len();
    for ((place, reference), position) in memory.iter_mut().zip(references).zip(0..) {
        place.key = (reference.centroid()[axis.index()].to_ordered_bits(), reference.index);
        place.position = position;
    }
    memory.sort_unstable_by_key(|place| place.key);
    // In `f64`, where the product of an `f32` and a count is exact, as are sums of products of one
    // area: equal costs compare equal.
    let cost = |aabb: &Aabb<S>, count: usize| aabb.scaled_half_area(scale).to_f64() * count as f64;
    let aabb_of = |place: &Place| references[place.position as usize].aabb;

    let mut right = Aabb::EMPTY;
    for (place, count) in memory[1..].iter_mut().rev().zip(1..) {
        right = right.union(aabb_of(place));
        place.right_cost = cost(&right, count);
    }
    let mut left = Aabb::EMPTY;
    let mut best = Best { left: n / 2, weighted_area: f64::INFINITY };
    for (pair, count) in memory.windows(2).zip(1..) {
        left = left.union(aabb_of(&pair[0]));
        let weighted_area = cost(&left, count) + pair[1].right_cost;
        // Of equal costs, the most even split is taken: identical primitives make
        // halves, not a chain.
        let is_better = weighted_area < best.weighted_area
            || weighted_area == best.weighted_area && count.abs_diff(n / 2) < best.left.abs_diff(n / 2);
        if is_better {
            best = Best { left: count, weighted_area };
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builders::reference::bounds;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn the_split_is_the_cheapest_of_all() {
        // Pseudo-random boxes; brute force computes the cost of every split on every axis.
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut next = || rng.random::<f32>();
        let references: Vec<PrimRef> = (0..40)
            .map(|index| {
                let min = [next() * 9.0, next() * 5.0, next() * 7.0];
                let aabb = Aabb::new(min, min.map(|x| x + next()));
                PrimRef::new(aabb, index)
            })
            .collect();
        let aabb = bounds(&references);
        let price = |axis: Axis, left: usize| {
            let mut sorted = references.clone();
            sorted.sort_by(|a, b| a.centroid()[axis.index()].total_cmp(&b.centroid()[axis.index()]));
            let (front, back) = sorted.split_at(left);
            [front, back].map(|side| bounds(side).half_area() * side.len() as f32).iter().sum::<f32>()
        };
        let cheapest = Axis::ALL
            .iter()
            .flat_map(|&axis| (1..references.len()).map(move |left| (axis, left)))
            .min_by(|&(a, i), &(b, j)| price(a, i).total_cmp(&price(b, j)))
            .unwrap();
        let split = SweepSah::default().split(&BuildNode {
            aabb,
            references: &references,
            depth: 0,
            max_leaf_size: 1,
            block_size: 1,
            scene: aabb,
            extra_references: 0,
        });
        assert_eq!(split, Split::Count { axis: cheapest.0, left: cheapest.1 });
    }
}
