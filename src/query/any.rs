//! Whether anything is hit at all.

use super::ask::Question;
use super::{Visitor, accept};
use crate::geometry::{PreparedRay, Ray};
use crate::primitive::{Found, Intersect, LEAF_WIDTH};
use crate::simd::Lanes;
use core::ops::ControlFlow;

/// Stops at the first hit accepted.
pub(crate) struct Any<'a, P: Intersect> {
    primitives: &'a [P],
    t_max: P::Scalar,
    found: bool,
}

impl<P: Intersect> Clone for Any<'_, P> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Intersect> Copy for Any<'_, P> {}

impl<'a, P: Intersect> Question<'a, P> for Any<'a, P> {
    type Answer = bool;
    const NONE: bool = false;

    #[inline(always)]
    fn new(primitives: &'a [P], ray: &Ray<P::Scalar>) -> Self {
        Self { primitives, t_max: ray.t_max, found: false }
    }

    #[inline(always)]
    fn answer(&self) -> bool {
        self.found
    }
}

impl<P: Intersect> Visitor<P> for Any<'_, P> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn primitives(&self) -> &[P] {
        self.primitives
    }

    #[inline(always)]
    fn limit(&self) -> P::Scalar {
        self.t_max
    }

    #[inline(always)]
    fn primitive(&mut self, index: u32, ray: &PreparedRay<P::Scalar>) -> ControlFlow<()> {
        if accept(&self.primitives[index as usize], ray, self.t_max).is_some() {
            self.found = true;
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn found<L: Lanes<P::Scalar>>(
        &mut self,
        found: &Found<P::Scalar, L>,
        _: &[u32; LEAF_WIDTH],
    ) -> ControlFlow<()> {
        if found.sure != 0 {
            self.found = true;
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}
