//! The two scalars, `f32` and `f64`, behind one sealed trait.

use crate::simd::{Halves, Lanes, Pair, Twice};
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};
use fearless_simd::{Simd, f32x4, f32x8, f32x16, f64x4, f64x8};
use glam::Vec3Swizzles;

/// A coordinate: `f32` or `f64`. Sealed; a bound to write generic code with.
///
/// Its arithmetic is the plain IEEE 754 one: no operation is fused or reordered, so that equal
/// operands give equal bits on every machine.
pub trait Scalar:
    sealed::Sealed
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

    /// No scalar is wider.
    #[doc(hidden)]
    const IS_WIDEST: bool;
    /// A power of two: an area below it and above its inverse has rounded as it should.
    #[doc(hidden)]
    const LARGE_AREA: Self;
    /// The same for a volume, near the ends of the range.
    #[doc(hidden)]
    const LARGE_VOLUME: Self;

    /// glam's vector of this scalar, in which the arithmetic of primitives is done.
    #[doc(hidden)]
    type Vec3: Vector<Self>;
    /// Four of them side by side, for the slab test of two boxes.
    #[doc(hidden)]
    type Lanes4: crate::simd::Lanes4<Self>;
    /// Lanes of an instruction set.
    #[doc(hidden)]
    type Times4<I: Simd>: Lanes<Self, Isa = I>;
    #[doc(hidden)]
    type Times8<I: Simd>: Lanes<Self, Isa = I> + Halves<Self::Times4<I>>;
    #[doc(hidden)]
    type Times16<I: Simd>: Lanes<Self, Isa = I>;
    /// Eight, to compute with beside sixteen.
    #[doc(hidden)]
    type Times8Of16<I: Simd>: Lanes<Self, Isa = I>;
    /// The scalar in which products and differences of this one's lose little or nothing: `f64`.
    #[doc(hidden)]
    type Wide: Scalar;

    /// The absolute value.
    fn abs(self) -> Self;
    /// Whether it is below zero, or -0.
    #[doc(hidden)]
    fn has_minus_sign(self) -> bool;
    /// Itself, with its sign turned if `other` has a minus sign.
    fn turned_by(self, other: Self) -> Self;
    /// The square root, rounded correctly; NaN below zero.
    fn sqrt(self) -> Self;
    /// `self * other`, rounded, and what the rounding left out, exactly but for underflow.
    #[doc(hidden)]
    fn exact_product(self, other: Self) -> [Self; 2];
    /// A power of two with which the product is in [1, 2] in size, if it is a normal number; a finite one above zero
    /// for any.
    #[doc(hidden)]
    fn inverse_power_of_two(self) -> Self;
    /// One of two, without a branch.
    #[doc(hidden)]
    fn select(first: bool, if_first: Self, otherwise: Self) -> Self;
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
    /// Exactly, in the wide scalar.
    #[doc(hidden)]
    fn widen(self) -> Self::Wide;
    /// The nearest to a wide scalar.
    #[doc(hidden)]
    fn narrow(wide: Self::Wide) -> Self;
    /// A total order, -0 before +0.
    fn total_cmp(&self, other: &Self) -> core::cmp::Ordering;
    /// The nearest scalar to `value`.
    fn from_f64(value: f64) -> Self;
    /// Exact for both scalars.
    fn to_f64(self) -> f64;
    /// The nearest scalar to a number of things.
    #[doc(hidden)]
    fn from_count(count: i32) -> Self;
    /// Rounded toward zero.
    ///
    /// # Safety
    /// From 0 to 2^31 - 1.
    #[doc(hidden)]
    unsafe fn to_small_integer(self) -> i32;
    /// An integer whose unsigned order is the total order of the scalars.
    fn to_ordered_bits(self) -> u64;
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

