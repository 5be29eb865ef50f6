//! The triangle, and the ray test shared with the mesh.

use super::{Intersect, Primitive};
use crate::geometry::{Aabb, Ray, Scalar, Vector};

/// A triangle that owns its three corners. Both sides are hit.
///
/// The ray test is that of Moller and Trumbore (Fast, Minimum Storage Ray/Triangle Intersection, 1997)
/// without its epsilon, its products grouped around the normal: a triangle without area is never hit.
/// Edges and corners count as inside as far as rounded arithmetic sees them; a ray at an edge that two
/// triangles share may slip between them. Products of three lengths are computed: with directions
/// of length 1, f32 is good for triangles and distances from about 1e-13 to 1e12, f64 from 1e-100 to
/// 1e100. Beyond, t loses precision and hits are lost, in the tree and in the naive loop alike.
///
/// ```
/// use bvhkit::{Bvh, Ray, Triangle};
/// let floor = Triangle::new([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
/// let bvh = Bvh::build([floor])?;
/// let hit = bvh.closest_hit(&Ray::new([1.0, 3.0, 2.0], [0.0, -1.0, 0.0])).unwrap();
/// assert_eq!((hit.t, hit.payload.u, hit.payload.v), (3.0, 0.25, 0.5));
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<S = f32> {
    /// The corner where u = v = 0.
    pub a: [S; 3],
    /// The corner where u = 1.
    pub b: [S; 3],
    /// The corner where v = 1.
    pub c: [S; 3],
}

/// Where on a triangle a hit is: the point (1 - u - v) a + u b + v c, with u, v and 1 - u - v
/// in [0, 1] up to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barycentrics<S = f32> {
    /// The weight of corner b.
    pub u: S,
    /// The weight of corner c.
    pub v: S,
}

impl<S: Scalar> Triangle<S> {
    /// The triangle with corners `a`, `b`, `c`.
    #[inline(always)]
    pub fn new(a: impl Into<[S; 3]>, b: impl Into<[S; 3]>, c: impl Into<[S; 3]>) -> Self {
        Self { a: a.into(), b: b.into(), c: c.into() }
    }
}

impl<S: Scalar> Primitive for Triangle<S> {
    type Scalar = S;

    #[inline(always)]
    fn aabb(&self) -> Aabb<S> {
        Aabb::of_points([self.a, self.b, self.c])
    }
}

impl<S: Scalar> Intersect for Triangle<S> {
    type Payload = Barycentrics<S>;

    #[inline(always)]
    fn intersect(&self, ray: &Ray<S>) -> Option<(S, Barycentrics<S>)> {
        moller_trumbore(self.a, self.b, self.c, ray)
    }
}

/// The ray-triangle test of Moller and Trumbore (1997): Cramer's rule for
/// `origin + t direction = a + u edge1 + v edge2`.
///
/// Departures: the three products are grouped around the triangle's normal and `(a - origin) x
/// direction`, as Embree does, so that a triangle without area, whose normal is zero, never hits,
/// and fewer rays slip through edges. No absolute epsilon rejects small triangles, only a
/// determinant of exactly zero (the ray in the triangle's plane, or no area) misses; comparisons are
/// made against |det|, so that divisions are made only for a hit. Edges and corners count as
/// inside, as far as the rounded arithmetic sees them: a ray at an edge that two triangles share may
/// miss both. An intermediate that overflows makes a NaN or an infinity, which misses.
#[inline(always)]
pub(super) fn moller_trumbore<S: Scalar>(
    a: [S; 3],
    b: [S; 3],
    c: [S; 3],
    ray: &Ray<S>,
) -> Option<(S, Barycentrics<S>)> {
    let a = S::Vec3::from_array(a);
    let edge1 = S::Vec3::from_array(b) - a;
    let edge2 = S::Vec3::from_array(c) - a;
    let direction = S::Vec3::from_array(ray.direction);
    let to_a = a - S::Vec3::from_array(ray.origin);
    let normal = edge1.cross(edge2);
    let r = to_a.cross(direction);
    let signed_det = normal.dot(direction);
    let det = signed_det.abs();
    // u, v and t are det times what they will be.
    let u = edge2.dot(r).turned_by(signed_det);
    let v = -edge1.dot(r).turned_by(signed_det);
    // Each false for NaN; u = v = 0 does not get a det that vanished or overflowed past the last.
    let inside = u >= S::ZERO && v >= S::ZERO && u + v <= det && det > S::ZERO && det < S::INFINITY;
    if !inside {
        return None;
    }
    let t = to_a.dot(normal).turned_by(signed_det) / det;
    (t >= ray.t_min && t <= ray.t_max).then(|| (t, Barycentrics { u: u / det, v: v / det }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Triangle = Triangle { a: [0.0, 0.0, 0.0], b: [1.0, 0.0, 0.0], c: [0.0, 1.0, 0.0] };

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 2.0], [0.0, 0.0, -1.0])
    }

    #[test]
    fn edges_and_corners_are_inside_and_both_sides_are_hit() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.25, 0.25)] {
            let (t, hit) = UNIT.intersect(&down(x, y)).unwrap();
            assert_eq!((t, hit.u, hit.v), (2.0, x, y));
            let up = Ray::new([x, y, -3.0], [0.0, 0.0, 1.0]);
            assert_eq!(UNIT.intersect(&up).unwrap().0, 3.0);
        }
        for (x, y) in [(-0.001, 0.5), (0.5, -0.001), (0.501, 0.5)] {
            assert!(UNIT.intersect(&down(x, y)).is_none());
        }
    }

    #[test]
    fn the_interval_is_closed() {
        let ray = down(0.25, 0.25);
        assert!(UNIT.intersect(&ray.with_interval(2.0, 2.0)).is_some());
        assert!(UNIT.intersect(&ray.with_interval(2.0f32.next_up(), 9.0)).is_none());
        assert!(UNIT.intersect(&ray.with_interval(0.0, 2.0f32.next_down())).is_none());
    }

    #[test]
    fn a_coplanar_ray_and_a_triangle_without_area_miss() {
        assert!(UNIT.intersect(&Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0])).is_none());
        let needle = Triangle::new([0.0f32; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
        assert!(needle.intersect(&down(0.5, 0.0)).is_none());
    }

    #[test]
    fn a_determinant_that_overflows_is_a_miss() {
        let large = Triangle::new([-1e10f32, -1e10, -1e10], [1e10, -1e10, 1e10], [0.0, 1e10, 0.0]);
        for (origin, length) in [([3e9, 0.0, 5e9], 1e18), ([9e9, 0.0, -5e9], 1e18), ([3e9, 0.0, -5e9], 2e18)]
        {
            assert_eq!(large.intersect(&Ray::new(origin, [0.0, 0.0, length])), None, "{origin:?}");
        }
    }

    #[test]
    fn size_alone_rejects_nothing() {
        for scale in [1e-12f32, 1e12] {
            let scaled = Triangle::new(UNIT.a, UNIT.b.map(|x| x * scale), UNIT.c.map(|x| x * scale));
            let ray = Ray::new([0.25 * scale, 0.25 * scale, 2.0 * scale], [0.0, 0.0, -1.0]);
            assert!(scaled.intersect(&ray).is_some(), "{scale}");
        }
    }
}
