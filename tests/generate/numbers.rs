//! Strategies for numbers with any bits, and for numbers with any exponent.

use bvhkit::Scalar;
use proptest::prelude::*;

/// Returns the number with these bits, or zero if it is not finite.
///
/// Tiny and huge numbers are equally likely: subnormals, both zeros, both ends of the range.
pub fn scalar_from_bits<S: Scalar>(bits: u64) -> S {
    let x = if size_of::<S>() == 4 { f64::from(f32::from_bits(bits as u32)) } else { f64::from_bits(bits) };
    S::from_f64(if x.is_finite() { x } else { 0.0 })
}

/// A power of two from the smallest subnormal to the largest number.
///
/// All powers are equally likely. The field is a position from 0 to 1 in the range of any scalar.
#[derive(Clone, Copy, Debug)]
pub struct Exponent(f64);

pub fn exponent() -> impl Strategy<Value = Exponent> {
    (0.0..1.0).prop_map(Exponent)
}

impl Exponent {
    /// Returns `x` times the power of two.
    pub fn scale<S: Scalar>(self, x: f64) -> S {
        let (low, high) = if size_of::<S>() == 4 { (-149, 127) } else { (-1074, 1023) };
        let exponent = low + (f64::from(high + 1 - low) * self.0) as i32;
        // Two factors, since the inverse of the whole power may be infinite.
        let half = exponent / 2;
        S::from_f64(x * 2f64.powi(half) * 2f64.powi(exponent - half))
    }
}

/// A number with either sign, any exponent and any mantissa.
#[derive(Clone, Copy, Debug)]
pub struct LogUniform {
    exponent: Exponent,
    mantissa: f64,
}

pub fn log_uniform() -> impl Strategy<Value = LogUniform> {
    // The bound is so close to 2 that no f32 is between them, and rounded it stays below 2.
    let mantissa =
        (1.0..1.999_999_9, any::<bool>()).prop_map(|(x, negative): (f64, _)| if negative { -x } else { x });
    (exponent(), mantissa).prop_map(|(exponent, mantissa)| LogUniform { exponent, mantissa })
}

impl LogUniform {
    pub fn number<S: Scalar>(self) -> S {
        self.exponent.scale(self.mantissa)
    }
}
