//! The sphere.

use super::{Found, Intersect, Leaf, Operands, Primitive, SurfacePoint};
use crate::geometry::{Aabb, PreparedRay, Scalar, Slabs, Vector};
use crate::simd::Lanes;

/// A sphere's surface: a ray from inside hits it on the way out.
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
    /// The radius, in units of length; one below zero makes the sphere invalid.
    pub radius: S,
}

impl<S: Scalar> Sphere<S> {
    /// The sphere around `center`.
    #[inline(always)]
    pub fn new(center: impl Into<[S; 3]>, radius: S) -> Self {
        Self { center: center.into(), radius }
    }

    /// The point of the sphere nearest to `position`, which is `ray.at(hit.t)`, to start rays from.
    pub fn surface_point(&self, position: impl Into<[S; 3]>) -> SurfacePoint<S> {
        SurfacePoint::of_sphere(self.center, self.radius, position.into())
    }
}

impl<S: Scalar> Primitive for Sphere<S> {
    type Scalar = S;

    /// Rounded outward, so that it contains the exact sphere.
    #[inline(always)]
    fn aabb(&self) -> Aabb<S> {
        if self.radius < S::ZERO {
            return Aabb::EMPTY;
        }
        Aabb {
            min: self.center.map(|x| (x - self.radius).next_down()),
            max: self.center.map(|x| (x + self.radius).next_up()),
        }
    }
}

impl<S: Scalar> Intersect for Sphere<S> {
    type Payload = ();
    type Leaf = SphereLeaf;

    /// The quadratic in the form of Haines, Gunther and Akenine-Moller (Precision Improvements for
    /// Ray/Sphere Intersection, Ray Tracing Gems 2019): the discriminant from the distance between
    /// the ray and the center (no cancellation for small, far spheres), the smaller root from the
    /// larger (none for origins near the surface). Squares of lengths are computed: a direction or a
    /// distance whose square leaves the scalar's range (1e19 or 1e-19 for f32) misses.
    #[inline(always)]
    fn intersect(&self, ray: &PreparedRay<S>) -> Option<(S, ())> {
        let direction = S::Vec3::from_array(ray.direction);
        let to_origin = S::Vec3::from_array(ray.origin) - S::Vec3::from_array(self.center);
        let a = direction.dot(direction);
        let b = -to_origin.dot(direction);
        let to_line = to_origin + direction * (b / a);
        let r2 = self.radius * self.radius;
        let discriminant = r2 - to_line.dot(to_line);
        // Squares that left the range, either way, would give a t that means nothing.
        let is_hit = discriminant >= S::ZERO && a.is_normal_number();
        if !is_hit {
            return None;
        }
        // Two roots: the product may leave the range where neither factor does.
        let root = a.sqrt() * discriminant.sqrt();
        let c = to_origin.dot(to_origin) - r2;
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

/// The leaf of [`Sphere`]s: center and radius of each.
#[derive(Clone, Copy, Debug)]
pub struct SphereLeaf;

impl<S: Scalar> Leaf<S, ()> for SphereLeaf {
    const OPERANDS: usize = 4;
    const SETTLES: bool = true;

    /// The padding of boxes has the other sign behind the origin.
    #[inline(always)]
    fn suits(ray: &PreparedRay<S>) -> bool {
        ray.t_min >= S::ZERO
    }

    #[inline(always)]
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, _: S) -> L::Mask {
        Quadratics::new(operands, ray).is_hit
    }

    #[inline(always)]
    fn test<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, limit: S) -> Found<S, L> {
        let quadratics = Quadratics::new(operands, ray);
        if L::bits(quadratics.is_hit) == 0 {
            return Found::to_be_asked(0, operands);
        }
        quadratics.found(operands, ray, limit)
    }

    #[inline(always)]
    fn payload(_: [S; 3]) -> Option<()> {
        Some(())
    }
}

/// The first half of [`Sphere::intersect`] in lanes, bit for bit.
struct Quadratics<S: Scalar, L: Lanes<S>> {
    /// The ray's origin relative to the center.
    to_origin: [L; 3],
    a: S,
    b: L,
    discriminant: L,
    is_hit: L::Mask,
}

