//! Leaves of triangles side by side, tested in lanes.
//!
//! Each lane does the same as `sheared` and `watertight` in `primitive::triangle` do for one
//! triangle, and as `primitive::accept` does after them.

use super::sealed::{Kernel, LeafKind};
use super::{LaneHits, LaneTest, Operands, is_ahead_and_in_range};
use crate::geometry::{Ray, RayFrame, Scalar, Slabs};
use crate::primitive::{Barycentrics, DOUBT, Fast, Triangle, Watertight, accept};
use crate::simd::Lanes;
use core::marker::PhantomData;

/// The leaf of [`Fast`] triangles: nine coordinates each.
///
/// The test needs nothing else. The leaf is for types whose `intersect` and box are those of
/// [`Fast`]: queries of wide trees call neither.
#[derive(Clone, Copy, Debug)]
pub struct FastLeaf;

/// The leaf of [`Watertight`] triangles: nine coordinates each.
///
/// The test needs nothing else. The leaf is for types whose `intersect` and box are those of
/// [`Watertight`]: queries of wide trees call neither.
#[derive(Clone, Copy, Debug)]
pub struct WatertightLeaf;

impl<S: Scalar> LeafKind<S, Barycentrics<S>> for FastLeaf {
    const OPERANDS: usize = 9;
    const IS_SETTLED_IN_LANES: bool = true;
    const KERNEL: Kernel = Kernel::Fast;

    #[inline(always)]
    fn payload(details: [S; 3]) -> Option<Barycentrics<S>> {
        Some(barycentrics(details))
    }
}

impl<S: Scalar> LeafKind<S, Barycentrics<S>> for WatertightLeaf {
    const OPERANDS: usize = 9;
    const IS_SETTLED_IN_LANES: bool = true;
    const KERNEL: Kernel = Kernel::Watertight;

    #[inline(always)]
    fn payload(details: [S; 3]) -> Option<Barycentrics<S>> {
        Some(barycentrics(details))
    }
}

impl<S: Scalar> LaneTest<S> for FastLeaf {
    const OPERANDS: usize = 9;
    type Frame = TriangleFrame<S>;

    #[inline(always)]
    fn frame(ray: &Ray<S>, slabs: &Slabs<S>) -> TriangleFrame<S> {
        TriangleFrame::of(ray, slabs)
    }

    #[inline(always)]
    fn suits(ray: &Ray<S>) -> bool {
        is_ahead_and_in_range(ray)
    }

    #[inline(always)]
    fn test<L: Lanes<S>>(
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &TriangleFrame<S>,
        limit: S,
    ) -> LaneHits<L> {
        let tests = EdgeTests::new(operands, &frame.shear);
        if L::bits(tests.inside) == 0 {
            return LaneHits::undecided(0, operands);
        }
        tests.hits(operands, ray, frame, limit, tests.inside)
    }

    fn one(operands: &[S], ray: &Ray<S>, slabs: &Slabs<S>) -> Option<(S, [S; 3])> {
        accept(&Fast(triangle(operands)), ray, slabs).map(details)
    }
}

impl<S: Scalar> LaneTest<S> for WatertightLeaf {
    const OPERANDS: usize = 9;
    type Frame = TriangleFrame<S>;

    #[inline(always)]
    fn frame(ray: &Ray<S>, slabs: &Slabs<S>) -> TriangleFrame<S> {
        TriangleFrame::of(ray, slabs)
    }

    #[inline(always)]
    fn suits(ray: &Ray<S>) -> bool {
        is_ahead_and_in_range(ray)
    }

    /// Tests all lanes, and leaves those undecided where rounding leaves a doubt.
    #[inline(always)]
    fn test<L: Lanes<S>>(
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &TriangleFrame<S>,
        limit: S,
    ) -> LaneHits<L> {
        let tests = EdgeTests::new(operands, &frame.shear);
        if L::bits(tests.inside) == 0 {
            return LaneHits::undecided(0, operands);
        }
        tests.hits(operands, ray, frame, limit, tests.settled(operands))
    }

    fn one(operands: &[S], ray: &Ray<S>, slabs: &Slabs<S>) -> Option<(S, [S; 3])> {
        accept(&Watertight(triangle(operands)), ray, slabs).map(details)
    }
}

/// The values of a ray that the tests of triangles in all modes need.
#[derive(Clone, Copy)]
pub(crate) struct TriangleFrame<S> {
    pub(super) shear: RayFrame<S>,
    /// The inverse direction of the slabs, on the axes of the frame.
    inv_near: [S; 3],
    inv_far: [S; 3],
}

impl<S: Scalar> TriangleFrame<S> {
    #[inline(always)]
    pub fn of(ray: &Ray<S>, &Slabs { inv_near, inv_far, .. }: &Slabs<S>) -> Self {
        let shear = RayFrame::of(ray);
        let [i, j, k] = shear.axes;
        let (i, j, k) = (i.index(), j.index(), k.index());
        let inv_near = [inv_near[i], inv_near[j], inv_near[k]];
        Self { shear, inv_near, inv_far: [inv_far[i], inv_far[j], inv_far[k]] }
    }
}

/// Returns the triangle with these coordinates.
pub(super) fn triangle<S: Scalar>(operands: &[S]) -> Triangle<S> {
    let corner = |k: usize| [operands[3 * k], operands[3 * k + 1], operands[3 * k + 2]];
    Triangle { a: corner(0), b: corner(1), c: corner(2) }
}

