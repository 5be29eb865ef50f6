//! An exact rational number.

use super::integers::decompose;
use crate::geometry::Scalar;
use core::cmp::Ordering;
use core::fmt;
use dashu_int::ops::Gcd;
use dashu_int::{IBig, UBig};

/// An exact rational number: the t of an exact hit.
///
/// Fractions compare by value, and are displayed in lowest terms.
///
/// # Examples
///
/// ```
/// use bvhkit::{Ray, Triangle, reference::exact};
/// let at = |z: f64| Triangle::new([-1.0, -1.0, z], [9.0, -1.0, z], [-1.0, 9.0, z]);
/// let ray = Ray::new([0.0, 0.0, 1.0], [0.0, 0.0, 3.0]);
/// let [third, two_thirds] = [2.0, 3.0].map(|z| exact::intersect(&at(z), &ray).unwrap());
/// assert!(third < two_thirds);
/// assert_eq!((third.to_string(), third.to_f64()), ("1/3".to_string(), 1.0 / 3.0));
/// // 0.25 is too small by 1/12, which is 1.5e15 times the distance from 1/3 to the next number.
/// assert!((third.ulps_from(0.25) / -1.5e15 - 1.0).abs() < 1e-3);
/// ```
#[derive(Clone)]
pub struct Fraction {
    // The value is numerator / denominator * 2^exponent. The denominator is not zero. Fractions are
    // not reduced: common divisors cost more to find than to carry.
    pub(super) numerator: IBig,
    pub(super) denominator: UBig,
    pub(super) exponent: i32,
}

impl Fraction {
    /// Returns numerator / denominator * 2^exponent; `None` for a denominator of zero.
    pub(super) fn new(numerator: IBig, denominator: IBig, exponent: i32) -> Option<Self> {
        let (sign, denominator) = denominator.into_parts();
        (!denominator.is_zero()).then(|| Self { numerator: numerator * sign, denominator, exponent })
    }

    /// Returns the value of a finite number.
    pub(super) fn of(x: f64) -> Self {
        let (m, exponent) = decompose(x);
        Self { numerator: m.into(), denominator: UBig::ONE, exponent }
    }

    /// Returns the nearest `f64`, as [`to_scalar`](Self::to_scalar) does.
    pub fn to_f64(&self) -> f64 {
        self.nearest::<f64>()
    }

    /// Returns the nearest `f32` or `f64`, as IEEE 754 rounds.
    ///
    /// Of two equally near numbers it is the one with the even last bit. Subnormal numbers are
    /// rounded to their coarser spacing. A value that is too small becomes zero with the sign kept,
    /// and one that is too large becomes infinity.
    pub fn to_scalar<S: Scalar>(&self) -> S {
        // The value is a number of `S` already.
        S::from_f64(self.nearest::<S>())
    }

    /// Compares with a number, exactly.
    ///
    /// -infinity is less than every fraction. Infinity and NaN are greater.
    pub fn cmp_scalar<S: Scalar>(&self, x: S) -> Ordering {
        let x = x.to_f64();
        if x.is_finite() {
            self.cmp(&Self::of(x))
        } else if x == f64::NEG_INFINITY {
            Ordering::Greater
        } else {
            Ordering::Less
        }
    }

    /// Returns the error of `t` as an approximation of this number, in ulps.
    ///
    /// This is (t - exact) / ulp, computed exactly and then rounded to the nearest `f64`. Its size
    /// is at most 0.5 for the nearest `S`.
    ///
    /// The ulp is the spacing of the numbers of `S` at the exact value: the distance between
    /// the two neighbours on both sides of it. If the exact value is a power of two, two
    /// spacings meet there, and the ulp is the wider one, on the side away from zero. At and
    /// near zero it is the smallest positive number. Beyond the largest number it is computed
    /// as if the exponents went on.
    ///
    /// An infinite or NaN `t` is returned as it is.
    pub fn ulps_from<S: Scalar>(&self, t: S) -> f64 {
        let t = t.to_f64();
        if !t.is_finite() {
            return t;
        }
        let mut error = Self::of(t).minus(self);
        error.exponent -= self.spacing_exponent::<S>();
        error.to_f64()
    }

    fn minus(&self, other: &Self) -> Self {
        let (left, right, exponent) = self.over_common_denominator(other);
        Self { numerator: left - right, denominator: &self.denominator * &other.denominator, exponent }
    }

    /// Returns both numerators over the product of denominators, and their exponent.
    fn over_common_denominator(&self, other: &Self) -> (IBig, IBig, i32) {
        let exponent = self.exponent.min(other.exponent);
        let left = (&self.numerator * &other.denominator) << (self.exponent - exponent) as usize;
        let right = (&other.numerator * &self.denominator) << (other.exponent - exponent) as usize;
        (left, right, exponent)
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> Ordering {
        let (left, right, _) = self.over_common_denominator(other);
        left.cmp(&right)
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Fraction {}

/// Shows the value exactly, in lowest terms, with a positive denominator.
///
/// It is for example `-3/4`, or `5` for a whole number. Both parts are decimal integers with as
/// many digits as needed.
impl fmt::Display for Fraction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shift = self.exponent.unsigned_abs() as usize;
        let (above, below) = if self.exponent >= 0 { (shift, 0) } else { (0, shift) };
        let (numerator, denominator) = (&self.numerator << above, &self.denominator << below);
        // The denominator is not zero.
        let common = (&numerator).gcd(&denominator);
        let (numerator, denominator) = (numerator / &common, denominator / &common);
        if denominator.is_one() { write!(f, "{numerator}") } else { write!(f, "{numerator}/{denominator}") }
    }
}

impl fmt::Debug for Fraction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    fn fraction(numerator: i64, denominator: i64, exponent: i32) -> Fraction {
        Fraction::new(numerator.into(), denominator.into(), exponent).unwrap()
    }

