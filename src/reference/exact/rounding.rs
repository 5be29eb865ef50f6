//! Rounding of a fraction to the nearest floating-point number.

use super::fraction::Fraction;
use super::integers::decompose;
use crate::geometry::Scalar;
use core::cmp::Ordering;
use dashu_int::ops::{BitTest, DivRem, UnsignedAbs};
use dashu_int::{IBig, UBig};

/// The floating-point format of a scalar.
struct Format {
    /// The number of binary digits of the significand, with the leading one.
    digits: i32,
    /// The smallest positive number is 2^lowest.
    lowest: i32,
    /// The largest number is between 2^highest and twice that.
    highest: i32,
}

impl Format {
    fn of<S: Scalar>() -> Self {
        let exponent = |x: S| decompose(x.to_f64()).1;
        let digits = 1 - exponent(S::EPSILON);
        let lowest = exponent(S::ZERO.next_up());
        // The largest number has all digits set.
        let highest = exponent(S::INFINITY.next_down()) + digits - 1;
        Self { digits, lowest, highest }
    }
}

impl Fraction {
    /// Returns the nearest number of `S`, ties to even.
    pub(super) fn nearest<S: Scalar>(&self) -> f64 {
        let Some(top) = self.floor_log2() else { return 0.0 };
        let format = Format::of::<S>();
        let size = if top > format.highest {
            f64::INFINITY
        } else {
            let unit = self.spacing_exponent::<S>();
            // The multiple is at most 2^digits, and its product with the spacing is a number of
            // `S`. So both operations are exact, or overflow as rounding should.
            self.nearest_multiple_of_power(unit) * power_of_two(unit)
        };
        if self.numerator < IBig::ZERO { -size } else { size }
    }

    /// Returns the exponent of the spacing of the numbers of `S` at this value.
    pub(super) fn spacing_exponent<S: Scalar>(&self) -> i32 {
        let format = Format::of::<S>();
        match self.floor_log2() {
            Some(top) => format.lowest.max(top + 1 - format.digits),
            None => format.lowest,
        }
    }

    /// Returns the k with 2^k <= |self| < 2^(k + 1); `None` for zero.
    fn floor_log2(&self) -> Option<i32> {
        let size = self.size();
        if size.is_zero() {
            return None;
        }
        // The ratio is between 2^(k - 1) and 2^(k + 1).
        let k = bit_length(&size) - bit_length(&self.denominator);
        let k = if at_scale(&size, -k) >= at_scale(&self.denominator, k) { k } else { k - 1 };
        Some(k + self.exponent)
    }

    /// Returns |self| / 2^unit as the nearest integer, ties to even.
    ///
    /// It is exact below 2^53.
    fn nearest_multiple_of_power(&self, unit: i32) -> f64 {
        let shift = self.exponent - unit;
        let (numerator, denominator) = (at_scale(&self.size(), shift), at_scale(&self.denominator, -shift));
        let (quotient, remainder) = numerator.div_rem(&denominator);
        let up = match (remainder << 1usize).cmp(&denominator) {
            Ordering::Less => false,
            Ordering::Equal => quotient.trailing_zeros() == Some(0),
            Ordering::Greater => true,
        };
        quotient.to_f64().value() + f64::from(up)
    }

    fn size(&self) -> UBig {
        (&self.numerator).unsigned_abs()
    }
}

/// Returns n * 2^shift if the shift is positive, else n.
///
/// Of the two parts of a ratio one is scaled up, instead of the other down.
fn at_scale(n: &UBig, shift: i32) -> UBig {
    n << shift.max(0) as usize
}

fn bit_length(n: &UBig) -> i32 {
    n.bit_len() as i32
}

