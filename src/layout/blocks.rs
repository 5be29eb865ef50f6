//! Nodes and leaves of different sizes, one after another in line-aligned memory.

use crate::simd::prefetch;
use alloc::vec::Vec;
use core::ops::Range;

/// A cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Line([u8; Line::BYTES]);

impl Line {
    pub const BYTES: usize = 64;
}

/// Memory in which blocks of plain data lie: all of it initialised, with zeros at first.
///
/// In pages of any size: asking the system for pages of 2 MiB (`madvise`) for this and the build's buffers made a first
/// build in a process quicker in five runs of eight (60 instead of 68 ms on sponza), slower in three, where such pages had
/// to be made (85 to 99), and rays quicker by 1 %.
///
/// The zeros are the system's, which come with a page when it is first written, on the thread that does: clearing lines
/// took a tenth of a build on two threads.
#[derive(Default)]
pub(super) struct Blocks {
    /// One line more than there is room for, less a word: somewhere in them the first line begins.
    words: Vec<u64>,
    /// The first line's first word.
    first: usize,
    /// How many lines there are.
    lines: usize,
}

const WORDS: usize = Line::BYTES / size_of::<u64>();

impl Blocks {
    /// Blocks begin at multiples of this many bytes.
    pub const UNIT: usize = 8;

    /// No block has to begin at multiples of more.
    pub const ALIGN: usize = Line::BYTES;

    /// Room for so many bytes.
    pub fn zeroed(bytes: usize) -> Self {
        let lines = bytes.div_ceil(Line::BYTES);
        if lines == 0 {
            return Self::default();
        }
        let words = alloc::vec![0u64; lines * WORDS + WORDS - 1];
        let address = words.as_ptr().addr();
        let first = (address.next_multiple_of(Line::BYTES) - address) / size_of::<u64>();
        Self { words, first, lines }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<u64>()
    }

    /// All lines' words, to be compared.
    pub fn words(&self) -> &[u64] {
        &self.words[self.first..][..self.lines * WORDS]
    }

    fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words[self.first..][..self.lines * WORDS]
    }

    #[inline(always)]
    fn start(&self) -> *const u8 {
        self.words.as_ptr().wrapping_add(self.first).cast()
    }

    /// The memory in parts that are written independently. `ranges` are of bytes, ascend, do not overlap, and begin with
    /// a line.
    pub fn parts(&mut self, ranges: impl Iterator<Item = Range<usize>>) -> Vec<Part<'_>> {
        // SAFETY: words are lines: as many bytes, any of which are some, and the first is where a line may begin (`zeroed`).
        let (before, lines, behind) = unsafe { self.words_mut().align_to_mut::<Line>() };
        debug_assert!(before.is_empty() && behind.is_empty());
        let (mut rest, mut done) = (lines, 0);
        let part = |range: Range<usize>| {
            let [start, end] = [range.start / Line::BYTES, range.end.div_ceil(Line::BYTES)];
            let (lines, behind) = core::mem::take(&mut rest)[start - done..].split_at_mut(end - start);
            (rest, done) = (behind, end);
            Part { lines }
        };
        ranges.map(part).collect()
    }

    /// Asks for lines to be brought into the cache. Any offset will do.
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
        debug_assert!(offset + len * size_of::<T>() <= self.lines * Line::BYTES);
        debug_assert!(offset.is_multiple_of(align_of::<T>()));
        // SAFETY: the caller's.
        unsafe { core::slice::from_raw_parts(self.start().add(offset).cast(), len) }
    }
}

impl Clone for Blocks {
    fn clone(&self) -> Self {
        let mut clone = Self::zeroed(self.lines * Line::BYTES);
        clone.words_mut().copy_from_slice(self.words());
        clone
    }
}

/// A part of the memory, to be written.
pub(super) struct Part<'m> {
    lines: &'m mut [Line],
}

impl Part<'_> {
    /// What lies at an offset from the part's begin, one after another.
    ///
    /// # Safety
    /// Any bytes are a `T`, and a `T` is any bytes.
    ///
    /// # Panics
    /// If they are not inside of the part, or not aligned.
    pub unsafe fn get_mut<T>(&mut self, offset: usize, len: usize) -> &mut [T] {
        assert!(offset + len * size_of::<T>() <= self.lines.len() * Line::BYTES);
        assert!(align_of::<T>() <= Line::BYTES && offset.is_multiple_of(align_of::<T>()));
        // SAFETY: inside and aligned, as was just asked; the bytes are a T by the caller's word.
        unsafe {
            core::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast::<u8>().add(offset).cast(), len)
        }
    }
}
