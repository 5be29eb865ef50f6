//! SSE2, which every x86-64 has.

use super::arch::*;
use crate::simd::Pair;
use crate::simd::isa::plain_isa;
use crate::simd::vector::vector;

/// The token that proves SSE2.
#[derive(Clone, Copy, Debug)]
pub struct Sse2(());

plain_isa!(Sse2, F32x4, Pair<F64x2>, runs_routines: false);

vector! {
    F32x4(__m128), Mask32x4(__m128): 4 of f32, Sse2;
    splat(x) = _mm_set1_ps(x);
    load(from) = _mm_loadu_ps(from);
    load_bytes(from) = {
        let (bytes, zero) = (_mm_cvtsi32_si128(from.cast::<i32>().read_unaligned()), _mm_setzero_si128());
        _mm_cvtepi32_ps(_mm_unpacklo_epi16(_mm_unpacklo_epi8(bytes, zero), zero))
    };
    store(a, to) = _mm_storeu_ps(to, a);
    add(a, b) = _mm_add_ps(a, b);
    sub(a, b) = _mm_sub_ps(a, b);
    mul(a, b) = _mm_mul_ps(a, b);
    div(a, b) = _mm_div_ps(a, b);
    mul_add(a, b, c) = _mm_add_ps(_mm_mul_ps(a, b), c);
    abs(a) = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
    sqrt(a) = _mm_sqrt_ps(a);
    min(a, b) = _mm_min_ps(a, b);
    max(a, b) = _mm_max_ps(a, b);
    lt(a, b) = _mm_cmplt_ps(a, b);
    le(a, b) = _mm_cmple_ps(a, b);
    orders_by_bits = false;
    later(a, b) = _mm_max_ps(a, b);
    earlier(a, b) = _mm_min_ps(a, b);
    not_after(a, b) = _mm_cmple_ps(a, b);
    select(a, mask, b) = _mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b));
    and(a, b) = _mm_and_ps(a, b);
    or(a, b) = _mm_or_ps(a, b);
    not(a) = _mm_xor_ps(a, _mm_castsi128_ps(_mm_set1_epi32(-1)));
    bits(mask) = _mm_movemask_ps(mask) as u32;
    /// Converts all lanes at once: one by one, each conversion checks its range.
    #[inline(always)]
    fn to_integers(self) -> [i32; 3] {
        let mut integers = [0; 4];
        // SAFETY: the vector holds the token, and `integers` has room for four.
        unsafe { _mm_storeu_si128(integers.as_mut_ptr().cast(), _mm_cvttps_epi32(self.0)) };
        [integers[0], integers[1], integers[2]]
    }
}

vector! {
    F64x2(__m128d), Mask64x2(__m128d): 2 of f64, Sse2;
    splat(x) = _mm_set1_pd(x);
    load(from) = _mm_loadu_pd(from);
    load_bytes(from) = {
        let bytes = _mm_cvtsi32_si128(i32::from(from.cast::<u16>().read_unaligned()));
        let zero = _mm_setzero_si128();
        _mm_cvtepi32_pd(_mm_unpacklo_epi16(_mm_unpacklo_epi8(bytes, zero), zero))
    };
    store(a, to) = _mm_storeu_pd(to, a);
    add(a, b) = _mm_add_pd(a, b);
    sub(a, b) = _mm_sub_pd(a, b);
    mul(a, b) = _mm_mul_pd(a, b);
    div(a, b) = _mm_div_pd(a, b);
    mul_add(a, b, c) = _mm_add_pd(_mm_mul_pd(a, b), c);
    abs(a) = _mm_andnot_pd(_mm_set1_pd(-0.0), a);
    sqrt(a) = _mm_sqrt_pd(a);
    min(a, b) = _mm_min_pd(a, b);
    max(a, b) = _mm_max_pd(a, b);
    lt(a, b) = _mm_cmplt_pd(a, b);
    le(a, b) = _mm_cmple_pd(a, b);
    orders_by_bits = false;
    later(a, b) = _mm_max_pd(a, b);
    earlier(a, b) = _mm_min_pd(a, b);
    not_after(a, b) = _mm_cmple_pd(a, b);
    select(a, mask, b) = _mm_or_pd(_mm_and_pd(mask, a), _mm_andnot_pd(mask, b));
    and(a, b) = _mm_and_pd(a, b);
    or(a, b) = _mm_or_pd(a, b);
    not(a) = _mm_xor_pd(a, _mm_castsi128_pd(_mm_set1_epi32(-1)));
    bits(mask) = _mm_movemask_pd(mask) as u32;
}
