//! One step of the build: a set of references becomes a leaf or two sets.

use super::heuristic::{BuildNode, Heuristic, Split};
use super::reference::{PrimRef, bounds};
use crate::geometry::{Aabb, Axis, Scalar};
use crate::tree::MAX_DEPTH;

/// What the driver needs to divide any node.
pub(crate) struct Rules<'h, H: ?Sized> {
    pub heuristic: &'h H,
    pub max_leaf_size: usize,
    pub block_size: usize,
}

impl<H: ?Sized> Rules<'_, H> {
    /// A node as heuristics see it.
    fn node<'r, S>(&self, references: &'r [PrimRef<S>], aabb: Aabb<S>, depth: usize) -> BuildNode<'r, S> {
        let Self { max_leaf_size, block_size, .. } = *self;
        BuildNode { aabb, references, depth, max_leaf_size, block_size }
    }
}

/// Two non-empty sides: the references before `middle`, and from it on.
pub(super) struct Division<S> {
    pub middle: usize,
    pub sides: [Aabb<S>; 2],
}

/// Reorders `references`, whose box is `aabb`, into the two sides of a split, or answers `None` for a leaf.
///
/// The depth bound is the invariant `depth + ceil(log2(n)) <= MAX_DEPTH` of every node. It holds at
/// the root (at most 2^32 primitives, 32 <= 64); a proposed split is taken only if it holds for both
/// sides; equal halves, which replace it otherwise, keep it, since each is one level deeper and
/// has one binary digit less.
pub(super) fn divide<S: Scalar, H: Heuristic<S> + ?Sized>(
    references: &mut [PrimRef<S>],
    aabb: &Aabb<S>,
    depth: usize,
    rules: &Rules<'_, H>,
) -> Option<Division<S>> {
    let n = references.len();
    if n < 2 {
        return None;
    }
    let middle = match rules.heuristic.split(&rules.node(references, *aabb, depth)) {
        Split::Leaf if n <= rules.max_leaf_size => return None,
        Split::Leaf => None,
        Split::Plane { axis, position } => Some(partition(references, axis, position)),
        Split::Count { axis, left } if left > 0 && left < n => Some(select(references, axis, left)),
        Split::Count { .. } => None,
    };
    let fits = |n: usize| n > 0 && depth + 1 + ceil_log2(n) <= MAX_DEPTH;
    let middle = match middle {
        Some(middle) if fits(middle) && fits(n - middle) => middle,
        _ => {
            let axis = rules.node(references, *aabb, depth).centroids().longest_axis();
            select(references, axis, n / 2)
        }
    };
    let (left, right) = references.split_at(middle);
    Some(Division { middle, sides: [bounds(left), bounds(right)] })
}

/// The smallest k with 2^k >= n, for n > 0.
fn ceil_log2(n: usize) -> usize {
    n.next_power_of_two().trailing_zeros() as usize
}

/// Moves the references with a centroid below `position` to the front, and tells how many they are: any number.
///
/// Lomuto's scheme without a branch: what comes next changes places with the first on the right, and whether it stays
/// there is added to the border. A branch would be mispredicted at every other reference.
fn partition<S: Scalar>(references: &mut [PrimRef<S>], axis: Axis, position: S) -> usize {
    let mut middle = 0;
    for i in 0..references.len() {
        // False for NaN.
        let is_left = references[i].middle(axis) < position;
        references.swap(i, middle);
        middle += usize::from(is_left);
    }
    middle
}

/// Moves the `left` references with the smallest centroids to the front, equal ones by index.
fn select<S: Scalar>(references: &mut [PrimRef<S>], axis: Axis, left: usize) -> usize {
    references.select_nth_unstable_by(left, |a, b| {
        a.middle(axis).total_cmp(&b.middle(axis)).then(a.index.cmp(&b.index))
    });
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn references(n: u32, x: impl Fn(u32) -> f32) -> Vec<PrimRef> {
        (0..n)
            .map(|index| {
                let point = [x(index), 0.0, 0.0];
                PrimRef::new(Aabb::new(point, point), index)
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
        let aabb = bounds(&references);
        let rules = Rules { heuristic: &Always(split), max_leaf_size: 4, block_size: 1 };
        divide(&mut references, &aabb, depth, &rules).map(|division| {
            let (left, right) = references.split_at(division.middle);
            assert_eq!(division.sides, [bounds(left), bounds(right)]);
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
