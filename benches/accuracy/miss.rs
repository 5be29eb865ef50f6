//! The distance by which a ray misses a triangle.

use bvhkit::{Ray, Triangle};
use glam::DVec3;

/// Returns the distance between the ray's line and the triangle's nearest edge.
///
/// The unit is 2^-24 times the distance from the origin to the farthest corner. The result is
/// computed in `f64` and is good to a millionth of that unit.
pub fn roundings(triangle: &Triangle, ray: &Ray) -> f64 {
    let wide = |point: [f32; 3]| DVec3::from(point.map(f64::from));
    let corners = [triangle.a, triangle.b, triangle.c].map(|corner| wide(corner) - wide(ray.origin));
    let along = wide(ray.direction).normalize();
    // The corners, projected along the ray.
    let [a, b, c] = corners.map(|corner| corner.reject_from_normalized(along));
    let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
        let edge = q - p;
        // `max` drops the NaN of an edge of no length.
        let nearest = (-p.dot(edge) / edge.length_squared()).clamp(0.0, 1.0).max(0.0);
        (p + nearest * edge).length()
    });
    let farthest = corners.map(DVec3::length).into_iter().fold(0.0, f64::max);
    edges.into_iter().fold(f64::INFINITY, f64::min) / (farthest * f64::from(f32::EPSILON) / 2.0)
}
