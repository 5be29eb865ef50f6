//! An allocator that measures the peak of a build's memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicIsize, Ordering::Relaxed};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The system's allocator, which counts bytes while a flag is set.
///
/// Only builds that are not timed are counted. The look at the flag does not
/// show in the times of the others.
struct Counting;

static IS_COUNTING: AtomicBool = AtomicBool::new(false);
/// Bytes more than when counting began; negative when older memory is freed.
static NOW: AtomicIsize = AtomicIsize::new(0);
static PEAK: AtomicIsize = AtomicIsize::new(0);

/// Returns the result of `build` and the peak of bytes above those at its start.
///
/// Allocations of all threads count.
pub fn peak<T>(build: impl FnOnce() -> T) -> (T, usize) {
    NOW.store(0, Relaxed);
    PEAK.store(0, Relaxed);
    IS_COUNTING.store(true, Relaxed);
    let built = build();
    IS_COUNTING.store(false, Relaxed);
    (built, PEAK.load(Relaxed).max(0) as usize)
}

fn count(bytes: isize) {
    if IS_COUNTING.load(Relaxed) {
        let now = NOW.fetch_add(bytes, Relaxed) + bytes;
        PEAK.fetch_max(now, Relaxed);
    }
}

/// Counts new memory, if there is any, and returns it.
fn counted(memory: *mut u8, bytes: isize) -> *mut u8 {
    if !memory.is_null() {
        count(bytes);
    }
    memory
}

// SAFETY: every method passes its arguments on to the system's allocator, which keeps the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller of this method keeps the same contract as
        // that of the system's allocator.
        counted(unsafe { System.alloc(layout) }, layout.size() as isize)
    }

    /// Allocates without `alloc`, since the system has pages that are zero already.
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller of this method keeps the same contract as
        // that of the system's allocator.
        counted(unsafe { System.alloc_zeroed(layout) }, layout.size() as isize)
    }

    /// Reallocates without `alloc`, since the system moves pages without copying them.
    ///
    /// For the same reason, only the difference in size is counted.
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller of this method keeps the same contract as
        // that of the system's allocator.
        counted(unsafe { System.realloc(memory, layout, size) }, size as isize - layout.size() as isize)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller of this method keeps the same contract as
        // that of the system's allocator.
        unsafe { System.dealloc(memory, layout) }
        count(-(layout.size() as isize));
    }
}
