//! Four lanes in plain code, without vector instructions.
#![expect(unused_unsafe, reason = "its operations are safe, those of instruction sets are not")]

use crate::simd::isa::plain_isa;
use crate::simd::vector::vector;

/// The token of plain code, which needs no proof.
#[derive(Clone, Copy, Debug)]
pub struct Portable(());

plain_isa!(Portable, F32x4, F64x4, runs_routines: false);

/// Evaluates an expression for each of four lanes.
macro_rules! each {
    ($k:ident => $value:expr) => {{
        let at = |$k: usize| $value;
        [at(0), at(1), at(2), at(3)]
    }};
}

macro_rules! four {
    ($lanes:ident, $mask:ident, $scalar:ty) => {
        vector! {
            $lanes([$scalar; 4]), $mask([bool; 4]): 4 of $scalar, Portable;
            splat(x) = [x; 4];
            load(from) = from.cast::<[$scalar; 4]>().read_unaligned();
            load_bytes(from) = {
                let bytes = from.cast::<[u8; 4]>().read();
                each!(k => <$scalar>::from(bytes[k]))
            };
            store(a, to) = to.cast::<[$scalar; 4]>().write(a);
            add(a, b) = each!(k => a[k] + b[k]);
            sub(a, b) = each!(k => a[k] - b[k]);
            mul(a, b) = each!(k => a[k] * b[k]);
            div(a, b) = each!(k => a[k] / b[k]);
            mul_add(a, b, c) = each!(k => a[k] * b[k] + c[k]);
            abs(a) = each!(k => a[k].abs());
            sqrt(a) = each!(k => crate::simd::ScalarLanes::rounded_sqrt(a[k]));
            min(a, b) = each!(k => if a[k] < b[k] { a[k] } else { b[k] });
            max(a, b) = each!(k => if a[k] > b[k] { a[k] } else { b[k] });
            lt(a, b) = each!(k => a[k] < b[k]);
            le(a, b) = each!(k => a[k] <= b[k]);
            orders_by_bits = false;
            later(a, b) = each!(k => if a[k] > b[k] { a[k] } else { b[k] });
            earlier(a, b) = each!(k => if a[k] < b[k] { a[k] } else { b[k] });
            not_after(a, b) = each!(k => a[k] <= b[k]);
            select(a, mask, b) = each!(k => if mask[k] { a[k] } else { b[k] });
            and(a, b) = each!(k => a[k] & b[k]);
            or(a, b) = each!(k => a[k] | b[k]);
            not(a) = each!(k => !a[k]);
            bits(mask) = {
                let [a, b, c, d] = each!(k => u32::from(mask[k]) << k);
                a | b | c | d
            };
        }
    };
}

four!(F32x4, Mask32x4, f32);
four!(F64x4, Mask64x4, f64);
