//! Instruction sets: their vector types, and how code is compiled for them.

use super::{Backend, Halves, Lanes, LeafLanes, Routine};
use core::fmt::Debug;

/// An instruction set: a token that proves that the processor has it.
///
/// A token comes from the type's `detect`, or from a wider instruction set's token by
/// [`up_to_avx2`](Self::up_to_avx2), and from nowhere else.
pub trait Isa: Copy + Debug + Send + Sync + 'static {
    /// Whether a [`Routine`] is compiled for it.
    ///
    /// Routines are compiled for the instruction sets of processors of the last ten years.
    const RUNS_ROUTINES: bool = true;

    type F32x4: Lanes<f32, Isa = Self>;
    type F32x8: Lanes<f32, Isa = Self> + Halves<Self::F32x4>;
    type F32x16: Lanes<f32, Isa = Self>;
    /// Eight lanes for the leaf test of `Doubled` kernels, beside nodes of sixteen.
    type F32x8Doubled: Lanes<f32, Isa = Self>;
    type F64x4: Lanes<f64, Isa = Self>;
    type F64x8: Lanes<f64, Isa = Self> + Halves<Self::F64x4>;
    type F64x16: Lanes<f64, Isa = Self>;

    /// This instruction set, or AVX2 if this one is wider.
    type UpToAvx2: Isa;
    fn up_to_avx2(self) -> Self::UpToAvx2;

    /// Runs `f` inside one function that has the instructions enabled.
    ///
    /// `f` is `#[inline(always)]`.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;

    /// Runs a routine's copy, as one function that has the instructions enabled.
    fn call<R: Routine, W: LeafLanes>(
        self,
        backend: Backend,
        a: R::A,
        b: R::B,
        c: R::C,
        d: R::D,
    ) -> R::Output;
}

/// Implements `Isa` for an instruction set that needs no detection.
///
/// Every processor of the target has it, or it is plain code.
macro_rules! plain_isa {
    ($isa:ident, $four:ident, $two_or_four:ty, runs_routines: $runs_routines:literal) => {
        impl crate::simd::isa::Isa for $isa {
            const RUNS_ROUTINES: bool = $runs_routines;
            type F32x4 = $four;
            type F32x8 = crate::simd::Pair<$four>;
            type F32x16 = crate::simd::Pair<Self::F32x8>;
            type F32x8Doubled = Self::F32x8;
            type F64x4 = $two_or_four;
            type F64x8 = crate::simd::Pair<Self::F64x4>;
            type F64x16 = crate::simd::Pair<Self::F64x8>;

            type UpToAvx2 = Self;

            #[inline(always)]
            fn up_to_avx2(self) -> Self {
                self
            }
            #[inline(always)]
            fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
                f()
            }
            #[inline(always)]
            fn call<R: crate::simd::Routine, W: crate::simd::LeafLanes>(
                self,
                backend: crate::simd::Backend,
                a: R::A,
                b: R::B,
                c: R::C,
                d: R::D,
            ) -> R::Output {
                R::run::<Self, W>(self, backend, a, b, c, d)
            }
        }

        impl $isa {
            #[inline(always)]
            pub fn detect() -> Option<Self> {
                Some(Self(()))
            }
        }
    };
}

pub(super) use plain_isa;
