//! The watertight ray test.

use super::Barycentrics;
use crate::geometry::{Aabb, Ray, Scalar, Shear, Vector, max, min};

/// The ray-triangle test of Woop, Benthin and Wald (Watertight Ray/Triangle Intersection, JCGT 2013), for
/// the corners in the ray's frame: where the ray is the third axis, a point is inside a triangle if it
/// is on the same side of all three edges.
///
/// The side of an edge is the sign of a difference of two products. Rounding is monotone, so the sign of
/// the rounded difference is that of the exact one or zero, and a triangle that shares the edge finds
/// the same with the sign turned. With zero counted as inside, no ray passes between them.
///
/// Departures: where a difference is zero, or the area has left the range of the scalar, all is computed
/// once more in the wide one, as in the paper, and that settles underflow too: in f64 products of two f32 are
/// exact. Weights are divided by the area before they meet lengths again, so that nothing of the third
/// power of a length is computed. Both sides are hit.
#[inline(always)]
pub(super) fn watertight<S: Scalar>(
    corners: [[S; 3]; 3],
    ray: &Ray<S>,
    shear: &Shear<S>,
) -> Option<(S, Barycentrics<S>)> {
    let [x, y, z] = shear.apply(corners);
    let mut weights = x.cross(y).to_array();
    if is_outside(weights) {
        return None;
    }
    let area = weights[0] + weights[1] + weights[2];
    let settled = weights[0] != S::ZERO && weights[1] != S::ZERO && weights[2] != S::ZERO && area.is_finite();
    if settled {
        weights = weights.map(|weight| weight / area);
    } else {
        weights = settle(x.to_array(), y.to_array())?;
    }
    let [a, b, c] = weights;
    let [az, bz, cz] = z.to_array();
    let t = shear.t(a * az + b * bz + c * cz);
    (t >= ray.t_min && t <= ray.t_max).then_some((t, Barycentrics { u: b, v: c }))
}

/// On different sides of two edges. Not for NaN.
#[inline(always)]
fn is_outside<S: Scalar>([a, b, c]: [S; 3]) -> bool {
    min(min(a, b), c) < S::ZERO && max(max(a, b), c) > S::ZERO
}

/// The corners' weights at the origin of the plane, computed in the wide scalar; none if it is outside, or
/// if the triangle, seen from there, has no area.
#[cold]
#[inline(never)]
fn settle<S: Scalar>(x: [S; 3], y: [S; 3]) -> Option<[S; 3]> {
    let [ax, bx, cx] = x.map(S::widen);
    let [ay, by, cy] = y.map(S::widen);
    let weights = [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx];
    let area = weights[0] + weights[1] + weights[2];
    let is_hit = !is_outside(weights) && area != S::Wide::ZERO && area.is_finite();
    is_hit.then(|| weights.map(|weight| S::narrow(weight / area)))
}

#[inline(always)]
pub(super) fn bounds<S: Scalar>(corners: [[S; 3]; 3]) -> Aabb<S> {
    Aabb::of_points(corners)
}
