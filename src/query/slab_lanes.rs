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
//! 1.00 to 1.03). And to prepare rays in four lanes of what is read as a whole: a nanosecond less, but 15 to 30 more where a ray is
//! asked right after it was written (see `simd::read_each`).
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
use crate::simd::Lanes;

/// The slabs in lanes.
pub(super) struct SlabLanes<S, L> {
    origin: [L; 3],
    inv_near: [L; 3],
    inv_far: [L; 3],
    /// On which axes the near planes are the maxima.
    negative: [bool; 3],
    pub t_min: S,
    /// What is said above holds: inverses are finite, and neither t_min nor t_max has a minus sign. Later limits have none
    /// either, since no hit's t has (see `query::accept` and the packed leaves).
    are_ordered_by_bits: bool,
}

impl<S: Scalar, L: Lanes<S>> SlabLanes<S, L> {
    #[inline(always)]
    pub fn new(isa: L::Isa, slabs: &Slabs<S>, ray: &Ray<S>) -> Self {
        let splat = |[x, y, z]: [S; 3]| [L::splat(isa, x), L::splat(isa, y), L::splat(isa, z)];
        Self {
            origin: splat(slabs.origin),
            inv_near: splat(slabs.inv_near),
            inv_far: splat(slabs.inv_far),
            negative: slabs.negative,
            // +0, whose bits are those of an integer.
            t_min: slabs.t_min + S::ZERO,
            are_ordered_by_bits: L::orders_by_bits(isa) && (slabs.is_ordinary || is_ordered_by_bits(ray)),
        }
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
        } else if self.t_min < S::ZERO {
            let (near, met) = enter_behind(node, ray, limit);
            // SAFETY: sixteen scalars, and no lanes are more.
            (unsafe { L::load(isa, near.as_ptr()) }, met)
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
        let first = usize::from(self.negative[axis]) * T::ROW;
        // SAFETY: one of three axes, and 0 or a row's length.
        let [first, last] = unsafe { node.planes::<L>(self.origin[0].isa(), axis, first) };
        [first - self.origin[axis], last - self.origin[axis]]
    }
}

/// Whether bits order what the slabs of a ray give that is not ordinary.
#[cold]
#[inline(never)]
fn is_ordered_by_bits<S: Scalar>(ray: &Ray<S>) -> bool {
    Slabs::new(ray).inv_far.iter().all(|inv| inv.is_finite()) && ray.t_min >= S::ZERO && ray.t_max > S::ZERO
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
