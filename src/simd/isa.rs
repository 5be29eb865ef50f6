//! Instruction sets: their vectors, and how code is compiled for them.

use super::{Backend, Halves, Lanes, LeafLanes, Routine};
use core::fmt::Debug;

/// An instruction set. A value of it is the proof that the processor has the instructions: it comes
/// from the type's `detect`, and from nowhere else.
pub trait Isa: Copy + Debug + Send + Sync + 'static {
    /// Whether routines are compiled for it: for what processors of the last ten years have.
    const RUNS_ROUTINES: bool = true;

    type F32x4: Lanes<f32, Isa = Self>;
    type F32x8: Lanes<f32, Isa = Self> + Halves<Self::F32x4>;
    type F32x16: Lanes<f32, Isa = Self>;
    /// Eight, to compute with beside sixteen.
    type F32x8Doubled: Lanes<f32, Isa = Self>;
    type F64x4: Lanes<f64, Isa = Self>;
    type F64x8: Lanes<f64, Isa = Self> + Halves<Self::F64x4>;
    type F64x16: Lanes<f64, Isa = Self>;

    /// Itself, or AVX2 where that is less.
    type UpToAvx2: Isa;
    fn up_to_avx2(self) -> Self::UpToAvx2;

    /// Runs `f`, which is `#[inline(always)]`, below one function with the instructions switched on.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;

    /// Runs a routine's copy, as one function with the instructions switched on.
    fn call<R: Routine, W: LeafLanes>(
        self,
        backend: Backend,
        a: R::A,
        b: R::B,
        c: R::C,
        d: R::D,
    ) -> R::Output;
}

/// The instruction set of a target whose every processor has it, or that needs none.
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
