//! How much memory a build has allocated at the most: an allocator that counts while it is told to.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicIsize, Ordering::Relaxed};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The system's, and a flag to look at, which no time shows: counts are kept in builds that are not timed.
struct Counting;

static IS_COUNTING: AtomicBool = AtomicBool::new(false);
/// Bytes more than when counting began; less than none when older memory is freed.
static NOW: AtomicIsize = AtomicIsize::new(0);
static PEAK: AtomicIsize = AtomicIsize::new(0);

/// What comes of `build`, and how many bytes more than before there were at the most. All threads count.
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

/// Counts the new memory if there is any.
fn counted(memory: *mut u8, bytes: isize) -> *mut u8 {
    if !memory.is_null() {
        count(bytes);
    }
    memory
}

// SAFETY: the system's allocator does everything, and is told what this one is told.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: our caller's promises are the same.
        counted(unsafe { System.alloc(layout) }, layout.size() as isize)
    }

    /// Not by `alloc`: the system has pages that are zero already.
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: our caller's promises are the same.
        counted(unsafe { System.alloc_zeroed(layout) }, layout.size() as isize)
    }

    /// Not by `alloc` either: the system moves pages without copying them, and so counts the difference alone.
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: our caller's promises are the same.
        counted(unsafe { System.realloc(memory, layout, size) }, size as isize - layout.size() as isize)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: our caller's promises are the same.
        unsafe { System.dealloc(memory, layout) }
        count(-(layout.size() as isize));
    }
}
