//! AVX2, and the extensions that processors got together with it.

use super::arch::*;
use super::{halves, has, with_features};
use crate::simd::vector::vector;
use crate::simd::{Isa, Pair};

/// The token that proves AVX2.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    #[inline]
    pub fn detect() -> Option<Self> {
        has!("avx2", "fma", "bmi1", "bmi2", "lzcnt", "popcnt").then_some(Self(()))
    }
}

impl Avx2 {
    /// Returns the token of AVX2: `Avx512::detect` asks for AVX2 too.
    #[inline(always)]
    pub(super) fn of_avx512(_: super::Avx512) -> Self {
        Self(())
    }
}

impl Isa for Avx2 {
    type F32x4 = F32x4;
    type F32x8 = F32x8;
    type F32x16 = Pair<F32x8>;
    type F32x8Doubled = F32x8;
    type F64x4 = F64x4;
    type F64x8 = Pair<F64x4>;
    type F64x16 = Pair<Pair<F64x4>>;

    type UpToAvx2 = Self;

    #[inline(always)]
    fn up_to_avx2(self) -> Self {
        self
    }
    with_features!("avx2,fma,bmi1,bmi2,lzcnt,popcnt");
}

vector! {
    F32x4(__m128), Mask32x4(__m128): 4 of f32, Avx2;
    splat(x) = _mm_set1_ps(x);
    load(from) = _mm_loadu_ps(from);
    load_bytes(from) = {
        let bytes = _mm_cvtsi32_si128(from.cast::<i32>().read_unaligned());
        _mm_cvtepi32_ps(_mm_cvtepu8_epi32(bytes))
    };
    store(a, to) = _mm_storeu_ps(to, a);
    add(a, b) = _mm_add_ps(a, b);
    sub(a, b) = _mm_sub_ps(a, b);
    mul(a, b) = _mm_mul_ps(a, b);
    div(a, b) = _mm_div_ps(a, b);
    mul_add(a, b, c) = _mm_fmadd_ps(a, b, c);
    abs(a) = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
    sqrt(a) = _mm_sqrt_ps(a);
    min(a, b) = _mm_min_ps(a, b);
    max(a, b) = _mm_max_ps(a, b);
    lt(a, b) = _mm_cmplt_ps(a, b);
    le(a, b) = _mm_cmple_ps(a, b);
    orders_by_bits = true;
    later(a, b) = _mm_castsi128_ps(_mm_max_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
    earlier(a, b) = _mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
    not_after(a, b) = {
        let (a, b) = (_mm_castps_si128(a), _mm_castps_si128(b));
        _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_min_epi32(a, b), a))
    };
    select(a, mask, b) = _mm_blendv_ps(b, a, mask);
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
    F32x8(__m256), Mask32x8(__m256): 8 of f32, Avx2;
    splat(x) = _mm256_set1_ps(x);
    load(from) = _mm256_loadu_ps(from);
    load_bytes(from) = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(from.cast())));
    store(a, to) = _mm256_storeu_ps(to, a);
    add(a, b) = _mm256_add_ps(a, b);
    sub(a, b) = _mm256_sub_ps(a, b);
    mul(a, b) = _mm256_mul_ps(a, b);
    div(a, b) = _mm256_div_ps(a, b);
    mul_add(a, b, c) = _mm256_fmadd_ps(a, b, c);
    abs(a) = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
    sqrt(a) = _mm256_sqrt_ps(a);
    min(a, b) = _mm256_min_ps(a, b);
    max(a, b) = _mm256_max_ps(a, b);
    lt(a, b) = _mm256_cmp_ps::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm256_cmp_ps::<_CMP_LE_OQ>(a, b);
    orders_by_bits = true;
    later(a, b) =
        _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
    earlier(a, b) =
        _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
    not_after(a, b) = {
        let (a, b) = (_mm256_castps_si256(a), _mm256_castps_si256(b));
        _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_min_epi32(a, b), a))
    };
    select(a, mask, b) = _mm256_blendv_ps(b, a, mask);
    and(a, b) = _mm256_and_ps(a, b);
    or(a, b) = _mm256_or_ps(a, b);
    not(a) = _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
    bits(mask) = _mm256_movemask_ps(mask) as u32;
}

vector! {
    F64x4(__m256d), Mask64x4(__m256d): 4 of f64, Avx2;
    splat(x) = _mm256_set1_pd(x);
    load(from) = _mm256_loadu_pd(from);
    load_bytes(from) = {
        let bytes = _mm_cvtsi32_si128(from.cast::<i32>().read_unaligned());
        _mm256_cvtepi32_pd(_mm_cvtepu8_epi32(bytes))
    };
    store(a, to) = _mm256_storeu_pd(to, a);
    add(a, b) = _mm256_add_pd(a, b);
    sub(a, b) = _mm256_sub_pd(a, b);
    mul(a, b) = _mm256_mul_pd(a, b);
    div(a, b) = _mm256_div_pd(a, b);
    mul_add(a, b, c) = _mm256_fmadd_pd(a, b, c);
    abs(a) = _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
    sqrt(a) = _mm256_sqrt_pd(a);
    min(a, b) = _mm256_min_pd(a, b);
    max(a, b) = _mm256_max_pd(a, b);
    lt(a, b) = _mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm256_cmp_pd::<_CMP_LE_OQ>(a, b);
    orders_by_bits = false;
    later(a, b) = _mm256_max_pd(a, b);
    earlier(a, b) = _mm256_min_pd(a, b);
    not_after(a, b) = _mm256_cmp_pd::<_CMP_LE_OQ>(a, b);
    select(a, mask, b) = _mm256_blendv_pd(b, a, mask);
    and(a, b) = _mm256_and_pd(a, b);
    or(a, b) = _mm256_or_pd(a, b);
    not(a) = _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi32(-1)));
    bits(mask) = _mm256_movemask_pd(mask) as u32;
}

halves! {
    F32x8 of F32x4:
    join(first, second) = _mm256_set_m128(second, first),
    split(both) = [_mm256_castps256_ps128(both), _mm256_extractf128_ps::<1>(both)]
}
