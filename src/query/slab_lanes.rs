//! The boxes of a wide node's children, tested all at once.

use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::WideNode;
use crate::simd::Lanes;

/// The slabs in lanes.
pub(super) struct SlabLanes<S, L> {
    origin: [L; 3],
    inv_near: [L; 3],
    inv_far: [L; 3],
    /// Where in a node the near planes of each axis lie, in bytes.
    first: [usize; 3],
    /// Where the far planes do.
    last: [usize; 3],
    pub t_min: S,
}

impl<S: Scalar, L: Lanes<S>> SlabLanes<S, L> {
    #[inline(always)]
    pub fn new<T: WideNode<S, N>, const N: usize>(isa: L::Isa, slabs: &Slabs<S>) -> Self {
        let splat = |[x, y, z]: [S; 3]| [L::splat(isa, x), L::splat(isa, y), L::splat(isa, z)];
        let [x, y, z] = slabs.negative;
        let row = |axis: usize, is_max: bool| (2 * axis + usize::from(is_max)) * T::ROW;
        Self {
            origin: splat(slabs.origin),
            inv_near: splat(slabs.inv_near),
            inv_far: splat(slabs.inv_far),
            first: [row(0, x), row(1, y), row(2, z)],
            last: [row(0, !x), row(1, !y), row(2, !z)],
            // +0, whose bits are those of an integer.
            t_min: slabs.t_min + S::ZERO,
        }
    }

    /// Where the ray enters the children's boxes, from t_min on, and which of them it meets up to `limit`.
    #[inline(always)]
    pub fn enter<const N: usize>(&self, node: &impl WideNode<S, N>, ray: &Ray<S>, limit: S) -> (L, u32) {
        if self.t_min < S::ZERO {
            let (near, met) = enter_behind(node, ray, limit);
            // SAFETY: sixteen scalars, and no lanes are more.
            (unsafe { L::load(self.origin[0].isa(), near.as_ptr()) }, met)
        } else {
            self.enter_ahead(node, limit)
        }
    }

    /// The same for a ray that does not look behind its origin.
    #[inline(always)]
    fn enter_ahead<const N: usize>(&self, node: &impl WideNode<S, N>, limit: S) -> (L, u32) {
        let isa = self.origin[0].isa();
        let (mut near, mut far) = (L::splat(isa, self.t_min), L::splat(isa, limit));
        for axis in 0..3 {
            // SAFETY: the places of `new`.
            let [first, last] = unsafe { node.planes::<L>(isa, axis, [self.first[axis], self.last[axis]]) };
            let (first, last) = (first - self.origin[axis], last - self.origin[axis]);
            let (inv_near, inv_far) = (self.inv_near[axis], self.inv_far[axis]);
            near = (first * inv_near).max(near);
            far = (last * inv_far).min(far);
        }
        (near, L::bits(near.le(far)) & node.lanes())
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
