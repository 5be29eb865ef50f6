//! A hint to the processor.

/// Asks for lines to be brought into the cache. Any address will do.
#[inline(always)]
pub fn prefetch(first: *const u8, bytes: usize) {
    /// In a cache line.
    const LINE: usize = 64;
    for line in 0..bytes.div_ceil(LINE) {
        #[cfg(target_arch = "x86_64")]
        {
            use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            // SAFETY: no address is wrong to ask for, and SSE is part of every x86-64.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(LINE * line).cast()) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = (first, line);
    }
}
