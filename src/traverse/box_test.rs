//! The box test of a wide node: all its children's boxes at once.
//!
//! Minima, maxima and their comparison are those of integers where the processor has them. On an
//! Intel Xeon (Granite Rapids) these take one cycle each, while those of floats take up to four,
//! one after the other (measured: docs/decisions.md, 29).
//!
//! Refused: t of ordinary rays as one fused product and sum, plane * slope + start, with slopes and
//! starts padded for the precision that this loses. Each step waits for one subtraction less, but
//! each ray needs 25 operations more (measured: docs/decisions.md, 30).
//!
//! Refused: to read several of a ray's scalars in one load. If the ray has just been
//! written, the load is wider than the pending stores, and that defeats store forwarding
//! (measured: docs/decisions.md, 31).
//!
//! # Comparison as integers
//!
//! Floats above -0 have the order of their bits. All floats below +0, as integers, come before
//! them. No t is NaN: planes and origin are not NaN, and the inverses are finite and not zero.
//!
//! - An entry is the largest of three t and t_min, which is not below +0. So a t below +0 is never
//!   the result, in whatever order those compare.
//! - An exit is the smallest of three t and the limit. If one of them is below +0, so is the
//!   result, and the box is left out. That is right unless the t is -0. So a small number is added
//!   to each exit, and none is -0.
//!
//! The exits are never before those of [`Slabs`], since rounding is monotone, whether once or
//! twice. So no box is left out that [`Slabs`] meets. Further boxes may be met with one instruction
//! set and not with another, but answers are the same.

use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::WideNode;
use crate::simd::{Isa, KernelLanes, Lanes};

/// The slab test of a ray in lanes. If `AHEAD`, the ray's t_min is not negative.
pub(super) struct BoxTest<S, L, const AHEAD: bool> {
    origin: [L; 3],
    inv_near: [L; 3],
    inv_far: [L; 3],
    /// For each axis 1 if the near planes are the maxima, else 0.
    first: [usize; 3],
    t_min: S,
    /// Whether boxes may be compared as integers, as the module describes.
    ///
    /// The inverses are finite, `t_min` above is +0 or more, and t_max has no minus sign. Later
    /// limits have none either, since no hit's t has one (see `primitive::accept` and the packed
    /// leaves).
    are_ordered_by_bits: bool,
}

/// Returns [`Ray::is_ordinary`], computed in lanes.
///
/// All lanes hold the same value. The scalars are read one by one, so that the values of a ray that
/// has just been written come straight from the stores. From scalar code a compiler would make
/// wider loads, which wait for the cache.
#[inline(always)]
pub(super) fn is_ordinary<S: Scalar, I: Isa>(isa: I, ray: &Ray<S>) -> bool {
    let splat = |x: S| S::Times4::<I>::splat(isa, x);
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
    let (ox, oy, oz) = (splat(ox).abs(), splat(oy).abs(), splat(oz).abs());
    let (dx, dy, dz) = (splat(dx).abs(), splat(dy).abs(), splat(dz).abs());
    let (large, zero) = (splat(S::LARGE_AREA), splat(S::ZERO));
    let (t_min, t_max) = (splat(ray.t_min), splat(ray.t_max));
    let all = (ox + oy + oz).lt(large)
        & (dx + dy + dz).lt(large)
        & splat(S::ONE / S::LARGE_AREA).lt(dx.min(dy).min(dz))
        & zero.le(t_min)
        & zero.lt(t_max)
        & t_min.le(t_max);
    S::Times4::<I>::bits(all) & 1 != 0
}

