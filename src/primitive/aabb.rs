//! The box as a primitive: rays hit its surface.

use super::{Intersect, Primitive};
use crate::geometry::{Aabb, Ray, Scalar, max, min};
use crate::leaf::OneByOne;

impl<S: Scalar> Primitive for Aabb<S> {
    type Scalar = S;

    #[inline(always)]
    fn aabb(&self) -> Aabb<S> {
        *self
    }
}

impl<S: Scalar> Intersect for Aabb<S> {
    type Payload = ();
    type Leaf = OneByOne;

    /// Returns the t of the first hit with the surface in the ray's interval.
    ///
    /// A ray from inside hits the surface on the way out. A ray in the plane of a face hits the
    /// edge of that face.
    #[inline(always)]
    fn intersect(&self, ray: &Ray<S>) -> Option<(S, ())> {
        let (mut near, mut far) = (S::NEG_INFINITY, S::INFINITY);
        for axis in 0..3 {
            let inv = S::ONE / ray.direction[axis];
            let (mut first, mut last) = (self.min[axis], self.max[axis]);
            if inv < S::ZERO {
                (first, last) = (last, first);
            }
            // A plane that is parallel to the ray and contains its origin gives 0 * infinity. This
            // is NaN, which `max` and `min` leave out.
            near = max((first - ray.origin[axis]) * inv, near);
            far = min((last - ray.origin[axis]) * inv, far);
        }
        let t = if ray.includes(near) { near } else { far };
        (near <= far && ray.includes(t)).then_some((t, ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { min: [0.0; 3], max: [1.0; 3] };

    #[test]
    fn from_outside_the_front_from_inside_the_back() {
        let ray = Ray::new([-2.0, 0.5, 0.5], [1.0, 0.0, -0.0]);
        assert_eq!(UNIT.intersect(&ray), Some((2.0, ())));
        assert_eq!(UNIT.intersect(&ray.with_interval(2.5, 9.0)), Some((3.0, ())));
        assert_eq!(UNIT.intersect(&ray.with_interval(3.5, 9.0)), None);
        assert_eq!(UNIT.intersect(&Ray::new([-2.0, 1.5, 0.5], [1.0, 0.0, 0.0])), None);
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_hits() {
        for y in [0.0, 1.0] {
            assert_eq!(UNIT.intersect(&Ray::new([2.0, y, 0.5], [-1.0, 0.0, 0.0])), Some((1.0, ())));
        }
    }
}
