//! The sphere primitive.

use super::{Intersect, Primitive, SurfacePoint};
use crate::geometry::{Aabb, Ray, Scalar, dot};
use crate::leaf::SphereLeaf;

/// The surface of a sphere. A ray that starts inside hits it on the way out.
///
/// ```
/// use bvhkit::{Bvh, Ray, Sphere};
/// let bvh = Bvh::build([Sphere::new([0.0, 0.0, 0.0], 1.0)])?;
/// let hit = bvh.closest_hit(&Ray::new([0.0, 0.0, -5.0], [0.0, 0.0, 1.0])).unwrap();
/// assert_eq!(hit.t, 4.0);
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<S = f32> {
    /// The center.
    pub center: [S; 3],
    /// The radius, in units of length. A negative radius makes the sphere invalid.
    pub radius: S,
}

impl<S: Scalar> Sphere<S> {
    /// Creates the sphere of `radius` around `center`.
    #[inline(always)]
    pub fn new(center: impl Into<[S; 3]>, radius: S) -> Self {
        Self { center: center.into(), radius }
    }

    /// Returns the point of the sphere nearest to `position`, to start rays from.
    ///
    /// For a hit, `position` is `ray.at(hit.t)`.
    pub fn surface_point(&self, position: impl Into<[S; 3]>) -> SurfacePoint<S> {
        SurfacePoint::of_sphere(self.center, self.radius, position.into())
    }
}

impl<S: Scalar> Primitive for Sphere<S> {
    type Scalar = S;

    /// Returns a box rounded outward, so that it contains the exact sphere.
    #[inline(always)]
    fn aabb(&self) -> Aabb<S> {
        if self.radius < S::ZERO {
            return Aabb::EMPTY;
        }
        let ([x, y, z], r) = (self.center, self.radius);
        Aabb {
            min: [(x - r).next_down(), (y - r).next_down(), (z - r).next_down()],
            max: [(x + r).next_up(), (y + r).next_up(), (z + r).next_up()],
        }
    }
}

impl<S: Scalar> Intersect for Sphere<S> {
    type Payload = ();
    type Leaf = SphereLeaf;

    /// Solves the quadratic equation in a form that avoids cancellation.
    ///
    /// The form is that of Haines, Gunther and Akenine-Moller (Precision Improvements for
    /// Ray/Sphere Intersection, Ray Tracing Gems 2019). The discriminant comes from the distance
    /// between the ray and the center: no cancellation for small, far spheres. The smaller root
    /// comes from the larger one: no cancellation for origins near the surface.
    ///
    /// The test squares lengths. If the square of the direction or of a distance leaves the
    /// scalar's range (1e19 or 1e-19 for `f32`), the ray misses.
    #[inline(always)]
    fn intersect(&self, ray: &Ray<S>) -> Option<(S, ())> {
        let ([dx, dy, dz], [ox, oy, oz], [cx, cy, cz]) = (ray.direction, ray.origin, self.center);
        let (x, y, z) = (ox - cx, oy - cy, oz - cz);
        let a = dot(ray.direction, ray.direction);
        let b = -dot([x, y, z], ray.direction);
        let step = b / a;
        let to_line = [x + dx * step, y + dy * step, z + dz * step];
        let r2 = self.radius * self.radius;
        let discriminant = r2 - dot(to_line, to_line);
        // Squares that left the range, at either end, would give a meaningless t.
        let is_hit = discriminant >= S::ZERO && a.is_normal_number();
        if !is_hit {
            return None;
        }
        // Two square roots: the product may leave the range where neither factor does.
        let root = a.sqrt() * discriminant.sqrt();
        let c = dot([x, y, z], [x, y, z]) - r2;
        let q = if b < S::ZERO { b - root } else { b + root };
        let (t0, t1) = (c / q, q / a);
        let (near, far) = if t0 <= t1 { (t0, t1) } else { (t1, t0) };
        let t = if ray.includes(near) { near } else { far };
        ray.includes(t).then_some((t, ()))
    }

    #[inline(always)]
    fn put_operands(&self, operands: &mut [S]) {
        let [x, y, z] = self.center;
        operands.copy_from_slice(&[x, y, z, self.radius]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_outside_the_near_root_from_inside_the_far_one() {
        let sphere = Sphere::new([1.0f64, 2.0, 3.0], 2.0);
        let ray = Ray::new([1.0, 2.0, -7.0], [0.0, 0.0, 2.0]);
        assert_eq!(sphere.intersect(&ray), Some((4.0, ())));
        assert_eq!(sphere.intersect(&ray.with_interval(4.5, 9.0)), Some((6.0, ())));
        assert_eq!(sphere.intersect(&ray.with_interval(4.5, 5.5)), None);
        assert_eq!(sphere.intersect(&Ray::new([1.0, 2.0, 3.0], [1.0, 0.0, 0.0])), Some((2.0, ())));
        assert_eq!(sphere.intersect(&Ray::new([1.0, 4.5, -7.0], [0.0, 0.0, 1.0])), None);
    }

    #[test]
    fn long_directions_and_large_radii_give_the_right_t_or_none() {
        let sphere = Sphere::new([0.0f32; 3], 1e10);
        let t = |origin, direction| sphere.intersect(&Ray::new(origin, direction)).map(|(t, ())| t);
        assert!((t([9e9, 0.0, -3e10], [0.0, 0.0, 1e10]).unwrap() - 2.5641).abs() < 1e-4);
        assert!((t([5e9, 0.0, 0.0], [1e10, 0.0, 0.0]).unwrap() - 0.5).abs() < 1e-5);
        assert_eq!(t([9e9, 0.0, 9e9], [0.0, 0.0, 1e10]), None);
        for length in [2e19, 1e-23] {
            assert_eq!(t([0.0; 3], [length, 0.0, 0.0]), None, "{length}");
        }
    }

    #[test]
    fn a_small_sphere_far_away_is_found_at_its_surface() {
        let sphere = Sphere::new([0.0f32, 0.0, 1e6], 1.0);
        let (t, ()) = sphere.intersect(&Ray::new([0.5, 0.0, 0.0], [0.0, 0.0, 1.0])).unwrap();
        assert!((t - 1e6).abs() <= 1.0, "{t}");
    }

    #[test]
    fn a_negative_radius_is_an_invalid_box() {
        assert!(!Sphere::new([0.0f32; 3], -1.0).aabb().is_valid());
        assert!(Sphere::new([0.0f32; 3], 0.0).aabb().is_valid());
    }
}
