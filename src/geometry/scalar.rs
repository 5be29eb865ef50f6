//! The two scalars, `f32` and `f64`, behind one sealed trait.

use crate::simd::ScalarLanes;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("bvhkit without its feature `std` needs `libm`, for square roots");

/// A coordinate: `f32` or `f64`.
///
/// The trait is sealed; use it as a bound in generic code.
///
/// Its arithmetic is plain IEEE 754. No operation is fused or reordered, so equal operands give
/// equal bits on every machine.
pub trait Scalar:
    ScalarLanes
    + ScalarParts
    + crate::builders::CompiledBuilders
    + crate::bvh::CompiledBuild
    + crate::layout::CompiledLayout
    + crate::traverse::ScalarKernels
    + Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// The number 0.5.
    const HALF: Self;
    /// Negative infinity.
    const NEG_INFINITY: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// The largest finite number.
    const MAX: Self;
    /// The distance from 1 to the next larger number: twice the largest relative rounding error.
    const EPSILON: Self;

    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Returns `self`, with its sign flipped if `other` has a minus sign.
    fn xor_sign(self, other: Self) -> Self;
    /// Returns the square root, rounded correctly; NaN below zero.
    fn sqrt(self) -> Self;
    /// Returns whether the value is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Returns whether the value is finite, and neither zero nor subnormal.
    fn is_normal_number(self) -> bool;
    /// Returns whether the value is NaN.
    fn is_nan(self) -> bool;
    /// Returns the next larger number (the smallest subnormal after zero).
    fn next_up(self) -> Self;
    /// Returns the next smaller number.
    fn next_down(self) -> Self;
    /// Compares by a total order, -0 before +0.
    fn total_cmp(&self, other: &Self) -> core::cmp::Ordering;
    /// Returns the scalar nearest to `value`.
    fn from_f64(value: f64) -> Self;
    /// Converts to `f64`, exactly for both scalars.
    fn to_f64(self) -> f64;
    /// Returns an integer whose unsigned order is the total order of the scalars.
    fn to_ordered_bits(self) -> u64;
}

/// Constants and operations of scalars that this crate uses, and users do not.
pub trait ScalarParts: Sized {
    /// Whether no scalar is wider.
    const IS_WIDEST: bool;
    /// A power of two: an area below it and above its inverse is rounded correctly.
    const LARGE_AREA: Self;
    /// The same for a volume, near the ends of the range.
    const LARGE_VOLUME: Self;
    /// The wide scalar, which is `f64`.
    ///
    /// Products and differences of this scalar lose little or nothing in it.
    type Wide: Scalar;

    /// Returns whether the value has a minus sign: it is below zero, or -0.
    fn has_minus_sign(self) -> bool;
    /// Returns `self * other`, rounded, and the part that was rounded away.
    ///
    /// The second part is exact, except for underflow.
    fn exact_product(self, other: Self) -> [Self; 2];
    /// Returns a power of two that scales a normal `self` to about 1.
    ///
    /// The size of the product is in [1, 2), or in [2, 4) if the exponent of `self` is the largest.
    /// For every finite `self` the power is finite and above zero.
    fn inverse_power_of_two(self) -> Self;
    /// Returns one of two values, without a branch.
    fn select(first: bool, if_first: Self, otherwise: Self) -> Self;
    /// Converts to the wide scalar, exactly.
    fn widen(self) -> Self::Wide;
    /// Returns the scalar nearest to `wide`.
    fn narrow(wide: Self::Wide) -> Self;
    /// Returns the scalar nearest to `count`.
    fn from_count(count: i32) -> Self;
}

/// Returns the smaller of two, `b` if either is NaN: one `min` instruction.
#[inline(always)]
pub(crate) fn min<S: Scalar>(a: S, b: S) -> S {
    if a < b { a } else { b }
}

/// Returns the larger of two, `b` if either is NaN: one `max` instruction.
#[inline(always)]
pub(crate) fn max<S: Scalar>(a: S, b: S) -> S {
    if a > b { a } else { b }
}

