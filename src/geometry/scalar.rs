//! The two scalars, `f32` and `f64`, behind one sealed trait.

use crate::simd::{Halves, Isa, Lanes};
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("bvhkit without its feature `std` needs `libm`, for square roots");

/// A coordinate: `f32` or `f64`. Sealed; a bound to write generic code with.
///
/// Its arithmetic is the plain IEEE 754 one: no operation is fused or reordered, so that equal
/// operands give equal bits on every machine.
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
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 0.5.
    const HALF: Self;
    /// -infinity.
    const NEG_INFINITY: Self;
    /// +infinity.
    const INFINITY: Self;
    /// The largest number.
    const MAX: Self;
    /// The distance from 1 to the next larger number: twice the largest relative rounding error.
    const EPSILON: Self;

    /// The absolute value.
    fn abs(self) -> Self;
    /// Itself, with its sign turned if `other` has a minus sign.
    fn xor_sign(self, other: Self) -> Self;
    /// The square root, rounded correctly; NaN below zero.
    fn sqrt(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Finite and at least the smallest number of full precision in size.
    fn is_normal_number(self) -> bool;
    /// Not a number.
    fn is_nan(self) -> bool;
    /// The next larger number (the smallest subnormal after zero).
    fn next_up(self) -> Self;
    /// The next smaller number.
    fn next_down(self) -> Self;
    /// A total order, -0 before +0.
    fn total_cmp(&self, other: &Self) -> core::cmp::Ordering;
    /// The nearest scalar to `value`.
    fn from_f64(value: f64) -> Self;
    /// Exact for both scalars.
    fn to_f64(self) -> f64;
    /// An integer whose unsigned order is the total order of the scalars.
    fn to_ordered_bits(self) -> u64;
}

/// The vectors of a scalar.
pub trait ScalarLanes: Sized {
    /// Four of them side by side, for the slab test of two boxes.
    type Lanes4: crate::simd::Lanes4<Self>;
    /// Lanes of an instruction set.
    type Times4<I: Isa>: Lanes<Self, Isa = I>;
    type Times8<I: Isa>: Lanes<Self, Isa = I> + Halves<Self::Times4<I>>;
    type Times16<I: Isa>: Lanes<Self, Isa = I>;
    /// Eight, to compute with beside sixteen.
    type Times8Doubled<I: Isa>: Lanes<Self, Isa = I>;
}

/// What this crate does with scalars, and users do not.
pub trait ScalarParts: Sized {
    /// No scalar is wider.
    const IS_WIDEST: bool;
    /// A power of two: an area below it and above its inverse has rounded as it should.
    const LARGE_AREA: Self;
    /// The same for a volume, near the ends of the range.
    const LARGE_VOLUME: Self;
    /// The scalar in which products and differences of this one's lose little or nothing: `f64`.
    type Wide: Scalar;

    /// Whether it is below zero, or -0.
    fn has_minus_sign(self) -> bool;
    /// `self * other`, rounded, and what the rounding left out, exactly but for underflow.
    fn exact_product(self, other: Self) -> [Self; 2];
    /// A power of two with which the product is in [1, 2] in size, if it is a normal number; a finite
    /// one above zero for any.
    fn inverse_power_of_two(self) -> Self;
    /// One of two, without a branch.
    fn select(first: bool, if_first: Self, otherwise: Self) -> Self;
    /// Exactly, in the wide scalar.
    fn widen(self) -> Self::Wide;
    /// The nearest to a wide scalar.
    fn narrow(wide: Self::Wide) -> Self;
    /// The nearest scalar to a number of things.
    fn from_count(count: i32) -> Self;
}

/// The smaller of two, `b` if either is NaN: one `min` instruction.
#[inline(always)]
pub(crate) fn min<S: Scalar>(a: S, b: S) -> S {
    if a < b { a } else { b }
}

/// The larger of two, `b` if either is NaN: one `max` instruction.
#[inline(always)]
pub(crate) fn max<S: Scalar>(a: S, b: S) -> S {
    if a > b { a } else { b }
}

macro_rules! scalar {
    (
        $scalar:ident, $lanes4:ty, [$times4:ident, $times8:ident, $times16:ident, $times8_doubled:ident],
        $bits:ident, $signed:ident, $libm_sqrt:ident, $libm_fma:ident, $large_area:expr, $large_volume:expr
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
                #[cfg(feature = "std")]
                return $scalar::sqrt(self);
                #[cfg(not(feature = "std"))]
                return libm::$libm_sqrt(self);
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
                // Negative numbers have all bits flipped, the others the sign bit alone.
                let bits = self.to_bits();
                let mask = ((bits as $signed) >> ($bits::BITS - 1)) as $bits | (1 << ($bits::BITS - 1));
                u64::from(bits ^ mask)
            }
        }

        impl ScalarLanes for $scalar {
            type Lanes4 = $lanes4;
            type Times4<I: Isa> = I::$times4;
            type Times8<I: Isa> = I::$times8;
            type Times16<I: Isa> = I::$times16;
            type Times8Doubled<I: Isa> = I::$times8_doubled;
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
                // 2^e has the bits of (e + bias) << digits: negated, twice the bias is left over.
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

scalar!(
    f32,
    crate::simd::F32Lanes4,
    [F32x4, F32x8, F32x16, F32x8Doubled],
    u32,
    i32,
    sqrtf,
    fmaf,
    f32::from_bits((127 + 60) << 23),
    f32::from_bits((127 + 100) << 23)
);
scalar!(
    f64,
    [f64; 4],
    [F64x4, F64x8, F64x16, F64x8],
    u64,
    i64,
    sqrt,
    fma,
    f64::from_bits((1023 + 600) << 52),
    f64::from_bits((1023 + 900) << 52)
);

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