impl<S: Scalar, L: Lanes<S>> Quadratics<S, L> {
    #[inline(always)]
    fn new(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>) -> Self {
        let splat = |x: S| operands.splat(x);
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let a = dx * dx + dy * dy + dz * dz;
        let (x, y, z) =
            (splat(ox) - operands.get(0), splat(oy) - operands.get(1), splat(oz) - operands.get(2));
        let (dx, dy, dz) = (splat(dx), splat(dy), splat(dz));
        let b = splat(-S::ZERO) - (x * dx + y * dy + z * dz);
        let step = b / splat(a);
        let (px, py, pz) = (x + dx * step, y + dy * step, z + dz * step);
        let radius = operands.get(3);
        let discriminant = radius * radius - (px * px + py * py + pz * pz);
        // A radius is no smaller than zero, nor is the product; NaN is no hit.
        let least = if a.is_normal_number() { S::ZERO } else { S::INFINITY };
        Self { to_origin: [x, y, z], a, b, discriminant, is_hit: splat(least).le(discriminant) }
    }

    /// What is hit up to `limit` where the ray's entry into the sphere's box, here without its rounding outward, proves
    /// that t need not be raised; the others are to be asked.
    #[inline(always)]
    fn found(&self, operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, limit: S) -> Found<S, L> {
        let splat = |x: S| operands.splat(x);
        let ([x, y, z], b, radius, zero) = (self.to_origin, self.b, operands.get(3), splat(S::ZERO));
        let root = splat(self.a.sqrt()) * self.discriminant.sqrt();
        let c = (x * x + y * y + z * z) - radius * radius;
        let q = (b - root).where_else(b.lt(zero), b + root);
        let (t0, t1) = (c / q, q / splat(self.a));
        let is_ordered = t0.le(t1);
        let (first, last) = (t0.where_else(is_ordered, t1), t1.where_else(is_ordered, t0));
        let includes = |t: L| splat(ray.t_min).le(t) & t.le(splat(ray.t_max));
        let t = first.where_else(includes(first), last) + zero;
        let limit = if limit < S::MAX { limit } else { S::MAX };
        let in_reach = self.is_hit & includes(t) & t.le(splat(limit));
        let Slabs { inv_near, inv_far, .. } = ray.slabs;
        let [near, far] = {
            let bounds = |axis: usize| {
                let (center, origin) = (operands.get(axis), splat(ray.origin[axis]));
                let (low, high) = ((center - radius) - origin, (center + radius) - origin);
                let (near, far) = (splat(inv_near[axis]), splat(inv_far[axis]));
                [(low * near).min(high * near), (low * far).max(high * far)]
            };
            let ([nx, fx], [ny, fy], [nz, fz]) = (bounds(0), bounds(1), bounds(2));
            [nx.max(ny.max(nz)), fx.min(fy.min(fz))]
        };
        let is_past = near.le(t) & near.le(far) & splat(ray.t_min).le(far);
        let sure = L::bits(in_reach & is_past);
        Found::new(sure, L::bits(in_reach & !is_past), t, [zero; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    #[test]
    fn from_outside_the_near_root_from_inside_the_far_one() {
        let sphere = Sphere::new([1.0f64, 2.0, 3.0], 2.0);
        let ray = Ray::new([1.0, 2.0, -7.0], [0.0, 0.0, 2.0]);
        assert_eq!(sphere.intersect(&ray.prepare()), Some((4.0, ())));
        assert_eq!(sphere.intersect(&ray.with_interval(4.5, 9.0).prepare()), Some((6.0, ())));
        assert_eq!(sphere.intersect(&ray.with_interval(4.5, 5.5).prepare()), None);
        assert_eq!(sphere.intersect(&Ray::new([1.0, 2.0, 3.0], [1.0, 0.0, 0.0]).prepare()), Some((2.0, ())));
        assert_eq!(sphere.intersect(&Ray::new([1.0, 4.5, -7.0], [0.0, 0.0, 1.0]).prepare()), None);
    }

    #[test]
    fn long_directions_and_large_radii_give_the_right_t_or_none() {
        let sphere = Sphere::new([0.0f32; 3], 1e10);
        let t = |origin, direction| sphere.intersect(&Ray::new(origin, direction).prepare()).map(|(t, ())| t);
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
        let (t, ()) = sphere.intersect(&Ray::new([0.5, 0.0, 0.0], [0.0, 0.0, 1.0]).prepare()).unwrap();
        assert!((t - 1e6).abs() <= 1.0, "{t}");
    }

    #[test]
    fn a_negative_radius_is_an_invalid_box() {
        assert!(!Sphere::new([0.0f32; 3], -1.0).aabb().is_valid());
        assert!(Sphere::new([0.0f32; 3], 0.0).aabb().is_valid());
    }
}
