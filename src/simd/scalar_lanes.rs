//! The vectors of `f32` and `f64`.

use super::{F32Lanes4, Halves, Isa, Lanes, Lanes4};

/// The vector types of a scalar.
pub trait ScalarLanes: Copy {
    /// Four scalars side by side, for the slab test of two boxes.
    type Lanes4: Lanes4<Self>;
    /// Four lanes of the instruction set `I`.
    type Times4<I: Isa>: Lanes<Self, Isa = I>;
    /// Eight lanes of the instruction set `I`.
    type Times8<I: Isa>: Lanes<Self, Isa = I> + Halves<Self::Times4<I>>;
    /// Sixteen lanes of the instruction set `I`.
    type Times16<I: Isa>: Lanes<Self, Isa = I>;
    /// Eight lanes, to compute with beside sixteen.
    ///
    /// With AVX-512 the vector holds each `f32` twice (see `simd::x86::doubled`).
    type Times8Doubled<I: Isa>: Lanes<Self, Isa = I>;

    /// Returns the square root, rounded correctly; NaN below zero.
    fn rounded_sqrt(self) -> Self;
    /// Returns an integer, rounded toward zero.
    fn to_i32(self) -> i32;
}

macro_rules! scalar {
    (
        $scalar:ident, $lanes4:ty,
        [$times4:ident, $times8:ident, $times16:ident, $times8_doubled:ident], $libm_sqrt:ident
    ) => {
        impl ScalarLanes for $scalar {
            type Lanes4 = $lanes4;
            type Times4<I: Isa> = I::$times4;
            type Times8<I: Isa> = I::$times8;
            type Times16<I: Isa> = I::$times16;
            type Times8Doubled<I: Isa> = I::$times8_doubled;

            #[inline(always)]
            fn rounded_sqrt(self) -> Self {
                #[cfg(feature = "std")]
                return $scalar::sqrt(self);
                #[cfg(not(feature = "std"))]
                return libm::$libm_sqrt(self);
            }
            #[inline(always)]
            fn to_i32(self) -> i32 {
                self as i32
            }
        }
    };
}

scalar!(f32, F32Lanes4, [F32x4, F32x8, F32x16, F32x8Doubled], sqrtf);
scalar!(f64, [f64; 4], [F64x4, F64x8, F64x16, F64x8], sqrt);
