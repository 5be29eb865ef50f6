//! Eight scalars, computed with twice over.
//!
//! While vectors of 512 bits are under way, an Intel processor multiplies vectors of 256 bits in
//! one place, but those of 512 in two. So with AVX-512 a leaf's eight primitives are tested in both
//! halves of a vector that is as wide as a node's. Both hold the same, at no price: a row is spread
//! over them on its way from the cache. On an Intel Xeon (Granite Rapids), means of a kitchen,
//! dragon and sponza in two runs, closest hits of `Fast` triangles were 1.10, 1.07 and 1.07 times
//! as quick (primary, diffuse, random), any hits 1.05, of `Watertight` ones 1.12, 1.10, 1.09 and
//! 1.07.
//!
//! Quotients and square roots are computed once: of 512 bits they take twice as long as of 256.
#![expect(unused_unsafe, reason = "masks are integers: their operations are safe, those of vectors are not")]

use super::Avx512;
use super::arch::*;
use crate::simd::vector::vector;
use core::sync::atomic::{AtomicU8, Ordering};

vector! {
    F32x8Doubled(__m512), Mask8Doubled(__mmask16): 8 of f32, Avx512;
    splat(x) = _mm512_set1_ps(x);
    load(from) = _mm512_broadcast_f32x8(_mm256_loadu_ps(from));
    load_bytes(from) = {
        let scalars = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(from.cast())));
        _mm512_broadcast_f32x8(scalars)
    };
    store(a, to) = _mm256_storeu_ps(to, _mm512_castps512_ps256(a));
    add(a, b) = _mm512_add_ps(a, b);
    sub(a, b) = _mm512_sub_ps(a, b);
    mul(a, b) = _mm512_mul_ps(a, b);
    div(a, b) = {
        let (a, b) = (_mm512_castps512_ps256(a), _mm512_castps512_ps256(b));
        _mm512_broadcast_f32x8(_mm256_div_ps(a, b))
    };
    mul_add(a, b, c) = _mm512_fmadd_ps(a, b, c);
    abs(a) = _mm512_abs_ps(a);
    sqrt(a) = _mm512_broadcast_f32x8(_mm256_sqrt_ps(_mm512_castps512_ps256(a)));
    min(a, b) = _mm512_min_ps(a, b);
    max(a, b) = _mm512_max_ps(a, b);
    lt(a, b) = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    orders_by_bits = false;
    later(a, b) = _mm512_max_ps(a, b);
    earlier(a, b) = _mm512_min_ps(a, b);
    not_after(a, b) = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    select(a, mask, b) = _mm512_mask_blend_ps(mask, b, a);
    and(a, b) = a & b;
    or(a, b) = a | b;
    not(a) = !a;
    bits(mask) = u32::from(mask) & 0xFF;
}

/// Whether doubled vectors are quicker than single ones: on Intel's processors. On AMD's they are no quicker, and slower where
/// 512 bits take two passes: with single ones, on Zen 4, closest hits were 1.03 to 1.08 times as quick, any hits 1.03 to 1.10.
pub fn is_doubled_quicker() -> bool {
    /// 0 as long as nobody has asked: on a virtual machine the question takes microseconds.
    static ANSWER: AtomicU8 = AtomicU8::new(0);
    let mut answer = ANSWER.load(Ordering::Relaxed);
    if answer == 0 {
        // SAFETY: a processor with AVX2 has the instruction, and nobody asks on others.
        let vendor = unsafe { __cpuid(0) };
        let is_intel =
            [vendor.ebx, vendor.edx, vendor.ecx].map(u32::to_le_bytes) == [*b"Genu", *b"ineI", *b"ntel"];
        answer = 1 + u8::from(is_intel);
        ANSWER.store(answer, Ordering::Relaxed);
    }
    answer == 2
}
