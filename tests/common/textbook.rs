//! The ray test of textbooks, as a yardstick.
//!
//! Rays that find no gap in this test are no good at finding gaps.

use bvhkit::{Aabb, Intersect, OneByOne, Primitive, Ray, Triangle};
use glam::Vec3;

/// A triangle with the ray test of Moller and Trumbore, without their epsilon.
///
/// Fast, Minimum Storage Ray/Triangle Intersection, 1997.
#[derive(Clone, Copy)]
pub struct Textbook(pub Triangle);

impl Primitive for Textbook {
    type Scalar = f32;

    fn aabb(&self) -> Aabb {
        Aabb::of_points([self.0.a, self.0.b, self.0.c])
    }
}

impl Intersect for Textbook {
    type Payload = ();
    type Leaf = OneByOne;

    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        let [a, b, c] = [self.0.a, self.0.b, self.0.c].map(Vec3::from);
        let [origin, direction] = [ray.origin, ray.direction].map(Vec3::from);
        let (edge1, edge2) = (b - a, c - a);
        let p = direction.cross(edge2);
        let det = edge1.dot(p);
        let to_origin = origin - a;
        let q = to_origin.cross(edge1);
        let (u, v) = (to_origin.dot(p) / det, direction.dot(q) / det);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| (edge2.dot(q) / det, ()))
    }
}
