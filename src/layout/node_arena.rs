//! Nodes and leaves of different sizes, one after another in line-aligned memory.

use crate::memory::Word;
use crate::parallel;
use crate::simd::prefetch;
use alloc::vec::Vec;
use core::mem::MaybeUninit;
use core::ops::Range;

/// Bytes in a cache line.
const LINE: usize = 64;

/// Memory in which blocks of plain data lie: all of it initialised, with zeros between them.
///
/// It is cleared block by block, just before each is written: clearing all at once, by the system or by the allocator, took 1 of the
/// 21 ms of a quick build of sponza, and on the calling thread a tenth of a build on two.
///
/// In pages of any size. Asking the system for pages of 2 MiB (`madvise`) for this and the build's large buffers halved the page
/// faults, and made first builds of a process with `Quality::Fast` a fifth quicker (sponza 36 to 30 ms, dragon 27 to 23), but with
/// `Quality::Balanced` up to two fifths slower (sponza 71 to 69, 92 and 99 ms): on a virtual machine, which waits for its host where
/// it touches memory that was given back. The kernel had nothing to compact. Rays were quicker by 1 %.
#[derive(Default)]
pub struct NodeArena {
    /// One line more than there is room for: somewhere in them the first line begins.
    words: Vec<Word>,
    /// The first line's first word.
    first: usize,
    /// How many lines there are.
    lines: usize,
}

const WORDS: usize = LINE / size_of::<Word>();

impl NodeArena {
    /// Blocks begin at multiples of this many bytes.
    pub const UNIT: usize = 8;

    /// No block has to begin at multiples of more.
    pub const ALIGN: usize = LINE;

    /// In memory for so many words, which `memory` has.
    ///
    /// Parts are written independently, each by `write`, which is told its number. They are `ranges` of bytes, which begin
    /// with lines and follow one another from 0 on but for what is left of a line. If all are empty, none is written.
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
        // SAFETY: what is before and behind the lines was written above, and the parts, which are all lines, to their ends.
        unsafe { words.set_len(len) }
        Self { words, first, lines }
    }

    /// Gives back the memory that it does not need.
    pub fn shrink(&mut self) {
        let before = self.start().addr() % LINE;
        self.words.shrink_to_fit();
        // It may have moved, and then lines begin elsewhere.
        if self.start().addr() % LINE != before {
            *self = self.clone();
        }
    }

    /// The memory, for others.
    pub fn into_words(self) -> Vec<Word> {
        self.words
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<Word>()
    }

    /// Bytes of the lines.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.lines * LINE
    }

    /// All lines' words, to be compared.
    pub fn words(&self) -> &[Word] {
        &self.words[self.first..][..self.lines * WORDS]
    }

    #[inline(always)]
    fn start(&self) -> *const u8 {
        self.words.as_ptr().wrapping_add(self.first).cast()
    }

    /// PackedQuery for lines to be brought into the cache. Any offset will do.
    #[inline(always)]
    pub fn prefetch(&self, offset: usize, bytes: usize) {
        prefetch(self.start().wrapping_add(offset), bytes);
    }

    /// What lies at an offset.
    ///
    /// # Safety
    /// Any bytes are a `T`, and one lies there: inside and aligned.
    #[inline(always)]
    pub unsafe fn get<T>(&self, offset: usize) -> &T {
        // SAFETY: the caller's.
        unsafe { &*self.get_slice(offset, 1).as_ptr() }
    }

    /// What lies at an offset, one after another.
    ///
    /// # Safety
    /// Any bytes are a `T`, and `len` of them lie there: inside and aligned.
    #[inline(always)]
    pub unsafe fn get_slice<T>(&self, offset: usize, len: usize) -> &[T] {
        debug_assert!(offset + len * size_of::<T>() <= self.lines * LINE);
        debug_assert!(offset.is_multiple_of(align_of::<T>()));
        // SAFETY: the caller's.
        unsafe { core::slice::from_raw_parts(self.start().add(offset).cast(), len) }
    }
}

