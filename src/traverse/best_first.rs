//! The queues of best-first search: boxes still to be opened, and hits found.

use crate::geometry::Scalar;
use alloc::collections::BinaryHeap;
use core::cmp::Ordering;
use core::mem;

/// Two queues: boxes by where the ray enters them, and hits by (t, index).
///
/// There is one for each, since boxes are small and many.
pub struct BestFirst<S, B> {
    /// The nearest of the boxes that were added since it was last taken.
    ///
    /// It is most often the next one, and so it is spared the way through the queue. Once
    /// [`next_box`](Self::next_box) has returned `None`, no other box is nearer.
    at_hand: Option<Queued<S, B>>,
    boxes: BinaryHeap<Queued<S, B>>,
    pub(super) hits: HitQueue<S>,
}

/// Hits, the first on top.
pub type HitQueue<S> = BinaryHeap<QueuedHit<S>>;

/// A hit by (t, index), with the details from which its payload is made.
pub type QueuedHit<S> = Queued<(S, u32), Details<S>>;

/// The source of a hit's payload.
#[derive(Clone, Copy)]
pub enum Details<S> {
    /// The details that the leaf's lane test has computed.
    OfLane([S; 3]),
    /// The number of the payload in the list of the leaf test that met the primitive.
    Kept(u32),
}

impl<S: Scalar> QueuedHit<S> {
    #[inline(always)]
    pub fn new(t: S, index: u32, details: Details<S>) -> Self {
        Self { key: (t, index), value: details }
    }
}

/// Initial capacity for boxes, so that most queues are allocated once.
const ROOM: usize = 32;

impl<S: Scalar, B> BestFirst<S, B> {
    /// Returns the queues before the root is opened.
    ///
    /// `root` is `None` if the ray misses the root's box.
    pub fn new(root: Option<(B, S)>) -> Self {
        let room = if root.is_some() { ROOM } else { 0 };
        let at_hand = root.map(|(value, key)| Queued { key, value });
        Self { at_hand, boxes: BinaryHeap::with_capacity(room), hits: HitQueue::new() }
    }

    /// Adds a box, and where the ray enters it.
    #[inline(always)]
    pub fn add(&mut self, place: B, entry: S) {
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

    /// Whether the first hit is the next one, or there is none.
    ///
    /// No hit is before the entry of its box (the own-box rule). But a box that is entered at the
    /// hit's t may hold a hit with the same t and a lower index.
    #[inline(always)]
    pub fn is_settled(&self) -> bool {
        self.at_hand.as_ref().is_none_or(|first| self.hits.peek().is_some_and(|hit| hit.key.0 < first.key))
    }

    /// Returns the box to be opened next, unless all is settled.
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

    /// Takes the first of the hits that were found.
    #[inline(always)]
    pub fn next_hit(&mut self) -> Option<(S, u32, Details<S>)> {
        let Queued { key: (t, index), value } = self.hits.pop()?;
        Some((t, index, value))
    }
}

/// An entry of a queue: the smallest key comes first. No key holds a NaN.
pub struct Queued<K, T> {
    key: K,
    value: T,
}

impl<K: PartialOrd, T> Ord for Queued<K, T> {
    /// Compares in reverse, since the heap takes out the greatest.
    ///
    /// It uses `<` alone: with `partial_cmp` a query for all hits takes about a tenth longer.
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
