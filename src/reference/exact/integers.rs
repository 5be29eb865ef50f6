//! Floating-point numbers as integers in a common unit.

use core::ops::Shl;

/// Returns (m, e) for the finite number m * 2^e, with m odd; (0, 0) for zero.
pub(super) fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    // Subnormal numbers have the exponent of the smallest normal ones, without the leading one.
    let (m, e) = match (bits >> 52 & 0x7ff) as i32 {
        0 => (fraction, -1074),
        exponent => (fraction | 1 << 52, exponent - 1075),
    };
    if m == 0 {
        return (0, 0);
    }
    let zeros = m.trailing_zeros();
    let m = m >> zeros;
    (if x < 0.0 { -m } else { m }, e + zeros as i32)
}

/// Finite numbers as integers times one power of two.
///
/// This is the largest power that leaves all of them whole, so that ordinary numbers
/// make small integers.
pub(super) struct Integers<const N: usize> {
    parts: [(i64, i32); N],
    /// The unit is 2^exponent.
    pub exponent: i32,
    /// The integers are below 2^bits in size.
    pub bits: i32,
}

impl<const N: usize> Integers<N> {
    pub fn new(values: [f64; N]) -> Self {
        let parts = values.map(decompose);
        let (mut exponent, mut top) = (i32::MAX, i32::MIN);
        for (m, e) in parts.into_iter().filter(|part| part.0 != 0) {
            exponent = exponent.min(e);
            top = top.max(e + (u64::BITS - m.unsigned_abs().leading_zeros()) as i32);
        }
        if top == i32::MIN {
            (exponent, top) = (0, 0);
        }
        Self { parts, exponent, bits: top - exponent }
    }

    /// Returns the integers, as a type that holds `bits` bits and a sign.
    pub fn to_array<I: From<i64> + Shl<usize, Output = I>>(&self) -> [I; N] {
        self.parts.map(|(m, e)| match m {
            0 => I::from(0),
            _ => I::from(m) << (e - self.exponent) as usize,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_apart_exactly() {
        assert_eq!(decompose(0.0), (0, 0));
        assert_eq!(decompose(-0.0), (0, 0));
        assert_eq!(decompose(-6.0), (-3, 1));
        assert_eq!(decompose(5e-324), (1, -1074));
        assert_eq!(decompose(-1.5e-323), (-3, -1074));
        assert_eq!(decompose(f64::MIN_POSITIVE), (1, -1022));
        assert_eq!(decompose(f64::from(f32::MAX)), ((1 << 24) - 1, 104));
        assert_eq!(decompose(f64::MAX), ((1 << 53) - 1, 971));
    }

    #[test]
    fn the_unit_is_as_large_as_can_be() {
        let integers = Integers::new([0.75, -20.0, 0.0, 0.5]);
        assert_eq!((integers.exponent, integers.bits), (-2, 7));
        assert_eq!(integers.to_array::<i128>(), [3, -80, 0, 2]);
        let zeros = Integers::new([0.0, -0.0]);
        assert_eq!((zeros.exponent, zeros.bits, zeros.to_array::<i128>()), (0, 0, [0; 2]));
    }
}
