//! Triangles side by side in a leaf, tested in lanes: each lane does what [`sheared`](super::sheared) and
//! [`watertight`](super::watertight) do for one, and `query::accept` after them.

use super::Barycentrics;
use super::watertight::DOUBT;
use crate::geometry::{PreparedRay, Scalar, Shear, Slabs, max};
use crate::primitive::{Found, Leaf, Operands};
use crate::simd::Lanes;
use core::marker::PhantomData;

/// The leaf of [`Fast`](super::Fast) triangles: nine coordinates each.
pub type FastLeaf = TriangleLeaf<false>;

/// The leaf of [`Watertight`](super::Watertight) triangles: nine coordinates each.
pub type WatertightLeaf = TriangleLeaf<true>;

/// A leaf of triangles: [`FastLeaf`], or [`WatertightLeaf`], which looks twice where rounding leaves something open.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLeaf<const LOOKS_TWICE: bool>;

impl<S: Scalar, const LOOKS_TWICE: bool> Leaf<S, Barycentrics<S>> for TriangleLeaf<LOOKS_TWICE> {
    const OPERANDS: usize = 9;
    const SETTLES: bool = true;

    #[inline(always)]
    fn suits(ray: &PreparedRay<S>) -> bool {
        is_ahead_and_in_range(ray)
    }

    #[inline(always)]
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, _: S) -> L::Mask {
        Sights::new(operands, &ray.shear).inside
    }

    #[inline(always)]
    fn test<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, limit: S) -> Found<S, L> {
        let sights = Sights::new(operands, &ray.shear);
        if L::bits(sights.inside) == 0 {
            return Found::to_be_asked(0, operands);
        }
        let sure = if LOOKS_TWICE { sights.settled(operands) } else { sights.inside };
        sights.found(operands, ray, limit, sure)
    }

    #[inline(always)]
    fn payload([b, c, area]: [S; 3]) -> Option<Barycentrics<S>> {
        Some(Barycentrics { u: b / area, v: c / area })
    }
}

/// The ray does not look behind its origin, where the padding of boxes has the other sign, and no sum or product of two
/// coordinates in the frame overflows: only lanes without a triangle are NaN. (In `f64` products overflow sooner, but
/// then t is NaN in lanes as it is for a single triangle, and nothing is hit.)
#[inline(always)]
fn is_ahead_and_in_range<S: Scalar>(ray: &PreparedRay<S>) -> bool {
    let [x, y, z] = ray.origin;
    // The first says all of it, and is known.
    ray.slabs.is_ordinary || (ray.t_min >= S::ZERO && max(max(x.abs(), y.abs()), z.abs()) < S::LARGE_AREA)
}

/// The leaf of [`Precise`](super::Precise) triangles: nine coordinates each, by which those are left out whose sides
/// are beyond doubt in `f32` already.
#[derive(Clone, Copy, Debug)]
pub struct PreciseLeaf;

impl Leaf<f32, Barycentrics> for PreciseLeaf {
    const OPERANDS: usize = 9;

    #[inline(always)]
    fn suits(ray: &PreparedRay) -> bool {
        is_ahead_and_in_range(ray)
    }

    /// A weight is a difference of two products of places in the frame, each of them off by less than 2 epsilon of what
    /// it would be if all signs were plus: so the weight is, by less than 16 epsilon of the largest such product. A slope, a
    /// place or a product that underflows is off by more than its epsilons, but by less than one of the smallest normal number,
    /// which is added to each.
    #[inline(always)]
    fn candidates<L: Lanes<f32>>(operands: &Operands<'_, f32, L>, ray: &PreparedRay, _: f32) -> L::Mask {
        let Sights { x, y, z, weights: [a, b, c], .. } = Sights::new(operands, &ray.shear);
        let [dx, dy, dz] = ray.shear.direction;
        let (x, y, z) = (largest(x), largest(y), largest(z));
        let splat = |x: f32| operands.splat(x.abs());
        let tiny = operands.splat(f32::MIN_POSITIVE);
        let (x, y) =
            (x * splat(dz) + z * (splat(dx) + tiny) + tiny, y * splat(dz) + z * (splat(dy) + tiny) + tiny);
        let doubt = x * y * operands.splat(16.0 * f32::EPSILON) + tiny;
        let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
        let zero = operands.splat(0.0);
        (zero - doubt).le(lowest) | highest.le(doubt)
    }
}

/// Where a ray enters the slab between the corners' places on an axis.
#[inline(always)]
fn first<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, [p, q, r]: [L; 3], inv: S) -> L {
    let inv = operands.splat(inv);
    (p * inv).min(q * inv).min(r * inv)
}

/// Where it leaves it.
#[inline(always)]
fn last<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, [p, q, r]: [L; 3], inv: S) -> L {
    let inv = operands.splat(inv);
    (p * inv).max(q * inv).max(r * inv)
}

/// In size.
#[inline(always)]
fn largest<S: Scalar, L: Lanes<S>>([p, q, r]: [L; 3]) -> L {
    p.abs().max(q.abs()).max(r.abs())
}

/// Neither so large nor so small that a part of it may have left the range.
#[inline(always)]
fn is_within<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, x: L, large: S) -> L::Mask {
    let x = x.abs();
    operands.splat(S::ONE / large).lt(x) & x.lt(operands.splat(large))
}

/// [`Sight`](super::sheared::Sight) in lanes.
struct Sights<S: Scalar, L: Lanes<S>> {
    /// The corners' places relative to the origin: unpermuted differences, on the frame's axes.
    x: [L; 3],
    y: [L; 3],
    z: [L; 3],
    /// The first and second coordinates in the frame.
    frame: [[L; 3]; 2],
    weights: [L; 3],
    inside: L::Mask,
    scalar: PhantomData<S>,
}

