//! The watertight triangle test, and the box that the test needs.
//!
//! # Why no ray slips through
//!
//! 1. A corner's position in the ray's frame is rounded, but in the same way for all triangles
//!    that share the corner. So the ray meets some closed mesh of flat triangles, a little off
//!    the given mesh. If the ray's origin is inside the given mesh by more than rounding, it is
//!    inside that mesh too.
//! 2. The side of an edge is the sign of a difference of two products. Rounding is monotone: the
//!    sign of the rounded difference is that of the exact one, or zero. Zero counts as inside. So
//!    every triangle of the mesh of step 1 that contains the ray's point is hit, if it has an area.
//!    An area that rounds to zero is computed again. In a closed mesh around the ray's origin, some
//!    triangle with an area contains the ray's point, since triangles without area add nothing to
//!    the part that the others cover.
//! 3. The ray meets the triangle's own box (see [`bounds`]), so the tree and the naive loop both
//!    accept the hit. This requires that the ray crosses the triangle's plane: of random triangles
//!    and rays in their planes up to rounding, 18 of 431,965 hits miss the box. No leak was found
//!    that way (measured: docs/decisions.md, 35).

use super::Barycentrics;
use super::sheared::{Sight, is_outside};
use crate::geometry::{Aabb, Ray, RayFrame, Scalar, cross, dot, max, min};

/// Tests a triangle so that no ray slips through.
///
/// The first test is that of [`sheared`](super::sheared::sheared). Where it leaves something open,
/// a second test follows. The second test is in the wide scalar. It decides three cases: a
/// difference that is zero, as Woop, Benthin and Wald do; an area or a volume out of the range; and
/// a t whose sign is in doubt. So the test knows on which side of a triangle a ray starts, even if
/// the ray starts a few roundings from the triangle.
///
/// No scalar is wider than `f64`: see [`watertight_widest`].
#[inline(always)]
pub(super) fn watertight<S: Scalar>(corners: [[S; 3]; 3], ray: &Ray<S>) -> Option<(S, Barycentrics<S>)> {
    let shear = &RayFrame::of(ray);
    if S::IS_WIDEST {
        return watertight_widest(corners, shear);
    }
    let sight = Sight::new(corners, shear)?;
    let is_in_range = is_within(sight.area, S::LARGE_AREA) && is_within(sight.volume, S::LARGE_VOLUME);
    if is_in_range && is_sure(&sight) {
        Some(sight.hit(shear))
    } else {
        let [x, y, _] = sight.corners;
        settle([x, y], corners, ray)
    }
}

/// Returns whether the size of `x` is between 1 / `large` and `large`.
///
/// Then no part of `x` was so large or so small that it left the range.
#[inline(always)]
fn is_within<S: Scalar>(x: S, large: S) -> bool {
    let x = x.abs();
    x > S::ONE / large && x < large
}

/// Tests a triangle in the widest scalar.
///
/// Where rounding leaves something open, the parts of the products that were
/// rounded away are added.
#[inline(always)]
pub(super) fn watertight_widest<S: Scalar>(
    corners: [[S; 3]; 3],
    shear: &RayFrame<S>,
) -> Option<(S, Barycentrics<S>)> {
    let sight = Sight::new(corners, shear)?;
    if is_sure(&sight) {
        Some(sight.hit(shear))
    } else {
        let (depth, at) = settle_widest(sight.corners)?;
        Some((shear.t(depth), at))
    }
}

/// Returns whether rounding leaves nothing open.
///
/// Then the ray's point is surely inside the triangle, and the sign of t is known.
#[inline(always)]
fn is_sure<S: Scalar>(sight: &Sight<S>) -> bool {
    let ([a, b, c], [x, y, z]) = (sight.weights, sight.corners);
    let is_inside = a != S::ZERO && b != S::ZERO && c != S::ZERO;
    is_inside && (is_ahead(z) || sight.volume.abs() > doubt(x, y, z))
}

/// Returns the depth and the weights of the hit, from exact products.
///
/// The arguments are the corners' first, second and third coordinates in the ray's frame. Returns
/// `None` if the ray passes outside, or if the triangle has no area in the frame.
#[cold]
#[inline(never)]
fn settle_widest<S: Scalar>([x, y, z]: [[S; 3]; 3]) -> Option<(S, Barycentrics<S>)> {
    let weight = |i: usize, j: usize| {
        let ([p, p_rest], [q, q_rest]) = (x[i].exact_product(y[j]), x[j].exact_product(y[i]));
        (p - q) + (p_rest - q_rest)
    };
    let [a, b, c] = [weight(1, 2), weight(2, 0), weight(0, 1)];
    let area = a + b + c;
    if is_outside([a, b, c]) || area == S::ZERO {
        return None;
    }
    let at = Barycentrics { u: b / area, v: c / area };
    let depth = if is_within(area, S::LARGE_AREA) {
        (a * z[0] + b * z[1] + c * z[2]) / area
    } else {
        // Divided first: weights that consist of the rests of products may be tiny.
        a / area * z[0] + at.u * z[1] + at.v * z[2]
    };
    Some((depth, at))
}

