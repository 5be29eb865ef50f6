//! How far beside a triangle a ray passes.

use bvhkit::{Ray, Triangle};
use glam::DVec3;

/// The distance between the ray's line and the triangle's nearest edge, in roundings of `f32` (2^-24) of the
/// distance to its farthest corner. In `f64`: good to a millionth of that.
pub fn roundings(triangle: &Triangle, ray: &Ray) -> f64 {
    let wide = |point: [f32; 3]| DVec3::from(point.map(f64::from));
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| wide(corner) - wide(ray.origin));
    let along = wide(ray.direction).normalize();
    // As seen along the ray.
    let [a, b, c] = corners.map(|corner| corner.reject_from_normalized(along));
    let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
        let edge = q - p;
        // NaN, for an edge of no length, is lost here.
        let nearest = (-p.dot(edge) / edge.length_squared()).clamp(0.0, 1.0).max(0.0);
        (p + nearest * edge).length()
    });
    let farthest = corners.map(DVec3::length).into_iter().fold(0.0, f64::max);
    edges.into_iter().fold(f64::INFINITY, f64::min) / (farthest * f64::from(f32::EPSILON) / 2.0)
}