impl<S: Scalar, L: Lanes<S>, const AHEAD: bool> BoxTest<S, L, AHEAD> {
    /// Prepares the box test. `is_ordinary` is [`Ray::is_ordinary`] of the ray.
    #[inline(always)]
    pub fn new(isa: L::Isa, slabs: &Slabs<S>, is_ordinary: bool) -> Self {
        let &Slabs { origin, inv_near, inv_far, negative, t_min } = slabs;
        let splat = |[x, y, z]: [S; 3]| [L::splat(isa, x), L::splat(isa, y), L::splat(isa, z)];
        Self {
            origin: splat(origin),
            inv_near: splat(inv_near),
            inv_far: splat(inv_far),
            first: [usize::from(negative[0]), usize::from(negative[1]), usize::from(negative[2])],
            // The sum turns -0 into +0, whose bits compare as those of an integer do.
            t_min: t_min + S::ZERO,
            are_ordered_by_bits: L::orders_by_bits(isa) && is_ordinary,
        }
    }

    /// Whether the ray does not look behind its origin.
    #[inline(always)]
    pub fn is_ahead(&self) -> bool {
        AHEAD || self.t_min >= S::ZERO
    }

    /// Returns where the ray enters the children's boxes, and the lanes of boxes met.
    ///
    /// Entries are at t_min or later, unless the ray looks behind its origin. Only boxes that the
    /// ray meets up to `limit` count as met.
    #[inline(always)]
    pub fn enter<const N: usize>(&self, node: &impl WideNode<S, N>, ray: &Ray<S>, limit: S) -> (L, u32) {
        let isa = self.origin[0].isa();
        let (t_min, t_max) = (L::splat(isa, self.t_min), L::splat(isa, limit));
        if self.are_ordered_by_bits {
            debug_assert!(limit.total_cmp(&S::ZERO).is_ge(), "no limit is -0");
            // The addend makes no exit -0.
            let after_zero = L::splat(isa, S::ONE / S::LARGE_VOLUME);
            let slab = |axis: usize, [first, last]: [L; 2]| {
                (first * self.inv_near[axis], last.mul_add(self.inv_far[axis], after_zero))
            };
            let (x, x_far) = slab(0, self.distances(node, 0));
            let (y, y_far) = slab(1, self.distances(node, 1));
            let (z, z_far) = slab(2, self.distances(node, 2));
            let near = x.later(y).later(z.later(t_min));
            let far = x_far.earlier(y_far).earlier(z_far.earlier(t_max));
            (near, L::bits(near.not_after(far)) & node.lanes())
        } else if !self.is_ahead() {
            let (near, met) = enter_behind(node, ray, limit);
            (L::from_slice(isa, &near), met)
        } else {
            // On an axis along which the ray does not move, a plane through the origin is left out.
            let (mut near, mut far) = (t_min, t_max);
            for axis in 0..3 {
                let [first, last] = self.distances(node, axis);
                near = (first * self.inv_near[axis]).max(near);
                far = (last * self.inv_far[axis]).min(far);
            }
            (near, L::bits(near.le(far)) & node.lanes())
        }
    }

    /// Returns the distances from the origin to the near and far planes across an axis.
    #[inline(always)]
    fn distances<T: WideNode<S, N>, const N: usize>(&self, node: &T, axis: usize) -> [L; 2] {
        let [first, last] = node.planes::<L>(self.origin[0].isa(), axis, self.first[axis]);
        [first - self.origin[axis], last - self.origin[axis]]
    }
}

/// The same for a ray that also looks behind its origin.
///
/// There the padding has the other sign.
#[cold]
#[inline(never)]
fn enter_behind<S: Scalar, T: WideNode<S, N>, const N: usize>(
    node: &T,
    ray: &Ray<S>,
    limit: S,
) -> ([S; 16], u32) {
    let slabs = Slabs::new(ray);
    let (mut entries, mut met) = ([S::ZERO; 16], 0);
    for (lane, entry) in entries.iter_mut().enumerate().take(N) {
        if let Some((aabb, _)) = node.child(lane)
            && let Some(t) = slabs.entry(&aabb).filter(|&t| t <= limit)
        {
            *entry = t;
            met |= 1 << lane;
        }
    }
    (entries, met)
}