impl<S: Scalar, L: Lanes<S>> Sights<S, L> {
    #[inline(always)]
    fn new(operands: &Operands<'_, S, L>, shear: &Shear<S>) -> Self {
        let [i, j, k] = shear.axes;
        let splat = |x: S| operands.splat(x);
        let [ox, oy, oz] = shear.origin;
        let (ox, oy, oz) = (splat(ox), splat(oy), splat(oz));
        let x = [operands.get(i) - ox, operands.get(3 + i) - ox, operands.get(6 + i) - ox];
        let y = [operands.get(j) - oy, operands.get(3 + j) - oy, operands.get(6 + j) - oy];
        let z = [operands.get(k) - oz, operands.get(3 + k) - oz, operands.get(6 + k) - oz];
        let frame = Self::frame(shear, operands, x, y, z);
        let [[x0, x1, x2], [y0, y1, y2]] = frame;
        let (a, b, c) = (x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0);
        let zero = splat(S::ZERO);
        let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
        let inside = zero.le(lowest) | highest.le(zero);
        Self { x, y, z, frame, weights: [a, b, c], inside, scalar: PhantomData }
    }

    #[inline(always)]
    fn frame(
        shear: &Shear<S>,
        operands: &Operands<'_, S, L>,
        [x0, x1, x2]: [L; 3],
        [y0, y1, y2]: [L; 3],
        [z0, z1, z2]: [L; 3],
    ) -> [[L; 3]; 2] {
        let [dx, dy, dz] = shear.direction;
        let (dx, dy, dz) = (operands.splat(dx), operands.splat(dy), operands.splat(dz));
        [
            [x0 * dz - z0 * dx, x1 * dz - z1 * dx, x2 * dz - z2 * dx],
            [y0 * dz - z0 * dy, y1 * dz - z1 * dy, y2 * dz - z2 * dy],
        ]
    }

    /// What is hit up to `limit`: those of `sure` whose own boxes prove that t need not be raised, and what is left
    /// of those inside, to be asked.
    #[inline(always)]
    fn found(
        &self,
        operands: &Operands<'_, S, L>,
        ray: &PreparedRay<S>,
        limit: S,
        sure: L::Mask,
    ) -> Found<S, L> {
        let ([a, b, c], [z0, z1, z2]) = (self.weights, self.z);
        let (area, volume) = (a + b + c, a * z0 + b * z1 + c * z2);
        let zero = operands.splat(S::ZERO);
        let t = volume / area / operands.splat(ray.shear.forward) + zero;
        // No infinity.
        let limit = if limit < S::MAX { limit } else { S::MAX };
        let in_reach = operands.splat(ray.t_min).le(t) & t.le(operands.splat(limit));
        let unsure = self.inside & !sure;
        let sure = sure & in_reach;
        let (sure, unsure) = if L::bits(sure) == 0 {
            (0, L::bits(unsure))
        } else {
            let proved = sure & self.is_past_its_box(operands, ray, t);
            (L::bits(proved), L::bits(unsure | (sure & !proved)))
        };
        Found::new(sure, unsure, t, [b, c, area])
    }

    /// Whether t is at or behind the ray's entry into the box of the corners, and the box is met: then the same is
    /// true of the triangle's own box, which contains it, and `query::accept` leaves t as it is.
    ///
    /// A difference from a bound is the least or the greatest of those from the corners, and so is its product with
    /// the inverse, since rounding is monotone. A product is NaN where a corner is level with the origin on an axis
    /// along which the ray does not move: then the axis is left out, as the slab test does, or the box seems smaller.
    ///
    /// Refused: entries in one half of a vector and exits in the other, which is half of the operations with AVX-512 (no
    /// quicker, and with AVX2 1 to 2 % slower).
    #[inline(always)]
    fn is_past_its_box(&self, operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, t: L) -> L::Mask {
        // Copies: an index into the ray itself would keep all of it in memory, what is not needed too.
        let Slabs { inv_near, inv_far, .. } = ray.slabs;
        let [i, j, k] = ray.shear.axes;
        let near_x = first(operands, self.x, inv_near[i]);
        let near_y = first(operands, self.y, inv_near[j]);
        let near_z = first(operands, self.z, inv_near[k]);
        let far_x = last(operands, self.x, inv_far[i]);
        let far_y = last(operands, self.y, inv_far[j]);
        let far_z = last(operands, self.z, inv_far[k]);
        let (near, far) = (near_x.max(near_y.max(near_z)), far_x.min(far_y.min(far_z)));
        near.le(t) & near.le(far) & operands.splat(ray.t_min).le(far)
    }

    /// Those inside of which rounding leaves nothing open: as in [`watertight`](super::watertight).
    #[inline(always)]
    fn settled(&self, operands: &Operands<'_, S, L>) -> L::Mask {
        let ([a, b, c], [z0, z1, z2]) = (self.weights, self.z);
        let zero = operands.splat(S::ZERO);
        let area = a + b + c;
        let mut sure = self.inside & zero.lt(a.abs().min(b.abs()).min(c.abs()));
        let volume = a * z0 + b * z1 + c * z2;
        if !S::IS_WIDEST {
            sure = sure
                & is_within(operands, area, S::LARGE_AREA)
                & is_within(operands, volume, S::LARGE_VOLUME);
        }
        let ahead = zero.lt(z0.min(z1).min(z2));
        if L::bits(sure & !ahead) == 0 {
            return sure;
        }
        let [x, y] = self.frame;
        let (x, y, z) = (largest(x), largest(y), largest(self.z));
        let doubt = operands.splat(S::from_f64(DOUBT) * S::EPSILON) * z * (z * (x + y) + x * y);
        sure & (ahead | doubt.lt(volume.abs()))
    }
}
