//! Whether anything is hit at all.

use super::counters::Recorder;
use super::traverse::{Visitor, traverse};
use super::{Scene, accept};
use crate::geometry::{PreparedRay, Ray};
use crate::primitive::{Intersect, Primitive};
use core::ops::{ControlFlow, Range};

pub(crate) fn any_hit<P: Intersect>(
    scene: Scene<'_, P>,
    ray: &Ray<P::Scalar>,
    recorder: &mut impl Recorder,
) -> bool {
    if !ray.is_valid() {
        return false;
    }
    recorder.ray();
    let ray = ray.prepare();
    let mut any = Any { scene, ray: &ray, found: false };
    traverse(scene.tree, &ray.slabs, &mut any, recorder);
    any.found
}

/// Stops at the first hit accepted.
struct Any<'a, P: Intersect> {
    scene: Scene<'a, P>,
    ray: &'a PreparedRay<P::Scalar>,
    found: bool,
}

impl<P: Intersect> Visitor<P::Scalar> for Any<'_, P> {
    #[inline(always)]
    fn limit(&self) -> <P as Primitive>::Scalar {
        self.ray.t_max
    }

    #[inline(always)]
    fn leaf(&mut self, slots: Range<usize>, recorder: &mut impl Recorder) -> ControlFlow<()> {
        for primitive in &self.scene.primitives[slots] {
            recorder.primitive();
            if accept(primitive, self.ray, self.ray.t_max).is_some() {
                self.found = true;
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}
