//! The only module that knows of threads; results never depend on their number.
//!
//! It uses `rayon-core` alone: it needs no more than to join, to scope and to start pools, and its
//! threads are those that users of `rayon` have. The parallel iterators of `rayon` are compiled for
//! each use, and were 60 % of the compiled code of a build.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::mem::{MaybeUninit, take};
#[cfg(feature = "rayon")]
use core::ops::Range;

/// The error of a thread pool that could not be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThreadPoolError {
    /// The number of threads asked for.
    pub threads: usize,
    /// The reason that the operating system gave.
    pub reason: String,
}

impl fmt::Display for ThreadPoolError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no pool of {} threads could be started ({}): ask for fewer", self.threads, self.reason)
    }
}

impl core::error::Error for ThreadPoolError {}

/// The number of items in a part; fewer items wake no other thread.
pub(crate) const PART: usize = 1 << 12;

/// Returns whether another thread could help with so many parts.
///
/// Each part takes a while. Without help, the calling thread does the parts on the spot: small
/// builds never wake a thread, and a pool of one thread is not entered. To enter it for every call
/// took 1 to 4 ms of a build (measured: docs/decisions.md, 39).
#[cfg(feature = "rayon")]
fn has_help(parts: usize) -> bool {
    parts > 1 && rayon_core::current_num_threads() > 1
}

/// Calls `f` with each number below `parts`, once and in any order.
///
/// It is compiled once, for parts of every kind.
fn for_each(parts: usize, f: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "rayon")]
    if has_help(parts) {
        return halve(0..parts, f);
    }
    (0..parts).for_each(f);
}

/// Runs one half here, and the other half too unless another thread takes it.
#[cfg(feature = "rayon")]
fn halve(parts: Range<usize>, f: &(dyn Fn(usize) + Sync)) {
    if parts.len() < 2 {
        return parts.for_each(f);
    }
    let middle = parts.start + parts.len() / 2;
    rayon_core::join(|| halve(parts.start..middle, f), || halve(middle..parts.end, f));
}

/// Applies `f` to each item in place.
pub(crate) fn each<T: Send>(items: &mut [T], f: impl Fn(&mut T) + Sync) {
    /// The address of the first item; one thread at a time takes each item.
    struct First<T>(*mut T);
    // SAFETY: each item is used by one thread, through an exclusive reference
    // (below), and items may be sent.
    unsafe impl<T: Send> Sync for First<T> {}
    let first = First(items.as_mut_ptr());
    let first = &first;
    for_each(items.len(), &|item| {
        // SAFETY: `item` is one of the items, which are borrowed for the whole call. `for_each`
        // passes each number once, so no other reference to the item exists.
        f(unsafe { &mut *first.0.add(item) });
    });
}

/// Returns the result of `f` for each item, in the order of the items.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, f: impl Fn(T) -> R + Sync) -> Vec<R> {
    let mut slots = Vec::with_capacity(items.len());
    for item in items {
        slots.push((Some(item), None));
    }
    each(&mut slots, |(item, result)| *result = item.take().map(&f));
    let mut results = Vec::with_capacity(slots.len());
    for (_, result) in slots {
        results.extend(result);
    }
    results
}

/// The memory of a list that is filled from the front.
pub struct Places<'m, T> {
    places: &'m mut [MaybeUninit<T>],
    filled: usize,
}

impl<T: Copy> Places<'_, T> {
    /// Fills the next places with items; items without a place are left out.
    #[inline(always)]
    pub fn extend(&mut self, items: impl Iterator<Item = T>) {
        let mut filled = self.filled;
        for (place, item) in self.places[filled..].iter_mut().zip(items) {
            place.write(item);
            filled += 1;
        }
        self.filled = filled;
    }
}

