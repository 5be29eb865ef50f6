//! Prefetch hints for the processor.

/// Prefetches the cache lines of a range of bytes, at any address.
#[inline(always)]
pub fn prefetch(first: *const u8, bytes: usize) {
    /// Bytes in a cache line.
    const LINE: usize = 64;
    for line in 0..bytes.div_ceil(LINE) {
        #[cfg(target_arch = "x86_64")]
        {
            use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            // SAFETY: a prefetch may name any address, and SSE is part of every x86-64.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(LINE * line).cast()) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = (first, line);
    }
}

/// Prefetches the memory one kilobyte after an item that is read in a row.
///
/// Processors detect by themselves which memory a loop will read next, but they detect it late
/// where many short rows follow one another. On an Intel Xeon, builds by splits take about 0.9 of
/// the time (measured: docs/decisions.md, 28).
#[inline(always)]
pub fn prefetch_ahead<T>(item: &T) {
    prefetch(core::ptr::from_ref(item).cast::<u8>().wrapping_add(1024), 1);
}
