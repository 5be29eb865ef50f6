//! One step of a build: a set of references becomes a leaf or two sets.
//!
//! Each of the two sets gets a part of the memory.

use super::heuristic::{BuildNode, Heuristic, Own, Proposal, Split};
use super::reference::{PrimRef, bounds, centroids};
use super::spatial_split::Cut;
use crate::geometry::{Aabb, Axis, Scalar};
use crate::simd::prefetch_ahead;

/// The rules by which the driver splits every node.
pub(crate) struct Rules<'h, S: Scalar> {
    pub heuristic: &'h dyn Heuristic<S>,
    pub max_leaf_size: usize,
    /// Maximum number of leaf ranges in a leaf; 1 if the layout has none, or if
    /// the user sets `max_leaf_size`.
    ///
    /// A leaf of neighbours along a curve is divided into leaf ranges.
    pub max_leaf_ranges: usize,
    pub block_size: usize,
    /// [`MAX_DEPTH`](crate::MAX_DEPTH), or less if clusters have subtrees below.
    pub max_depth: usize,
}

/// A set of references, in memory that has room for extra references.
pub(super) struct Set<'r, S> {
    pub memory: &'r mut [PrimRef<S>],
    pub len: usize,
    /// The box around the references.
    pub aabb: Aabb<S>,
    pub depth: usize,
}

impl<S> Set<'_, S> {
    pub fn references(&self) -> &[PrimRef<S>] {
        &self.memory[..self.len]
    }
}

impl<'r, S: Scalar> Set<'r, S> {
    /// Splits the set in two, or returns it as `Err` if it becomes a leaf.
    ///
    /// `scene` is the box around the whole scene.
    ///
    /// The depth bound is the invariant `depth + ceil(log2(n)) <= max_depth` of every node. It
    /// holds at the root: there are at most 2^32 references, and 32 <= 48, the smallest
    /// `max_depth`. A proposed split is taken only if the invariant holds for both sides. Otherwise
    /// equal halves replace the split. They keep the invariant: each half is one level deeper, and
    /// its `ceil(log2(n))` is at least one less.
    pub fn divide(self, rules: &Rules<'_, S>, scene: &Aabb<S>) -> Result<[Self; 2], Self> {
        let n = self.len;
        if n < 2 {
            return Err(self);
        }
        let Proposal { split, sides } = rules.heuristic.proposal(
            &BuildNode {
                aabb: self.aabb,
                references: self.references(),
                depth: self.depth,
                max_leaf_size: rules.max_leaf_size,
                block_size: rules.block_size,
                scene: *scene,
                extra_references: self.memory.len() - n,
            },
            Own::BUILD,
        );
        let fits = |n: usize| n > 0 && self.depth + 1 + ceil_log2(n) <= rules.max_depth;
        let room = self.memory.len();
        let references = &mut self.memory[..n];
        let middle = match split {
            Split::Leaf if n <= rules.max_leaf_size => return Err(self),
            Split::Plane { axis, position } => match &sides {
                Some(sides) => partition(references, |reference| sides.has_on_the_left(reference)),
                None => partition(references, |reference| reference.middle(axis) < position),
            },
            Split::Count { axis, left } if left > 0 && left < n => select(references, axis, left),
            Split::Spatial { axis, position } => {
                let cut = Cut::new(references, axis, position);
                let [left, right] = cut.counts;
                if left + right <= room && fits(left) && fits(right) {
                    let (left, right) = cut.carry_out(references);
                    if left > 0 && !right.is_empty() {
                        return Ok(self.cut(left, &right));
                    }
                    // All references stayed whole and went to the same side: undo the split.
                    references[left..].copy_from_slice(&right);
                }
                0
            }
            Split::Leaf | Split::Count { .. } => 0,
        };
        if fits(middle) && fits(n - middle) {
            return Ok(self.divided(middle, sides.map(|sides| sides.boxes)));
        }
        let axis = centroids(references).longest_axis();
        let middle = select(references, axis, n / 2);
        Ok(self.divided(middle, None))
    }

    /// Splits the set after the first `middle` references.
    ///
    /// `boxes` are the boxes of both sides, if they are known.
    fn divided(self, middle: usize, boxes: Option<[Aabb<S>; 2]>) -> [Self; 2] {
        let n = self.len;
        let border = middle + share(self.memory.len() - n, middle, n);
        if border > middle {
            self.memory.copy_within(middle..n, border);
        }
        self.split_at(border, [middle, n - middle], boxes)
    }

