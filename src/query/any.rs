//! Any hit: whether a ray hits anything at all.

use super::each::each;
use crate::primitive::{Intersect, accept};
use crate::traverse::{LeafTest, LeafView, RayState};
use core::ops::ControlFlow;

/// The leaf test of any hit, which stops at the first one.
pub(super) struct AnyTest<'a, P> {
    pub primitives: &'a [P],
    pub is_hit: bool,
}

impl<P: Intersect> LeafTest<P::Scalar> for AnyTest<'_, P> {
    fn test(&mut self, leaf: LeafView<'_, P::Scalar>, ray: &mut RayState<P::Scalar>) -> ControlFlow<()> {
        each(self.primitives, leaf, ray, |primitive, _, ray| {
            if accept(primitive, &ray.ray, &ray.slabs).is_some() {
                self.is_hit = true;
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
    }
}
