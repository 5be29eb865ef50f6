//! The node arena: nodes and leaves of different sizes, in line-aligned memory.

use crate::memory::Word;
use crate::parallel;
use crate::simd::prefetch;
use alloc::vec::Vec;
use core::mem::MaybeUninit;
use core::ops::Range;

/// The size of a cache line, in bytes.
const LINE: usize = 64;

/// Memory for blocks of plain data, with zeros between the blocks.
///
/// All of the memory is initialised. It is cleared block by block, just before each block is
/// written. Clearing all at once, by the system or by the allocator, takes 1 of the 21 ms of a
/// quick build of sponza (measured: docs/decisions.md, 25).
///
/// Pages may have any size. Refused: pages of 2 MiB (`madvise`) for the arena and the build's large
/// buffers. They make builds with `Quality::Fast` faster, but builds with `Quality::Balanced`
/// slower (measured: docs/decisions.md, 26).
#[derive(Default)]
pub struct NodeArena {
    /// The words of all lines, and one line more.
    ///
    /// The first line begins at an aligned address inside of them.
    words: Vec<Word>,
    /// The index of the first line's first word.
    first: usize,
    /// The number of lines.
    lines: usize,
}

const WORDS: usize = LINE / size_of::<Word>();

impl NodeArena {
    /// The unit of offsets: blocks begin at multiples of this number of bytes.
    pub const UNIT: usize = 8;

    /// The largest alignment of a block, in bytes.
    pub const ALIGN: usize = LINE;

    /// Creates an arena, whose parts are written independently.
    ///
    /// `memory` returns an empty buffer with room for the given number of words. `ranges` are the
    /// parts, in bytes. The first part begins at 0. Each other part begins at the first line that
    /// is at or behind the end of the part before it. `write` writes a part, by its number. If all
    /// parts are empty, `write` is not called.
    ///
    /// # Panics
    ///
    /// If the parts do not follow one another in this way, or if the buffer is too small.
    pub fn filled(
        memory: impl FnOnce(usize) -> Vec<Word>,
        ranges: &[Range<usize>],
        write: &(dyn Fn(usize, &mut Part<'_>) + Sync),
    ) -> Self {
        let lines = ranges.last().map_or(0, |last| last.end).div_ceil(LINE);
        if lines == 0 {
            return Self::default();
        }
        let len = (lines + 1) * WORDS;
        let mut words = memory(len);
        let address = words.as_ptr().addr();
        let first = (address.next_multiple_of(LINE) - address) / size_of::<Word>();
        let (before, rest) = words.spare_capacity_mut()[..len].split_at_mut(first);
        let (mut rest, behind) = rest.split_at_mut(lines * WORDS);
        before.fill(MaybeUninit::new(Word([0; 2])));
        behind.fill(MaybeUninit::new(Word([0; 2])));
        let mut parts = Vec::with_capacity(ranges.len());
        let mut done = 0;
        for (number, range) in ranges.iter().enumerate() {
            let end = range.end.div_ceil(LINE) * WORDS;
            assert!(range.start == done * size_of::<Word>() && end >= done);
            let (words, behind) = rest.split_at_mut(end - done);
            (rest, done) = (behind, end);
            parts.push((number, Part { words, clear: 0 }));
        }
        parallel::each(&mut parts, |(number, part)| {
            write(*number, part);
            part.clear_to(size_of_val(part.words));
        });
        // SAFETY: all `len` words are initialised. The words before and behind the lines
        // were written above. The parts are all of the lines, and each part was written
        // or cleared to its end.
        unsafe { words.set_len(len) }
        Self { words, first, lines }
    }

    /// Frees the memory that the arena does not need.
    pub fn shrink(&mut self) {
        let before = self.start().addr() % LINE;
        self.words.shrink_to_fit();
        // The memory may have moved. If it is aligned differently, the lines are copied.
        if self.start().addr() % LINE != before {
            *self = self.clone();
        }
    }

    /// Returns the memory, for other uses.
    pub fn into_words(self) -> Vec<Word> {
        self.words
    }

    /// Returns the size of the memory, in bytes.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<Word>()
    }

    /// Returns the size of all lines, in bytes.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.lines * LINE
    }

    /// Returns the words of all lines, for comparisons.
    pub fn words(&self) -> &[Word] {
        &self.words[self.first..][..self.lines * WORDS]
    }

    #[inline(always)]
    fn start(&self) -> *const u8 {
        self.words.as_ptr().wrapping_add(self.first).cast()
    }

    /// Prefetches lines into the cache.
    ///
    /// Any offset is allowed.
    #[inline(always)]
    pub fn prefetch(&self, offset: usize, bytes: usize) {
        prefetch(self.start().wrapping_add(offset), bytes);
    }

    /// Returns the item at an offset.
    ///
    /// # Safety
    ///
    /// Any bytes are a `T`, and the item at the offset is inside the arena and aligned.
    #[inline(always)]
    pub unsafe fn get<T>(&self, offset: usize) -> &T {
        // SAFETY: the caller ensures the conditions of `get_slice` for one item.
        unsafe { &*self.get_slice(offset, 1).as_ptr() }
    }

