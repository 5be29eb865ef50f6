//! The traversal stack of the wide trees: children that were met and deferred.

use crate::layout::{MAX_STACK, Reference};
use crate::simd::Window;
use core::mem::MaybeUninit;

/// The capacity, with room for all lanes of one more node.
///
/// Some of these lanes are written and not kept.
const CAPACITY: usize = MAX_STACK + 16;

/// Memory for [`TraversalStack`], on the thread's stack and not cleared.
///
/// For `f32` it is smaller than a page: with more, every query would first touch it page by page.
pub(super) struct Memory<S> {
    references: [MaybeUninit<Reference>; CAPACITY],
    entries: [MaybeUninit<S>; CAPACITY],
}

impl<S: Copy> Memory<S> {
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            references: [const { MaybeUninit::uninit() }; CAPACITY],
            entries: [const { MaybeUninit::uninit() }; CAPACITY],
        }
    }
}

/// A stack of references, each with the t at which the ray enters its box.
pub(super) struct TraversalStack<'m, S> {
    memory: &'m mut Memory<S>,
    /// The number of references on the stack.
    ///
    /// `references[..len]` are initialised, and so are `entries[..len]` if the query is in order.
    len: usize,
}

impl<'m, S: Copy + PartialOrd> TraversalStack<'m, S> {
    #[inline(always)]
    pub fn new(memory: &'m mut Memory<S>) -> Self {
        Self { memory, len: 0 }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub fn push(&mut self, reference: Reference, entry: S) {
        debug_assert!(self.len < CAPACITY);
        // SAFETY: the path to a node defers at most `MAX_STACK` children, since
        // `layout::collapse` builds no other tree, and the node at most 15 more: `CAPACITY` has
        // room for both.
        unsafe {
            self.memory.references.get_unchecked_mut(self.len).write(reference);
            self.memory.entries.get_unchecked_mut(self.len).write(entry);
        }
        self.len += 1;
    }

    /// Returns space for all lanes of one node above the top.
    ///
    /// `grow` then keeps some of them.
    #[inline(always)]
    pub fn windows(&mut self) -> (&mut Window<Reference>, &mut Window<S>) {
        debug_assert!(self.len <= MAX_STACK);
        // SAFETY: `len` is what the path to a node defers, at most `MAX_STACK`, since
        // `layout::collapse` builds no other tree. So 16 more are inside of the memory.
        unsafe {
            (
                &mut *self.memory.references.as_mut_ptr().add(self.len).cast(),
                &mut *self.memory.entries.as_mut_ptr().add(self.len).cast(),
            )
        }
    }

    /// Keeps the first `count` of the windows, which have been written.
    #[inline(always)]
    pub fn grow(&mut self, count: usize) {
        self.len += count;
    }

    /// Moves the top down below the nearer ones, but not below `base`.
    ///
    /// So the farthest is the lowest.
    #[inline(always)]
    pub fn sink(&mut self, base: usize) {
        let (references, entries) = (&mut self.memory.references, &mut self.memory.entries);
        let mut place = self.len - 1;
        // SAFETY: `push` has initialised the references and entries from `base` to `len`.
        while place > base && unsafe { entries[place - 1].assume_init() < entries[place].assume_init() } {
            references.swap(place - 1, place);
            entries.swap(place - 1, place);
            place -= 1;
        }
    }

    /// Takes the top off the stack.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<Reference> {
        let top = self.top()?;
        self.len -= 1;
        Some(top)
    }

    /// Returns the reference that [`pop`](Self::pop) would take.
    #[inline(always)]
    pub fn top(&self) -> Option<Reference> {
        let place = self.len.checked_sub(1)?;
        // SAFETY: it is below `len`, so it is initialised.
        Some(unsafe { self.memory.references.get_unchecked(place).assume_init() })
    }

    /// Takes the last one that begins at or before `limit`, and drops those above it.
    #[inline(always)]
    pub fn pop_before(&mut self, limit: S) -> Option<Reference> {
        loop {
            let reference = self.pop()?;
            // SAFETY: it was below `len` before `pop`, and entries below `len` are initialised in
            // queries in order, which alone call this.
            let entry = unsafe { self.memory.entries.get_unchecked(self.len).assume_init() };
            if entry <= limit {
                return Some(reference);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_sinks_and_what_is_beyond_the_limit_is_dropped() {
        let place = |k: usize| Reference::node(k * 64);
        let mut memory = Memory::new();
        let mut stack = TraversalStack::<f32>::new(&mut memory);
        stack.push(place(0), 1.0);
        for (k, entry) in [(1, 3.0), (2, 5.0), (3, 4.0)] {
            stack.push(place(k), entry);
            stack.sink(1);
        }
        assert_eq!(stack.pop_before(3.5), Some(place(1)));
        assert_eq!(stack.pop(), Some(place(3)));
        assert_eq!(stack.pop_before(0.5), None);
        assert_eq!(stack.pop(), None);
    }
}
