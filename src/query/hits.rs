//! All hits along a ray, in order, found as they are asked for.

use super::counters::Recorder;
use super::traverse::enter_children;
use super::{Hit, HitOf, Scene, accept};
use crate::geometry::{PreparedRay, Ray, Scalar};
use crate::primitive::Intersect;
use crate::tree::Child;
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
pub struct Hits<'a, P: Intersect, R = ()> {
    scene: Scene<'a, P>,
    ray: PreparedRay<P::Scalar>,
    queue: BinaryHeap<Event<P::Scalar, P::Payload>>,
    recorder: R,
}

/// Something that lies ahead on the ray.
struct Event<S, T> {
    t: S,
    what: What<T>,
}

enum What<T> {
    Box(Child),
    Hit { index: u32, payload: T },
}

impl<'a, P: Intersect, R: Recorder> Hits<'a, P, R> {
    pub(crate) fn new(scene: Scene<'a, P>, ray: &Ray<P::Scalar>, mut recorder: R) -> Self {
        let mut queue = BinaryHeap::new();
        let ray = ray.prepare();
        if ray.is_valid() {
            recorder.ray();
            if let Some(root) = scene.tree.root()
                && let Some(t) = ray.slabs.entry(&scene.tree.aabb).filter(|&t| t <= ray.t_max)
            {
                queue.push(Event { t, what: What::Box(root) });
            }
        }
        Self { scene, ray, queue, recorder }
    }

    /// Puts what is in a box into the queue.
    fn open(&mut self, child: Child) {
        let limit = self.ray.t_max;
        if child.is_leaf() {
            self.recorder.leaf();
            for slot in child.slots() {
                self.recorder.primitive();
                if let Some((t, payload)) = accept(&self.scene.primitives[slot], &self.ray, limit) {
                    let index = self.scene.tree.indices[slot];
                    self.queue.push(Event { t, what: What::Hit { index, payload } });
                }
            }
        } else {
            self.recorder.node();
            let node = &self.scene.tree.nodes[child.first as usize];
            let (entries, met) = enter_children(node, &self.ray.slabs, limit);
            for side in 0..2 {
                if met[side] {
                    self.queue.push(Event { t: entries[side], what: What::Box(node.children[side]) });
                }
            }
        }
    }
}

impl<P: Intersect, R: Recorder> Iterator for Hits<'_, P, R> {
    type Item = HitOf<P>;

    fn next(&mut self) -> Option<HitOf<P>> {
        loop {
            let Event { t, what } = self.queue.pop()?;
            match what {
                What::Box(child) => self.open(child),
                What::Hit { index, payload } => return Some(Hit { t, index: index as usize, payload }),
            }
        }
    }
}

impl<P: Intersect, R: Recorder> core::iter::FusedIterator for Hits<'_, P, R> {}

impl<S: Scalar, T> Ord for Event<S, T> {
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

impl<S: Scalar, T> PartialOrd for Event<S, T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<S: Scalar, T> PartialEq for Event<S, T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<S: Scalar, T> Eq for Event<S, T> {}