macro_rules! scalar {
    (
        $scalar:ident, $bits:ident, $signed:ident, $libm_fma:ident, $large_area:expr, $large_volume:expr
    ) => {
        impl Scalar for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const INFINITY: Self = $scalar::INFINITY;
            const NEG_INFINITY: Self = $scalar::NEG_INFINITY;
            const MAX: Self = $scalar::MAX;
            const EPSILON: Self = $scalar::EPSILON;

            #[inline(always)]
            fn abs(self) -> Self {
                $scalar::abs(self)
            }
            #[inline(always)]
            fn xor_sign(self, other: Self) -> Self {
                let sign = 1 << ($bits::BITS - 1);
                Self::from_bits(self.to_bits() ^ (other.to_bits() & sign))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.rounded_sqrt()
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $scalar::is_finite(self)
            }
            #[inline(always)]
            fn is_normal_number(self) -> bool {
                $scalar::is_normal(self)
            }
            #[inline(always)]
            fn is_nan(self) -> bool {
                $scalar::is_nan(self)
            }
            #[inline(always)]
            fn next_up(self) -> Self {
                $scalar::next_up(self)
            }
            #[inline(always)]
            fn next_down(self) -> Self {
                $scalar::next_down(self)
            }
            #[inline(always)]
            fn total_cmp(&self, other: &Self) -> core::cmp::Ordering {
                $scalar::total_cmp(self, other)
            }
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $scalar
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn to_ordered_bits(self) -> u64 {
                // All bits of negative numbers are flipped, and the sign bit alone of the others.
                let bits = self.to_bits();
                let mask = ((bits as $signed) >> ($bits::BITS - 1)) as $bits | (1 << ($bits::BITS - 1));
                u64::from(bits ^ mask)
            }
        }

        impl ScalarParts for $scalar {
            const IS_WIDEST: bool = size_of::<Self>() == size_of::<f64>();
            const LARGE_AREA: Self = $large_area;
            const LARGE_VOLUME: Self = $large_volume;
            type Wide = f64;

            #[inline(always)]
            fn has_minus_sign(self) -> bool {
                self.is_sign_negative()
            }
            #[inline(always)]
            fn exact_product(self, other: Self) -> [Self; 2] {
                let product = self * other;
                #[cfg(feature = "std")]
                let rest = self.mul_add(other, -product);
                #[cfg(not(feature = "std"))]
                let rest = libm::$libm_fma(self, other, -product);
                [product, rest]
            }
            #[inline(always)]
            fn inverse_power_of_two(self) -> Self {
                // The bits of 2^e are (e + bias) << digits. Those of 2^-e are twice the
                // bias minus these.
                let exponent = self.to_bits() & Self::INFINITY.to_bits();
                let twice_the_bias = 2 * (1.0 as Self).to_bits();
                Self::from_bits(twice_the_bias.wrapping_sub(exponent).max(Self::MIN_POSITIVE.to_bits()))
            }
            #[inline(always)]
            fn select(first: bool, if_first: Self, otherwise: Self) -> Self {
                let mask = ($bits::from(first)).wrapping_neg();
                Self::from_bits((if_first.to_bits() & mask) | (otherwise.to_bits() & !mask))
            }
            #[inline(always)]
            fn widen(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn narrow(wide: f64) -> Self {
                wide as $scalar
            }
            #[inline(always)]
            fn from_count(count: i32) -> Self {
                count as $scalar
            }
        }
    };
}

scalar!(f32, u32, i32, fmaf, f32::from_bits((127 + 60) << 23), f32::from_bits((127 + 100) << 23));
scalar!(f64, u64, i64, fma, f64::from_bits((1023 + 600) << 52), f64::from_bits((1023 + 900) << 52));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordered_bits_order_as_total_cmp_does() {
        let values = [f32::NEG_INFINITY, -1.5, -1e-45, -0.0, 0.0, 1e-45, 2.0, f32::INFINITY];
        for pair in values.windows(2) {
            assert!(pair[0].to_ordered_bits() < pair[1].to_ordered_bits(), "{pair:?}");
        }
        let doubles = values.map(f64::from);
        for pair in doubles.windows(2) {
            assert!(pair[0].to_ordered_bits() < pair[1].to_ordered_bits(), "{pair:?}");
        }
    }

    #[test]
    fn min_and_max_ignore_a_nan_on_the_left() {
        assert_eq!(min(f32::NAN, 1.0), 1.0);
        assert_eq!(max(f64::NAN, 1.0), 1.0);
    }
}
