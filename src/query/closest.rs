//! The first hit along a ray.

use super::ask::Question;
use super::children::next_lane;
use super::{Hit, HitOf, Visitor, accept, precedes};
use crate::geometry::{PreparedRay, Ray};
use crate::primitive::{Found, Intersect, LEAF_WIDTH, Leaf};
use crate::simd::Lanes;
use core::ops::ControlFlow;

/// Keeps the smallest (t, index) seen; its t is the limit.
pub(crate) struct Closest<'a, P: Intersect> {
    primitives: &'a [P],
    limit: P::Scalar,
    best: Option<(u32, P::Payload)>,
}

impl<P: Intersect> Clone for Closest<'_, P> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Intersect> Copy for Closest<'_, P> {}

impl<'a, P: Intersect> Question<'a, P> for Closest<'a, P> {
    type Answer = Option<HitOf<P>>;
    const NONE: Option<HitOf<P>> = None;

    #[inline(always)]
    fn new(primitives: &'a [P], ray: &Ray<P::Scalar>) -> Self {
        Self { primitives, limit: ray.t_max, best: None }
    }

    #[inline(always)]
    fn answer(&self) -> Option<HitOf<P>> {
        self.best.map(|(index, payload)| Hit { t: self.limit, index: index as usize, payload })
    }
}

impl<P: Intersect> Closest<'_, P> {
    #[inline(always)]
    fn is_first(&self, t: P::Scalar, index: u32) -> bool {
        match self.best {
            Some((best, _)) => precedes(t, index, self.limit, best),
            None => t <= self.limit,
        }
    }
}

impl<P: Intersect> Visitor<P> for Closest<'_, P> {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn primitives(&self) -> &[P] {
        self.primitives
    }

    #[inline(always)]
    fn limit(&self) -> P::Scalar {
        self.limit
    }

    #[inline(always)]
    fn primitive(&mut self, index: u32, ray: &PreparedRay<P::Scalar>) -> ControlFlow<()> {
        if let Some((t, payload)) = accept(&self.primitives[index as usize], ray, self.limit)
            && self.is_first(t, index)
        {
            self.limit = t;
            self.best = Some((index, payload));
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn found<L: Lanes<P::Scalar>>(
        &mut self,
        found: &Found<P::Scalar, L>,
        indices: &[u32; LEAF_WIDTH],
    ) -> ControlFlow<()> {
        let mut lanes = found.sure;
        while lanes != 0 {
            let lane = next_lane(&mut lanes) % LEAF_WIDTH;
            let (t, index) = (found.t.lane(lane), indices[lane]);
            if self.is_first(t, index) {
                let [a, b, c] = found.details;
                let details = [a.lane(lane), b.lane(lane), c.lane(lane)];
                if let Some(payload) = <P::Leaf as Leaf<_, _>>::payload(details) {
                    self.limit = t;
                    self.best = Some((index, payload));
                }
            }
        }
        ControlFlow::Continue(())
    }
}
