//! Sorts and packs the children of a node in registers of AVX-512.

use super::Avx512;
use super::arch::*;
use crate::simd::Window;

/// Sorts two to eight children by distance and returns the lane of the nearest.
///
/// All of them are written to the windows, the farthest first. Returns `None` for more than eight
/// children, which few nodes have: the caller sorts those one by one.
///
/// A key is a distance, not below +0, whose last four bits are replaced by its lane. As an integer
/// a key has the order of its distance, and one permutation fetches the children. So the entries
/// are less than 16 ulps smaller than the distances, and never larger.
///
/// Keys are packed first. Most nodes have at most four, and these need half the steps, both in the
/// reduction, whose result the next node waits for, and in the sorting network.
#[inline(always)]
pub fn sort(
    _: Avx512,
    near: __m512,
    met: u16,
    children: __m512i,
    references: &mut Window<u32>,
    entries: &mut Window<f32>,
) -> Option<u32> {
    let count = met.count_ones();
    if count > 8 {
        return None;
    }
    // SAFETY: the token proves AVX-512. The windows are 64 bytes long, and any bits are valid in
    // the part of them that holds no child.
    unsafe {
        let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let low_bits = _mm512_set1_epi32(15);
        let keys = _mm512_or_si512(_mm512_andnot_si512(low_bits, _mm512_castps_si512(near)), lanes);
        // Merges with ones: masking with zeros would wait for the register's old value.
        let none = _mm512_set1_epi32(-1);
        let keys = _mm512_mask_compress_epi32(none, met, keys);
        // The nearest has the largest complement, except for the unused lanes, which go to the end.
        let kept = (1u32 << count) - 1;
        let turned = _mm512_mask_xor_epi32(none, kept as u16, keys, none);
        if count <= 4 {
            let nearest = min4(_mm512_castsi512_si128(keys));
            let sorted = sort4(_mm512_castsi512_si128(turned));
            let sorted = _mm_xor_si128(sorted, _mm_set1_epi32(-1));
            let places = _mm512_permutexvar_epi32(_mm512_castsi128_si512(sorted), children);
            _mm_storeu_si128(references.as_mut_ptr().cast(), _mm512_castsi512_si128(places));
            let distances = _mm_andnot_si128(_mm_set1_epi32(15), sorted);
            _mm_storeu_si128(entries.as_mut_ptr().cast(), distances);
            Some(nearest & 15)
        } else {
            let keys = _mm512_castsi512_si256(keys);
            let nearest =
                min4(_mm_min_epu32(_mm256_castsi256_si128(keys), _mm256_extracti128_si256::<1>(keys)));
            let sorted = sort8(_mm512_castsi512_si256(turned));
            let sorted = _mm256_xor_si256(sorted, _mm256_set1_epi32(-1));
            let places = _mm512_permutexvar_epi32(_mm512_castsi256_si512(sorted), children);
            _mm256_storeu_si256(references.as_mut_ptr().cast(), _mm512_castsi512_si256(places));
            let distances = _mm256_andnot_si256(_mm256_set1_epi32(15), sorted);
            _mm256_storeu_si256(entries.as_mut_ptr().cast(), distances);
            Some(nearest & 15)
        }
    }
}

#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
fn min4(v: __m128i) -> u32 {
    let v = _mm_min_epu32(v, _mm_shuffle_epi32::<0b11_10_11_10>(v));
    let v = _mm_min_epu32(v, _mm_shuffle_epi32::<0b01_01_01_01>(v));
    _mm_cvtsi128_si32(v) as u32
}

/// Packs the children of the mask, in the order of their lanes.
#[inline(always)]
pub fn compress(_: Avx512, met: u16, children: __m512i, references: &mut Window<u32>) {
    // SAFETY: the token proves AVX-512, and the window is 64 bytes long.
    unsafe {
        // Merges with ones: masking with zeros would wait for the register's old value.
        let packed = _mm512_mask_compress_epi32(_mm512_set1_epi32(-1), met, children);
        _mm512_storeu_si512(references.as_mut_ptr().cast(), packed);
    }
}

/// One step of a sorting network, for each lane and its partner.
///
/// A lane gets the larger of the two if its bit in the mask is set, else the smaller.
macro_rules! step {
    ($v:ident, $permuted:expr, $mask:literal, $min:ident, $mask_max:ident) => {{
        let partner = $permuted;
        $mask_max($min($v, partner), $mask, $v, partner)
    }};
}

