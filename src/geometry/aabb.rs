//! The axis-aligned bounding box.

use super::{Axis, Scalar, max, min};

/// An axis-aligned box, from corner `min` to corner `max`, both included.
///
/// ```
/// use bvhkit::Aabb;
/// let unit = Aabb::new([0.0, 0.0, 0.0], [1.0, 1.0, 1.0]);
/// assert_eq!(unit.grow([2.0, 0.5, 0.5]).extent(), [2.0, 1.0, 1.0]);
/// assert!(Aabb::<f32>::EMPTY.is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Aabb<S = f32> {
    /// The corner with the smallest coordinates.
    pub min: [S; 3],
    /// The corner with the largest coordinates.
    pub max: [S; 3],
}

impl<S: Scalar> Aabb<S> {
    /// The box that holds no point: a union with it changes nothing.
    pub const EMPTY: Self = Self { min: [S::INFINITY; 3], max: [S::NEG_INFINITY; 3] };

    /// Creates the box from `min` to `max`.
    ///
    /// The box is empty if `min` exceeds `max` on any axis.
    #[inline(always)]
    pub fn new(min: impl Into<[S; 3]>, max: impl Into<[S; 3]>) -> Self {
        Self { min: min.into(), max: max.into() }
    }

    /// Returns the smallest box around `points`.
    ///
    /// The box is not valid if a coordinate is NaN or infinite.
    #[inline(always)]
    pub fn of_points(points: impl IntoIterator<Item = [S; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::grow)
    }

    /// Returns this box, enlarged to hold `point`.
    ///
    /// A bound that is NaN stays NaN, so that a NaN in a primitive does not go unnoticed.
    #[inline(always)]
    #[must_use]
    pub fn grow(self, point: [S; 3]) -> Self {
        let mut grown = self;
        for (axis, x) in point.into_iter().enumerate() {
            if x < grown.min[axis] || x.is_nan() {
                grown.min[axis] = x;
            }
            if x > grown.max[axis] || x.is_nan() {
                grown.max[axis] = x;
            }
        }
        grown
    }

    /// Returns the smallest box around both. A NaN bound of `other` is ignored.
    #[inline(always)]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.min, other.min);
        let ([cx, cy, cz], [dx, dy, dz]) = (self.max, other.max);
        Self { min: [min(bx, ax), min(by, ay), min(bz, az)], max: [max(dx, cx), max(dy, cy), max(dz, cz)] }
    }

    /// Returns the part that is inside both boxes; empty if there is none.
    #[inline]
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.min, other.min);
        let ([cx, cy, cz], [dx, dy, dz]) = (self.max, other.max);
        Self { min: [max(bx, ax), max(by, ay), max(bz, az)], max: [min(dx, cx), min(dy, cy), min(dz, cz)] }
    }

    /// Returns the part of this box inside `other`, or this box if there is none.
    #[inline]
    pub(crate) fn within(self, other: Self) -> Self {
        let inside = self.intersection(other);
        if inside.is_empty() { self } else { inside }
    }

    /// Returns whether the box holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|a| self.min[a] > self.max[a])
    }

    /// Returns whether all bounds are finite and no minimum exceeds its maximum.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // All comparisons at once: a branch for each takes longer. Comparisons with NaN are false.
        let in_order = |axis: usize| {
            (S::NEG_INFINITY < self.min[axis])
                & (self.min[axis] <= self.max[axis])
                & (self.max[axis] < S::INFINITY)
        };
        in_order(0) & in_order(1) & in_order(2)
    }

    /// Returns whether `other` is inside this box. They may touch.
    ///
    /// An empty box is inside every box.
    #[inline]
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty() || (0..3).all(|a| self.min[a] <= other.min[a] && other.max[a] <= self.max[a])
    }

    /// Returns the middle of the box, rounded; finite for every valid box.
    #[inline(always)]
    pub fn center(&self) -> [S; 3] {
        let ([ax, ay, az], [bx, by, bz]) = (self.min, self.max);
        // Halves are added: the sum of two large bounds may overflow.
        let middle = |a: S, b: S| a * S::HALF + b * S::HALF;
        [middle(ax, bx), middle(ay, by), middle(az, bz)]
    }

    /// Returns the size along each axis.
    ///
    /// The size is infinite where it overflows, and negative where `min` exceeds `max`.
    #[inline(always)]
    pub fn extent(&self) -> [S; 3] {
        let ([ax, ay, az], [bx, by, bz]) = (self.min, self.max);
        [bx - ax, by - ay, bz - az]
    }

    /// Returns the axis along which the box is largest; the first of equal ones.
    #[inline]
    pub fn longest_axis(&self) -> Axis {
        let [x, y, z] = self.extent();
        if x >= y && x >= z {
            Axis::X
        } else if y >= z {
            Axis::Y
        } else {
            Axis::Z
        }
    }

    /// Returns half the surface area, in units of length squared.
    ///
    /// A negative extent counts as 0, so the area of [`EMPTY`](Self::EMPTY) is 0.
    ///
    /// The area overflows to infinity or underflows to zero at the extremes of the scalar's range:
    /// [`scaled_half_area`](Self::scaled_half_area) compares boxes there.
    #[inline(always)]
    pub fn half_area(&self) -> S {
        self.scaled_half_area(S::ONE)
    }

    /// Returns half the surface area, with the extents multiplied by `scale`.
    ///
    /// A negative extent counts as 0, so the area of [`EMPTY`](Self::EMPTY) is 0.
    ///
    /// Let `scale` be 1 / (the largest extent of a box around all boxes to be compared). Then areas
    /// neither overflow nor vanish together, whatever the unit of length.
    #[inline(always)]
    pub fn scaled_half_area(&self, scale: S) -> S {
        let [x, y, z] = self.extent();
        let (x, y, z) = (max(x * scale, S::ZERO), max(y * scale, S::ZERO), max(z * scale, S::ZERO));
        x * y + y * z + z * x
    }

    /// Returns how many of `count` equal slices fit into a unit of length, by axis.
    ///
    /// The number is 0 on an axis without extent, where the quotient is not finite.
    #[inline(always)]
    pub(crate) fn per_unit(&self, count: usize) -> [S; 3] {
        let count = S::from_count(count as i32);
        let [x, y, z] = self.extent();
        let (x, y, z) = (count / x, count / y, count / z);
        let finite = |scale: S| if scale.is_finite() { scale } else { S::ZERO };
        [finite(x), finite(y), finite(z)]
    }

    /// Returns the scale by which areas inside this box are compared.
    ///
    /// This is the scale for [`scaled_half_area`](Self::scaled_half_area): 1 / (the largest
    /// extent), or 1 if that is zero or not finite, as for a point.
    #[inline]
    pub(crate) fn area_scale(&self) -> S {
        let largest = self.extent()[self.longest_axis().index()];
        let scale = S::ONE / largest;
        if scale > S::ZERO && scale.is_finite() { scale } else { S::ONE }
    }
}

