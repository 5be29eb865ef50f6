//! All hits along a ray, in order, found as they are asked for.

use super::counters::Recorder;
use super::{Hit, HitOf, accept};
use crate::geometry::{PreparedRay, Ray, Scalar};
use crate::layout::{Layout, Part};
use crate::primitive::Intersect;
use alloc::collections::BinaryHeap;
use core::cmp::Ordering;

/// An iterator over the hits of a ray by increasing (t, index).
///
/// A queue holds what is known of the ray: boxes by where the ray enters them, hits by their t.
/// The front of the queue, if it is a box, is opened, and if it is a hit, is next: nothing behind
/// the front can come before it, since no hit lies before its box (the own-box rule). So the first
/// hits cost little more than the closest one.
///
/// From [`Bvh::hits`](crate::Bvh::hits).
pub struct Hits<'a, P: Intersect, L: Layout<P>, R = ()> {
    layout: &'a L,
    primitives: &'a [P],
    ray: PreparedRay<P::Scalar>,
    queue: BinaryHeap<Event<P::Scalar, P::Payload, L::Place>>,
    /// The last answer: a primitive that is in several leaves is met again, but is an answer once.
    last: Option<(P::Scalar, u32)>,
    recorder: R,
}

/// Something that lies ahead on the ray.
struct Event<S, T, B> {
    t: S,
    what: What<T, B>,
}

enum What<T, B> {
    Box(B),
    Hit { index: u32, payload: T },
}

impl<'a, P: Intersect, L: Layout<P>, R: Recorder> Hits<'a, P, L, R> {
    pub(crate) fn new(layout: &'a L, primitives: &'a [P], ray: &Ray<P::Scalar>, mut recorder: R) -> Self {
        let mut queue = BinaryHeap::new();
        let ray = ray.prepare();
        if ray.is_valid() {
            recorder.ray();
            if let Some(root) = layout.root()
                && let Some(t) = ray.slabs.entry(&layout.aabb()).filter(|&t| t <= ray.t_max)
            {
                queue.push(Event { t, what: What::Box(root) });
            }
        }
        Self { layout, primitives, ray, queue, last: None, recorder }
    }

    /// Puts what is in a box into the queue.
    fn open(&mut self, place: L::Place) {
        let Self { layout, primitives, ray, queue, recorder, .. } = self;
        let mut is_leaf = false;
        layout.open(place, |part| match part {
            Part::Child(aabb, place) => {
                if let Some(t) = ray.slabs.entry(&aabb).filter(|&t| t <= ray.t_max) {
                    queue.push(Event { t, what: What::Box(place) });
                }
            }
            Part::Primitive(index) => {
                is_leaf = true;
                recorder.primitive();
                if let Some((t, payload)) = accept(&primitives[index as usize], ray, ray.t_max) {
                    queue.push(Event { t, what: What::Hit { index, payload } });
                }
            }
        });
        if is_leaf { recorder.leaf() } else { recorder.node() }
    }
}

impl<P: Intersect, L: Layout<P>, R: Recorder> Iterator for Hits<'_, P, L, R> {
    type Item = HitOf<P>;

    fn next(&mut self) -> Option<HitOf<P>> {
        loop {
            let Event { t, what } = self.queue.pop()?;
            match what {
                What::Box(place) => self.open(place),
                What::Hit { index, payload } => {
                    if self.last.is_none_or(|last| last < (t, index)) {
                        self.last = Some((t, index));
                        return Some(Hit { t, index: index as usize, payload });
                    }
                }
            }
        }
    }
}

impl<P: Intersect, L: Layout<P>, R: Recorder> core::iter::FusedIterator for Hits<'_, P, L, R> {}

impl<S: Scalar, T, B> Ord for Event<S, T, B> {
    /// The heap's greatest is the first along the ray: a box before a hit at the same t, which may
    /// hold one with a lower index. No t is NaN, nor is a hit's -0; a box's entry may be, and no
    /// matter.
    fn cmp(&self, other: &Self) -> Ordering {
        other.t.total_cmp(&self.t).then_with(|| match (&self.what, &other.what) {
            (What::Hit { index: a, .. }, What::Hit { index: b, .. }) => b.cmp(a),
            (What::Box(_), What::Hit { .. }) => Ordering::Greater,
            (What::Hit { .. }, What::Box(_)) => Ordering::Less,
            (What::Box(_), What::Box(_)) => Ordering::Equal,
        })
    }
}

impl<S: Scalar, T, B> PartialOrd for Event<S, T, B> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<S: Scalar, T, B> PartialEq for Event<S, T, B> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<S: Scalar, T, B> Eq for Event<S, T, B> {}
