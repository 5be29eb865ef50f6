//! One step of the build: a set of references becomes a leaf or two sets.

use super::heuristic::{BuildNode, Heuristic, Split};
use super::reference::{Extent, PrimRef};
use crate::geometry::{Axis, Scalar};
use crate::tree::MAX_DEPTH;

/// What the driver needs to divide any node.
pub(super) struct Rules<'h, H: ?Sized> {
    pub heuristic: &'h H,
    pub max_leaf_size: usize,
}

/// Two non-empty sides: the references before `middle`, and from it on.
pub(super) struct Division<S> {
    pub middle: usize,
    pub sides: [Extent<S>; 2],
}

/// Reorders `references` into the two sides of a split, or answers `None` for a leaf.
///
/// The depth bound is the invariant `depth + ceil(log2(n)) <= MAX_DEPTH` of every node. It holds at
/// the root (at most 2^32 primitives, 32 <= 64); a proposed split is taken only if it holds for both
/// sides; equal halves, which replace it otherwise, keep it, since each is one level deeper and
/// has one binary digit less.
pub(super) fn divide<S: Scalar, H: Heuristic<S> + ?Sized>(
    references: &mut [PrimRef<S>],
    extent: &Extent<S>,
    depth: usize,
    rules: &Rules<'_, H>,
) -> Option<Division<S>> {
    let n = references.len();
    if n < 2 {
        return None;
    }
    let split = rules.heuristic.split(&BuildNode {
        aabb: extent.aabb,
        centroids: extent.centroids,
        references,
        depth,
        max_leaf_size: rules.max_leaf_size,
    });
    let division = match split {
        Split::Leaf if n <= rules.max_leaf_size => return None,
        Split::Leaf => None,
        Split::Plane { axis, position } => Some(partition(references, axis, position)),
        Split::Count { axis, left } if left > 0 && left < n => Some(select(references, axis, left)),
        Split::Count { .. } => None,
    };
    let fits = |n: usize| n > 0 && depth + 1 + ceil_log2(n) <= MAX_DEPTH;
    Some(match division {
        Some(division) if fits(division.middle) && fits(n - division.middle) => division,
        _ => select(references, extent.centroids.longest_axis(), n / 2),
    })
}

/// The smallest k with 2^k >= n, for n > 0.
fn ceil_log2(n: usize) -> usize {
    n.next_power_of_two().trailing_zeros() as usize
}

/// Moves the references with a centroid below `position` to the front. A side may be empty.
fn partition<S: Scalar>(references: &mut [PrimRef<S>], axis: Axis, position: S) -> Division<S> {
    let axis = axis.index();
    let (mut left, mut right) = (Extent::EMPTY, Extent::EMPTY);
    let (mut middle, mut end) = (0, references.len());
    while middle < end {
        let reference = references[middle];
        // False for NaN.
        if reference.centroid[axis] < position {
            left = left.grow(&reference);
            middle += 1;
        } else {
            right = right.grow(&reference);
            end -= 1;
            references.swap(middle, end);
        }
    }
    Division { middle, sides: [left, right] }
}

/// Moves the `left` references with the smallest centroids to the front, equal ones by index.
fn select<S: Scalar>(references: &mut [PrimRef<S>], axis: Axis, left: usize) -> Division<S> {
    let axis = axis.index();
    references.select_nth_unstable_by(left, |a, b| {
        a.centroid[axis].total_cmp(&b.centroid[axis]).then(a.index.cmp(&b.index))
    });
    let (front, back) = references.split_at(left);
    Division { middle: left, sides: [Extent::of(front), Extent::of(back)] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use alloc::vec::Vec;

    fn references(n: u32, x: impl Fn(u32) -> f32) -> Vec<PrimRef> {
        (0..n)
            .map(|index| {
                let centroid = [x(index), 0.0, 0.0];
                PrimRef { aabb: Aabb::new(centroid, centroid), centroid, index }
            })
            .collect()
    }

    /// Proposes always the same.
    struct Always(Split<f32>);
    impl Heuristic<f32> for Always {
        fn split(&self, _: &BuildNode<'_, f32>) -> Split<f32> {
            self.0
        }
    }

    fn middle(split: Split<f32>, n: u32, depth: usize) -> Option<usize> {
        let mut references = references(n, |i| (i * 7 % n) as f32);
        let extent = Extent::of(&references);
        let rules = Rules { heuristic: &Always(split), max_leaf_size: 4 };
        divide(&mut references, &extent, depth, &rules).map(|division| {
            for (side, part) in
                [&references[..division.middle], &references[division.middle..]].iter().enumerate()
            {
                assert_eq!(Extent::of(part), division.sides[side]);
            }
            division.middle
        })
    }

    #[test]
    fn good_splits_are_taken_and_bad_ones_replaced_by_halves() {
        let plane = |position| Split::Plane { axis: Axis::X, position };
        let count = |left| Split::Count { axis: Axis::X, left };
        assert_eq!(middle(plane(30.0), 100, 0), Some(30));
        assert_eq!(middle(count(1), 100, 0), Some(1));
        for bad in [
            plane(f32::NAN),
            plane(f32::INFINITY),
            plane(-1.0),
            count(0),
            count(100),
            count(usize::MAX),
            Split::Leaf,
        ] {
            assert_eq!(middle(bad, 100, 0), Some(50), "{bad:?}");
        }
        assert_eq!(middle(Split::Leaf, 4, 0), None);
        assert_eq!(middle(Split::Leaf, 5, 0), Some(2));
    }

    #[test]
    fn a_split_that_would_break_the_depth_bound_is_replaced_by_halves() {
        let one = Split::Count { axis: Axis::X, left: 1 };
        // 99 references need 7 more levels, below depth 57 there are 6 left after this one.
        assert_eq!(middle(one, 100, MAX_DEPTH - 8), Some(1));
        assert_eq!(middle(one, 100, MAX_DEPTH - 7), Some(50));
    }
}
