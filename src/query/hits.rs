//! All hits along a ray, in order, found on demand.

use super::each::each;
use super::{Hit, HitOf, Traverse};
use crate::geometry::{Ray, Slabs};
use crate::leaf::sealed::LeafKind;
use crate::primitive::{Intersect, accept};
use crate::simd::Backend;
use crate::traverse::{BestFirst, Details, LeafTest, LeafView, QueuedHit, RayState, Recorder};
use alloc::vec::Vec;
use core::ops::ControlFlow;

/// An iterator over the hits of a ray by increasing (t, index).
///
/// The search is best-first. It has two queues: boxes by the t at which the ray enters them, and
/// hits by their t. It opens the nearest box until the first hit is before all boxes. That hit is
/// the next one, since no hit is before its box (the own-box rule). So the first hit opens no more
/// boxes than the closest hit does, and each further hit opens only the boxes that it takes to be
/// sure. Nodes and leaves are tested as in the other queries: all children or primitives at once.
///
/// The iterator allocates, unlike the closest hit: there may be any number of boxes ahead.
///
/// Made by [`Bvh::hits`](crate::Bvh::hits).
pub struct Hits<'a, P: Intersect, L: Traverse<P>, R = ()> {
    layout: &'a L,
    backend: Backend,
    ray: Ray<P::Scalar>,
    ahead: BestFirst<P::Scalar, L::Place>,
    leaf_test: AllTest<'a, P>,
    /// The last answer.
    ///
    /// A primitive in several leaves is met again, but is an answer once.
    last: Option<(P::Scalar, u32)>,
    recorder: R,
}

impl<'a, P: Intersect, L: Traverse<P>, R: Recorder> Hits<'a, P, L, R> {
    pub(crate) fn new(
        layout: &'a L,
        backend: Backend,
        primitives: &'a [P],
        ray: &Ray<P::Scalar>,
        mut recorder: R,
    ) -> Self {
        let mut root = None;
        if ray.is_valid() {
            recorder.ray();
            let entry = Slabs::new(ray).entry(&layout.aabb()).filter(|&entry| entry <= ray.t_max);
            root = layout.root().zip(entry);
        }
        let (ahead, leaf_test) = (BestFirst::new(root), AllTest { primitives, payloads: Vec::new() });
        Self { layout, backend, ray: *ray, ahead, leaf_test, last: None, recorder }
    }
}

impl<P: Intersect, L: Traverse<P>, R: Recorder> Iterator for Hits<'_, P, L, R> {
    type Item = HitOf<P>;

    #[inline]
    fn next(&mut self) -> Option<HitOf<P>> {
        loop {
            if !self.ahead.is_settled() {
                let Self { layout, ray, ahead, leaf_test, recorder, .. } = self;
                let steps = layout.open_ahead(self.backend, ray, ahead, leaf_test);
                if recorder.records() {
                    steps.tell(recorder);
                }
            }
            let (t, index, details) = self.ahead.next_hit()?;
            if self.last.is_none_or(|last| last < (t, index)) {
                self.last = Some((t, index));
                let payload = match details {
                    Details::OfLane(details) => {
                        <P::Leaf as LeafKind<P::Scalar, P::Payload>>::payload(details)?
                    }
                    Details::Kept(number) => self.leaf_test.payloads[number as usize],
                };
                return Some(Hit { t, index: index as usize, payload });
            }
        }
    }
}

impl<P: Intersect, L: Traverse<P>, R: Recorder> core::iter::FusedIterator for Hits<'_, P, L, R> {}

/// The leaf test of all hits, which keeps their payloads.
#[doc(hidden)]
pub struct AllTest<'a, P: Intersect> {
    pub(super) primitives: &'a [P],
    payloads: Vec<P::Payload>,
}

impl<P: Intersect> LeafTest<P::Scalar> for AllTest<'_, P> {
    fn test(&mut self, leaf: LeafView<'_, P::Scalar>, ray: &mut RayState<P::Scalar>) -> ControlFlow<()> {
        each(self.primitives, leaf, ray, |primitive, index, ray| {
            if let Some((t, payload)) = accept(primitive, &ray.ray, &ray.slabs) {
                ray.hits.push(QueuedHit::new(t, index, Details::Kept(self.payloads.len() as u32)));
                self.payloads.push(payload);
            }
            ControlFlow::Continue(())
        })
    }
}
