//! References in the order of a curve: keys of their codes and places, sorted.

use super::radix::sort;
use super::subtree::{Parent, Subtree, TASK_SIZE, task_child};
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::tree::MAX_DEPTH;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

const _: () = assert!(MAX_DEPTH <= u64::BITS as usize);

/// Sorted keys: a code, and behind it the place of its reference, so that no two are equal.
pub(super) struct Curve<'m> {
    pub keys: &'m [u64],
    /// The bits of a key that are the place.
    place: u64,
}

impl<'m> Curve<'m> {
    /// Of at least one code. Keys have `bits` at the most: codes lose their lowest if they have too many. Not fewer than
    /// places take. `spare` is memory for as many, and the keys lie in one of the two.
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

    /// The place of a key's reference.
    #[inline(always)]
    pub fn place(&self, key: u64) -> usize {
        (key & self.place) as usize
    }

    /// As many keys with the same places, whose tree is one of halves.
    pub fn in_a_row(&self, keys: &[u64]) -> Vec<u64> {
        (0..).zip(keys).map(|(row, &key)| row << self.place.count_ones() | key & self.place).collect()
    }

    /// The nodes of more than [`TASK_SIZE`] keys, without their boxes, and the keys of the tasks below them, in order.
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

/// Where the highest bit changes among two keys or more.
pub(super) fn border(keys: &[u64]) -> usize {
    let highest = (keys[0] ^ keys[keys.len() - 1]).ilog2();
    keys.partition_point(|key| key >> highest & 1 == 0)
}

/// How keys on both sides of a border differ: the greater, the higher the node between them. More than any two at the ends.
#[inline(always)]
pub(super) fn difference(keys: &[u64], border: usize) -> u64 {
    match (border, keys.get(border)) {
        (1.., Some(key)) => key ^ keys[border - 1],
        _ => u64::MAX,
    }
}
