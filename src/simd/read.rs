//! When scalars are read, where compilers would choose another time than is good.

use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};

/// Reads items one by one, which compilers would merge into reads of several.
///
/// A processor hands on what is still on its way to the cache only to reads of no more than was written at once. What was
/// written in parts and is read as a whole has to get there first: on an Intel Xeon rays of which each scalar has just been
/// written took 15 ns more, of 50 to 250.
#[inline(always)]
pub fn read_each<T: Copy, const N: usize>(items: &[T; N]) -> [T; N] {
    core::array::from_fn(|i| {
        // SAFETY: an item of an array that there is.
        unsafe { core::ptr::read_volatile(&items[i]) }
    })
}

/// What lies in memory until it is used, and is read anew each time, as far as compilers do what they are told.
///
/// Scalars that a loop spreads over vectors, compilers spread before it, and put the vectors on the stack if they are too many:
/// for a ray of four steps that is more work than it saves. (On an Intel Xeon with AVX-512, `Fast` triangles of a kitchen, dragon
/// and sponza: closest hits 1.00 to 1.01 times as quick, any hits 1.02 to 1.03.)
pub struct Kept<'a, T>(&'a T);

impl<'a, T> Kept<'a, T> {
    #[inline(always)]
    pub fn new(value: &'a T) -> Self {
        Self(black_box(value))
    }

    #[inline(always)]
    pub fn get(&self) -> &'a T {
        compiler_fence(Ordering::SeqCst);
        self.0
    }
}
