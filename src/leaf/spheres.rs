//! Leaves of spheres side by side, tested in lanes.

use super::sealed::{Kernel, LeafKind};
use super::{LaneHits, LaneTest, Operands};
use crate::geometry::{Ray, Scalar, Slabs};
use crate::primitive::{Sphere, accept};
use crate::simd::Lanes;

/// The leaf of [`Sphere`]s: the center and the radius of each.
#[derive(Clone, Copy, Debug)]
pub struct SphereLeaf;

impl<S: Scalar> LeafKind<S, ()> for SphereLeaf {
    const OPERANDS: usize = 4;
    const IS_SETTLED_IN_LANES: bool = true;
    const KERNEL: Kernel = Kernel::Spheres;

    #[inline(always)]
    fn payload(_: [S; 3]) -> Option<()> {
        Some(())
    }
}

impl<S: Scalar> LaneTest<S> for SphereLeaf {
    const OPERANDS: usize = 4;
    type Frame = Slabs<S>;

    #[inline(always)]
    fn frame(_: &Ray<S>, slabs: &Slabs<S>) -> Slabs<S> {
        *slabs
    }

    /// Returns whether the ray does not look behind its origin.
    ///
    /// Behind the origin, the padding of boxes has the other sign.
    #[inline(always)]
    fn suits(ray: &Ray<S>) -> bool {
        ray.t_min >= S::ZERO
    }

    #[inline(always)]
    fn test<L: Lanes<S>>(
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        slabs: &Slabs<S>,
        limit: S,
    ) -> LaneHits<L> {
        let quadratics = Quadratics::new(operands, ray);
        if L::bits(quadratics.is_hit) == 0 {
            return LaneHits::undecided(0, operands);
        }
        quadratics.hits(operands, ray, slabs, limit)
    }

    fn one(operands: &[S], ray: &Ray<S>, slabs: &Slabs<S>) -> Option<(S, [S; 3])> {
        let sphere = Sphere { center: [operands[0], operands[1], operands[2]], radius: operands[3] };
        accept(&sphere, ray, slabs).map(|(t, ())| (t, [S::ZERO; 3]))
    }
}

/// The first half of [`Sphere::intersect`] in lanes, bit for bit.
struct Quadratics<S: Scalar, L: Lanes<S>> {
    /// The ray's origin relative to the centers.
    to_origin: [L; 3],
    a: S,
    b: L,
    discriminant: L,
    is_hit: L::Mask,
}

impl<S: Scalar, L: Lanes<S>> Quadratics<S, L> {
    #[inline(always)]
    fn new(operands: &Operands<'_, S, L>, ray: &Ray<S>) -> Self {
        let splat = |x: S| operands.splat(x);
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let a = dx * dx + dy * dy + dz * dz;
        let (x, y, z) =
            (splat(ox) - operands.get(0), splat(oy) - operands.get(1), splat(oz) - operands.get(2));
        let (dx, dy, dz) = (splat(dx), splat(dy), splat(dz));
        let b = splat(-S::ZERO) - (x * dx + y * dy + z * dz);
        let step = b / splat(a);
        let (px, py, pz) = (x + dx * step, y + dy * step, z + dz * step);
        let radius = operands.get(3);
        let discriminant = radius * radius - (px * px + py * py + pz * pz);
        // A radius is never below zero, nor is its square. If `a` is out of range, no finite
        // discriminant is a hit. NaN is never a hit.
        let least = if a.is_normal_number() { S::ZERO } else { S::INFINITY };
        Self { to_origin: [x, y, z], a, b, discriminant, is_hit: splat(least).le(discriminant) }
    }

    /// Returns the hits up to `limit`.
    ///
    /// A lane is settled if the ray's entry into the sphere's box proves that t need not be raised.
    /// Here the box is not rounded outward. The scalar test decides the other lanes.
    #[inline(always)]
    fn hits(&self, operands: &Operands<'_, S, L>, ray: &Ray<S>, slabs: &Slabs<S>, limit: S) -> LaneHits<L> {
        let splat = |x: S| operands.splat(x);
        let ([x, y, z], b, radius, zero) = (self.to_origin, self.b, operands.get(3), splat(S::ZERO));
        let root = splat(self.a.sqrt()) * self.discriminant.sqrt();
        let c = (x * x + y * y + z * z) - radius * radius;
        let q = (b - root).select(b.lt(zero), b + root);
        let (t0, t1) = (c / q, q / splat(self.a));
        let is_ordered = t0.le(t1);
        let (first, last) = (t0.select(is_ordered, t1), t1.select(is_ordered, t0));
        let includes = |t: L| splat(ray.t_min).le(t) & t.le(splat(ray.t_max));
        let t = first.select(includes(first), last) + zero;
        let limit = if limit < S::MAX { limit } else { S::MAX };
        let in_reach = self.is_hit & includes(t) & t.le(splat(limit));
        let ([nx, fx], [ny, fy], [nz, fz]) =
            (slab(operands, slabs, 0), slab(operands, slabs, 1), slab(operands, slabs, 2));
        let (near, far) = (nx.max(ny.max(nz)), fx.min(fy.min(fz)));
        let is_past = near.le(t) & near.le(far) & splat(ray.t_min).le(far);
        let (settled, undecided) = (L::bits(in_reach & is_past), L::bits(in_reach & !is_past));
        LaneHits { settled, undecided, t, details: [zero; 3] }
    }
}

/// Returns where the ray enters and leaves the slabs of the boxes, on one axis.
#[inline(always)]
fn slab<S: Scalar, L: Lanes<S>>(operands: &Operands<'_, S, L>, slabs: &Slabs<S>, axis: usize) -> [L; 2] {
    let (center, radius, origin) = (operands.get(axis), operands.get(3), operands.splat(slabs.origin[axis]));
    let (low, high) = ((center - radius) - origin, (center + radius) - origin);
    let (near, far) = (operands.splat(slabs.inv_near[axis]), operands.splat(slabs.inv_far[axis]));
    [(low * near).min(high * near), (low * far).max(high * far)]
}
