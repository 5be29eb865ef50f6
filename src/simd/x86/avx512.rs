//! AVX-512, whose masks have registers of their own.
#![expect(unused_unsafe, reason = "masks are integers: their operations are safe, those of vectors are not")]

use super::arch::*;
use super::{halves, has, sort, with_features};
use crate::simd::vector::vector;
use crate::simd::{Isa, Pair, Window};

/// The token that proves AVX-512.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    #[inline]
    pub fn detect() -> Option<Self> {
        // The last five exclude processors before Ice Lake, which slow down when they use 512 bits.
        let has = has!(
            "avx512f",
            "avx512bw",
            "avx512cd",
            "avx512dq",
            "avx512vl",
            "avx512vbmi",
            "avx512vbmi2",
            "avx512vnni",
            "avx512bitalg",
            "avx512vpopcntdq"
        ) && super::Avx2::detect().is_some();
        has.then_some(Self(()))
    }
}

impl Isa for Avx512 {
    type F32x4 = F32x4;
    type F32x8 = F32x8;
    type F32x16 = F32x16;
    type F32x8Doubled = super::doubled::F32x8Doubled;
    type F64x4 = F64x4;
    type F64x8 = F64x8;
    type F64x16 = Pair<F64x8>;

    type UpToAvx2 = super::Avx2;

    #[inline(always)]
    fn up_to_avx2(self) -> super::Avx2 {
        super::Avx2::of_avx512(self)
    }
    with_features!("avx2,fma,bmi1,bmi2,lzcnt,popcnt", "avx512f,avx512bw,avx512cd,avx512dq,avx512vl");
}

vector! {
    F32x4(__m128), Mask4Of32(__mmask8): 4 of f32, Avx512;
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
    lt(a, b) = _mm_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = true;
    later(a, b) = _mm_castsi128_ps(_mm_max_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
    earlier(a, b) = _mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
    not_after(a, b) = _mm_cmple_epi32_mask(_mm_castps_si128(a), _mm_castps_si128(b));
    select(a, mask, b) = _mm_mask_blend_ps(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask) & 0xF;
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
    F32x8(__m256), Mask8Of32(__mmask8): 8 of f32, Avx512;
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
    lt(a, b) = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = true;
    later(a, b) = _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
    earlier(a, b) = _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b)));
    not_after(a, b) = _mm256_cmple_epi32_mask(_mm256_castps_si256(a), _mm256_castps_si256(b));
    select(a, mask, b) = _mm256_mask_blend_ps(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask);
}

vector! {
    F32x16(__m512), Mask16Of32(__mmask16): 16 of f32, Avx512;
    splat(x) = _mm512_set1_ps(x);
    load(from) = _mm512_loadu_ps(from);
    load_bytes(from) = _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128(from.cast())));
    store(a, to) = _mm512_storeu_ps(to, a);
    add(a, b) = _mm512_add_ps(a, b);
    sub(a, b) = _mm512_sub_ps(a, b);
    mul(a, b) = _mm512_mul_ps(a, b);
    div(a, b) = _mm512_div_ps(a, b);
    mul_add(a, b, c) = _mm512_fmadd_ps(a, b, c);
    abs(a) = _mm512_abs_ps(a);
    sqrt(a) = _mm512_sqrt_ps(a);
    min(a, b) = _mm512_min_ps(a, b);
    max(a, b) = _mm512_max_ps(a, b);
    lt(a, b) = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = true;
    later(a, b) = _mm512_castsi512_ps(_mm512_max_epi32(_mm512_castps_si512(a), _mm512_castps_si512(b)));
    earlier(a, b) = _mm512_castsi512_ps(_mm512_min_epi32(_mm512_castps_si512(a), _mm512_castps_si512(b)));
    not_after(a, b) = _mm512_cmple_epi32_mask(_mm512_castps_si512(a), _mm512_castps_si512(b));
    select(a, mask, b) = _mm512_mask_blend_ps(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask);

    #[inline(always)]
    fn sort(
        self,
        met: u32,
        children: &[u32],
        references: &mut Window<u32>,
        entries: &mut Window<f32>,
    ) -> Option<u32> {
        let children = row(self.1, children);
        sort::sort(self.1, self.0, met as u16, children, references, entries)
    }
    #[inline(always)]
    fn compress(isa: Avx512, met: u32, children: &[u32], references: &mut Window<u32>) -> bool {
        sort::compress(isa, met as u16, row(isa, children), references);
        true
    }
}

vector! {
    F64x4(__m256d), Mask4Of64(__mmask8): 4 of f64, Avx512;
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
    lt(a, b) = _mm256_cmp_pd_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm256_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = false;
    later(a, b) = _mm256_max_pd(a, b);
    earlier(a, b) = _mm256_min_pd(a, b);
    not_after(a, b) = _mm256_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
    select(a, mask, b) = _mm256_mask_blend_pd(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask) & 0xF;
}

vector! {
    F64x8(__m512d), Mask8Of64(__mmask8): 8 of f64, Avx512;
    splat(x) = _mm512_set1_pd(x);
    load(from) = _mm512_loadu_pd(from);
    load_bytes(from) = _mm512_cvtepi32_pd(_mm256_cvtepu8_epi32(_mm_loadl_epi64(from.cast())));
    store(a, to) = _mm512_storeu_pd(to, a);
    add(a, b) = _mm512_add_pd(a, b);
    sub(a, b) = _mm512_sub_pd(a, b);
    mul(a, b) = _mm512_mul_pd(a, b);
    div(a, b) = _mm512_div_pd(a, b);
    mul_add(a, b, c) = _mm512_fmadd_pd(a, b, c);
    abs(a) = _mm512_abs_pd(a);
    sqrt(a) = _mm512_sqrt_pd(a);
    min(a, b) = _mm512_min_pd(a, b);
    max(a, b) = _mm512_max_pd(a, b);
    lt(a, b) = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = false;
    later(a, b) = _mm512_max_pd(a, b);
    earlier(a, b) = _mm512_min_pd(a, b);
    not_after(a, b) = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
    select(a, mask, b) = _mm512_mask_blend_pd(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask);
}

halves! {
    F32x8 of F32x4:
    join(first, second) = _mm256_set_m128(second, first),
    split(both) = [_mm256_castps256_ps128(both), _mm256_extractf128_ps::<1>(both)]
}

halves! {
    F64x8 of F64x4:
    join(first, second) = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(first), second),
    split(both) = [_mm512_castpd512_pd256(both), _mm512_extractf64x4_pd::<1>(both)]
}

/// Loads the children of a node.
#[inline(always)]
fn row(_: Avx512, children: &[u32]) -> __m512i {
    let children = children[..16].as_ptr();
    // SAFETY: the token proves the instructions, and the slice has sixteen children of four bytes.
    unsafe { _mm512_loadu_si512(children.cast()) }
}