/// Returns whether all corners, and so the hit, are ahead of the origin.
#[inline(always)]
fn is_ahead<S: Scalar>([a, b, c]: [S; 3]) -> bool {
    min(min(a, b), c) > S::ZERO
}

/// The factor of the error bound `doubt`, in epsilons.
pub(crate) const DOUBT: f64 = 40.0;

/// Returns a bound above the rounding error of the volume (x cross y) . z.
///
/// x and y are each off by up to 2 epsilon times the sum of themselves and z, and each product by
/// some more. In 20,000,000 random cases the error was at most a sixth of the bound.
#[inline(always)]
fn doubt<S: Scalar>(x: [S; 3], y: [S; 3], z: [S; 3]) -> S {
    let largest = |[a, b, c]: [S; 3]| max(max(a.abs(), b.abs()), c.abs());
    let (x, y, z) = (largest(x), largest(y), largest(z));
    S::from_f64(DOUBT) * S::EPSILON * z * (z * (x + y) + x * y)
}

/// Returns the hit of a triangle, computed in the wide scalar.
///
/// `xy` holds the corners' first and second coordinates in the ray's frame. Returns `None` if the
/// ray passes outside, or if the triangle has no area in the frame.
///
/// The rounded corners in the frame decide whether the triangle is hit, so that its neighbours
/// agree. But t is that of the triangle's true plane, no nearer than the nearest corner and no
/// farther than the farthest, for rays that start on the triangle. For a ray in the plane, this
/// t says little. There, t from the weights in the frame would be right within rounding. But it
/// would cost 28 self-hits of 19,980 rays from triangles that are a million times their size
/// from the origin.
#[cold]
#[inline(never)]
fn settle<S: Scalar>(xy: [[S; 3]; 2], corners: [[S; 3]; 3], ray: &Ray<S>) -> Option<(S, Barycentrics<S>)> {
    let widen = |point: [S; 3]| point.map(S::widen);
    let [x, y] = xy.map(widen);
    let [a, b, c] = cross(x, y);
    let area = a + b + c;
    if is_outside([a, b, c]) || area == S::Wide::ZERO || !area.is_finite() {
        return None;
    }
    let shear = RayFrame::widened(ray);
    let t = shear.t(plane_depth(corners.map(widen), &shear));
    Some((S::narrow(t), Barycentrics { u: S::narrow(b / area), v: S::narrow(c / area) }))
}

/// Returns the depth at which the ray meets the triangle's plane.
///
/// The depth is the third coordinate in the ray's frame, clamped to the range of the
/// corners' depths.
fn plane_depth<S: Scalar>(corners: [[S; 3]; 3], shear: &RayFrame<S>) -> S {
    let [x, y, z] = shear.apply(corners);
    let weights = cross(x, y);
    let [a, b, c] = weights;
    let depth = dot(weights, z) / (a + b + c);
    let [a, b, c] = z;
    // A ray in the plane gives a NaN, which `max` leaves out.
    min(max(depth, min(min(a, b), c)), max(max(a, b), c))
}

/// Returns the box of a triangle, larger than the box of its corners.
///
/// The margin is 4 epsilon of the largest extent, plus an epsilon of the coordinate. In the ray's
/// frame, the triangle may reach that far out of the box of its corners.
///
/// Let u be half an epsilon, s the largest extent, and h the point of the ray (relative to its
/// origin) that the test calls hit. Along an axis x that is not the ray's largest, the position
/// x dz - z dx of a corner A is rounded by up to 2 u |A.x dz| + 2 u |A.z dx| + u |x dz - z dx|. We
/// have |A.x| <= |h.x| + s, and the same bound for A.z dx / dz. So the rounding is at most
/// 4 u |h.x| + 6 u s in units of length. The second part is less than 4 epsilon s. The padding of
/// the slab test (see `Slabs`) covers the first part. So the ray meets the box. Underflow is
/// excluded: coordinates must be at least some 2^24 times the smallest normal number, or zero.
///
/// The corners must be valid. At the end of the scalar's range the margin is cut off.
#[inline(always)]
pub(super) fn bounds<S: Scalar>(corners: [[S; 3]; 3]) -> Aabb<S> {
    let mut padded = exact_bounds(corners);
    let [x, y, z] = padded.extent();
    let margin = max(max(x, y), z) * (S::from_f64(4.0) * S::EPSILON);
    for axis in 0..3 {
        let outward = |x: S| margin + S::EPSILON * x.abs();
        padded.min[axis] = max(padded.min[axis] - outward(padded.min[axis]), -S::MAX);
        padded.max[axis] = min(padded.max[axis] + outward(padded.max[axis]), S::MAX);
    }
    padded
}

/// Returns the exact box of the corners, which must be valid.
#[inline(always)]
pub(super) fn exact_bounds<S: Scalar>([a, b, c]: [[S; 3]; 3]) -> Aabb<S> {
    let each = |f: fn(S, S) -> S| [f(f(a[0], b[0]), c[0]), f(f(a[1], b[1]), c[1]), f(f(a[2], b[2]), c[2])];
    Aabb { min: each(min), max: each(max) }
}
