//! The choice of the instruction set that a query runs with, at run time.

use super::{Baseline, Doubled, Isa, LeafLanes, Single};
use core::fmt;
#[cfg(feature = "std")]
use std::sync::OnceLock;

/// An instruction set that queries are compiled for.
///
/// Queries use [`best`](Self::best) unless
/// [`Builder::instruction_set`](crate::Builder::instruction_set) names another one, to compare or
/// to test. Answers are the same bits on all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Plain code on four to sixteen scalars, without vector instructions.
    Portable,
    /// The least that the target has.
    ///
    /// It is SSE2 on x86-64, NEON on aarch64, and SIMD128 on wasm32 if that is enabled.
    Baseline,
    /// AVX2: x86-64-v3.
    Avx2,
    /// AVX-512, as processors have it since Ice Lake and Zen 4.
    Avx512,
}

impl InstructionSet {
    /// All instruction sets, from the least to the best.
    pub const ALL: &[Self] = &[Self::Portable, Self::Baseline, Self::Avx2, Self::Avx512];

    /// Returns the best instruction set that this processor has.
    ///
    /// Without the feature `std` the processor cannot be asked, and this is the best one of
    /// the build's target.
    pub fn best() -> Self {
        Backend::best().instruction_set()
    }

    /// Returns those that this processor has and this build contains, the least first.
    ///
    /// `Portable` is in builds for targets without vectors, and in builds with the feature
    /// `portable`, which is for tests.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(|&set| Backend::of(set).is_some())
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Portable => "portable",
            Self::Baseline => "baseline",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        })
    }
}

/// Code that is compiled once for each instruction set.
pub trait Kernel {
    /// Whether it is compiled for all instruction sets, or for the baseline alone.
    const IS_WIDE: bool;
    /// Whether a wide kernel is compiled for AVX-512 too, or for AVX2 at most.
    const USES_AVX512: bool = true;
    type Output;
    /// Runs the kernel.
    ///
    /// It is `#[inline(always)]`, and so is each function that it calls and that has to
    /// use the instructions.
    fn run<I: Isa>(self, isa: I) -> Self::Output;
}

/// A kernel whose arguments stay in registers.
///
/// As fields of a [`Kernel`] the arguments would be written to memory and read again, and the
/// dispatch would call the chosen copy instead of jumping to it.
pub trait Routine {
    type A;
    type B;
    type C;
    type D;
    type Output;
    /// Whether there is a copy with [`Doubled`] vectors, for where those are faster.
    const HAS_DOUBLED: bool;

    /// Runs the routine.
    ///
    /// It is `#[inline(always)]`, and so is each function that it calls and that has to
    /// use the instructions.
    fn run<I: Isa, W: LeafLanes>(
        isa: I,
        backend: Backend,
        a: Self::A,
        b: Self::B,
        c: Self::C,
        d: Self::D,
    ) -> Self::Output;

    /// Gives the same output by other code.
    ///
    /// It runs where [`run`](Self::run) is not compiled: for the baseline of x86, since processors
    /// of the last ten years have more, and for the portable path. `run` itself may leave
    /// arguments to it that are rare.
    fn run_general(backend: Backend, a: Self::A, b: Self::B, c: Self::C, d: Self::D) -> Self::Output;
}

