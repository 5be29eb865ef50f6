//! Which instructions a query is compiled for, chosen at run time.

use core::fmt;
use fearless_simd::{Level, Simd};

/// An instruction set that queries are compiled for.
///
/// [`best`](Self::best) is what is used unless [`Builder::instruction_set`](crate::Builder::instruction_set)
/// says otherwise, to compare or to test: answers are the same bits on all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// No vector instructions asked for: four to sixteen scalars in plain code.
    Portable,
    /// The least that the target has: SSE2 on x86-64, NEON on aarch64, SIMD128 on wasm32 if it is enabled.
    Baseline,
    /// AVX2: x86-64-v3.
    Avx2,
    /// AVX-512, as since Ice Lake and Zen 4.
    Avx512,
}

impl InstructionSet {
    /// All, from the least to the best.
    pub const ALL: &[Self] = &[Self::Portable, Self::Baseline, Self::Avx2, Self::Avx512];

    /// The best that this processor has. Without the feature `std` it cannot be asked, and this is what the
    /// build's target has.
    pub fn best() -> Self {
        Backend::best().instruction_set()
    }

    /// Those that this processor has and this build contains, from the least to the best. `Portable` is in builds for
    /// targets without vectors, and in this crate's tests.
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

/// An instruction set that the processor was found to have: the variant's value is the proof.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Backend {
    #[cfg(any(
        feature = "portable",
        not(any(
            any(target_arch = "x86", target_arch = "x86_64"),
            target_arch = "aarch64",
            all(target_arch = "wasm32", target_feature = "simd128")
        ))
    ))]
    Portable(fearless_simd::Fallback),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Sse2(fearless_simd::Sse2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2(fearless_simd::Avx2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512(fearless_simd::Avx512),
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::Neon),
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    Simd128(fearless_simd::WasmSimd128),
}

/// What is compiled for each instruction set.
pub(crate) trait Kernel {
    /// Compiled for the target's own instruction set alone if not.
    const IS_WIDE: bool;
    type Output;
    /// `#[inline(always)]`, and so is everything that it calls and that is to use the instructions.
    fn run<I: Simd>(self, isa: I) -> Self::Output;
}

impl Backend {
    pub fn best() -> Self {
        let best = InstructionSet::ALL.iter().copied().rev().find_map(Self::of);
        best.expect("every target has a baseline or the portable path")
    }

    pub fn of(set: InstructionSet) -> Option<Self> {
        Self::available(set, Level::try_detect().unwrap_or_else(Level::baseline))
    }

    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    fn available(set: InstructionSet, level: Level) -> Option<Self> {
        match set {
            InstructionSet::Portable => Self::portable(),
            InstructionSet::Baseline => level.as_sse2().map(Self::Sse2),
            InstructionSet::Avx2 => level.as_avx2().map(Self::Avx2),
            InstructionSet::Avx512 => level.as_avx512().map(Self::Avx512),
        }
    }

    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    fn available(set: InstructionSet, level: Level) -> Option<Self> {
        match (set, level) {
            (InstructionSet::Portable, _) => Self::portable(),
            #[cfg(target_arch = "aarch64")]
            (InstructionSet::Baseline, level) => level.as_neon().map(Self::Neon),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            (InstructionSet::Baseline, level) => level.as_wasm_simd128().map(Self::Simd128),
            _ => None,
        }
    }

    fn portable() -> Option<Self> {
        #[cfg(feature = "portable")]
        let level = Level::fallback();
        #[cfg(not(feature = "portable"))]
        let level = Level::baseline();
        match level {
            #[cfg(any(
                feature = "portable",
                not(any(
                    any(target_arch = "x86", target_arch = "x86_64"),
                    target_arch = "aarch64",
                    all(target_arch = "wasm32", target_feature = "simd128")
                ))
            ))]
            Level::Fallback(isa) => Some(Self::Portable(isa)),
            _ => None,
        }
    }

    pub fn instruction_set(self) -> InstructionSet {
        match self {
            #[cfg(any(
                feature = "portable",
                not(any(
                    any(target_arch = "x86", target_arch = "x86_64"),
                    target_arch = "aarch64",
                    all(target_arch = "wasm32", target_feature = "simd128")
                ))
            ))]
            Self::Portable(_) => InstructionSet::Portable,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2(_) => InstructionSet::Baseline,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2(_) => InstructionSet::Avx2,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512(_) => InstructionSet::Avx512,
            #[cfg(target_arch = "aarch64")]
            Self::Neon(_) => InstructionSet::Baseline,
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Self::Simd128(_) => InstructionSet::Baseline,
        }
    }

    /// Runs the kernel's copy for this instruction set.
    #[inline(always)]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        if !K::IS_WIDE {
            // Other targets have but one.
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            if let Some(isa) = Level::baseline().as_sse2() {
                return kernel.run(isa);
            }
        }
        match self {
            #[cfg(any(
                feature = "portable",
                not(any(
                    any(target_arch = "x86", target_arch = "x86_64"),
                    target_arch = "aarch64",
                    all(target_arch = "wasm32", target_feature = "simd128")
                ))
            ))]
            Self::Portable(isa) => vectorized(isa, kernel),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2(isa) => vectorized(isa, kernel),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2(isa) => vectorized(isa, kernel),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512(isa) => vectorized(isa, kernel),
            #[cfg(target_arch = "aarch64")]
            Self::Neon(isa) => vectorized(isa, kernel),
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Self::Simd128(isa) => vectorized(isa, kernel),
        }
    }
}

/// Below one function that has the instructions switched on.
#[inline(always)]
fn vectorized<I: Simd, K: Kernel>(isa: I, kernel: K) -> K::Output {
    isa.vectorize(
        #[inline(always)]
        || kernel.run(isa),
    )
}