/// What the arithmetic of primitives needs of glam's vectors.
pub trait Vector<S>: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<S, Output = Self> {
    fn from_array(array: [S; 3]) -> Self;
    fn dot(self, other: Self) -> S;
    fn cross(self, other: Self) -> Self;
    fn to_array(self) -> [S; 3];
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

macro_rules! scalar {
    ($scalar:ident, $vec3:ty, $lanes4:ty, [$times4:ty, $times8:ty, $times16:ty, $times8_of_16:ty], $bits:ident, $signed:ident, $libm_sqrt:ident, $libm_fma:ident, $large_area:expr, $large_volume:expr) => {
        impl Scalar for $scalar {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const INFINITY: Self = $scalar::INFINITY;
            const NEG_INFINITY: Self = $scalar::NEG_INFINITY;
            const MAX: Self = $scalar::MAX;
            const EPSILON: Self = $scalar::EPSILON;
            const IS_WIDEST: bool = size_of::<Self>() == size_of::<f64>();
            const LARGE_AREA: Self = $large_area;
            const LARGE_VOLUME: Self = $large_volume;
            type Vec3 = $vec3;
            type Lanes4 = $lanes4;
            type Times4<I: Simd> = $times4;
            type Times8<I: Simd> = $times8;
            type Times16<I: Simd> = $times16;
            type Times8Of16<I: Simd> = $times8_of_16;
            type Wide = f64;

            #[inline(always)]
            fn abs(self) -> Self {
                $scalar::abs(self)
            }
            #[inline(always)]
            fn has_minus_sign(self) -> bool {
                self.is_sign_negative()
            }
            #[inline(always)]
            fn turned_by(self, other: Self) -> Self {
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
            fn exact_product(self, other: Self) -> [Self; 2] {
                let product = self * other;
                [product, libm::$libm_fma(self, other, -product)]
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
            fn widen(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn narrow(wide: f64) -> Self {
                wide as $scalar
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
            fn from_count(count: i32) -> Self {
                count as $scalar
            }
            #[inline(always)]
            unsafe fn to_small_integer(self) -> i32 {
                // SAFETY: the caller's.
                unsafe { self.to_int_unchecked() }
            }
            #[inline(always)]
            fn to_ordered_bits(self) -> u64 {
                // Negative numbers have all bits flipped, the others the sign bit alone.
                let bits = self.to_bits();
                let mask = ((bits as $signed) >> ($bits::BITS - 1)) as $bits | (1 << ($bits::BITS - 1));
                u64::from(bits ^ mask)
            }
        }

        impl Vector<$scalar> for $vec3 {
            #[inline(always)]
            fn from_array(array: [$scalar; 3]) -> Self {
                <$vec3>::from_array(array)
            }
            #[inline(always)]
            fn dot(self, other: Self) -> $scalar {
                <$vec3>::dot(self, other)
            }
            // glam's own fuses where the target has it: then the two products are rounded differently,
            // and the cross product of b and a is not that of a and b with its signs turned.
            #[inline(always)]
            fn cross(self, other: Self) -> Self {
                (self.zxy() * other - self * other.zxy()).zxy()
            }
            #[inline(always)]
            fn to_array(self) -> [$scalar; 3] {
                <$vec3>::to_array(&self)
            }
        }
    };
}

scalar!(
    f32,
    glam::Vec3A,
    glam::Vec4,
    [f32x4<I>, f32x8<I>, f32x16<I>, Twice<I>],
    u32,
    i32,
    sqrtf,
    fmaf,
    f32::from_bits((127 + 60) << 23),
    f32::from_bits((127 + 100) << 23)
);
scalar!(
    f64,
    glam::DVec3,
    [f64; 4],
    [f64x4<I>, f64x8<I>, Pair<f64x8<I>>, f64x8<I>],
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

    /// Fails where the build has fused multiplication and addition, and anything uses it.
    #[test]
    fn cross_products_turn_their_signs_exactly_and_dot_products_round_each_step() {
        // Two products that differ by less than a rounding.
        let (a, b) = ([1.0f32 + f32::EPSILON, 3.0, 0.7], [3.0f32 * (1.0 + f32::EPSILON), 9.0, 2.1]);
        fn check<S: Scalar>(a: [S; 3], b: [S; 3]) {
            let [x, y] = [a, b].map(S::Vec3::from_array);
            let products = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
            assert_eq!(x.cross(y).to_array(), [products(1, 2), products(2, 0), products(0, 1)]);
            assert_eq!(y.cross(x).to_array(), x.cross(y).to_array().map(|x| -x));
            assert_eq!(x.dot(y), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        }
        check(a, b);
        check(a.map(|x| f64::from(x) / 3.0), b.map(|x| f64::from(x) / 7.0));
    }

    #[test]
    fn min_and_max_ignore_a_nan_on_the_left() {
        assert_eq!(min(f32::NAN, 1.0), 1.0);
        assert_eq!(max(f64::NAN, 1.0), 1.0);
    }
}