    /// Splits the set into its first `left` references and those in `right`.
    fn cut(self, left: usize, right: &[PrimRef<S>]) -> [Self; 2] {
        let n = left + right.len();
        let border = left + share(self.memory.len() - n, left, n);
        self.memory[border..border + right.len()].copy_from_slice(right);
        self.split_at(border, [left, right.len()], None)
    }

    fn split_at(self, border: usize, lens: [usize; 2], boxes: Option<[Aabb<S>; 2]>) -> [Self; 2] {
        let (left, right) = self.memory.split_at_mut(border);
        let boxes = boxes.unwrap_or_else(|| [bounds(&left[..lens[0]]), bounds(&right[..lens[1]])]);
        debug_assert_eq!(boxes, [bounds(&left[..lens[0]]), bounds(&right[..lens[1]])]);
        let depth = self.depth + 1;
        let side = |memory: &'r mut [PrimRef<S>], len: usize, aabb: Aabb<S>| Set { memory, len, aabb, depth };
        [side(left, lens[0], boxes[0]), side(right, lens[1], boxes[1])]
    }
}

/// Returns a side's share of the extra references, by its number of references.
fn share(extra_references: usize, side: usize, all: usize) -> usize {
    if extra_references == 0 { 0 } else { (extra_references as u128 * side as u128 / all as u128) as usize }
}

/// Returns the smallest k with 2^k >= n, for n > 0.
fn ceil_log2(n: usize) -> usize {
    n.next_power_of_two().trailing_zeros() as usize
}

/// Moves the left side's references to the front; returns their number.
///
/// The number may be 0 or `references.len()`.
///
/// Lomuto's scheme without a branch: each reference is swapped with the first one of the right
/// side, and the border moves by one if the reference belongs to the left side. A branch would be
/// mispredicted for every other reference.
///
/// Refused: to compute the boxes of both sides in the same loop. A build took 39 ms instead of
/// 35 ms.
fn partition<S: Scalar>(references: &mut [PrimRef<S>], is_left: impl Fn(&PrimRef<S>) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..references.len() {
        prefetch_ahead(&references[i]);
        prefetch_ahead(&references[middle]);
        let goes_left = is_left(&references[i]);
        references.swap(i, middle);
        middle += usize::from(goes_left);
    }
    middle
}

/// Moves the `left` references with the smallest centroids to the front.
///
/// Equal centroids are ordered by index. Returns `left`.
fn select<S: Scalar>(references: &mut [PrimRef<S>], axis: Axis, left: usize) -> usize {
    references.select_nth_unstable_by(left, |a, b| {
        a.middle(axis).total_cmp(&b.middle(axis)).then(a.index.cmp(&b.index))
    });
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::MAX_DEPTH;
    use alloc::vec::Vec;

    fn references(n: u32, x: impl Fn(u32) -> f32) -> Vec<PrimRef> {
        (0..n)
            .map(|index| {
                let point = [x(index), 0.0, 0.0];
                PrimRef::new(Aabb::new(point, point), index)
            })
            .collect()
    }

    /// Always proposes the same split.
    struct Always(Split<f32>);
    impl Heuristic<f32> for Always {
        fn split(&self, _: &BuildNode<'_, f32>) -> Split<f32> {
            self.0
        }
    }

    fn middle(split: Split<f32>, n: u32, depth: usize) -> Option<usize> {
        let mut references = references(n, |i| (i * 7 % n) as f32);
        let aabb = bounds(&references);
        let rules = Rules {
            heuristic: &Always(split),
            max_leaf_size: 4,
            max_leaf_ranges: 1,
            block_size: 1,
            max_depth: MAX_DEPTH,
        };
        let len = references.len();
        let sides = Set { memory: &mut references, len, aabb, depth }.divide(&rules, &aabb).ok()?;
        for side in &sides {
            assert_eq!(side.aabb, bounds(side.references()));
        }
        assert_eq!(sides[0].len + sides[1].len, len);
        Some(sides[0].len)
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
        // 99 references need 7 more levels. At depth 57, a split leaves only 6 levels.
        assert_eq!(middle(one, 100, MAX_DEPTH - 8), Some(1));
        assert_eq!(middle(one, 100, MAX_DEPTH - 7), Some(50));
    }
}
