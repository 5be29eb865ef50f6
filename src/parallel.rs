//! The one place that knows of threads. Results never depend on their number.
//!
//! Of rayon, `rayon-core` alone: to join, to scope and to start pools is all that is needed, and
//! its threads are those that users of rayon have. The parallel iterators, which are compiled for
//! each use, took 60 % of what a build was compiled to.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::mem::{MaybeUninit, take};
#[cfg(feature = "rayon")]
use core::ops::Range;

/// The thread pool that was asked for could not be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ThreadPoolError {
    /// How many threads were asked for.
    pub threads: usize,
    /// What the operating system said.
    pub reason: String,
}

impl fmt::Display for ThreadPoolError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no pool of {} threads could be started ({}): ask for fewer", self.threads, self.reason)
    }
}

impl core::error::Error for ThreadPoolError {}

/// Items in a part: for fewer no other thread is woken.
pub(crate) const PART: usize = 1 << 12;

/// Whether another thread could help with so many parts, each of which takes a while. Else they are done on the spot: small
/// builds never wake a thread, and a pool of one is not worth going to. To go there and back for every call took 1 to 4 ms of a
/// build on a virtual machine (kitchen with `Quality::Fast` 5.3 ms instead of 4.1, dragon with `Balanced` 44.6 instead of 42.3).
#[cfg(feature = "rayon")]
fn has_help(parts: usize) -> bool {
    parts > 1 && rayon_core::current_num_threads() > 1
}

/// Calls `f` with each number below `parts`, once and in any order. Compiled once, whatever the
/// parts are.
fn for_each(parts: usize, f: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "rayon")]
    if has_help(parts) {
        return halve(0..parts, f);
    }
    (0..parts).for_each(f);
}

/// One half here, the other one too unless another thread takes it.
#[cfg(feature = "rayon")]
fn halve(parts: Range<usize>, f: &(dyn Fn(usize) + Sync)) {
    if parts.len() < 2 {
        return parts.for_each(f);
    }
    let middle = parts.start + parts.len() / 2;
    rayon_core::join(|| halve(parts.start..middle, f), || halve(middle..parts.end, f));
}

/// Applies `f` to each item where it lies.
pub(crate) fn each<T: Send>(items: &mut [T], f: impl Fn(&mut T) + Sync) {
    /// Of items that one thread at a time takes.
    struct First<T>(*mut T);
    // SAFETY: what is shared are exclusive references to items that may be sent.
    unsafe impl<T: Send> Sync for First<T> {}
    let first = First(items.as_mut_ptr());
    let first = &first;
    for_each(items.len(), &|item| {
        // SAFETY: one of the items, which are borrowed for all of this; each number comes once.
        f(unsafe { &mut *first.0.add(item) });
    });
}

/// What `f` makes of each item, in the items' order.
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

/// Memory of a list that is to be filled from the front.
pub struct Places<'m, T> {
    places: &'m mut [MaybeUninit<T>],
    filled: usize,
}

impl<T: Copy> Places<'_, T> {
    /// Fills the next places with items; those for which there is none are left out.
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

/// Lists of these lengths one after another, in empty memory: `fill` fills each, by its number.
///
/// # Panics
/// If a list has fewer items than it has places.
pub(crate) fn concat<T: Copy + Send>(
    mut memory: Vec<T>,
    lens: &[usize],
    fill: &(dyn Fn(usize, &mut Places<'_, T>) + Sync),
) -> Vec<T> {
    memory.clear();
    let all_len = lens.iter().sum();
    memory.reserve(all_len);
    let mut rest = &mut memory.spare_capacity_mut()[..all_len];
    // Lists may be of one item: several are filled at a time.
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
    // SAFETY: the jobs' places are so many from the first on, and each was written, or `each` would
    // have panicked.
    unsafe { memory.set_len(all_len) }
    memory
}

/// Writes a value to all places.
pub(crate) fn filled<T: Copy + Send + Sync>(places: &mut [MaybeUninit<T>], value: T) -> &mut [T] {
    let mut parts: Vec<_> = places.chunks_mut(PART).collect();
    each(&mut parts, |part| part.fill(MaybeUninit::new(value)));
    // SAFETY: the parts were all places, and each was written.
    unsafe { &mut *(core::ptr::from_mut(places) as *mut [T]) }
}

/// Makes a list longer by a value.
pub(crate) fn extend_to<T: Copy + Send + Sync>(list: &mut Vec<T>, len: usize, value: T) {
    let more = len.saturating_sub(list.len());
    list.reserve(more);
    filled(&mut list.spare_capacity_mut()[..more], value);
    // SAFETY: the places behind the list were just written.
    unsafe { list.set_len(list.len() + more) }
}

/// Runs `f`, which is about so many items, where [`each`] has `threads` threads; with `None`, those
/// of the pool it is called in.
///
/// On one of the pool's threads, if others can help: to come from outside for each step takes one thread more than there may be
/// processors (two threads, a million triangles with `Quality::Fast`: 76 ms instead of 72). Of several that come at the same
/// time, one may then wait for another to be done.
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

/// Without threads, `f` runs on the caller's.
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

    /// On three threads.
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
        // Of more items than there are places, the first.
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
