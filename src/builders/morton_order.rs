//! References in the order of a curve: sorted keys of codes and places.

use super::radix::sort;
use super::subtree::{Parent, Subtree, TASK_SIZE, task_child};
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::tree::MAX_DEPTH;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

const _: () = assert!(MAX_DEPTH <= u64::BITS as usize);

/// Sorted keys: a code, and in the lower bits the place of its reference.
///
/// The place is the position in the list of references, so no two keys are equal.
pub(super) struct Curve<'m> {
    pub keys: &'m [u64],
    /// The mask of the bits that hold the place.
    place: u64,
}

impl<'m> Curve<'m> {
    /// Sorts the keys of a list of codes.
    ///
    /// Requires at least one code. Keys use at most `bits` bits, which must be enough for a place:
    /// codes lose their lowest bits if they have too many. `spare` has room for as many keys. The
    /// sorted keys are in one of the two lists.
    pub fn new(codes: &'m mut [u64], spare: &'m mut [u64], bits: usize) -> Self {
        let place_bits = usize::BITS - (codes.len() - 1).leading_zeros();
        let any = |codes: &[u64]| codes.iter().fold(0, |all, code| all | code);
        let all = any(&parallel::map(codes.chunks(TASK_SIZE).collect(), any));
        let code_bits = u64::BITS - all.leading_zeros();
        let lost = (code_bits + place_bits).saturating_sub(bits as u32);
        let mut parts: Vec<_> = codes.chunks_mut(TASK_SIZE).zip((0..).step_by(TASK_SIZE)).collect();
        parallel::each(&mut parts, |(codes, first)| {
            for (code, place) in codes.iter_mut().zip(*first..) {
                *code = (*code >> lost).unbounded_shl(place_bits) | place;
            }
        });
        let keys = sort(codes, spare, place_bits, place_bits + code_bits - lost);
        Self { keys, place: (1 << place_bits) - 1 }
    }

    /// Returns the place of a key's reference.
    #[inline(always)]
    pub fn place(&self, key: u64) -> usize {
        (key & self.place) as usize
    }

    /// Returns keys with the same places, and consecutive numbers as codes.
    ///
    /// The tree over n such keys has a depth of at most ceil(log2(n)).
    pub fn in_a_row(&self, keys: &[u64]) -> Vec<u64> {
        (0..).zip(keys).map(|(row, &key)| row << self.place.count_ones() | key & self.place).collect()
    }

    /// Returns the nodes above the tasks, and the keys of each task, in order.
    ///
    /// A node has more than [`TASK_SIZE`] keys; its boxes are not computed yet.
    pub fn divide<S: Scalar>(&self) -> (Subtree<S>, Vec<Range<usize>>) {
        let (mut top, mut tasks) = (Subtree::with_capacity(0, 0), Vec::new());
        let mut open: Vec<(Parent, Range<usize>)> = vec![(None, 0..self.keys.len())];
        while let Some((parent, range)) = open.pop() {
            if range.len() <= TASK_SIZE {
                top.refer(parent, task_child(tasks.len()));
                tasks.push(range);
                continue;
            }
            let border = range.start + border(&self.keys[range.clone()]);
            let node = top.push(parent, [Aabb::EMPTY; 2]);
            open.push((Some((node, 1)), border..range.end));
            open.push((Some((node, 0)), range.start..border));
        }
        (top, tasks)
    }
}

/// Returns the index of the first key that has the highest bit in which any two keys differ.
///
/// There are at least two keys.
pub(super) fn border(keys: &[u64]) -> usize {
    let highest = (keys[0] ^ keys[keys.len() - 1]).ilog2();
    keys.partition_point(|key| key >> highest & 1 == 0)
}

/// Returns the difference of the keys on both sides of a border.
///
/// The greater the difference, the higher the node between the keys. At the ends of the list, it
/// is `u64::MAX`. The shift keeps the differences of keys below that. The lost bit never decides:
/// the differences at the two ends of a part have distinct highest bits.
#[inline(always)]
pub(super) fn difference(keys: &[u64], border: usize) -> u64 {
    match (border, keys.get(border)) {
        (1.., Some(key)) => (key ^ keys[border - 1]) >> 1,
        _ => u64::MAX,
    }
}