/// Returns 2^exponent, for the exponents of positive `f64` numbers.
fn power_of_two(exponent: i32) -> f64 {
    if exponent >= -1022 {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    } else {
        f64::from_bits(1 << (exponent + 1074))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fraction(numerator: i64, denominator: i64, exponent: i32) -> Fraction {
        Fraction::new(numerator.into(), denominator.into(), exponent).unwrap()
    }

    /// Checks that a fraction rounds to a number, and its opposite to the opposite.
    fn assert_rounds<S: Scalar>(numerator: i64, denominator: i64, exponent: i32, expected: S) {
        for (numerator, expected) in [(numerator, expected), (-numerator, -expected)] {
            let rounded = fraction(numerator, denominator, exponent).to_scalar::<S>();
            let case = (numerator, denominator, exponent, rounded);
            assert_eq!(rounded.to_ordered_bits(), expected.to_ordered_bits(), "{case:?}");
        }
    }

    #[test]
    fn the_nearest_number_is_that_of_the_division() {
        for n in 1..200 {
            for d in 1..200 {
                assert_rounds(n, d, 0, n as f64 / d as f64);
                assert_rounds(n, d, -3, n as f32 / d as f32 / 8.0);
            }
        }
    }

    #[test]
    fn ties_go_to_even() {
        let one = 1 << 24;
        assert_rounds(one + 1, 1, -24, 1.0f32);
        assert_rounds(one + 3, 1, -24, 1.0f32 + 2.0 * f32::EPSILON);
        // A little beyond the tie: rounding to `f64` first would lose it.
        assert_rounds((one + 1) << 36 | 1, 1, -60, 1.0f32.next_up());
        assert_rounds((one + 1) << 36, 1, -60, 1.0f32);
        assert_rounds(((one + 1) << 36) - 1, 1, -60, 1.0f32);
        // These round up to the next power of two.
        assert_rounds((one << 1) - 1, 1, -25, 1.0f32);
        assert_rounds((1 << 53) + 1, 1, -53, 1.0);
        assert_rounds((1 << 53) + 3, 1, -53, 1.0 + 2.0 * f64::EPSILON);
        assert_rounds((1 << 54) - 1, 1, -54, 1.0);
    }

    #[test]
    fn subnormal_numbers_have_their_own_spacing() {
        assert_rounds(1, 1, -149, f32::from_bits(1));
        assert_rounds(1, 1, -1074, f64::from_bits(1));
        // Ties between 0 and 1, 1 and 2, 2 and 3, 3 and 4 times the smallest number.
        for (n, expected) in [(1, 0), (3, 2), (5, 2), (7, 4)] {
            assert_rounds(n, 2, -149, f32::from_bits(expected as u32));
            assert_rounds(n, 2, -1074, f64::from_bits(expected));
        }
        assert_rounds(501, 1000, -149, f32::from_bits(1));
        assert_rounds(499, 1000, -1074, 0.0);
        assert_rounds(1, 1, -5000, 0.0);
        assert_rounds(1, 1, -5000, 0.0f32);
        // The largest subnormal number, and numbers between it and the smallest normal one.
        assert_rounds((1 << 23) - 1, 1, -149, f32::MIN_POSITIVE.next_down());
        assert_rounds((1 << 24) - 1, 2, -149, f32::MIN_POSITIVE);
        assert_rounds((1 << 53) - 1, 2, -1074, f64::MIN_POSITIVE);
    }

    #[test]
    fn large_numbers_round_to_infinity_from_half_a_spacing_on() {
        let one = 1 << 25;
        assert_rounds((1 << 24) - 1, 1, 104, f32::MAX);
        assert_rounds(one - 1, 1, 103, f32::INFINITY);
        assert_rounds(((one - 1) << 30) - 1, 1, 73, f32::MAX);
        assert_rounds((1 << 54) - 1, 1, 970, f64::INFINITY);
        assert_rounds((1 << 54) - 2, 1, 970, f64::MAX);
        assert_rounds(((1 << 55) - 2) * 3 - 1, 3, 969, f64::MAX);
        assert_rounds(1, 1, 5000, f64::INFINITY);
    }

    #[test]
    fn zero_is_positive() {
        for zero in [fraction(0, 3, 7), fraction(0, -3, -7)] {
            assert_eq!((zero.to_f64().to_bits(), zero.to_scalar::<f32>().to_bits()), (0, 0));
        }
    }
}
