//! NEON, which every aarch64 target has except those without floating point.

use crate::simd::Pair;
use crate::simd::isa::plain_isa;
use crate::simd::vector::vector;
use core::arch::aarch64::*;

/// The token that proves NEON.
#[derive(Clone, Copy, Debug)]
pub struct Neon(());

plain_isa!(Neon, F32x4, Pair<F64x2>, runs_routines: true);

vector! {
    F32x4(float32x4_t), Mask32x4(uint32x4_t): 4 of f32, Neon;
    splat(x) = vdupq_n_f32(x);
    load(from) = vld1q_f32(from);
    load_bytes(from) = {
        let [a, b, c, d] = from.cast::<[u8; 4]>().read();
        let shorts = vmovl_u8(vld1_u8([a, b, c, d, 0, 0, 0, 0].as_ptr()));
        vcvtq_f32_u32(vmovl_u16(vget_low_u16(shorts)))
    };
    store(a, to) = vst1q_f32(to, a);
    add(a, b) = vaddq_f32(a, b);
    sub(a, b) = vsubq_f32(a, b);
    mul(a, b) = vmulq_f32(a, b);
    div(a, b) = vdivq_f32(a, b);
    // The addend is the first argument.
    mul_add(a, b, c) = vfmaq_f32(c, a, b);
    abs(a) = vabsq_f32(a);
    sqrt(a) = vsqrtq_f32(a);
    // The instructions for minimum and maximum return NaN if either operand is NaN.
    min(a, b) = vbslq_f32(vcltq_f32(a, b), a, b);
    max(a, b) = vbslq_f32(vcgtq_f32(a, b), a, b);
    lt(a, b) = vcltq_f32(a, b);
    le(a, b) = vcleq_f32(a, b);
    orders_by_bits = true;
    later(a, b) =
        vreinterpretq_f32_s32(vmaxq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b)));
    earlier(a, b) =
        vreinterpretq_f32_s32(vminq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b)));
    not_after(a, b) = vcleq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b));
    select(a, mask, b) = vbslq_f32(mask, a, b);
    and(a, b) = vandq_u32(a, b);
    or(a, b) = vorrq_u32(a, b);
    not(a) = vmvnq_u32(a);
    bits(mask) = vaddvq_u32(vandq_u32(mask, vld1q_u32([1, 2, 4, 8].as_ptr())));
}

vector! {
    F64x2(float64x2_t), Mask64x2(uint64x2_t): 2 of f64, Neon;
    splat(x) = vdupq_n_f64(x);
    load(from) = vld1q_f64(from);
    load_bytes(from) = {
        let [a, b] = from.cast::<[u8; 2]>().read();
        vcvtq_f64_u64(vld1q_u64([u64::from(a), u64::from(b)].as_ptr()))
    };
    store(a, to) = vst1q_f64(to, a);
    add(a, b) = vaddq_f64(a, b);
    sub(a, b) = vsubq_f64(a, b);
    mul(a, b) = vmulq_f64(a, b);
    div(a, b) = vdivq_f64(a, b);
    mul_add(a, b, c) = vfmaq_f64(c, a, b);
    abs(a) = vabsq_f64(a);
    sqrt(a) = vsqrtq_f64(a);
    min(a, b) = vbslq_f64(vcltq_f64(a, b), a, b);
    max(a, b) = vbslq_f64(vcgtq_f64(a, b), a, b);
    lt(a, b) = vcltq_f64(a, b);
    le(a, b) = vcleq_f64(a, b);
    orders_by_bits = false;
    later(a, b) = vbslq_f64(vcgtq_f64(a, b), a, b);
    earlier(a, b) = vbslq_f64(vcltq_f64(a, b), a, b);
    not_after(a, b) = vcleq_f64(a, b);
    select(a, mask, b) = vbslq_f64(mask, a, b);
    and(a, b) = vandq_u64(a, b);
    or(a, b) = vorrq_u64(a, b);
    not(a) = veorq_u64(a, vdupq_n_u64(u64::MAX));
    bits(mask) = vaddvq_u64(vandq_u64(mask, vld1q_u64([1, 2].as_ptr()))) as u32;
}
