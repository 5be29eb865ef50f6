//! What is known to lie ahead on a ray: boxes that are still to be opened, hits that were found in others.

use super::children::next_lane;
use super::{Hit, HitOf, Visitor, accept};
use crate::geometry::PreparedRay;
use crate::primitive::{Found, Intersect, LEAF_WIDTH, Leaf};
use crate::simd::Lanes;
use alloc::collections::BinaryHeap;
use core::cell::Cell;
use core::cmp::Ordering;
use core::mem;
use core::ops::ControlFlow;

/// Boxes by where the ray enters them, and hits by (t, index): a queue for each, since boxes are small and many.
#[doc(hidden)]
pub struct Ahead<P: Intersect, B> {
    /// Of the boxes that came last the nearest, most often the next: it is spared the way through the queue. None of the
    /// others is nearer once [`next_box`](Self::next_box) has answered none.
    at_hand: Option<Queued<P::Scalar, B>>,
    boxes: BinaryHeap<Queued<P::Scalar, B>>,
    hits: HitQueue<P>,
}

type HitQueue<P> = BinaryHeap<Queued<(<P as crate::Primitive>::Scalar, u32), <P as Intersect>::Payload>>;

/// Boxes for which there is room from the start, so that most queues are allocated once.
const ROOM: usize = 32;

impl<P: Intersect, B> Ahead<P, B> {
    /// Before the root is opened; none if the ray does not meet its box.
    pub fn new(root: Option<(B, P::Scalar)>) -> Self {
        let room = if root.is_some() { ROOM } else { 0 };
        let at_hand = root.map(|(value, key)| Queued { key, value });
        Self { at_hand, boxes: BinaryHeap::with_capacity(room), hits: BinaryHeap::new() }
    }

    /// Adds a box.
    #[inline(always)]
    pub fn add(&mut self, place: B, entry: P::Scalar) {
        let mut new = Queued { key: entry, value: place };
        match &mut self.at_hand {
            None => self.at_hand = Some(new),
            Some(at_hand) => {
                if new.key < at_hand.key {
                    mem::swap(at_hand, &mut new);
                }
                self.boxes.push(new);
            }
        }
    }

    /// Whether the first hit is the next one, or there is none: no hit lies before its box (the own-box rule), but a box
    /// that is entered at the hit's t may hold one with a lower index.
    #[inline(always)]
    pub fn is_settled(&self) -> bool {
        self.at_hand.as_ref().is_none_or(|first| self.hits.peek().is_some_and(|hit| hit.key.0 < first.key))
    }

    /// The box to be opened next, unless all is settled.
    #[inline(always)]
    pub fn next_box(&mut self) -> Option<B> {
        match &mut self.at_hand {
            None => self.at_hand = self.boxes.pop(),
            Some(at_hand) => {
                if let Some(mut first) = self.boxes.peek_mut()
                    && first.key < at_hand.key
                {
                    mem::swap(at_hand, &mut *first);
                }
            }
        }
        if self.is_settled() { None } else { self.at_hand.take().map(|first| first.value) }
    }

    /// The first of the hits that were found.
    #[inline(always)]
    pub fn next_hit(&mut self) -> Option<HitOf<P>> {
        let Queued { key: (t, index), value: payload } = self.hits.pop()?;
        Some(Hit { t, index: index as usize, payload })
    }

    /// A visitor that adds all hits up to `limit`.
    #[inline(always)]
    pub(super) fn visitor<'q>(&'q mut self, primitives: &'q [P], limit: P::Scalar) -> All<'q, P> {
        All { primitives, limit, hits: Cell::from_mut(&mut self.hits) }
    }
}

/// Keeps every hit.
pub(super) struct All<'q, P: Intersect> {
    primitives: &'q [P],
    limit: P::Scalar,
    /// In a cell, for visitors are copied.
    hits: &'q Cell<HitQueue<P>>,
}

impl<P: Intersect> Clone for All<'_, P> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Intersect> Copy for All<'_, P> {}

impl<P: Intersect> All<'_, P> {
    #[inline(always)]
    fn add(&self, t: P::Scalar, index: u32, payload: P::Payload) {
        let mut hits = self.hits.take();
        hits.push(Queued { key: (t, index), value: payload });
        self.hits.set(hits);
    }
}

impl<P: Intersect> Visitor<P> for All<'_, P> {
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
        if let Some((t, payload)) = accept(&self.primitives[index as usize], ray, self.limit) {
            self.add(t, index, payload);
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
            let details = found.details.map(
                #[inline(always)]
                |detail| detail.lane(lane),
            );
            if let Some(payload) = <P::Leaf as Leaf<_, _>>::payload(details) {
                self.add(found.t.lane(lane), indices[lane], payload);
            }
        }
        ControlFlow::Continue(())
    }
}

/// What waits with its place in the queue: the smallest key comes first. No key holds a NaN.
struct Queued<K, T> {
    key: K,
    value: T,
}

impl<K: PartialOrd, T> Ord for Queued<K, T> {
    /// The other way round, since the queue takes out what is greatest. By `<` alone: with `partial_cmp` to take all hits takes
    /// about a tenth longer.
    #[inline(always)]
    fn cmp(&self, other: &Self) -> Ordering {
        if self.key < other.key {
            Ordering::Greater
        } else if other.key < self.key {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }
}

impl<K: PartialOrd, T> PartialOrd for Queued<K, T> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: PartialOrd, T> PartialEq for Queued<K, T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<K: PartialOrd, T> Eq for Queued<K, T> {}
