//! Several scalars side by side, and the instruction sets that compute with them.
//!
//! Kernels are generic inline functions over [`Lanes`], compiled once for each instruction set below one
//! `#[target_feature]` function (see [`InstructionSet`]). Arithmetic is the plain IEEE 754 one on all of
//! them, nothing fused but in [`Lanes`]' `mul_add`, which no answer is made of: equal operands give equal bits
//! whatever the machine.

#[cfg(target_arch = "x86_64")]
mod avx512;
mod backend;
mod lanes;
mod pairs;
mod prefetch;
mod read;
mod twice;

pub use backend::InstructionSet;
pub(crate) use backend::{Backend, Kernel};
pub(crate) use lanes::{Count, Pair, Width, Window};
pub use lanes::{Halves, Lanes};
pub use pairs::Lanes4;
pub(crate) use prefetch::{prefetch, prefetch_ahead};
pub(crate) use read::{Kept, read_each};
pub(crate) use twice::Twice;