impl<S: Scalar> Default for Aabb<S> {
    /// Returns [`Aabb::EMPTY`].
    fn default() -> Self {
        Self::EMPTY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_has_no_area() {
        let unit = Aabb::new([0.0f32; 3], [1.0; 3]);
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert_eq!(unit.union(Aabb::EMPTY), unit);
        assert_eq!(Aabb::<f32>::EMPTY.half_area(), 0.0);
        assert!(unit.contains(&Aabb::EMPTY) && !Aabb::EMPTY.contains(&unit));
    }

    #[test]
    fn area_longest_axis_and_center() {
        let b = Aabb::new([0.0f64, -1.0, 2.0], [1.0, 2.0, 4.0]);
        assert_eq!(b.half_area(), 1.0 * 3.0 + 3.0 * 2.0 + 2.0 * 1.0);
        assert_eq!(b.longest_axis(), Axis::Y);
        assert_eq!(b.center(), [0.5, 0.5, 3.0]);
    }

    #[test]
    fn the_extremes_of_the_range_keep_a_finite_center_and_comparable_areas() {
        let huge = Aabb::new([f32::MAX; 3], [f32::MAX; 3]);
        assert_eq!(huge.center(), [f32::MAX; 3]);
        for unit in [1e-30f32, 1e30] {
            let b = Aabb::new([0.0; 3], [unit; 3]);
            let half = Aabb::new([0.0; 3], [unit * 0.5; 3]);
            let scale = b.area_scale();
            let ratio = half.scaled_half_area(scale) / b.scaled_half_area(scale);
            assert!((ratio - 0.25).abs() < 1e-6, "{unit}: {ratio}");
        }
    }

    #[test]
    fn a_nan_among_points_makes_the_box_invalid_wherever_it_is() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for place in 0..9 {
                let mut points = [[0.0f32, 1.0, 2.0], [3.0, -1.0, 0.5], [1.0, 1.0, 1.0]];
                points[place / 3][place % 3] = bad;
                assert!(!Aabb::of_points(points).is_valid(), "{points:?}");
            }
        }
    }

    #[test]
    fn validity() {
        assert!(Aabb::new([0.0f32; 3], [0.0; 3]).is_valid());
        for bad in [f32::NAN, f32::INFINITY] {
            assert!(!Aabb::new([0.0, bad, 0.0], [1.0, bad, 1.0]).is_valid());
        }
        assert!(!Aabb::new([0.0f32, 2.0, 0.0], [1.0, 1.0, 1.0]).is_valid());
        assert!(!Aabb::<f32>::EMPTY.is_valid());
    }
}
