//! The slab test: the t at which a ray enters and leaves a box.

use super::{Aabb, Ray, Scalar, max, min};

/// A ray prepared for slab tests.
///
/// The interval of t inside a box is the intersection of its three slabs (Kay and Kajiya
/// 1986). For each axis, the sign of the ray's direction decides which of the box's two planes
/// is met first, so that
///
/// ```text
/// near = max over axes of (near plane - origin) * inv_near
/// far  = min over axes of (far plane  - origin) * inv_far
/// ```
///
/// `inv_near` and `inv_far` are 1 / direction, made smaller and larger by 5 epsilon. Each side of
/// the test makes at most four roundings of half an epsilon. So, underflow aside, the interval
/// contains the exact one. Ize (2013) widens the far side alone; both sides are needed where a hit
/// is compared with `near`. The interval also contains that of a box moved by another 2 epsilon of
/// the distance to it, as the watertight triangle test moves corners. The padding takes no time: it
/// is in the inverse.
///
/// Behind the origin, at negative t, `inv_near` and `inv_far` change places for a ray with a
/// negative `t_min`. Other rays never look there, and the sign decides nothing for them.
///
/// On an axis with direction +0 or -0 the inverse is infinite. A plane strictly on one side gives
/// an infinity of the right sign. A plane through the origin gives 0 * infinity = NaN, which the
/// comparison leaves out: the box's face counts as inside.
///
/// Every step is a monotone function of the plane's coordinate: a rounded difference, a rounded
/// product with a constant of one sign, a maximum that leaves NaN out. Therefore **if box A
/// contains box B then near(A) <= near(B) and far(A) >= far(B), in floating point, exactly.** The
/// agreement of tree and naive loop rests on this (see `primitive::accept`).
#[derive(Clone, Copy, Debug)]
pub struct Slabs<S> {
    pub origin: [S; 3],
    pub inv_near: [S; 3],
    pub inv_far: [S; 3],
    /// For each axis, whether the near plane is the box's maximum.
    ///
    /// This is the sign bit of the direction, so that -0 is like +0.
    pub negative: [bool; 3],
    pub t_min: S,
}

impl<S: Scalar> Slabs<S> {
    #[inline(always)]
    pub fn new(ray: &Ray<S>) -> Self {
        let padding = S::from_f64(5.0) * S::EPSILON;
        let [dx, dy, dz] = ray.direction;
        let (ix, iy, iz) = (S::ONE / dx, S::ONE / dy, S::ONE / dz);
        let (near, far) = (S::ONE - padding, S::ONE + padding);
        // Written out: `array::map` is not inlined in builds of several codegen units.
        Self {
            origin: ray.origin,
            inv_near: [ix * near, iy * near, iz * near],
            inv_far: [ix * far, iy * far, iz * far],
            negative: [dx.has_minus_sign(), dy.has_minus_sign(), dz.has_minus_sign()],
            t_min: ray.t_min,
        }
    }

    /// Returns the t at which the ray enters and leaves the slab of an axis.
    ///
    /// The slab is between the planes `min` and `max`. The answer holds for any ray.
    #[inline(always)]
    pub fn slab(&self, axis: usize, [min, max]: [S; 2]) -> [S; 2] {
        let negative = self.negative[axis];
        let (first, last) = if negative { (max, min) } else { (min, max) };
        let at = |plane: S, ahead: S, behind: S| {
            let distance = plane - self.origin[axis];
            let is_behind = self.t_min < S::ZERO && (distance < S::ZERO) != negative;
            distance * if is_behind { behind } else { ahead }
        };
        let (inv_near, inv_far) = (self.inv_near[axis], self.inv_far[axis]);
        [at(first, inv_near, inv_far), at(last, inv_far, inv_near)]
    }

    /// Returns the t at which the ray enters the box.
    ///
    /// Returns `None` if the ray misses the box, or leaves it before `t_min`. Apart from that, the
    /// interval of the ray is ignored.
    #[inline(always)]
    pub fn entry(&self, aabb: &Aabb<S>) -> Option<S> {
        let (near, far) = if self.t_min < S::ZERO {
            // A copy: a reference would keep the slabs out of registers on every other path.
            let copy = *self;
            copy.interval_behind(aabb)
        } else {
            let (mut near, mut far) = (S::NEG_INFINITY, S::INFINITY);
            for axis in 0..3 {
                let (low, high) = (aabb.min[axis], aabb.max[axis]);
                let (first, last) = if self.negative[axis] { (high, low) } else { (low, high) };
                near = max((first - self.origin[axis]) * self.inv_near[axis], near);
                far = min((last - self.origin[axis]) * self.inv_far[axis], far);
            }
            (near, far)
        };
        (near <= far && far >= self.t_min).then_some(near)
    }

    /// Returns the interval of t inside the box, for a ray with a negative `t_min`.
    #[cold]
    #[inline(never)]
    fn interval_behind(&self, aabb: &Aabb<S>) -> (S, S) {
        let (mut near, mut far) = (S::NEG_INFINITY, S::INFINITY);
        for axis in 0..3 {
            let [enters, leaves] = self.slab(axis, [aabb.min[axis], aabb.max[axis]]);
            near = max(enters, near);
            far = min(leaves, far);
        }
        (near, far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(ray: Ray<f32>, min: [f32; 3], max: [f32; 3]) -> Option<f32> {
        Slabs::new(&ray).entry(&Aabb { min, max })
    }

    #[test]
    fn enters_at_the_near_plane_within_the_padding() {
        let t = entry(Ray::new([-3.0, 0.5, 0.5], [1.0, 0.0, 0.0]), [0.0; 3], [1.0; 3]).unwrap();
        assert!(t <= 3.0 && t > 3.0 - 1e-5, "{t}");
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_meets_the_box_with_either_zero() {
        for zero in [0.0, -0.0] {
            for y in [0.0, 1.0] {
                let ray = Ray::new([-3.0, y, 0.5], [1.0, zero, zero]);
                assert!(entry(ray, [0.0; 3], [1.0; 3]).is_some(), "{zero:?} {y}");
            }
            let ray = Ray::new([-3.0, 1.0001, 0.5], [1.0, zero, zero]);
            assert!(entry(ray, [0.0; 3], [1.0; 3]).is_none());
        }
    }

    #[test]
    fn the_padding_widens_behind_the_origin_too() {
        let ray = Ray::new([0.3, 0.3, 5.0], [0.1, 0.0, 1.0]).with_interval(-10.0, 10.0);
        let t = entry(ray, [-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]).unwrap();
        assert!(t <= -5.0 && t > -5.0 - 1e-5, "{t}");
    }

    #[test]
    fn a_box_behind_t_min_is_missed_and_one_that_touches_it_is_met() {
        let ray = Ray::new([0.5f32; 3], [1.0, 0.0, 0.0]);
        assert!(entry(ray.with_interval(0.5, 9.0), [0.0; 3], [1.0; 3]).is_some());
        assert!(entry(ray.with_interval(0.6, 9.0), [0.0; 3], [1.0; 3]).is_none());
    }
}
