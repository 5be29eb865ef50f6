//! Sorting of codes.

use crate::parallel;
use alloc::vec;
use alloc::vec::Vec;

/// Bits in a digit: the places of 2,048 digits fit the first cache.
const DIGIT: u32 = 11;

/// Fewer keys are sorted by comparisons.
const FEW: usize = 256;

/// Sorts keys that ascend already as far as they are equal above the bit `low`; there are no bits from `high` on.
///
/// A radix sort: by the highest digit into buckets, in each of those by the next two digits, and what is equal in
/// all three, which is little but in the densest places, by comparisons. Buckets are sorted at the same time.
pub(super) fn sorted(mut keys: Vec<u64>, low: u32, high: u32) -> Vec<u64> {
    if keys.len() < FEW {
        keys.sort_unstable();
        return keys;
    }
    let top = high.saturating_sub(DIGIT).max(low);
    let mut buckets = vec![0; keys.len()];
    let mut ends = scatter(&keys, &mut buckets, top);
    if top > low {
        let (mut sources, mut targets) = (buckets.as_mut_slice(), keys.as_mut_slice());
        let mut done = 0;
        let parts = ends.iter_mut().map(|end| {
            let len = *end as usize - core::mem::replace(&mut done, *end as usize);
            let (source, rest) = core::mem::take(&mut sources).split_at_mut(len);
            sources = rest;
            let (target, rest) = core::mem::take(&mut targets).split_at_mut(len);
            targets = rest;
            (source, target)
        });
        let parts = parts.filter(|(bucket, _)| bucket.len() > 1).collect();
        parallel::map(parts, |(bucket, spare)| sort_bucket(bucket, spare, low, top));
    }
    buckets
}

/// Sorts a bucket below the bit `high`.
fn sort_bucket(bucket: &mut [u64], spare: &mut [u64], low: u32, high: u32) {
    if bucket.len() < FEW {
        return bucket.sort_unstable();
    }
    let middle = high.saturating_sub(DIGIT).max(low);
    let bottom = middle.saturating_sub(DIGIT).max(low);
    scatter(bucket, spare, bottom);
    scatter(spare, bucket, middle);
    if bottom > low {
        let runs = bucket.chunk_by_mut(|a, b| a >> bottom == b >> bottom);
        runs.filter(|run| run.len() > 1).for_each(<[u64]>::sort_unstable);
    }
}

/// Copies keys in the order of the digit above a bit, equal ones in their own; tells where each digit's keys end.
fn scatter(keys: &[u64], sorted: &mut [u64], shift: u32) -> [u32; 1 << DIGIT] {
    let digit = |key: u64| (key >> shift) as usize & ((1 << DIGIT) - 1);
    let mut places = [0u32; 1 << DIGIT];
    for &key in keys {
        places[digit(key)] += 1;
    }
    let mut sum = 0;
    for place in &mut places {
        sum += core::mem::replace(place, sum);
    }
    for &key in keys {
        let place = &mut places[digit(key)];
        sorted[*place as usize] = key;
        *place += 1;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of many bits and of few, many equal ones among them, above the places.
    #[test]
    fn keys_are_sorted_whatever_their_bits() {
        for (n, code_bits) in
            [(10, 40), (300, 1), (20_000, 46), (20_000, 34), (20_000, 23), (20_000, 12), (20_000, 3)]
        {
            for kept in [u64::MAX, 0x1111_1111_1111, 0xffff_0000_0000] {
                let mut state = 1u64;
                let keys: Vec<u64> = (0..n)
                    .map(|place| {
                        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                        ((state >> (64 - code_bits)) & kept) << 16 | place
                    })
                    .collect();
                let mut expected = keys.clone();
                expected.sort_unstable();
                assert!(sorted(keys, 16, 16 + code_bits) == expected, "{n} keys of {code_bits} bits");
            }
        }
    }
}
