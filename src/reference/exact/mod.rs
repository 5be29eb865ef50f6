//! The exact oracle: the hits of a ray in exact arithmetic.
//!
//! It is for tests of any ray-triangle test or tree. The naive loop tells whether a tree misses a
//! hit; this module tells whether an answer is true. Coordinates are taken as the exact numbers
//! that they are, of any size, and nothing is rounded:
//!
//! - edges and corners are inside;
//! - a ray in the triangle's plane misses, and every ray misses a triangle without area;
//! - t is in the closed interval [`t_min`, `t_max`], whose ends may be infinite;
//! - an invalid ray (see [`Ray::validate`]) hits nothing, and a triangle with a corner that is NaN
//!   or infinite is not hit.
//!
//! # Examples
//!
//! ```
//! use bvhkit::{Bvh, Ray, Triangle, reference::exact};
//!
//! // Two halves of a square, and a ray at the edge that they share.
//! let (p, q) = ([1.0, 0.0, 0.1], [0.0, 1.0, 0.7]);
//! let square = [Triangle::new([0.0, 0.0, 0.3], p, q), Triangle::new([1.0, 1.0, 0.4], p, q)];
//! let ray = Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]);
//!
//! let nearest = exact::closest_hits(&square, &ray);
//! assert_eq!(nearest.len(), 2); // both, at the same t
//! assert_eq!(nearest[0].t, nearest[1].t);
//!
//! if let Some(hit) = Bvh::build(&square)?.closest_hit(&ray) {
//!     assert!(nearest.iter().any(|exact| exact.index == hit.index));
//!     assert!(nearest[0].t.ulps_from(hit.t).abs() < 4.0);
//! }
//! # Ok::<(), bvhkit::BuildError>(())
//! ```
//!
//! # Method
//!
//! Let a, b, c be the corners relative to the origin, and d the direction. The signs of
//!
//! ```text
//! U = d . (c x b)    V = d . (a x c)    W = d . (b x a)
//! ```
//!
//! tell on which sides of the edges the ray's line passes. The line meets the triangle where no two
//! of them have opposite signs and U + V + W is not zero. That sum is -n . d, where n is the
//! normal. There t = a . (c x b) / (U + V + W). These are the scaled barycentrics of Woop, Benthin
//! and Wald (Watertight Ray/Triangle Intersection, JCGT 2013) before their shear.
//!
//! As in Shewchuk (Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates, 1997), a filter in plain `f64` comes first, and the cases that its error bound
//! leaves open are computed exactly. Here this is done in integers, since an exponent range as wide
//! as that of `f64` would overflow Shewchuk's expansions.

mod filter;
mod fraction;
mod integers;
mod primitive;
mod rounding;
mod volumes;

pub use fraction::Fraction;
pub use primitive::Exact;

use crate::geometry::{Ray, Scalar};
use crate::primitive::Triangle;
use alloc::vec::Vec;
use volumes::Volumes;

/// An exact hit, ordered by t, equal ones by index.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ExactHit {
    /// The t of the hit, in lengths of the ray's direction.
    pub t: Fraction,
    /// The triangle's index in the input.
    pub index: usize,
}

/// Returns the exact t at which the ray meets the triangle; `None` for a miss.
///
/// A t outside of the ray's interval is a miss.
///
/// # Examples
///
/// ```
/// use bvhkit::{Ray, Triangle, reference::exact};
/// let triangle = Triangle::new([0.0f32, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 3.0, 1.0]);
/// let ray = Ray::new([0.0, 0.0, 0.0], [1.0, 1.0, 3.0]);
/// let t = exact::intersect(&triangle, &ray).unwrap();
/// assert_eq!(t.to_string(), "1/3");
/// assert_eq!(t.to_scalar::<f32>(), 1.0 / 3.0);
/// // The nearest number to a third is a little larger, and an interval that starts there too late.
/// assert!(exact::intersect(&triangle, &ray.with_interval(1.0 / 3.0, 1.0)).is_none());
/// ```
pub fn intersect<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> Option<Fraction> {
    if !ray.is_valid() || filter::surely_misses(triangle, ray) {
        return None;
    }
    let volumes = Volumes::exact(triangle, ray)?;
    let t = volumes.t().filter(|_| volumes.are_of_one_sign())?;
    (t.cmp_scalar(ray.t_min).is_ge() && t.cmp_scalar(ray.t_max).is_le()).then_some(t)
}

/// Returns all hits in the ray's interval, by exact t, equal ones by index.
pub fn hits<S: Scalar>(triangles: &[Triangle<S>], ray: &Ray<S>) -> Vec<ExactHit> {
    let mut hits: Vec<_> = all(triangles, ray).collect();
    hits.sort();
    hits
}

/// Returns all triangles with the exactly smallest t, by index; empty for a miss.
///
/// Only hits in the ray's interval count. If two triangles share an edge, a ray through that edge
/// hits both at one t, and a rounded test may answer with either.
pub fn closest_hits<S: Scalar>(triangles: &[Triangle<S>], ray: &Ray<S>) -> Vec<ExactHit> {
    let mut closest: Vec<ExactHit> = Vec::new();
    for hit in all(triangles, ray) {
        if let Some(best) = closest.first() {
            if hit.t > best.t {
                continue;
            }
            if hit.t < best.t {
                closest.clear();
            }
        }
        closest.push(hit);
    }
    closest
}

/// Whether anything is hit in the ray's interval; stops at the first hit.
pub fn any_hit<S: Scalar>(triangles: &[Triangle<S>], ray: &Ray<S>) -> bool {
    all(triangles, ray).next().is_some()
}