impl Clone for NodeArena {
    fn clone(&self) -> Self {
        let words = self.words();
        let copy = &|_: usize, part: &mut Part<'_>| {
            // SAFETY: words are any bytes, and any bytes are some.
            unsafe { part.get_mut(0, words.len()) }.copy_from_slice(words);
        };
        Self::filled(Vec::with_capacity, core::slice::from_ref(&(0..size_of_val(words))), copy)
    }
}

/// A part of the memory, to be written.
pub struct Part<'m> {
    words: &'m mut [MaybeUninit<Word>],
    /// So many bytes at the begin are initialised.
    clear: usize,
}

impl Part<'_> {
    /// What lies at an offset from the part's begin, one after another; zeros where nothing was written yet.
    ///
    /// # Safety
    /// Any bytes are a `T`, and a `T` is any bytes.
    ///
    /// # Panics
    /// If they are not inside of the part, or not aligned.
    pub unsafe fn get_mut<T>(&mut self, offset: usize, len: usize) -> &mut [T] {
        let end = size_of::<T>().checked_mul(len).and_then(|bytes| bytes.checked_add(offset));
        let end = end.filter(|&end| end <= size_of_val(self.words)).expect("a block lies inside of its part");
        assert!(align_of::<T>() <= LINE && offset.is_multiple_of(align_of::<T>()));
        self.clear_to(end);
        // SAFETY: inside and aligned, as was just asked, and initialised; the bytes are a T by the caller's word.
        unsafe {
            core::slice::from_raw_parts_mut(self.words.as_mut_ptr().cast::<u8>().add(offset).cast(), len)
        }
    }

    /// Writes what lies at an offset.
    ///
    /// # Safety
    /// A `T` is any bytes, all of them initialised: it has no gaps.
    ///
    /// # Panics
    /// If it is not inside of the part, or not aligned.
    pub unsafe fn put<T>(&mut self, offset: usize, value: T) {
        let end = size_of::<T>().checked_add(offset);
        let end = end.filter(|&end| end <= size_of_val(self.words)).expect("a block lies inside of its part");
        assert!(align_of::<T>() <= LINE && offset.is_multiple_of(align_of::<T>()));
        self.clear_to(offset);
        // SAFETY: inside and aligned, as was just asked.
        unsafe { self.words.as_mut_ptr().cast::<u8>().add(offset).cast::<T>().write(value) }
        self.clear = self.clear.max(end);
    }

    /// Initialises all up to `end`, which is inside of the part, with zeros where nothing was.
    fn clear_to(&mut self, end: usize) {
        debug_assert!(end <= size_of_val(self.words));
        if let Some(more) = end.checked_sub(self.clear) {
            // SAFETY: inside of the part.
            unsafe { self.words.as_mut_ptr().cast::<u8>().add(self.clear).write_bytes(0, more) }
            self.clear = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written where it was said, zeros elsewhere, lines where lines begin.
    #[test]
    fn parts_are_written_and_the_rest_is_clear() {
        // What the allocator has at hand for the same size is not clear.
        drop(core::hint::black_box(alloc::vec![Word([u64::MAX; 2]); 384 / 16 + WORDS]));
        let arena = NodeArena::filled(
            Vec::with_capacity,
            &[0..100, 128..300, 320..320, 320..323],
            &|number, part| {
                if number == 2 {
                    return;
                }
                // SAFETY: bytes are any bytes.
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
        // In memory for more, of which the rest is given back.
        let threefold = |len| Vec::with_capacity(3 * len);
        let mut large = NodeArena::filled(threefold, core::slice::from_ref(&(0..1000)), &|_, part| {
            // SAFETY: bytes are any bytes.
            unsafe { part.get_mut::<u8>(0, 1000) }.fill(7);
        });
        let (exact, before) = (large.clone(), large.bytes());
        large.shrink();
        assert!(large.words() == exact.words() && large.words().as_ptr().addr().is_multiple_of(LINE));
        assert!(large.bytes() == exact.bytes() && before == 3 * exact.bytes());
        assert_eq!(NodeArena::filled(Vec::with_capacity, &[], &|_, _| unreachable!()).words(), []);
    }
}
