//! The boxes of a wide node's children, tested all at once.
//!
//! Minima, maxima and their comparison are those of integers where the processor has them: on an Intel Xeon (Granite Rapids)
//! they take one cycle each, those of numbers up to four, one after the other. In an ordinary build, means of three scenes,
//! closest hits were 1.03 to 1.06 times as quick with AVX2 and 1.01 to 1.03 with AVX-512, any hits 1.01 to 1.03 with either;
//! in a build for that processor alone, all kinds of rays with AVX2 1.19 to 1.27. (In all of these t took one division instead
//! of two, which is worth 0 to 1 % and was given up.)
//!
//! Refused: t of ordinary rays as one fused product and sum, place * slope + start, with slopes and starts padded for what that
//! loses (a difference less to wait for in each step, 25 operations more for each ray: with AVX-512 0.95 to 1.00 of the rate, with AVX2
//! 1.00 to 1.03). And to read a ray's scalars several at once: a nanosecond less, but 15 to 30 more where a ray is
//! asked right after it was written, for a load wider than a pending store waits for the cache.
//!
//! # As integers
//!
//! Floats above -0 are ordered as their bits are, and all below +0, as integers, come before them. No t is NaN: planes and
//! origin are none, and the inverses are finite and not zero. An entry is the largest of three t and t_min, which is not below
//! +0: a t below is never taken, whichever of two. An exit is the smallest of three t and the limit: if one is below +0 so is
//! what is taken, and the box is left out, which it has to be unless t is -0. So exits get a little more, by which none is -0.
//! They are never before those of [`Slabs`], since rounding is monotone, once or twice: no box is left out that those meet.
//! Boxes beyond may be met with one instruction set and not with another; answers are the same.

use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::WideNode;
use crate::simd::{Isa, KernelLanes, Lanes};

/// The slabs in lanes. If `AHEAD`, of rays that do not look behind their origin.
pub(super) struct BoxTest<S, L, const AHEAD: bool> {
    origin: [L; 3],
    inv_near: [L; 3],
    inv_far: [L; 3],
    /// For each axis 1 if the near planes are the maxima, else 0.
    first: [usize; 3],
    t_min: S,
    /// What is said above holds: inverses are finite, and neither t_min nor t_max has a minus sign. Later limits have none
    /// either, since no hit's t has (see `primitive::accept` and the packed leaves).
    are_ordered_by_bits: bool,
}

/// [`Ray::is_ordinary`] in lanes, which hold the same: scalars are read one by one, so that those of a ray that was just
/// written come straight from the stores. A compiler would read several at once, and wait for the cache.
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
    /// `is_ordinary` is what the ray says.
    #[inline(always)]
    pub fn new(isa: L::Isa, slabs: &Slabs<S>, is_ordinary: bool) -> Self {
        let &Slabs { origin, inv_near, inv_far, negative, t_min } = slabs;
        let splat = |[x, y, z]: [S; 3]| [L::splat(isa, x), L::splat(isa, y), L::splat(isa, z)];
        Self {
            origin: splat(origin),
            inv_near: splat(inv_near),
            inv_far: splat(inv_far),
            first: [usize::from(negative[0]), usize::from(negative[1]), usize::from(negative[2])],
            // +0, whose bits are those of an integer.
            t_min: t_min + S::ZERO,
            are_ordered_by_bits: L::orders_by_bits(isa) && is_ordinary,
        }
    }

    /// Whether the ray does not look behind its origin.
    #[inline(always)]
    pub fn is_ahead(&self) -> bool {
        AHEAD || self.t_min >= S::ZERO
    }

    /// Where the ray enters the children's boxes, from t_min on, and which of them it meets up to `limit`.
    #[inline(always)]
    pub fn enter<const N: usize>(&self, node: &impl WideNode<S, N>, ray: &Ray<S>, limit: S) -> (L, u32) {
        let isa = self.origin[0].isa();
        let (t_min, t_max) = (L::splat(isa, self.t_min), L::splat(isa, limit));
        if self.are_ordered_by_bits {
            debug_assert!(limit.total_cmp(&S::ZERO).is_ge(), "no limit is -0");
            // No far plane is crossed at -0.
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
            // A plane through the origin, on an axis along which the ray does not move, is left out.
            let (mut near, mut far) = (t_min, t_max);
            for axis in 0..3 {
                let [first, last] = self.distances(node, axis);
                near = (first * self.inv_near[axis]).max(near);
                far = (last * self.inv_far[axis]).min(far);
            }
            (near, L::bits(near.le(far)) & node.lanes())
        }
    }

    /// How far from the origin the near planes and the far planes across an axis are.
    #[inline(always)]
    fn distances<T: WideNode<S, N>, const N: usize>(&self, node: &T, axis: usize) -> [L; 2] {
        let [first, last] = node.planes::<L>(self.origin[0].isa(), axis, self.first[axis]);
        [first - self.origin[axis], last - self.origin[axis]]
    }
}

/// The same for a ray that also looks behind its origin, where the padding has the other sign.
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
