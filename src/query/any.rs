//! Whether anything is hit at all.

use super::each::each;
use crate::primitive::{Intersect, accept};
use crate::traverse::{Ask, AskedLeaf, AskedRay};
use core::ops::ControlFlow;

/// Stops at the first hit.
pub(super) struct AskAny<'a, P> {
    pub primitives: &'a [P],
    pub is_hit: bool,
}

impl<P: Intersect> Ask<P::Scalar> for AskAny<'_, P> {
    fn ask(&mut self, leaf: AskedLeaf<'_, P::Scalar>, ray: &mut AskedRay<P::Scalar>) -> ControlFlow<()> {
        each(self.primitives, leaf, ray, |primitive, _, ray| {
            if accept(primitive, &ray.ray, &ray.slabs).is_some() {
                self.is_hit = true;
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
    }
}