    /// Returns a slice of items at an offset.
    ///
    /// # Safety
    ///
    /// Any bytes are a `T`, and the `len` items at the offset are inside the arena and aligned.
    #[inline(always)]
    pub unsafe fn get_slice<T>(&self, offset: usize, len: usize) -> &[T] {
        debug_assert!(offset + len * size_of::<T>() <= self.lines * LINE);
        debug_assert!(offset.is_multiple_of(align_of::<T>()));
        // SAFETY: the caller ensures that the items are inside the arena and aligned, and that any
        // bytes are a `T`. All bytes of the arena are initialised by `filled`.
        unsafe { core::slice::from_raw_parts(self.start().add(offset).cast(), len) }
    }
}

impl Clone for NodeArena {
    fn clone(&self) -> Self {
        let words = self.words();
        let copy = &|_: usize, part: &mut Part<'_>| {
            // SAFETY: any bytes are a word, and a word has no padding.
            unsafe { part.get_mut(0, words.len()) }.copy_from_slice(words);
        };
        Self::filled(Vec::with_capacity, core::slice::from_ref(&(0..size_of_val(words))), copy)
    }
}

/// A part of an arena that is being written.
pub struct Part<'m> {
    words: &'m mut [MaybeUninit<Word>],
    /// The number of initialised bytes at the start of the part.
    clear: usize,
}

impl Part<'_> {
    /// Returns a slice of items at an offset from the start of the part.
    ///
    /// Bytes that were not written yet are zeros.
    ///
    /// # Safety
    ///
    /// Any bytes are a `T`, and a `T` has no padding.
    ///
    /// # Panics
    ///
    /// If the items are not inside the part, or not aligned.
    pub unsafe fn get_mut<T>(&mut self, offset: usize, len: usize) -> &mut [T] {
        let end = size_of::<T>().checked_mul(len).and_then(|bytes| bytes.checked_add(offset));
        let end = end.filter(|&end| end <= size_of_val(self.words)).expect("a block lies inside of its part");
        assert!(align_of::<T>() <= LINE && offset.is_multiple_of(align_of::<T>()));
        self.clear_to(end);
        // SAFETY: the items are inside the part and aligned, as checked above, and `clear_to` has
        // initialised them. The caller ensures that any bytes are a `T`.
        unsafe {
            core::slice::from_raw_parts_mut(self.words.as_mut_ptr().cast::<u8>().add(offset).cast(), len)
        }
    }

    /// Writes a value at an offset from the start of the part.
    ///
    /// # Safety
    ///
    /// A `T` has no padding: all of its bytes are initialised.
    ///
    /// # Panics
    ///
    /// If the value is not inside the part, or not aligned.
    pub unsafe fn put<T>(&mut self, offset: usize, value: T) {
        let end = size_of::<T>().checked_add(offset);
        let end = end.filter(|&end| end <= size_of_val(self.words)).expect("a block lies inside of its part");
        assert!(align_of::<T>() <= LINE && offset.is_multiple_of(align_of::<T>()));
        self.clear_to(offset);
        // SAFETY: the value is inside the part and aligned, as checked above.
        unsafe { self.words.as_mut_ptr().cast::<u8>().add(offset).cast::<T>().write(value) }
        self.clear = self.clear.max(end);
    }

    /// Writes zeros to all uninitialised bytes before `end`, inside the part.
    fn clear_to(&mut self, end: usize) {
        debug_assert!(end <= size_of_val(self.words));
        if let Some(more) = end.checked_sub(self.clear) {
            // SAFETY: the bytes are inside the part: each caller passes an `end` inside it.
            unsafe { self.words.as_mut_ptr().cast::<u8>().add(self.clear).write_bytes(0, more) }
            self.clear = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the written bytes, the zeros elsewhere, and the alignment of lines.
    #[test]
    fn parts_are_written_and_the_rest_is_clear() {
        // Memory of this size that the allocator has at hand is not zero.
        drop(core::hint::black_box(alloc::vec![Word([u64::MAX; 2]); 384 / 16 + WORDS]));
        let arena = NodeArena::filled(
            Vec::with_capacity,
            &[0..100, 128..300, 320..320, 320..323],
            &|number, part| {
                if number == 2 {
                    return;
                }
                // SAFETY: any byte is a `u8`.
                let places: &mut [u8] = unsafe { part.get_mut(number, 1) };
                assert_eq!(places, [0]);
                places[0] = number as u8 + 1;
            },
        );
        let bytes: Vec<u8> =
            arena.words().iter().flat_map(|word| word.0).flat_map(u64::to_ne_bytes).collect();
        assert!(arena.words().as_ptr().addr().is_multiple_of(LINE));
        let mut expected = alloc::vec![0; 384];
        (expected[0], expected[129], expected[323]) = (1, 2, 4);
        assert_eq!(bytes, expected);
        assert_eq!(arena.clone().words(), arena.words());
        // An arena in too large a buffer, whose rest `shrink` frees.
        let threefold = |len| Vec::with_capacity(3 * len);
        let mut large = NodeArena::filled(threefold, core::slice::from_ref(&(0..1000)), &|_, part| {
            // SAFETY: any byte is a `u8`.
            unsafe { part.get_mut::<u8>(0, 1000) }.fill(7);
        });
        let (exact, before) = (large.clone(), large.bytes());
        large.shrink();
        assert!(large.words() == exact.words() && large.words().as_ptr().addr().is_multiple_of(LINE));
        assert!(large.bytes() == exact.bytes() && before == 3 * exact.bytes());
        assert_eq!(NodeArena::filled(Vec::with_capacity, &[], &|_, _| unreachable!()).words(), []);
    }
}