/// Returns a payload as details, from which [`barycentrics`] makes the same bits.
pub(super) fn details<S: Scalar>((t, Barycentrics { u, v }): (S, Barycentrics<S>)) -> (S, [S; 3]) {
    (t, [u, v, S::ONE])
}

/// Returns the payload of a hit with these details.
///
/// They are the weights of the second and the third corner, times the area, and the area.
#[inline(always)]
pub(super) fn barycentrics<S: Scalar>([b, c, area]: [S; 3]) -> Barycentrics<S> {
    Barycentrics { u: b / area, v: c / area }
}

/// Returns where a ray enters the slab between the corners on an axis.
#[inline(always)]
fn first<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, [p, q, r]: [L; 3], inv: S) -> L {
    let inv = operands.splat(inv);
    (p * inv).min(q * inv).min(r * inv)
}

/// Returns where a ray leaves the slab between the corners on an axis.
#[inline(always)]
fn last<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, [p, q, r]: [L; 3], inv: S) -> L {
    let inv = operands.splat(inv);
    (p * inv).max(q * inv).max(r * inv)
}

/// Returns the largest of three absolute values, in each lane.
#[inline(always)]
pub(super) fn largest<S: Scalar, L: Lanes<S>>([p, q, r]: [L; 3]) -> L {
    p.abs().max(q.abs()).max(r.abs())
}

/// Returns the lanes where no term of `x` can have left the scalar's range.
///
/// There, `x` is neither too large nor too small for that.
#[inline(always)]
fn is_within<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, x: L, large: S) -> L::Mask {
    let x = x.abs();
    operands.splat(S::ONE / large).lt(x) & x.lt(operands.splat(large))
}

/// The edge test of `sheared`, in lanes.
pub(super) struct EdgeTests<S: Scalar, L: Lanes<S>> {
    /// The corners relative to the origin: plain differences, on the frame's axes.
    pub x: [L; 3],
    pub y: [L; 3],
    pub z: [L; 3],
    /// The first and the second coordinates of the corners in the frame.
    frame: [[L; 3]; 2],
    pub weights: [L; 3],
    inside: L::Mask,
    scalar: PhantomData<S>,
}

impl<S: Scalar, L: Lanes<S>> EdgeTests<S, L> {
    #[inline(always)]
    pub fn new(operands: &Operands<'_, S, L>, shear: &RayFrame<S>) -> Self {
        let [i, j, k] = shear.axes;
        let (i, j, k) = (i.index(), j.index(), k.index());
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
        shear: &RayFrame<S>,
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

    /// Returns the hits up to `limit`.
    ///
    /// A lane of `sure` with t in reach is settled if the triangle's own box proves that t need not
    /// be raised. The scalar test decides the other lanes of `sure` with t in reach, and the lanes
    /// inside that are not in `sure`.
    #[inline(always)]
    fn hits(
        &self,
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &TriangleFrame<S>,
        limit: S,
        sure: L::Mask,
    ) -> LaneHits<L> {
        let ([a, b, c], [z0, z1, z2]) = (self.weights, self.z);
        let (area, volume) = (a + b + c, a * z0 + b * z1 + c * z2);
        let zero = operands.splat(S::ZERO);
        let t = volume / area / operands.splat(frame.shear.forward) + zero;
        // An infinite t is no hit.
        let limit = if limit < S::MAX { limit } else { S::MAX };
        let in_reach = operands.splat(ray.t_min).le(t) & t.le(operands.splat(limit));
        let unsure = self.inside & !sure;
        let sure = sure & in_reach;
        let (sure, unsure) = if L::bits(sure) == 0 {
            (0, L::bits(unsure))
        } else {
            let proved = sure & self.is_past_its_box(operands, ray, frame, t);
            (L::bits(proved), L::bits(unsure | (sure & !proved)))
        };
        LaneHits { settled: sure, undecided: unsure, t, details: [b, c, area] }
    }

    /// Returns the lanes where t is not before the ray's entry into the corners' box.
    ///
    /// In these lanes the ray meets the box. The triangle's own box contains the corners' box, so
    /// the same is true of the own box, and `primitive::accept` leaves t as it is.
    ///
    /// The difference between a bound and the origin is the least or the greatest of the
    /// differences between the corners and the origin. So is its product with the inverse,
    /// because rounding is monotone. A product is NaN where a corner is level with the origin on
    /// an axis along which the ray does not move. Then the axis is left out, as in the slab test,
    /// or the box seems smaller.
    ///
    /// Refused: entries in one half of a vector, and exits in the other. With AVX-512 this takes
    /// half of the operations, but is no quicker. With AVX2 it is 1 to 2 % slower.
    #[inline(always)]
    fn is_past_its_box(
        &self,
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &TriangleFrame<S>,
        t: L,
    ) -> L::Mask {
        let ([near_i, near_j, near_k], [far_i, far_j, far_k]) = (frame.inv_near, frame.inv_far);
        let near_x = first(operands, self.x, near_i);
        let near_y = first(operands, self.y, near_j);
        let near_z = first(operands, self.z, near_k);
        let far_x = last(operands, self.x, far_i);
        let far_y = last(operands, self.y, far_j);
        let far_z = last(operands, self.z, far_k);
        let (near, far) = (near_x.max(near_y.max(near_z)), far_x.min(far_y.min(far_z)));
        near.le(t) & near.le(far) & operands.splat(ray.t_min).le(far)
    }

    /// Returns the lanes inside whose answer rounding cannot change.
    ///
    /// The rule is that of `primitive::triangle::watertight`.
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
