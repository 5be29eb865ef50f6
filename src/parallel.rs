//! The one place that knows of threads. Results never depend on their number.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::mem::MaybeUninit;

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

/// Whether another thread could help with so many parts, each of which takes a while. Else they are done on the spot: small
/// builds never wake a thread, and a pool of one is not worth going to. To go there and back for every call took 1 to 4 ms of a
/// build on a virtual machine (kitchen with `Quality::Fast` 5.3 ms instead of 4.1, dragon with `Balanced` 44.6 instead of 42.3).
#[cfg(feature = "rayon")]
fn has_help(parts: usize) -> bool {
    parts > 1 && rayon::current_num_threads() > 1
}

/// Applies `f` to each item, results in the items' order.
#[cfg(feature = "rayon")]
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, f: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    if has_help(items.len()) {
        items.into_par_iter().map(f).collect()
    } else {
        items.into_iter().map(f).collect()
    }
}

/// Applies `f` to each item, results in the items' order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<T, R>(items: Vec<T>, f: impl Fn(T) -> R) -> Vec<R> {
    items.into_iter().map(f).collect()
}

/// What `f` makes of each item and its number, in place of what was collected before.
#[cfg(feature = "rayon")]
pub(crate) fn collect<T: Sync, R: Send>(
    items: &[T],
    collected: &mut Vec<R>,
    f: impl Fn(usize, &T) -> R + Sync,
) {
    use rayon::prelude::*;
    let made = |(index, item)| f(index, item);
    if !has_help(items.len() / FEW) {
        collected.clear();
        return collected.extend(items.iter().enumerate().map(made));
    }
    items.par_iter().enumerate().with_min_len(FEW).map(made).collect_into_vec(collected);
}

/// What `f` makes of each item and its number, in place of what was collected before.
#[cfg(not(feature = "rayon"))]
pub(crate) fn collect<T, R>(items: &[T], collected: &mut Vec<R>, f: impl Fn(usize, &T) -> R) {
    collected.clear();
    collected.extend(items.iter().enumerate().map(|(index, item)| f(index, item)));
}

/// Writes a value to all places.
pub(crate) fn filled<T: Copy + Send + Sync>(places: &mut [MaybeUninit<T>], value: T) -> &mut [T] {
    map(places.chunks_mut(FEW).collect(), |part| part.fill(MaybeUninit::new(value)));
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

/// The items of all parts, one after another, in empty memory for as many.
///
/// # Panics
/// If a part has fewer items than it says, or `memory` is not for as many as asked for.
pub(crate) fn concat<T: Send, I: ExactSizeIterator<Item = T> + Send>(
    parts: Vec<I>,
    memory: impl FnOnce(usize) -> Vec<T>,
) -> Vec<T> {
    let all_len = parts.iter().map(ExactSizeIterator::len).sum();
    let mut all = memory(all_len);
    let mut rest: &mut [MaybeUninit<T>] = &mut all.spare_capacity_mut()[..all_len];
    // Parts may be of one item: several are written at a time.
    let mut jobs: Vec<(&mut [MaybeUninit<T>], Vec<I>)> = Vec::new();
    let mut parts = parts.into_iter().peekable();
    while parts.peek().is_some() {
        let (mut job, mut len) = (Vec::new(), 0);
        while let Some(items) = parts.next_if(|_| len < FEW) {
            len += items.len();
            job.push(items);
        }
        let (places, behind) = core::mem::take(&mut rest).split_at_mut(len);
        rest = behind;
        jobs.push((places, job));
    }
    assert!(rest.is_empty());
    map(jobs, |(places, job)| {
        let mut items = job.into_iter().flatten();
        for place in places {
            place.write(items.next().expect("a part has as many items as it says"));
        }
    });
    // SAFETY: the jobs' places are all, as was asserted, and each was written, or `map` would have panicked.
    unsafe { all.set_len(all_len) }
    all
}

/// Items in a part: for fewer no other thread is woken.
const FEW: usize = 1 << 12;

/// Runs `f`, which is about so many items, where [`map`] has `threads` threads; with `None`, those of the pool it is called in.
///
/// On one of the pool's threads, if others can help: to come from outside for each step takes one thread more than there may be
/// processors (two threads, a million triangles with `Quality::Fast`: 76 ms instead of 72). Of several that come at the same
/// time, one may then wait for another to be done.
#[cfg(feature = "rayon")]
pub(crate) fn in_pool<R: Send>(
    threads: Option<usize>,
    items: usize,
    f: impl FnOnce() -> R + Send,
) -> Result<R, ThreadPoolError> {
    use alloc::string::ToString;
    let Some(threads) = threads else {
        return Ok(if has_help(items / FEW) { rayon::scope(|_| f()) } else { f() });
    };
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => Ok(pool.install(f)),
        Err(error) => Err(ThreadPoolError { threads, reason: error.to_string() }),
    }
}

/// Without threads, `f` runs on the caller's.
#[cfg(not(feature = "rayon"))]
pub(crate) fn in_pool<R>(
    _threads: Option<usize>,
    _items: usize,
    f: impl FnOnce() -> R,
) -> Result<R, ThreadPoolError> {
    Ok(f())
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn lists_become_longer_and_never_shorter() {
        let len = 3 * FEW + 1;
        let mut list = vec![(1u8, 7u64); 2];
        in_pool(Some(3), len, || extend_to(&mut list, len, (2, 9))).unwrap();
        assert!(list[..2] == [(1, 7); 2] && list[2..] == vec![(2, 9); len - 2]);
        extend_to(&mut list, 5, (3, 3));
        assert_eq!(list.len(), len);
    }

    #[test]
    fn parts_of_any_length_follow_one_another() {
        let parts: Vec<_> = [0, 1, FEW, 0, 2 * FEW, 3].map(|len| 0..len).into();
        let expected: Vec<_> = parts.iter().cloned().flatten().collect();
        let all = in_pool(Some(3), expected.len(), || concat(parts, Vec::with_capacity)).unwrap();
        assert!(all == expected);
    }
}
