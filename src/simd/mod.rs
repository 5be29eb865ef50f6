//! Vectors of scalars, and the instruction sets that compute with them.
//!
//! Kernels are generic inline functions over [`Lanes`]. Each is compiled once for each instruction
//! set, inside one `#[target_feature]` function (see [`InstructionSet`]). Arithmetic is plain IEEE
//! 754 on all of them. Only `mul_add` may be fused, and no answer is computed with it: equal
//! operands give equal bits on every machine.
//!
//! An instruction set is a token type and its vector types ([`Isa`]). Each vector type is
//! a list of operations.

mod backend;
mod isa;
mod lanes;
mod pair;
mod pairs;
mod prefetch;
mod scalar_lanes;
#[cfg(test)]
mod tests;
mod vector;

#[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
mod neon;
#[cfg(any(
    feature = "portable",
    not(any(
        all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"),
        all(target_arch = "aarch64", target_feature = "neon"),
        all(target_arch = "wasm32", target_feature = "simd128"),
    ))
))]
mod portable;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;
#[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
mod x86;

/// The instruction set that every processor of the target has.
#[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
use neon::Neon as Baseline;
#[cfg(not(any(
    all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"),
    all(target_arch = "aarch64", target_feature = "neon"),
    all(target_arch = "wasm32", target_feature = "simd128"),
)))]
use portable::Portable as Baseline;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
use simd128::Simd128 as Baseline;
#[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"))]
use x86::Sse2 as Baseline;

pub use backend::InstructionSet;
pub use backend::{Backend, Kernel, Routine};
pub use isa::Isa;
pub(crate) use lanes::{Count, Doubled, Single, Width, Window};
pub use lanes::{Halves, KernelLanes, Lanes, LeafLanes};
pub(crate) use pair::Pair;
pub use pairs::{F32Lanes4, Lanes4};
pub(crate) use prefetch::{prefetch, prefetch_ahead};
pub use scalar_lanes::ScalarLanes;