#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
fn sort4(v: __m128i) -> __m128i {
    let v = step!(v, _mm_shuffle_epi32::<0b10_11_00_01>(v), 0b1010, _mm_min_epu32, _mm_mask_max_epu32);
    let v = step!(v, _mm_shuffle_epi32::<0b01_00_11_10>(v), 0b1100, _mm_min_epu32, _mm_mask_max_epu32);
    step!(v, _mm_shuffle_epi32::<0b11_01_10_00>(v), 0b0100, _mm_min_epu32, _mm_mask_max_epu32)
}

/// Sorts eight lanes with 19 comparisons in 6 steps.
///
/// The network is from Knuth, The Art of Computer Programming, volume 3, 5.3.4.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
fn sort8(v: __m256i) -> __m256i {
    macro_rules! step8 {
        ($v:ident, $p:expr, $mask:literal) => {{
            let [a, b, c, d, e, f, g, h]: [i32; 8] = $p;
            let order = _mm256_setr_epi32(a, b, c, d, e, f, g, h);
            step!($v, _mm256_permutexvar_epi32(order, $v), $mask, _mm256_min_epu32, _mm256_mask_max_epu32)
        }};
    }
    let v = step8!(v, [2, 3, 0, 1, 6, 7, 4, 5], 0b1100_1100);
    let v = step8!(v, [4, 5, 6, 7, 0, 1, 2, 3], 0b1111_0000);
    let v = step8!(v, [1, 0, 3, 2, 5, 4, 7, 6], 0b1010_1010);
    let v = step8!(v, [0, 1, 4, 5, 2, 3, 6, 7], 0b0011_0000);
    let v = step8!(v, [0, 4, 2, 6, 1, 5, 3, 7], 0b0101_0000);
    step8!(v, [0, 2, 1, 4, 3, 6, 5, 7], 0b0101_0100)
}

#[cfg(test)]
mod tests {
    use crate::simd::{Isa, KernelLanes};
    use core::mem::MaybeUninit;

    /// Distances with ties and zeros, and all sets of two or more children.
    #[test]
    fn children_are_sorted_farthest_first_and_none_is_lost() {
        let Some(isa) = super::Avx512::detect() else { return };
        let distances: [f32; 16] = core::array::from_fn(|lane| ((lane * 7 + 3) % 11) as f32 * 0.75);
        // SAFETY: `distances` has sixteen scalars.
        let near = unsafe { <super::Avx512 as Isa>::F32x16::load(isa, distances.as_ptr()) };
        let children: [u32; 16] = core::array::from_fn(|lane| 1000 + lane as u32);
        for met in (3..=u32::from(u16::MAX)).filter(|met| met.count_ones() > 1) {
            let mut references = [MaybeUninit::new(0u32); 16];
            let mut entries = [MaybeUninit::new(0.0f32); 16];
            let nearest = near.sort(met, &children, &mut references, &mut entries);
            if met.count_ones() > 8 {
                assert_eq!(nearest, None, "{met:b}");
                continue;
            }
            // SAFETY: both arrays were initialised where they were created.
            let (references, entries) =
                unsafe { (references.map(|x| x.assume_init()), entries.map(|x| x.assume_init())) };
            let count = met.count_ones() as usize;
            let lanes = references[..count].iter().map(|child| child - 1000);
            assert_eq!(lanes.clone().fold(0, |set, lane| set | 1 << lane), met, "{met:b}");
            assert_eq!(lanes.clone().next_back(), nearest, "{met:b}");
            assert!(entries[..count].is_sorted_by(|a, b| a >= b), "{met:b}: {entries:?}");
            for (lane, &entry) in lanes.zip(&entries) {
                let distance = distances[lane as usize];
                assert!(entry <= distance && entry >= distance * (1.0 - 16.0 * f32::EPSILON), "{met:b}");
            }
        }
    }

    #[test]
    fn children_met_are_packed_in_order() {
        let Some(isa) = super::Avx512::detect() else { return };
        let children: [u32; 16] = core::array::from_fn(|lane| 1000 + lane as u32);
        for met in 0..=u32::from(u16::MAX) {
            let mut references = [MaybeUninit::new(0u32); 16];
            assert!(<super::Avx512 as Isa>::F32x16::compress(isa, met, &children, &mut references));
            // SAFETY: the array was initialised where it was created.
            let references = references.map(|x| unsafe { x.assume_init() });
            let lanes = (0..16).filter(|lane| met >> lane & 1 != 0);
            assert!(
                lanes.map(|lane| 1000 + lane).eq(references[..met.count_ones() as usize].iter().copied())
            );
        }
    }
}
