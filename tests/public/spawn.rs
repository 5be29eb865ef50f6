//! Rays that start on a surface do not hit it.

use bvhkit::{
    Barycentrics, Corners, Intersect, Precise, Primitive, Ray, Scalar, Sphere, SurfacePoint, Triangle,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Point = [f64; 3];

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// Random triangles, points on them, and directions away from those points.
///
/// Sizes and distances from the origin are from 1e-3 to 1e3. Some triangles are 10,000 times as
/// long as wide. Directions have any angle to the triangle, down to 1e-5.
struct Cases {
    rng: Pcg64Mcg,
}

impl Cases {
    fn new(seed: u64) -> Self {
        Self { rng: Pcg64Mcg::seed_from_u64(seed) }
    }

    fn point(&mut self, size: f64) -> Point {
        [0; 3].map(|_| self.rng.random_range(-size..size))
    }

    fn size(&mut self) -> f64 {
        10f64.powf(self.rng.random_range(-3.0..3.0))
    }

    fn triangle<S: Scalar>(&mut self) -> (Triangle<S>, Barycentrics<S>) {
        let (size, distance) = (self.size(), self.size());
        let center = self.point(distance);
        let [a, b, c] = [0; 3].map(|_| self.point(size));
        let width = if self.rng.random_range(0..5) == 0 { 1e-4 } else { 1.0 };
        let c = [0, 1, 2].map(|k| b[k] + width * (c[k] - b[k]));
        // A third of the triangles is perpendicular to an axis, half of these at coordinate zero.
        let (axis, flat) = (self.rng.random_range(0..3), self.rng.random_range(0..6));
        let corner = |p: Point| {
            [0, 1, 2].map(|k| match flat {
                0 if k == axis => S::ZERO,
                1 if k == axis => S::from_f64(center[k]),
                _ => S::from_f64(center[k] + p[k]),
            })
        };
        let (u, v): (f64, f64) = (self.rng.random(), self.rng.random());
        // A quarter of the points is on an edge.
        let v = if self.rng.random_range(0..4) == 0 { 0.0 } else { v * (1.0 - u) };
        let at = Barycentrics { u: S::from_f64(u), v: S::from_f64(v) };
        (Triangle::new(corner(a), corner(b), corner(c)), at)
    }

    fn direction<S: Scalar>(&mut self, point: &SurfacePoint<S>) -> [S; 3] {
        let side = if self.rng.random() { 1.0 } else { -1.0 };
        let normal = point.normal.map(|x| side * x.to_f64());
        let any = unit(self.point(1.0));
        let along = dot(any, normal);
        let tangent = unit([0, 1, 2].map(|k| any[k] - along * normal[k]));
        let rise = 10f64.powf(self.rng.random_range(-5.0..1.0));
        unit([0, 1, 2].map(|k| tangent[k] + rise * normal[k])).map(S::from_f64)
    }
}

/// Returns how many of 100,000 rays hit the triangle that they start from.
fn hits_itself<S: Scalar>(seed: u64, intersects: impl Fn(Triangle<S>, &Ray<S>) -> bool) -> usize {
    let mut cases = Cases::new(seed);
    (0..100_000)
        .filter(|_| {
            let (triangle, at) = cases.triangle();
            let point = triangle.surface_point(at);
            let direction = cases.direction(&point);
            intersects(triangle, &point.spawn(direction))
        })
        .count()
}

#[test]
fn a_triangle_is_not_hit_by_rays_that_leave_it() {
    assert_eq!(hits_itself::<f32>(1, |triangle, ray| triangle.intersect(ray).is_some()), 0);
    assert_eq!(hits_itself::<f32>(2, |triangle, ray| Precise(triangle).intersect(ray).is_some()), 0);
    assert_eq!(hits_itself::<f64>(3, |triangle, ray| triangle.intersect(ray).is_some()), 0);
}

/// Without the offset, rays do hit the triangle they leave: the test has power.
#[test]
fn rays_from_the_rounded_point_itself_do_hit() {
    let on_the_spot = |triangle: Triangle, ray: &Ray| {
        let mut point = triangle.surface_point(Barycentrics { u: 0.3, v: 0.3 });
        point.error = [0.0; 3];
        point.normal = [0.0; 3];
        triangle.intersect(&point.spawn(ray.direction)).is_some()
    };
    assert!(hits_itself::<f32>(1, on_the_spot) > 10_000);
}

#[test]
fn the_start_is_close_to_the_hit() {
    let mut cases = Cases::new(4);
    for _ in 0..10_000 {
        let (triangle, at) = cases.triangle::<f32>();
        let point = triangle.surface_point(at);
        let start = point.spawn(cases.direction(&point)).origin;
        for (from, to) in point.position.into_iter().zip(start) {
            // Three roundings on the axis itself, and the share that the
            // normal brings from the other axes.
            let largest = triangle.aabb().max.into_iter().chain(triangle.aabb().min).map(f32::abs);
            let bound = 3.0 * f32::EPSILON * largest.fold(0.0, f32::max);
            assert!((to - from).abs() <= bound, "{point:?} {start:?}");
        }
    }
}

#[test]
fn a_sphere_is_not_hit_by_rays_that_leave_it() {
    fn check<S: Scalar>(seed: u64) {
        let mut cases = Cases::new(seed);
        let mut hits = 0;
        for _ in 0..100_000 {
            let (size, distance) = (cases.size(), cases.size());
            let center = cases.point(distance);
            let sphere = Sphere::new(center.map(S::from_f64), S::from_f64(size));
            let ray = Ray::new(cases.point(distance).map(S::from_f64), cases.point(1.0).map(S::from_f64));
            let Some((t, ())) = sphere.intersect(&ray) else { continue };
            hits += 1;
            let point = sphere.surface_point(ray.at(t));
            let direction = cases.direction(&point);
            let outward = dot(direction.map(S::to_f64), point.normal.map(S::to_f64)) > 0.0;
            let again = sphere.intersect(&point.spawn(direction));
            // A ray into the sphere hits only the far side, at 0.9 of its chord or more.
            let chord = -2.0 * size * dot(direction.map(S::to_f64), point.normal.map(S::to_f64));
            assert!(
                again.is_none_or(|(t, ())| !outward && t.to_f64() > 0.9 * chord),
                "{sphere:?} {point:?} {direction:?}: {again:?}, chord {chord}"
            );
        }
        assert!(hits > 10_000);
    }
    check::<f32>(5);
    check::<f64>(6);
}

#[test]
fn without_a_normal_the_ray_starts_at_the_point() {
    let needle = Triangle::new([1.0f32; 3], [2.0; 3], [3.0; 3]);
    let point = needle.surface_point(Barycentrics { u: 0.5, v: 0.25 });
    assert_eq!((point.position, point.normal), ([2.0; 3], [0.0; 3]));
    assert_eq!(point.spawn([1.0, 0.0, 0.0]).origin, [2.0; 3]);
}