/// Returns lists of these lengths, one after another, as one list.
///
/// `fill` fills each list, by its number. The list is in the given memory, which is cleared first.
///
/// # Panics
/// If `fill` leaves a place of a list empty.
pub(crate) fn concat<T: Copy + Send>(
    mut memory: Vec<T>,
    lens: &[usize],
    fill: &(dyn Fn(usize, &mut Places<'_, T>) + Sync),
) -> Vec<T> {
    memory.clear();
    let all_len = lens.iter().sum();
    memory.reserve(all_len);
    let mut rest = &mut memory.spare_capacity_mut()[..all_len];
    // Lists may be of one item: a job fills several.
    let (mut jobs, mut first) = (Vec::new(), 0);
    while first < lens.len() {
        let (mut len, mut end) = (0, first);
        while end < lens.len() && len < PART {
            len += lens[end];
            end += 1;
        }
        let (places, behind) = take(&mut rest).split_at_mut(len);
        rest = behind;
        jobs.push((first..end, places));
        first = end;
    }
    each(&mut jobs, |(lists, rest)| {
        for list in lists {
            let (places, behind) = take(rest).split_at_mut(lens[list]);
            *rest = behind;
            let mut places = Places { places, filled: 0 };
            fill(list, &mut places);
            assert_eq!(places.filled, places.places.len(), "a list has as many items as it says");
        }
    });
    // SAFETY: the places of the jobs are the first `all_len` of the memory. Each of
    // them was written: the assertion in the jobs would have failed otherwise, and
    // `each` would have panicked.
    unsafe { memory.set_len(all_len) }
    memory
}

/// Writes a value to all places, and returns them.
pub(crate) fn filled<T: Copy + Send + Sync>(places: &mut [MaybeUninit<T>], value: T) -> &mut [T] {
    let mut parts: Vec<_> = places.chunks_mut(PART).collect();
    each(&mut parts, |part| part.fill(MaybeUninit::new(value)));
    // SAFETY: the parts are all places, and each was written above.
    unsafe { &mut *(core::ptr::from_mut(places) as *mut [T]) }
}

/// Extends a list to `len` items with a value; a longer list stays as it is.
pub(crate) fn extend_to<T: Copy + Send + Sync>(list: &mut Vec<T>, len: usize, value: T) {
    let more = len.saturating_sub(list.len());
    list.reserve(more);
    filled(&mut list.spare_capacity_mut()[..more], value);
    // SAFETY: the `more` places behind the list were just written.
    unsafe { list.set_len(list.len() + more) }
}

/// Runs `f` where [`each`] has `threads` threads.
///
/// With `None`, these are the threads of the pool that the function is called in. `items` is about
/// the number of items that `f` works on.
///
/// If others can help, `f` runs on one of the pool's threads. If each step entered the pool from
/// outside, there would be one thread more than there may be processors (two threads, a million
/// triangles with `Quality::Fast`: 76 ms instead of 72). Of several callers at the same time, one
/// may then wait until another is done.
///
/// # Errors
/// [`ThreadPoolError`], if a pool of `threads` threads could not be started.
#[cfg(feature = "rayon")]
pub(crate) fn in_pool(
    threads: Option<usize>,
    items: usize,
    f: &mut (dyn FnMut() + Send),
) -> Result<(), ThreadPoolError> {
    use alloc::string::ToString;
    let Some(threads) = threads else {
        if has_help(items / PART) {
            rayon_core::scope(|_| f());
        } else {
            f();
        }
        return Ok(());
    };
    match rayon_core::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => {
            pool.install(f);
            Ok(())
        }
        Err(error) => Err(ThreadPoolError { threads, reason: error.to_string() }),
    }
}

/// Runs `f` on the calling thread, since there are no others.
#[cfg(not(feature = "rayon"))]
pub(crate) fn in_pool(
    _threads: Option<usize>,
    _items: usize,
    f: &mut (dyn FnMut() + Send),
) -> Result<(), ThreadPoolError> {
    f();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    /// Runs `f` in a pool of three threads.
    fn on_three<R: Send>(mut f: impl FnMut() -> R + Send) -> R {
        let mut result = None;
        in_pool(Some(3), 3 * PART, &mut || result = Some(f())).unwrap();
        result.unwrap()
    }

    #[test]
    fn results_are_in_the_items_order() {
        let expected: Vec<_> = (0..1000u64).map(|item| item * item).collect();
        assert_eq!(on_three(|| map((0..1000u64).collect(), |item| item * item)), expected);
        assert_eq!(map(Vec::<u8>::new(), |item| item), []);
    }

    #[test]
    fn lists_become_longer_and_never_shorter() {
        let len = 3 * PART + 1;
        let mut list = on_three(|| {
            let mut list = vec![(1u8, 7u64); 2];
            extend_to(&mut list, len, (2, 9));
            list
        });
        assert!(list[..2] == [(1, 7); 2] && list[2..] == vec![(2, 9); len - 2]);
        extend_to(&mut list, 5, (3, 3));
        assert_eq!(list.len(), len);
    }

    #[test]
    fn lists_of_any_length_follow_one_another() {
        let lens = [0, 1, PART, 0, 2 * PART, 3];
        let expected: Vec<_> = lens.iter().flat_map(|&len| 0..len).collect();
        // There are more items than places: the first are taken.
        let all = on_three(|| concat(Vec::new(), &lens, &|list, places| places.extend(0..lens[list] + 7)));
        assert!(all == expected);
    }

    #[test]
    #[should_panic(expected = "as many items as it says")]
    fn a_list_with_too_few_items_is_not_taken() {
        concat(Vec::new(), &[1, 2], &|_, places| places.extend(0..1));
    }

    #[test]
    #[should_panic(expected = "of part 77")]
    fn a_part_that_panics_is_not_swallowed() {
        on_three(|| map((0..100).collect(), |part: usize| assert!(part != 77, "of part {part}")));
    }
}
