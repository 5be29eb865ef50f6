//! All hits along a ray, in order, found as they are asked for.

use super::ahead::Ahead;
use super::counters::Recorder;
use super::{HitOf, Traverse};
use crate::geometry::{PreparedRay, Ray};
use crate::primitive::Intersect;
use crate::simd::{Backend, Kernel};
use fearless_simd::Simd;

/// An iterator over the hits of a ray by increasing (t, index).
///
/// Two queues hold what is known of the ray: boxes by where the ray enters them, hits by their t. The nearest box is opened
/// until none lies before the first hit, which is the next one then: no hit lies before its box (the own-box rule). So the
/// first hit opens no more than the closest one does, and each that follows only what it takes to be sure of it. Nodes
/// and leaves are tested as by the other queries, all children or primitives at once.
///
/// It allocates, where the closest hit does not: no number of boxes is too many to lie ahead.
///
/// From [`Bvh::hits`](crate::Bvh::hits).
pub struct Hits<'a, P: Intersect, L: Traverse<P>, R = ()> {
    layout: &'a L,
    backend: Backend,
    primitives: &'a [P],
    ray: PreparedRay<P::Scalar>,
    ahead: Ahead<P, L::Place>,
    /// The last answer: a primitive that is in several leaves is met again, but is an answer once.
    last: Option<(P::Scalar, usize)>,
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
        let ray = ray.prepare();
        let mut root = None;
        if ray.is_valid() {
            recorder.ray();
            let entry = ray.slabs.entry(&layout.aabb()).filter(|&entry| entry <= ray.t_max);
            root = layout.root().zip(entry);
        }
        let ahead = Ahead::new(root);
        Self { layout, backend, primitives, ray, ahead, last: None, recorder }
    }
}

impl<P: Intersect, L: Traverse<P>, R: Recorder> Iterator for Hits<'_, P, L, R> {
    type Item = HitOf<P>;

    #[inline]
    fn next(&mut self) -> Option<HitOf<P>> {
        loop {
            if !self.ahead.is_settled() {
                let Self { layout, primitives, ray, ahead, recorder, .. } = self;
                self.backend.run(Open { layout: *layout, primitives, ray, ahead, recorder });
            }
            let hit = self.ahead.next_hit()?;
            if self.last.is_none_or(|last| last < (hit.t, hit.index)) {
                self.last = Some((hit.t, hit.index));
                return Some(hit);
            }
        }
    }
}

impl<P: Intersect, L: Traverse<P>, R: Recorder> core::iter::FusedIterator for Hits<'_, P, L, R> {}

/// Boxes are opened until the next hit is known.
struct Open<'q, P: Intersect, L: Traverse<P>, R> {
    layout: &'q L,
    primitives: &'q [P],
    ray: &'q PreparedRay<P::Scalar>,
    ahead: &'q mut Ahead<P, L::Place>,
    recorder: &'q mut R,
}

impl<P: Intersect, L: Traverse<P>, R: Recorder> Kernel for Open<'_, P, L, R> {
    const IS_WIDE: bool = L::IS_WIDE;
    type Output = ();

    #[inline(always)]
    fn run<I: Simd>(self, isa: I) {
        let Self { layout, primitives, ray, ahead, recorder } = self;
        layout.open_ahead(isa, ray, primitives, ahead, recorder);
    }
}
