//! Radix sort of keys.

use crate::parallel;
use alloc::vec;
use alloc::vec::Vec;

/// Bits of a digit: counters for 2,048 digits fit the first-level cache.
const DIGIT: u32 = 11;

/// Maximum number of digits by which a bucket is sorted.
const DIGITS: u32 = 4;

/// Buckets of fewer keys are sorted by comparisons.
const FEW: usize = 256;

/// Least mean number of keys in a bucket.
///
/// The second-level cache holds twice as many keys.
const BUCKET: usize = 1 << 15;

/// Number of parts of the keys that are put into buckets at the same time.
const PARTS: usize = 8;

/// Sorts keys, and returns the one of the two lists that holds them.
///
/// Keys that are equal in the bits from `low` up must already ascend, and no key may have bits from
/// `high` on. `spare` has room for as many keys.
///
/// The highest bits put the keys into buckets. The buckets are then sorted at the same time, by up
/// to four digits from the lowest up. Keys that are equal in all of these bits are sorted by
/// comparisons: only the densest places have many. The sort takes 6 ns per key. Refused: 2,048
/// buckets by the highest digit, then two more digits, where small buckets clear more counters than
/// they have keys (measured: docs/decisions.md, 13).
pub(super) fn sort<'m>(keys: &'m mut [u64], spare: &'m mut [u64], low: u32, high: u32) -> &'m [u64] {
    let bits = (keys.len() / BUCKET).checked_ilog2().unwrap_or(0).min(DIGIT);
    if bits == 0 {
        sort_bucket(keys, spare, low, high);
        return keys;
    }
    let top = high.saturating_sub(bits).max(low);
    let lens = scatter_in_parts(keys, spare, top, high - top);
    let (mut sources, mut targets) = (&mut *spare, &mut *keys);
    let parts = lens.into_iter().map(|len| {
        let (source, rest) = core::mem::take(&mut sources).split_at_mut(len);
        sources = rest;
        let (target, rest) = core::mem::take(&mut targets).split_at_mut(len);
        targets = rest;
        (source, target)
    });
    let mut parts: Vec<_> = parts.filter(|(bucket, _)| bucket.len() > 1).collect();
    parallel::each(&mut parts, |(bucket, spare)| sort_bucket(bucket, spare, low, top));
    spare
}

/// Sorts a bucket by the bits from `low` to `high`.
fn sort_bucket(bucket: &mut [u64], spare: &mut [u64], low: u32, high: u32) {
    if bucket.len() < FEW {
        return bucket.sort_unstable();
    }
    let bottom = high.saturating_sub(DIGITS * DIGIT).max(low);
    let (mut from, mut to) = (bucket, spare);
    let digits = (high - bottom).div_ceil(DIGIT);
    for digit in 0..digits {
        scatter(from, to, bottom + digit * DIGIT);
        core::mem::swap(&mut from, &mut to);
    }
    if digits % 2 == 1 {
        to.copy_from_slice(from);
        core::mem::swap(&mut from, &mut to);
    }
    if bottom > low {
        let leaf_ranges = from.chunk_by_mut(|a, b| a >> bottom == b >> bottom);
        leaf_ranges.filter(|run| run.len() > 1).for_each(<[u64]>::sort_unstable);
    }
}

/// Copies keys in the order of the `bits` bits from `low` up.
///
/// Equal keys keep their order. Returns the number of keys for each value of these bits.
///
/// Parts of the keys are copied at the same time: each part has its own places among
/// those of equal keys.
fn scatter_in_parts(keys: &[u64], mut sorted: &mut [u64], low: u32, bits: u32) -> Vec<usize> {
    let digit = |key: u64| (key >> low) as usize & ((1 << bits) - 1);
    let parts: Vec<_> = keys.chunks(keys.len().div_ceil(PARTS)).collect();
    let counts = parallel::map(parts.clone(), |part| {
        let mut counts = vec![0usize; 1 << bits];
        part.iter().for_each(|&key| counts[digit(key)] += 1);
        counts
    });
    let mut places: Vec<Vec<&mut [u64]>> = parts.iter().map(|_| Vec::with_capacity(1 << bits)).collect();
    for digit in 0..1 << bits {
        for (counts, places) in counts.iter().zip(&mut places) {
            let (part, rest) = core::mem::take(&mut sorted).split_at_mut(counts[digit]);
            places.push(part);
            sorted = rest;
        }
    }
    let mut parts: Vec<_> = parts.into_iter().zip(places).collect();
    parallel::each(&mut parts, |(part, places)| {
        for &key in *part {
            let places = &mut places[digit(key)];
            if let Some((place, rest)) = core::mem::take(places).split_first_mut() {
                *place = key;
                *places = rest;
            }
        }
    });
    (0..1 << bits).map(|digit| counts.iter().map(|counts| counts[digit]).sum()).collect()
}

/// Copies keys in the order of the digit at the bit `shift`.
///
/// Equal keys keep their order.
fn scatter(keys: &[u64], sorted: &mut [u64], shift: u32) {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Few keys, one bucket and several buckets.
    ///
    /// The codes, above the places, have many bits or few, and many codes are equal.
    #[test]
    fn keys_are_sorted_whatever_their_bits() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for (n, bits) in [(10, 40), (300, 1), (20_000, 46), (20_000, 40), (20_000, 23), (20_000, 3)]
            .into_iter()
            .chain([47, 46, 35, 24, 12, 2].map(|bits| (3 * BUCKET as u64, bits)))
        {
            for kept in [u64::MAX, 0x1111_1111_1111, 0xffff_0000_0000] {
                let mut code = || rng.random::<u64>() >> (64 - bits) & kept;
                let keys: Vec<u64> = (0..n).map(|place| code() << 17 | place).collect();
                let mut expected = keys.clone();
                expected.sort_unstable();
                let (mut keys, mut spare) = (keys, vec![0; expected.len()]);
                assert!(sort(&mut keys, &mut spare, 17, 17 + bits) == expected, "{n} keys of {bits} bits");
            }
        }
    }
}
