//! Primitives other than triangles, to put in place of a scene's triangles.
//!
//! Each is in the middle of its triangle and as large as the inscribed circle.

use crate::support::rays::Surface;
use bvhkit::{Aabb, Intersect, OneByOne, Primitive, Ray, Sphere, Triangle};
use glam::Vec3;

pub fn spheres(triangles: &[Triangle]) -> Vec<Sphere> {
    circles(triangles).map(|(center, radius, _)| Sphere::new(center, radius)).collect()
}

/// Returns discs with the normals of their triangles.
pub fn discs(triangles: &[Triangle]) -> Vec<Disc> {
    circles(triangles).map(|(center, radius, normal)| Disc { center, radius, normal }).collect()
}

/// Returns centers, radii and normals, except for triangles without area.
fn circles(triangles: &[Triangle]) -> impl Iterator<Item = (Vec3, f32, Vec3)> {
    triangles.iter().filter_map(|triangle| {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::from);
        let radius = (b - a).cross(c - a).length() / (a.distance(b) + b.distance(c) + c.distance(a));
        let center = (a + b + c) / 3.0;
        triangle.normal(center).filter(|_| radius > 0.0).map(|normal| (center, radius, normal))
    })
}

/// A disc, a primitive that is tested one by one.
#[derive(Clone, Copy)]
pub struct Disc {
    center: Vec3,
    radius: f32,
    /// The normal, of length 1.
    normal: Vec3,
}

impl Primitive for Disc {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        let reach = self.radius * (1.0 - self.normal * self.normal).max(Vec3::ZERO).map(f32::sqrt);
        Aabb::new(self.center - reach, self.center + reach)
    }
}

impl Intersect for Disc {
    type Payload = ();
    type Leaf = OneByOne;
    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        let to_center = self.center - Vec3::from(ray.origin);
        let t = self.normal.dot(to_center) / self.normal.dot(ray.direction.into());
        let from_center = self.center.distance_squared(ray.at(t).into());
        (from_center <= self.radius * self.radius).then_some((t, ()))
    }
}

impl Surface for Disc {
    fn normal(&self, _: Vec3) -> Option<Vec3> {
        Some(self.normal)
    }
}

impl Surface for Sphere {
    fn normal(&self, at: Vec3) -> Option<Vec3> {
        (at - Vec3::from(self.center)).try_normalize()
    }
}
