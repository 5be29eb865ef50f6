//! x86: SSE2, AVX2 and AVX-512.

mod avx2;
mod avx512;
mod doubled;
mod sort;
mod sse2;

#[cfg(target_arch = "x86")]
use core::arch::x86 as arch;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64 as arch;

pub use avx2::Avx2;
pub use avx512::Avx512;
pub use doubled::is_doubled_quicker;
pub use sse2::Sse2;

/// Whether the processor has all of these features.
///
/// Without `std`, whether the build's target has them.
macro_rules! has {
    ($($feature:tt),* $(,)?) => {{
        #[cfg(feature = "std")]
        let has = $(std::is_x86_feature_detected!($feature))&&*;
        #[cfg(not(feature = "std"))]
        let has = cfg!(all($(target_feature = $feature),*));
        has
    }};
}

/// Implements `Halves` for a vector type that is one register.
macro_rules! halves {
    ($lanes:ident of $half:ident: join($first:ident, $second:ident) = $join:expr, split($both:ident) = $split:expr) => {
        impl crate::simd::Halves<$half> for $lanes {
            #[inline(always)]
            fn of_halves([first, second]: [$half; 2]) -> Self {
                let ($first, $second) = (first.0, second.0);
                // SAFETY: the vectors hold the token: the processor has the instructions.
                Self(unsafe { $join }, first.1)
            }
            #[inline(always)]
            fn to_halves(self) -> [$half; 2] {
                let $both = self.0;
                // SAFETY: the vector holds the token: the processor has the instructions.
                let [first, second] = unsafe { $split };
                [$half(first, self.1), $half(second, self.1)]
            }
        }
    };
}

/// The methods of an `Isa` that run code below a function with these features enabled.
macro_rules! with_features {
    ($($features:literal),+) => {
        #[inline(always)]
        fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
            $(#[target_feature(enable = $features)])+
            fn with_instructions<R>(f: impl FnOnce() -> R) -> R {
                f()
            }
            // SAFETY: the token proves that the processor has the features.
            unsafe { with_instructions(f) }
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
            $(#[target_feature(enable = $features)])+
            fn routine<I: crate::simd::Isa, R: crate::simd::Routine, W: crate::simd::LeafLanes>(
                isa: I,
                backend: crate::simd::Backend,
                a: R::A,
                b: R::B,
                c: R::C,
                d: R::D,
            ) -> R::Output {
                R::run::<I, W>(isa, backend, a, b, c, d)
            }
            // SAFETY: as above.
            unsafe { routine::<Self, R, W>(self, backend, a, b, c, d) }
        }
    };
}

use {halves, has, with_features};
