//! Eight lanes in a vector of sixteen, which holds each lane twice.
//!
//! While 512-bit operations are in flight, an Intel processor has one port for 256-bit multiplies,
//! but two for 512-bit ones. So with AVX-512 the eight primitives of a leaf are tested in both
//! halves of a vector that is as wide as a node's. Both halves hold the same lanes, and that costs
//! nothing: the load from the cache broadcasts a row to both. On an Intel Xeon rays are 1.05 to
//! 1.12 times as fast (measured: docs/decisions.md, 8).
//!
//! Quotients and square roots are computed once, in 256 bits: in 512 bits they take twice as long.
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

/// Whether doubled vectors are faster than single ones, as on Intel's processors.
///
/// On AMD's processors they are no faster, and they are slower where a 512-bit operation takes two
/// passes (measured: docs/decisions.md, 8).
pub fn is_doubled_quicker() -> bool {
    /// 0 until the first call.
    ///
    /// On a virtual machine the CPUID instruction takes microseconds.
    static ANSWER: AtomicU8 = AtomicU8::new(0);
    let mut answer = ANSWER.load(Ordering::Relaxed);
    if answer == 0 {
        // SAFETY: each processor with AVX-512 has CPUID, and `Backend::is_quicker` calls this only
        // after `Avx512::detect` has found it.
        let vendor = unsafe { __cpuid(0) };
        let is_intel =
            [vendor.ebx, vendor.edx, vendor.ecx].map(u32::to_le_bytes) == [*b"Genu", *b"ineI", *b"ntel"];
        answer = 1 + u8::from(is_intel);
        ANSWER.store(answer, Ordering::Relaxed);
    }
    answer == 2
}
