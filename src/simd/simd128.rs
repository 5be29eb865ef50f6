//! The SIMD128 instructions of WebAssembly.
#![expect(unused_unsafe, reason = "its operations are safe, those of other instruction sets are not")]

use crate::simd::Pair;
use crate::simd::isa::plain_isa;
use crate::simd::vector::vector;
use core::arch::wasm32::*;

/// The token that proves SIMD128.
#[derive(Clone, Copy, Debug)]
pub struct Simd128(());

plain_isa!(Simd128, F32x4, Pair<F64x2>, runs_routines: true);

vector! {
    F32x4(v128), Mask32x4(v128): 4 of f32, Simd128;
    splat(x) = f32x4_splat(x);
    load(from) = v128_load(from.cast());
    load_bytes(from) = {
        let shorts = u16x8_extend_low_u8x16(v128_load32_zero(from.cast()));
        f32x4_convert_u32x4(u32x4_extend_low_u16x8(shorts))
    };
    store(a, to) = v128_store(to.cast(), a);
    add(a, b) = f32x4_add(a, b);
    sub(a, b) = f32x4_sub(a, b);
    mul(a, b) = f32x4_mul(a, b);
    div(a, b) = f32x4_div(a, b);
    mul_add(a, b, c) = f32x4_add(f32x4_mul(a, b), c);
    abs(a) = f32x4_abs(a);
    sqrt(a) = f32x4_sqrt(a);
    // `f32x4_pmin(b, a)` is a < b ? a : b.
    min(a, b) = f32x4_pmin(b, a);
    max(a, b) = f32x4_pmax(b, a);
    lt(a, b) = f32x4_lt(a, b);
    le(a, b) = f32x4_le(a, b);
    orders_by_bits = true;
    later(a, b) = i32x4_max(a, b);
    earlier(a, b) = i32x4_min(a, b);
    not_after(a, b) = i32x4_le(a, b);
    select(a, mask, b) = v128_bitselect(a, b, mask);
    and(a, b) = v128_and(a, b);
    or(a, b) = v128_or(a, b);
    not(a) = v128_not(a);
    bits(mask) = u32::from(i32x4_bitmask(mask));
}

vector! {
    F64x2(v128), Mask64x2(v128): 2 of f64, Simd128;
    splat(x) = f64x2_splat(x);
    load(from) = v128_load(from.cast());
    load_bytes(from) = f64x2(f64::from(*from), f64::from(*from.add(1)));
    store(a, to) = v128_store(to.cast(), a);
    add(a, b) = f64x2_add(a, b);
    sub(a, b) = f64x2_sub(a, b);
    mul(a, b) = f64x2_mul(a, b);
    div(a, b) = f64x2_div(a, b);
    mul_add(a, b, c) = f64x2_add(f64x2_mul(a, b), c);
    abs(a) = f64x2_abs(a);
    sqrt(a) = f64x2_sqrt(a);
    min(a, b) = f64x2_pmin(b, a);
    max(a, b) = f64x2_pmax(b, a);
    lt(a, b) = f64x2_lt(a, b);
    le(a, b) = f64x2_le(a, b);
    orders_by_bits = false;
    later(a, b) = f64x2_pmax(b, a);
    earlier(a, b) = f64x2_pmin(b, a);
    not_after(a, b) = f64x2_le(a, b);
    select(a, mask, b) = v128_bitselect(a, b, mask);
    and(a, b) = v128_and(a, b);
    or(a, b) = v128_or(a, b);
    not(a) = v128_not(a);
    bits(mask) = u32::from(i64x2_bitmask(mask));
}
