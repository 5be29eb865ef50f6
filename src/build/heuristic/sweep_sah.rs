//! The surface area heuristic on every split there is.

use super::{BuildNode, Heuristic, SahCost, Split};
use crate::build::parallel;
use crate::build::reference::PrimRef;
use crate::geometry::{Aabb, Axis, Scalar};
use alloc::vec;
use alloc::vec::Vec;

/// References above which the three axes are swept on several threads.
const PARALLEL: usize = 1 << 13;

/// The cheapest of all splits of the references in the order of their centroids, on all three axes,
/// by the surface area heuristic (MacDonald and Booth, Heuristics for Ray Tracing Using Space
/// Subdivision, 1990).
///
/// Exact where [`BinnedSah`](super::BinnedSah) samples; each node sorts its references on each
/// axis, so a build takes O(n log^2 n).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepSah {
    /// The costs of a step and of a test.
    pub cost: SahCost,
}

impl<S: Scalar> Heuristic<S> for SweepSah {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        let n = node.references.len();
        let scale = node.aabb.area_scale();
        let sweeps = if n < PARALLEL {
            let mut sweep = Sweep::new(n);
            Axis::ALL.map(|axis| sweep.best(node.references, axis, scale))
        } else {
            let best = |axis| Sweep::new(n).best(node.references, axis, scale);
            let sweeps = parallel::map(Vec::from(Axis::ALL), best);
            [sweeps[0], sweeps[1], sweeps[2]]
        };
        // The first of equals.
        let (mut axis, mut best) = (Axis::X, sweeps[0]);
        for (next, sweep) in [(Axis::Y, sweeps[1]), (Axis::Z, sweeps[2])] {
            if sweep.weighted_area < best.weighted_area {
                (axis, best) = (next, sweep);
            }
        }
        let area = node.aabb.scaled_half_area(scale);
        if n <= node.max_leaf_size && self.cost.prefers_leaf(n, area, best.weighted_area) {
            Split::Leaf
        } else {
            Split::Count { axis, left: best.left }
        }
    }
}

#[derive(Clone, Copy)]
struct Best<S> {
    left: usize,
    weighted_area: S,
}

/// The memory of a sweep, shared between axes.
struct Sweep<S> {
    /// The centroid as ordered bits, the primitive's index, the position in the node: sorted as
    /// [`Split::Count`] counts.
    order: Vec<(u64, u32, u32)>,
    /// The cost of everything from a place on.
    right_cost: Vec<S>,
}

impl<S: Scalar> Sweep<S> {
    fn new(n: usize) -> Self {
        Self { order: Vec::with_capacity(n), right_cost: vec![S::ZERO; n] }
    }

    fn best(&mut self, references: &[PrimRef<S>], axis: Axis, scale: S) -> Best<S> {
        let n = references.len();
        self.order.clear();
        self.order.extend(references.iter().zip(0..).map(|(reference, position)| {
            (reference.centroid[axis.index()].to_ordered_bits(), reference.index, position)
        }));
        self.order.sort_unstable();
        let cost = |aabb: &Aabb<S>, count: usize| aabb.scaled_half_area(scale) * S::from_f64(count as f64);
        let aabb_at = |place: usize| references[self.order[place].2 as usize].aabb;

        let mut right = Aabb::EMPTY;
        for i in (1..n).rev() {
            right = right.union(aabb_at(i));
            self.right_cost[i] = cost(&right, n - i);
        }
        let mut left = Aabb::EMPTY;
        let mut best = Best { left: n / 2, weighted_area: S::INFINITY };
        for i in 1..n {
            left = left.union(aabb_at(i - 1));
            let weighted_area = cost(&left, i) + self.right_cost[i];
            if weighted_area < best.weighted_area {
                best = Best { left: i, weighted_area };
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::reference::Extent;

    #[test]
    fn the_split_is_the_cheapest_of_all() {
        // Pseudo-random boxes; every split on every axis is priced by brute force.
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let references: Vec<PrimRef> = (0..40)
            .map(|index| {
                let min = [next() * 9.0, next() * 5.0, next() * 7.0];
                let aabb = Aabb::new(min, min.map(|x| x + next()));
                PrimRef { aabb, centroid: aabb.center(), index }
            })
            .collect();
        let extent = Extent::of(&references);
        let price = |axis: Axis, left: usize| {
            let mut sorted = references.clone();
            sorted.sort_by(|a, b| a.centroid[axis.index()].total_cmp(&b.centroid[axis.index()]));
            let (front, back) = sorted.split_at(left);
            [front, back]
                .map(|side| Extent::of(side).aabb.half_area() * side.len() as f32)
                .iter()
                .sum::<f32>()
        };
        let cheapest = Axis::ALL
            .iter()
            .flat_map(|&axis| (1..references.len()).map(move |left| (axis, left)))
            .min_by(|&(a, i), &(b, j)| price(a, i).total_cmp(&price(b, j)))
            .unwrap();
        let split = SweepSah::default().split(&BuildNode {
            aabb: extent.aabb,
            centroids: extent.centroids,
            references: &references,
            depth: 0,
            max_leaf_size: 1,
        });
        assert_eq!(split, Split::Count { axis: cheapest.0, left: cheapest.1 });
    }
}