    #[test]
    fn fractions_compare_by_value_whatever_their_parts() {
        assert_eq!(fraction(1, -3, 1), fraction(-8, 6, -1));
        assert_eq!(fraction(0, 5, 9), fraction(0, -7, -9));
        let ordered = [(-1, 1, 70), (-1, 3, 0), (0, 1, 0), (1, 3, -2000), (1, 3, 0), (2, 5, 0), (1, 1, 70)];
        for pair in ordered.map(|(n, d, e)| fraction(n, d, e)).windows(2) {
            assert_eq!(pair[0].cmp(&pair[1]), Ordering::Less, "{pair:?}");
            assert_eq!(pair[1].cmp(&pair[0]), Ordering::Greater, "{pair:?}");
        }
        assert!(Fraction::new(1.into(), 0.into(), 0).is_none());
    }

    #[test]
    fn fractions_compare_with_numbers_exactly() {
        let third = fraction(1, 3, 0);
        assert_eq!(third.cmp_scalar(1.0f32 / 3.0), Ordering::Less);
        assert_eq!(third.cmp_scalar((1.0f32 / 3.0).next_down()), Ordering::Greater);
        assert_eq!(third.cmp_scalar(1.0 / 3.0), Ordering::Greater);
        assert_eq!(fraction(3, -8, 1).cmp_scalar(-0.75f32), Ordering::Equal);
        assert_eq!(fraction(1, 1, -1074).cmp_scalar(5e-324), Ordering::Equal);
        assert_eq!(fraction(0, 3, 0).cmp_scalar(-0.0f32), Ordering::Equal);
        for huge in [fraction(1, 1, 5000), fraction(-1, 1, 5000)] {
            assert_eq!(huge.cmp_scalar(f64::INFINITY), Ordering::Less);
            assert_eq!(huge.cmp_scalar(f32::NEG_INFINITY), Ordering::Greater);
            assert_eq!(huge.cmp_scalar(f32::NAN), Ordering::Less);
            assert_eq!(huge.cmp_scalar(f64::MAX).is_gt(), huge.cmp_scalar(0.0f32).is_gt());
        }
    }

    #[test]
    fn fractions_are_shown_in_lowest_terms() {
        for (n, d, e, shown) in [
            (6, -8, 0, "-3/4"),
            (5, 3, -1, "5/6"),
            (10, 4, 1, "5"),
            (0, 7, -3, "0"),
            (-1, 1, 64, "-18446744073709551616"),
        ] {
            assert_eq!(fraction(n, d, e).to_string(), shown);
        }
    }

    #[test]
    fn ulps_are_those_at_the_exact_value() {
        let u = f64::from(f32::EPSILON);
        // The spacing of `f32` from 1 to 2 is u, and below 1 it is half of that.
        assert_eq!(fraction(1, 1, 0).ulps_from(1.0f32 + f32::EPSILON), 1.0);
        assert_eq!(fraction(1, 1, 0).ulps_from(1.0f32.next_down()), -0.5);
        assert_eq!(fraction(3, 4, 0).ulps_from(1.0f32), 0.5 / u);
        assert_eq!(fraction(-3, 2, 0).ulps_from((-1.5f32).next_up()), 1.0);
        assert_eq!(fraction(1, 3, 0).ulps_from(1.0f32 / 3.0), 1.0 / 3.0);
        assert_eq!(fraction(1, 3, 0).ulps_from(1.0 / 3.0), -1.0 / 3.0);
        // Subnormal numbers, and zero.
        assert_eq!(fraction(5, 2, -149).ulps_from(f32::from_bits(3)), 0.5);
        assert_eq!(fraction(5, 2, -1074).ulps_from(-0.0), -2.5);
        assert_eq!(fraction(0, 1, 0).ulps_from(f32::from_bits(1)), 1.0);
        assert_eq!(fraction(1, 1, -126).ulps_from(f32::MIN_POSITIVE.next_down()), -1.0);
        // Beyond the largest number.
        assert_eq!(fraction(1, 1, 128).ulps_from(f32::MAX), -0.5);
        assert_eq!(fraction(1, 1, 3000).ulps_from(0.0), -(2.0f64.powi(52)));
        assert_eq!(fraction(1, 1, 128).ulps_from(f32::INFINITY), f64::INFINITY);
        assert!(fraction(1, 1, 0).ulps_from(f64::NAN).is_nan());
    }
}
