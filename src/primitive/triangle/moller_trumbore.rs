//! The fast ray test.

use super::Barycentrics;
use crate::geometry::{Ray, Scalar, Vector};

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
    [a, b, c]: [[S; 3]; 3],
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
