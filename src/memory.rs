//! Large buffers, in large pages.
//!
//! The first build of a process gets all of its memory from the system, page by page, and so do later ones as far as the allocator
//! has given theirs back. A page of 4 KiB took 1.5 us here, one of 2 MiB as long as 50 of them: with these the first quick build of
//! sponza takes 26 ms instead of 33, and builds of the dragon, whose memory is given back each time, 19 instead of 23. Where the
//! system takes long to find such pages, as a virtual machine may whose host took them back, a build can take longer (49 ms once
//! in six).

use alloc::vec::Vec;

/// Room for so many items, of which the caller is to write most.
pub(crate) fn with_capacity<T>(len: usize) -> Vec<T> {
    let items = Vec::with_capacity(len);
    #[cfg(all(target_os = "linux", feature = "std", not(miri)))]
    ask_for_large_pages(&items);
    items
}

/// So many copies of a value.
pub(crate) fn filled<T: Clone>(value: T, len: usize) -> Vec<T> {
    let mut items = with_capacity(len);
    items.resize(len, value);
    items
}

/// Asks the system for pages of 2 MiB, if there are whole ones in the memory.
#[cfg(all(target_os = "linux", feature = "std", not(miri)))]
fn ask_for_large_pages<T>(items: &Vec<T>) {
    const LARGE: usize = 1 << 21;
    let (start, bytes) = (items.as_ptr(), items.capacity() * size_of::<T>());
    let skipped = start.addr().next_multiple_of(LARGE) - start.addr();
    let len = bytes.saturating_sub(skipped) / LARGE * LARGE;
    // Of less than two, most of the memory would lie in others.
    if len >= 2 * LARGE {
        // SAFETY: inside of the items' memory; the advice changes none of its bytes. That it may be refused does not matter.
        unsafe { libc::madvise(start.cast_mut().byte_add(skipped).cast(), len, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_buffers_are_as_large_as_asked_for() {
        assert!(with_capacity::<u64>(3 << 20).capacity() >= 3 << 20);
        assert_eq!(filled(7u8, 9 << 20), alloc::vec![7; 9 << 20]);
        assert_eq!(filled(7u8, 0), []);
    }
}