/// Returns how far outside of the triangle the ray's line passes, as a part of it.
///
/// It is at most 0 for a line that meets the triangle, and -1/3 for one through its middle. The
/// ray's interval does not matter.
///
/// The result is the exact -min(U, V, W) / |U + V + W|, with signs turned so that the sum is
/// positive, rounded to the nearest `f64`. This is the largest of the negated barycentric
/// coordinates of the point where the line meets the plane. If a rounded test reports a hit at
/// 1e-7, the point is outside by that part of the triangle's height over the nearest edge.
///
/// Returns `None` if the line is parallel to the plane, if the triangle has no area or a corner
/// that is not finite, or if the ray is invalid.
///
/// # Examples
///
/// ```
/// use bvhkit::{Ray, Triangle, reference::exact};
/// let triangle = Triangle::new([0.0f32, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]);
/// let slack = |x| exact::edge_slack(&triangle, &Ray::new([x, 1.0, 0.0], [0.0, 0.0, 1.0]));
/// assert_eq!([slack(-1.0), slack(0.0), slack(1.0)], [Some(0.25), Some(0.0), Some(-0.25)]);
/// ```
pub fn edge_slack<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> Option<f64> {
    if !ray.is_valid() {
        return None;
    }
    Some(Volumes::exact(triangle, ray)?.slack()?.to_f64())
}

/// Returns the hits in the order of the input.
fn all<S: Scalar>(triangles: &[Triangle<S>], ray: &Ray<S>) -> impl Iterator<Item = ExactHit> {
    let hit = |(index, triangle)| Some(ExactHit { t: intersect(triangle, ray)?, index });
    triangles.iter().enumerate().filter_map(hit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const UNIT: Triangle = Triangle { a: [0.0, 0.0, 0.0], b: [1.0, 0.0, 0.0], c: [0.0, 1.0, 0.0] };

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 2.0], [0.0, 0.0, -1.0])
    }

    #[test]
    fn edges_and_corners_are_inside_and_what_is_next_to_them_is_not() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.25, 0.25)] {
            assert_eq!(intersect(&UNIT, &down(x, y)).unwrap().to_f64(), 2.0);
        }
        for (x, y) in [(-1e-45, 0.5), (0.5, -1e-45), (0.5, 0.5f32.next_up()), (1.0, 1e-45)] {
            assert_eq!(intersect(&UNIT, &down(x, y)), None, "{x}, {y}");
            assert!(edge_slack(&UNIT, &down(x, y)).unwrap() > 0.0);
        }
    }

    #[test]
    fn a_coplanar_ray_and_a_triangle_without_area_miss() {
        let flat = Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]);
        let needle = Triangle::new([0.0f32; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
        for (triangle, ray) in [(&UNIT, &flat), (&needle, &down(0.5, 0.0))] {
            assert_eq!((intersect(triangle, ray), edge_slack(triangle, ray)), (None, None));
        }
    }

    #[test]
    fn what_is_not_finite_is_not_hit() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for corner in 0..9 {
                let mut corners = [UNIT.a, UNIT.b, UNIT.c];
                corners[corner / 3][corner % 3] = bad;
                let [a, b, c] = corners;
                assert_eq!(intersect(&Triangle { a, b, c }, &down(0.25, 0.25)), None);
                assert_eq!(edge_slack(&Triangle { a, b, c }, &down(0.25, 0.25)), None);
            }
        }
        let ray = down(0.25, 0.25);
        for invalid in [
            down(f32::NAN, 0.25),
            Ray { direction: [0.0, f32::INFINITY, -1.0], ..ray },
            Ray { direction: [f32::NAN, 0.0, -1.0], ..ray },
            Ray { direction: [0.0, -0.0, 0.0], ..ray },
            ray.with_interval(3.0, 1.0),
            ray.with_interval(f32::NAN, 3.0),
            ray.with_interval(1.0, f32::NAN),
        ] {
            assert_eq!(
                (intersect(&UNIT, &invalid), edge_slack(&UNIT, &invalid)),
                (None, None),
                "{invalid:?}"
            );
        }
    }

    #[test]
    fn infinite_ends_hold_every_t_and_are_none() {
        let ray = down(0.25, 0.25);
        assert!(intersect(&UNIT, &ray.with_interval(f32::NEG_INFINITY, f32::INFINITY)).is_some());
        assert!(intersect(&UNIT, &ray.with_interval(f32::INFINITY, f32::INFINITY)).is_none());
        assert!(intersect(&UNIT, &ray.with_interval(f32::NEG_INFINITY, f32::NEG_INFINITY)).is_none());
    }

    #[test]
    fn hits_come_by_t_then_index() {
        let at = |z| Triangle::new([0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]);
        let scene = [at(-1.0), at(1.0), at(0.0), at(1.0), at(3.0)];
        let indices = |hits: Vec<ExactHit>| hits.iter().map(|hit| hit.index).collect::<Vec<_>>();
        assert_eq!(indices(hits(&scene, &down(0.25, 0.25))), vec![1, 3, 2, 0]);
        assert_eq!(indices(closest_hits(&scene, &down(0.25, 0.25))), vec![1, 3]);
        assert!(any_hit(&scene, &down(0.25, 0.25)) && !any_hit(&scene, &down(-0.25, 0.25)));
        assert_eq!(closest_hits(&scene, &down(-0.25, 0.25)), vec![]);
    }
}
