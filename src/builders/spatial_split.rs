//! Spatial splits: a plane cuts the references that it crosses in two.
//!
//! Boxes of references are cut, never primitives, although the part of a primitive in half of its
//! box might need less room. So the two boxes together are the whole box, to the bit. This keeps
//! the answers those of the naive loop. A ray that meets the whole box meets one of the two
//! halves at the same entry, because the slab test rounds monotonically and the halves share the
//! plane. So nothing is culled that would not be culled with the whole box. A box around a part
//! of the primitive has no such guarantee: near a grazing hit, the error of t is larger than the
//! margin of such a box.

use super::reference::PrimRef;
use crate::geometry::{Aabb, Axis, Scalar};
use alloc::vec::Vec;

/// A plane, with the counts and boxes of its sides.
///
/// At first, they are the counts and boxes if all references that the plane crosses are cut.
pub(super) struct Cut<S> {
    axis: Axis,
    position: S,
    /// The number of references on each side.
    pub counts: [usize; 2],
    boxes: [Aabb<S>; 2],
    /// The scale for [`Aabb::scaled_half_area`].
    scale: S,
}

/// Returns the parts of a box on both sides of a plane.
///
/// One of them is `None` if the plane does not cross the box.
#[inline(always)]
pub(super) fn halves<S: Scalar>(aabb: &Aabb<S>, axis: Axis, position: S) -> [Option<Aabb<S>>; 2] {
    let axis = axis.index();
    if aabb.max[axis] <= position {
        [Some(*aabb), None]
    } else if aabb.min[axis] < position {
        let (mut left, mut right) = (*aabb, *aabb);
        (left.max[axis], right.min[axis]) = (position, position);
        [Some(left), Some(right)]
    } else {
        // The case of a NaN position, too.
        [None, Some(*aabb)]
    }
}

impl<S: Scalar> Cut<S> {
    pub fn new(references: &[PrimRef<S>], axis: Axis, position: S) -> Self {
        let (mut counts, mut boxes, mut all) = ([0, 0], [Aabb::EMPTY; 2], Aabb::EMPTY);
        for reference in references {
            all = all.union(reference.aabb);
            for (side, half) in halves(&reference.aabb, axis, position).into_iter().enumerate() {
                if let Some(half) = half {
                    counts[side] += 1;
                    boxes[side] = boxes[side].union(half);
                }
            }
        }
        Self { axis, position, counts, boxes, scale: all.area_scale() }
    }

    /// Moves the left side's references to the front of the list.
    ///
    /// Returns the number of these references, and the references of the right side.
    ///
    /// A reference that the plane crosses stays whole where that costs less (Stich's unsplitting):
    /// the box of one side grows, and the other side has one reference less.
    pub fn carry_out(mut self, references: &mut [PrimRef<S>]) -> (usize, Vec<PrimRef<S>>) {
        let mut right = Vec::with_capacity(self.counts[1]);
        let mut left = 0;
        for i in 0..references.len() {
            let reference = references[i];
            let sides = match halves(&reference.aabb, self.axis, self.position) {
                [Some(first), Some(second)] => self.parts(&reference, [first, second]),
                whole => whole,
            };
            if let Some(aabb) = sides[0] {
                references[left] = PrimRef::new(aabb, reference.index);
                left += 1;
            }
            if let Some(aabb) = sides[1] {
                right.push(PrimRef::new(aabb, reference.index));
            }
        }
        (left, right)
    }

    /// Returns both halves, or the whole box on one side.
    fn parts(&mut self, reference: &PrimRef<S>, halves: [Aabb<S>; 2]) -> [Option<Aabb<S>>; 2] {
        let whole = reference.aabb;
        let [left, right] = self.boxes;
        let (with_left, with_right) = (left.union(whole), right.union(whole));
        let cost = |aabb: &Aabb<S>, count: usize| aabb.scaled_half_area(self.scale).to_f64() * count as f64;
        let [l, r] = self.counts;
        let both = cost(&left, l) + cost(&right, r);
        let all_left = cost(&with_left, l) + cost(&right, r - 1);
        let all_right = cost(&left, l - 1) + cost(&with_right, r);
        if both <= all_left && both <= all_right {
            return halves.map(Some);
        }
        if all_left <= all_right {
            (self.boxes[0], self.counts[1]) = (with_left, r - 1);
            [Some(whole), None]
        } else {
            (self.boxes[1], self.counts[0]) = (with_right, l - 1);
            [None, Some(whole)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(min: f32, max: f32, index: u32) -> PrimRef {
        PrimRef::new(Aabb::new([min, 0.0, 0.0], [max, 1.0, 1.0]), index)
    }

    #[test]
    fn what_the_plane_passes_through_is_on_both_sides_and_nothing_else_is() {
        // A box that touches the plane is on one side of it.
        let mut references =
            [reference(0.0, 1.0, 0), reference(1.0, 2.0, 1), reference(-9.0, 9.0, 2), reference(3.0, 4.0, 3)];
        let cut = Cut::new(&references, Axis::X, 1.0);
        assert_eq!(cut.counts, [2, 3]);
        let (left, right) = cut.carry_out(&mut references);
        assert_eq!(references[..left], [reference(0.0, 1.0, 0), reference(-9.0, 1.0, 2)]);
        assert_eq!(right, [reference(1.0, 2.0, 1), reference(1.0, 9.0, 2), reference(3.0, 4.0, 3)]);
    }

    #[test]
    fn what_hardly_reaches_over_stays_whole() {
        let mut references: Vec<_> = (0..10).map(|i| reference(0.0, 5.0, i)).collect();
        references.extend((10..20).map(|i| reference(5.0, 10.0, i)));
        references.push(reference(0.0, 5.25, 20));
        let cut = Cut::new(&references, Axis::X, 5.0);
        assert_eq!(cut.counts, [11, 11]);
        let (left, right) = cut.carry_out(&mut references);
        assert_eq!((left, right.len()), (11, 10));
        assert_eq!(references[10], reference(0.0, 5.25, 20));
    }
}
