//! Memory that serves one purpose after another.
//!
//! Memory that is new to a process costs more than writing to it: systems hand it out page by page,
//! as it is touched. So a build touches little of it. The same memory holds, one after another:
//!
//! - references to primitives, and keys behind them;
//! - the data of the optimisation about the tree that was made of the references;
//! - the data of the collapse about that tree;
//! - nodes and leaves.
//!
//! So a build touches a quarter to a third fewer pages (measured:
//! docs/decisions.md, 40).

use crate::parallel::filled;
use alloc::vec::Vec;
use core::mem::{ManuallyDrop, MaybeUninit, take};

/// 16-byte unit of untyped buffers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub(crate) struct Word(pub [u64; 2]);

/// Returns the memory of a buffer as an empty buffer of other items.
///
/// Returns a buffer without memory if the bytes are not a whole number of such items.
pub(crate) fn recast<T: Copy, U: Copy>(buffer: Vec<T>) -> Vec<U> {
    const { assert!(align_of::<T>() == align_of::<U>() && size_of::<U>() > 0) }
    let bytes = buffer.capacity() * size_of::<T>();
    if !bytes.is_multiple_of(size_of::<U>()) {
        return Vec::new();
    }
    let mut buffer = ManuallyDrop::new(buffer);
    // SAFETY: the memory is that of the vector, which does not free it any more (`ManuallyDrop`).
    // It has the same alignment, and a whole number of items, as checked above. The length is 0, so
    // no item is taken to be initialised. Items of `T` are `Copy`, and need not be dropped.
    unsafe { Vec::from_raw_parts(buffer.as_mut_ptr().cast(), 0, bytes / size_of::<U>()) }
}

/// Returns the items, and `each` zeros per item behind them in the same memory.
///
/// If the memory has no room for the zeros, the items move.
pub(crate) fn with_numbers<T: Copy>(items: &mut Vec<T>, each: usize) -> (&mut [T], &mut [u64]) {
    const { assert!(align_of::<T>() >= align_of::<u64>()) }
    let count = items.len();
    let numbers = count.checked_mul(each).expect("as many as there is memory for");
    items.reserve_exact(bytes::<u64>(numbers).div_ceil(size_of::<T>()));
    let items = items.as_mut_ptr();
    // SAFETY: the vector has `count` initialised items. Behind them, it has memory for `numbers`
    // numbers, reserved above. The address is aligned for numbers: `T` is aligned at least like
    // `u64`, as asserted above. The two slices do not overlap, and the vector is borrowed for both.
    let (items, behind) = unsafe {
        let behind = items.add(count).cast::<MaybeUninit<u64>>();
        (core::slice::from_raw_parts_mut(items, count), core::slice::from_raw_parts_mut(behind, numbers))
    };
    (items, filled(behind, 0))
}

/// Returns `len` copies of a value, in the memory of words that are not in use.
///
/// If the memory has no room for them, other memory replaces it.
pub(crate) fn lent<T: Copy + Send + Sync>(words: &mut Vec<Word>, len: usize, value: T) -> &mut [T] {
    const { assert!(align_of::<T>() <= align_of::<Word>()) }
    // A whole number of references, whatever their scalar.
    let needed = bytes::<T>(len).div_ceil(size_of::<Word>()).next_multiple_of(4);
    if words.capacity() < needed {
        drop(take(words));
        words.reserve_exact(needed);
    }
    words.clear();
    let places = words.as_mut_ptr().cast::<MaybeUninit<T>>();
    // SAFETY: the vector has memory for `len` values, reserved above, at an address that is aligned
    // for them, as asserted above. No word of it is in use, and the vector is borrowed.
    filled(unsafe { core::slice::from_raw_parts_mut(places, len) }, value)
}

/// Returns the byte size of `len` items of `T`.
fn bytes<T>(len: usize) -> usize {
    len.checked_mul(size_of::<T>()).expect("as many as there is memory for")
}

/// Returns an empty buffer with room for `len` items.
///
/// The kept buffer is returned if it is large enough, and not larger than twice the need: in a
/// larger one, the result would take much more memory than it has to. A kept buffer that is too
/// small is replaced by one that is an eighth larger than needed, since the need may go on to grow.
/// The eighth is a multiple of four, so that words remain a whole number of references.
pub(crate) fn fitting<T>(kept: &mut Vec<T>, len: usize) -> Vec<T> {
    kept.clear();
    match kept.capacity() {
        capacity if capacity == 0 || capacity > 2 * len => Vec::with_capacity(len),
        capacity if capacity >= len => take(kept),
        _ => {
            drop(take(kept));
            Vec::with_capacity(len + len / 32 * 4)
        }
    }
}

/// Keeps the larger of two buffers, whatever is in them.
pub(crate) fn keep_larger<T>(kept: &mut Vec<T>, other: Vec<T>) {
    if other.capacity() > kept.capacity() {
        *kept = other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(C, align(16))]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Three([u64; 6]);

    #[test]
    fn memory_is_the_same_for_others_if_it_is_a_whole_number_of_them() {
        let words = Vec::<Word>::with_capacity(12);
        let start = words.as_ptr().addr();
        let threes: Vec<Three> = recast(words);
        assert_eq!((threes.len(), threes.capacity(), threes.as_ptr().addr()), (0, 4, start));
        let words: Vec<Word> = recast(threes);
        assert_eq!((words.len(), words.capacity(), words.as_ptr().addr()), (0, 12, start));
        assert_eq!(recast::<Word, Three>(Vec::with_capacity(13)).capacity(), 0);
        assert_eq!(recast::<Word, Three>(Vec::new()).capacity(), 0);
    }

    #[test]
    fn memory_is_lent_where_there_is_enough_and_made_where_there_is_not() {
        let mut words = Vec::with_capacity(8);
        words.extend([Word([7; 2]); 5]);
        let start = words.as_ptr().addr();
        let lent_to = lent(&mut words, 9, [1.5f32, 2.5]);
        assert_eq!((&*lent_to, lent_to.as_ptr().addr()), (&[[1.5, 2.5]; 9][..], start));
        lent_to.fill([0.0; 2]);
        assert_eq!(words, []);
        assert_eq!(lent(&mut words, 100_000, 3u8), [3; 100_000]);
        assert!(words.is_empty() && words.capacity() * size_of::<Word>() >= 100_000);
        assert_eq!(lent(&mut Vec::new(), 0, 3u8), []);
    }

    /// Covers items with room behind them, and items that have to move.
    #[test]
    fn numbers_lie_behind_items() {
        for room in [0, 2] {
            let mut items = Vec::with_capacity(3 + room);
            items.extend([Three([7; 6]); 3]);
            let start = items.as_ptr().addr();
            let (same, numbers) = with_numbers(&mut items, 2);
            assert_eq!((&*same, &*numbers), (&[Three([7; 6]); 3][..], &[0; 6][..]));
            assert_eq!(numbers.as_ptr().addr(), same.as_ptr_range().end.addr());
            numbers.fill(u64::MAX);
            assert!(room == 0 || same.as_ptr().addr() == start);
            assert_eq!(items, [Three([7; 6]); 3]);
        }
    }
}
