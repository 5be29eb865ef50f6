//! The closest hit along a ray.

use super::each::each;
use super::{Hit, HitOf};
use crate::layout::NO_PRIMITIVE;
use crate::leaf::sealed::LeafKind;
use crate::primitive::{Intersect, accept};
use crate::traverse::{Found, LeafTest, LeafView, RayState};
use core::ops::ControlFlow;

/// The leaf test of the closest hit.
///
/// It keeps the payload of the closest hit so far, and narrows the ray to that hit.
pub(super) struct ClosestTest<'a, P: Intersect> {
    pub primitives: &'a [P],
    pub payload: Option<P::Payload>,
}

impl<P: Intersect> LeafTest<P::Scalar> for ClosestTest<'_, P> {
    fn test(&mut self, leaf: LeafView<'_, P::Scalar>, ray: &mut RayState<P::Scalar>) -> ControlFlow<()> {
        each(self.primitives, leaf, ray, |primitive, index, ray| {
            if let Some((t, payload)) = accept(primitive, &ray.ray, &ray.slabs)
                && ray.is_closer(t, index)
            {
                (ray.ray.t_max, ray.index) = (t, index);
                self.payload = Some(payload);
            }
            ControlFlow::Continue(())
        })
    }
}

impl<P: Intersect> ClosestTest<'_, P> {
    /// Returns the hit that was found, once the ray is at its end.
    #[inline(always)]
    pub fn hit(self, ray: &RayState<P::Scalar>) -> Option<HitOf<P>> {
        self.payload.map(|payload| Hit { t: ray.ray.t_max, index: ray.index as usize, payload })
    }
}

/// Returns the hit that a kernel found in lanes, if there is one.
#[inline(always)]
pub(super) fn hit_of<P: Intersect>(found: &Found<P::Scalar>) -> Option<HitOf<P>> {
    let &Found { t, index, details } = found;
    if index == NO_PRIMITIVE {
        return None;
    }
    <P::Leaf as LeafKind<P::Scalar, P::Payload>>::payload(details).map(|payload| Hit {
        t,
        index: index as usize,
        payload,
    })
}
