//! The watertight ray test, and the box that goes with it.

use super::Barycentrics;
use crate::geometry::{Aabb, Scalar, Shear, Vector, max, min};

/// The ray-triangle test of Woop, Benthin and Wald (Watertight Ray/Triangle Intersection, JCGT 2013), for
/// the corners in the ray's frame: seen along the ray, the triangle holds the ray's point if that is on
/// the same side of all three edges.
///
/// # Why no ray slips through
///
/// 1. A corner's place in the frame is rounded, but alike for all triangles that share the corner: what
///    the ray looks at is some closed mesh of flat triangles, a little off the given one.
/// 2. The side of an edge is the sign of a difference of two products. Rounding is monotone: the sign of
///    the rounded difference is that of the exact one, or zero. With zero counted as inside, every
///    triangle of the mesh of 1 that holds the point is hit; and in a closed mesh around the ray's
///    origin one that has an area does, since those without add nothing to what the others cover.
/// 3. Its own box is met (see [`bounds`]), so the tree and the naive loop both accept it.
///
/// Where a difference is zero, or the area is too large or small for products of three lengths, all is
/// computed once more in the wide scalar, as in the paper: in f64 products of two f32 are exact, and those of
/// three in range. Both sides are hit.
#[inline(always)]
pub(super) fn watertight<S: Scalar>(corners: [[S; 3]; 3], shear: &Shear<S>) -> Option<(S, Barycentrics<S>)> {
    let [x, y, z] = shear.apply(corners);
    let weights = x.cross(y);
    let [a, b, c] = weights.to_array();
    if is_outside([a, b, c]) {
        return None;
    }
    let area = a + b + c;
    let is_settled = a != S::ZERO && b != S::ZERO && c != S::ZERO && is_ordinary(area);
    let (depth, at) = if is_settled {
        (weights.dot(z) / area, Barycentrics { u: b / area, v: c / area })
    } else {
        settle(x.to_array(), y.to_array(), z.to_array())?
    };
    Some((shear.t(depth), at))
}

/// On different sides of two edges. A NaN may hide a side, but does not make one up.
#[inline(always)]
pub(super) fn is_outside<S: Scalar>([a, b, c]: [S; 3]) -> bool {
    min(min(a, b), c) < S::ZERO && max(max(a, b), c) > S::ZERO
}

/// Neither so large nor so small that its product with a length may leave the range.
#[inline(always)]
fn is_ordinary<S: Scalar>(area: S) -> bool {
    let area = area.abs();
    area > S::ONE / S::LARGE_AREA && area < S::LARGE_AREA
}

/// The depth and the weights at the origin of the plane, computed in the wide scalar; none if that is
/// outside, or if the triangle, seen from there, has no area.
#[cold]
#[inline(never)]
fn settle<S: Scalar>(x: [S; 3], y: [S; 3], z: [S; 3]) -> Option<(S, Barycentrics<S>)> {
    let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = [x, y, z].map(|lanes| lanes.map(S::widen));
    let [a, b, c] = [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx];
    let area = a + b + c;
    let is_hit = !is_outside([a, b, c]) && area != S::Wide::ZERO && area.is_finite();
    is_hit.then(|| {
        let depth = (a * az + b * bz + c * cz) / area;
        (S::narrow(depth), Barycentrics { u: S::narrow(b / area), v: S::narrow(c / area) })
    })
}

/// The box of a triangle, larger than its corners' by 4 epsilon of its largest extent and one rounding
/// of the coordinate: what the rounded triangle of [`watertight`] may reach out of it.
///
/// Let u be half an epsilon, s the largest extent, h the point on the ray (relative to its origin) that the test
/// calls hit. Along an axis x that is not the ray's largest, a corner A has its place x dz - z dx rounded by up to
/// 2 u |A.x dz| + 2 u |A.z dx| + u |x dz - z dx|: in units of length, since |A.x| <= |h.x| + s, and the same of
/// A.z dx / dz, by no more than 4 u |h.x| + 6 u s. The second part is less than 4 epsilon s, the first is covered by the
/// padding of the slab test (see `Slabs`): so the ray meets the box. Underflow aside: the least coordinates
/// that count must be some 2^24 times the smallest normal number.
#[inline(always)]
pub(super) fn bounds<S: Scalar>(corners: [[S; 3]; 3]) -> Aabb<S> {
    let exact = Aabb::of_points(corners);
    let two = S::ONE + S::ONE;
    let [x, y, z] = exact.extent();
    let margin = max(max(x, y), z) * (two * two * S::EPSILON);
    let mut padded = exact;
    for axis in 0..3 {
        let outward = |x: S| margin + S::EPSILON * x.abs();
        padded.min[axis] = exact.min[axis] - outward(exact.min[axis]);
        padded.max[axis] = exact.max[axis] + outward(exact.max[axis]);
    }
    // Corners at the end of the range are valid; their margin is beyond it, and so are extents.
    if padded.is_valid() { padded } else { exact }
}
