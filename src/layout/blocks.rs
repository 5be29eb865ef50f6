//! Nodes and leaves of different sizes, one after another in line-aligned memory.

use alloc::vec::Vec;

/// A cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Memory in which blocks of plain data lie: all of it initialised, with zeros at first.
#[derive(Clone, Default)]
pub(super) struct Blocks {
    lines: Vec<Line>,
    /// In bytes.
    len: usize,
}

impl Blocks {
    /// Blocks begin at multiples of this many bytes.
    pub const UNIT: usize = 8;

    /// Bytes in use.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.lines.capacity() * size_of::<Line>()
    }

    /// The bytes in use, to be compared.
    pub fn as_bytes(&self) -> &[[u8; 64]] {
        // SAFETY: a line is its 64 bytes, all initialised.
        unsafe { core::slice::from_raw_parts(self.lines.as_ptr().cast(), self.lines.len()) }
    }

    /// A new block of zeros, at a multiple of `align` bytes, at most 64.
    pub fn allocate(&mut self, bytes: usize, align: usize) -> usize {
        let offset = self.len.next_multiple_of(align);
        self.len = offset + bytes;
        self.lines.resize(self.len.div_ceil(64), Line([0; 64]));
        offset
    }

    /// Gives back what is not used.
    pub fn shrink_to_fit(&mut self) {
        self.lines.shrink_to_fit();
    }

    /// Asks for lines to be brought into the cache. Any offset will do.
    #[inline(always)]
    pub fn prefetch(&self, offset: usize, bytes: usize) {
        let first = self.lines.as_ptr().cast::<i8>().wrapping_add(offset);
        for line in 0..bytes.div_ceil(64) {
            #[cfg(target_arch = "x86_64")]
            {
                use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
                // SAFETY: no address is wrong to ask for, and SSE is part of every x86-64.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(64 * line)) }
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = (first, line);
        }
    }

    /// What lies at an offset.
    ///
    /// # Safety
    /// Any bytes are a `T`.
    ///
    /// # Panics
    /// If it is not inside, or not aligned.
    pub unsafe fn get_mut<T>(&mut self, offset: usize) -> &mut T {
        assert!(offset + size_of::<T>() <= self.lines.len() * 64 && align_of::<T>() <= 64);
        assert!(offset.is_multiple_of(align_of::<T>()));
        // SAFETY: inside and aligned, as was just asked; the bytes are a T by the caller's word.
        unsafe { &mut *self.lines.as_mut_ptr().cast::<u8>().add(offset).cast() }
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
        debug_assert!(offset + len * size_of::<T>() <= self.lines.len() * 64);
        debug_assert!(offset.is_multiple_of(align_of::<T>()));
        // SAFETY: the caller's.
        unsafe { core::slice::from_raw_parts(self.lines.as_ptr().cast::<u8>().add(offset).cast(), len) }
    }
}