macro_rules! backends {
    ($($(#[$where:meta])* $backend:ident($module:ident::$isa:ident) = $set:ident, $call:ident;)*) => {
        /// An instruction set that the processor was found to have.
        ///
        /// The variant's value is the proof.
        #[derive(Clone, Copy, Debug)]
        pub enum Backend {
            $($(#[$where])* $backend(super::$module::$isa),)*
        }

        impl Backend {
            pub fn of(set: InstructionSet) -> Option<Self> {
                Self::all().find(|backend| backend.instruction_set() == set && backend.is_quicker())
            }

            /// Returns all variants that the processor has.
            pub fn all() -> impl Iterator<Item = Self> {
                let all = [$($(#[$where])* super::$module::$isa::detect().map(Self::$backend),)*];
                all.into_iter().flatten()
            }

            pub fn instruction_set(self) -> InstructionSet {
                match self {
                    $($(#[$where])* Self::$backend(_) => InstructionSet::$set,)*
                }
            }

            /// Runs the routine's copy for this instruction set.
            #[inline(always)]
            pub fn call<R: Routine>(self, a: R::A, b: R::B, c: R::C, d: R::D) -> R::Output {
                match self {
                    $($(#[$where])* Self::$backend(isa) => $call::<_, R>(isa, self, a, b, c, d),)*
                }
            }

            /// Runs the kernel's copy for this instruction set.
            #[inline(always)]
            pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
                if const { !K::IS_WIDE } && let Some(isa) = Baseline::detect() {
                    return kernel.run(isa);
                }
                match self {
                    $($(#[$where])* Self::$backend(isa) => run_wide(isa, kernel),)*
                }
            }
        }
    };
}

backends! {
    #[cfg(any(feature = "portable", not(any(
        all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"),
        all(target_arch = "aarch64", target_feature = "neon"),
        all(target_arch = "wasm32", target_feature = "simd128"),
    ))))]
    Portable(portable::Portable) = Portable, call;
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
    Sse2(x86::Sse2) = Baseline, call;
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
    Avx2(x86::Avx2) = Avx2, call;
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
    Avx512(x86::Avx512) = Avx512, call;
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
    Avx512Doubled(x86::Avx512) = Avx512, call_doubled;
    #[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
    Neon(neon::Neon) = Baseline, call;
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    Simd128(simd128::Simd128) = Baseline, call;
}

impl Backend {
    /// Returns the best that the processor has.
    ///
    /// The processor is asked once, since builders need the answer often.
    #[cfg(feature = "std")]
    pub fn best() -> Self {
        static BEST: OnceLock<Backend> = OnceLock::new();
        *BEST.get_or_init(Self::detect)
    }

    /// Returns the best that the build's target has.
    #[cfg(not(feature = "std"))]
    pub fn best() -> Self {
        Self::detect()
    }

    /// Whether this is the faster variant of its instruction set on this processor.
    fn is_quicker(self) -> bool {
        match self {
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
            Self::Avx512(_) => !super::x86::is_doubled_quicker(),
            #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
            Self::Avx512Doubled(_) => super::x86::is_doubled_quicker(),
            _ => true,
        }
    }

    fn detect() -> Self {
        let best = InstructionSet::ALL.iter().copied().rev().find_map(Self::of);
        best.expect("every target has a baseline or the portable path")
    }
}

#[inline(always)]
fn run_wide<I: Isa, K: Kernel>(isa: I, kernel: K) -> K::Output {
    if const { K::USES_AVX512 } { vectorized(isa, kernel) } else { vectorized(isa.up_to_avx2(), kernel) }
}

#[inline(always)]
fn call<I: Isa, R: Routine>(isa: I, backend: Backend, a: R::A, b: R::B, c: R::C, d: R::D) -> R::Output {
    if const { I::RUNS_ROUTINES } {
        isa.call::<R, Single>(backend, a, b, c, d)
    } else {
        R::run_general(backend, a, b, c, d)
    }
}

#[cfg_attr(
    not(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2")),
    expect(dead_code, reason = "AVX-512 alone has doubled vectors")
)]
#[inline(always)]
fn call_doubled<I: Isa, R: Routine>(
    isa: I,
    backend: Backend,
    a: R::A,
    b: R::B,
    c: R::C,
    d: R::D,
) -> R::Output {
    if const { R::HAS_DOUBLED } {
        isa.call::<R, Doubled>(backend, a, b, c, d)
    } else {
        call::<I, R>(isa, backend, a, b, c, d)
    }
}

/// Runs the kernel inside one function that has the instructions enabled.
#[inline(always)]
fn vectorized<I: Isa, K: Kernel>(isa: I, kernel: K) -> K::Output {
    isa.vectorize(
        #[inline(always)]
        || kernel.run(isa),
    )
}
