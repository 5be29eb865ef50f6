//! The triangle, and the ray test shared with the mesh.

mod mesh;
mod modes;
mod moller_trumbore;
mod watertight;

pub use mesh::{MeshError, MeshTriangle, TriangleMesh};
pub use modes::{Fast, Precise, Watertight};

use super::{Intersect, Primitive};
use crate::geometry::{Aabb, PreparedRay, Scalar};

/// Three corners.
pub trait Corners {
    /// The scalar.
    type Scalar: Scalar;
    /// The corners.
    fn corners(&self) -> [[Self::Scalar; 3]; 3];
}

impl<P: Corners + ?Sized> Corners for &P {
    type Scalar = P::Scalar;
    #[inline(always)]
    fn corners(&self) -> [[P::Scalar; 3]; 3] {
        (**self).corners()
    }
}

impl<S: Scalar> Corners for Triangle<S> {
    type Scalar = S;
    #[inline(always)]
    fn corners(&self) -> [[S; 3]; 3] {
        [self.a, self.b, self.c]
    }
}

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
        Watertight(self).aabb()
    }
}

impl<S: Scalar> Intersect for Triangle<S> {
    type Payload = Barycentrics<S>;

    #[inline(always)]
    fn intersect(&self, ray: &PreparedRay<S>) -> Option<(S, Barycentrics<S>)> {
        Watertight(self).intersect(ray)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    const UNIT: Triangle = Triangle { a: [0.0, 0.0, 0.0], b: [1.0, 0.0, 0.0], c: [0.0, 1.0, 0.0] };

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 2.0], [0.0, 0.0, -1.0])
    }

    #[test]
    fn edges_and_corners_are_inside_and_both_sides_are_hit() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.25, 0.25)] {
            let (t, hit) = UNIT.intersect(&down(x, y).prepare()).unwrap();
            assert_eq!((t, hit.u, hit.v), (2.0, x, y));
            let up = Ray::new([x, y, -3.0], [0.0, 0.0, 1.0]);
            assert_eq!(UNIT.intersect(&up.prepare()).unwrap().0, 3.0);
        }
        for (x, y) in [(-0.001, 0.5), (0.5, -0.001), (0.501, 0.5)] {
            assert!(UNIT.intersect(&down(x, y).prepare()).is_none());
        }
    }

    #[test]
    fn the_interval_is_closed() {
        let ray = down(0.25, 0.25);
        assert!(UNIT.intersect(&ray.with_interval(2.0, 2.0).prepare()).is_some());
        assert!(UNIT.intersect(&ray.with_interval(2.0f32.next_up(), 9.0).prepare()).is_none());
        assert!(UNIT.intersect(&ray.with_interval(0.0, 2.0f32.next_down()).prepare()).is_none());
    }

    #[test]
    fn a_coplanar_ray_and_a_triangle_without_area_miss() {
        assert!(UNIT.intersect(&Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]).prepare()).is_none());
        let needle = Triangle::new([0.0f32; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
        assert!(needle.intersect(&down(0.5, 0.0).prepare()).is_none());
    }

    #[test]
    fn a_determinant_that_overflows_is_a_miss() {
        let large = Triangle::new([-1e10f32, -1e10, -1e10], [1e10, -1e10, 1e10], [0.0, 1e10, 0.0]);
        for (origin, length) in [([3e9, 0.0, 5e9], 1e18), ([9e9, 0.0, -5e9], 1e18), ([3e9, 0.0, -5e9], 2e18)]
        {
            assert_eq!(large.intersect(&Ray::new(origin, [0.0, 0.0, length]).prepare()), None, "{origin:?}");
        }
    }

    #[test]
    fn size_alone_rejects_nothing() {
        for scale in [1e-12f32, 1e12] {
            let scaled = Triangle::new(UNIT.a, UNIT.b.map(|x| x * scale), UNIT.c.map(|x| x * scale));
            let ray = Ray::new([0.25 * scale, 0.25 * scale, 2.0 * scale], [0.0, 0.0, -1.0]);
            assert!(scaled.intersect(&ray.prepare()).is_some(), "{scale}");
        }
    }
}
