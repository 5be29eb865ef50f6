//! The first hit along a ray.

use super::counters::Recorder;
use super::traverse::{Visitor, traverse};
use super::{Hit, HitOf, Scene, accept, precedes};
use crate::geometry::{PreparedRay, Ray};
use crate::primitive::{Intersect, Primitive};
use core::ops::{ControlFlow, Range};

pub(crate) fn closest_hit<P: Intersect>(
    scene: Scene<'_, P>,
    ray: &Ray<P::Scalar>,
    recorder: &mut impl Recorder,
) -> Option<HitOf<P>> {
    if !ray.is_valid() {
        return None;
    }
    recorder.ray();
    let ray = ray.prepare();
    let mut closest = Closest { scene, ray: &ray, limit: ray.t_max, best: None };
    traverse(scene.tree, &ray.slabs, &mut closest, recorder);
    closest.best.map(|(index, payload)| Hit { t: closest.limit, index: index as usize, payload })
}

/// Keeps the smallest (t, index) seen; its t is the limit.
struct Closest<'a, P: Intersect> {
    scene: Scene<'a, P>,
    ray: &'a PreparedRay<P::Scalar>,
    limit: P::Scalar,
    best: Option<(u32, P::Payload)>,
}

impl<P: Intersect> Visitor<P::Scalar> for Closest<'_, P> {
    #[inline(always)]
    fn limit(&self) -> <P as Primitive>::Scalar {
        self.limit
    }

    #[inline(always)]
    fn leaf(&mut self, slots: Range<usize>, recorder: &mut impl Recorder) -> ControlFlow<()> {
        let indices = &self.scene.tree.indices[slots.clone()];
        for (primitive, &index) in self.scene.primitives[slots].iter().zip(indices) {
            recorder.primitive();
            if let Some((t, payload)) = accept(primitive, self.ray, self.limit)
                && self.best.is_none_or(|(best, _)| precedes(t, index, self.limit, best))
            {
                self.limit = t;
                self.best = Some((index, payload));
            }
        }
        ControlFlow::Continue(())
    }
}
