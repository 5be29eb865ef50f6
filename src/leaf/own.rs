//! Leaves that call `intersect`: those of users' primitives and of boxes.

use super::sealed::LeafKind;
use super::{LEAF_WIDTH, Operands};
use crate::geometry::{Ray, Scalar};
use crate::simd::{Backend, Isa, Kernel, Lanes};
use core::marker::PhantomData;

/// A leaf that tests each primitive by itself, in the order of the leaf.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne;

impl<S: Scalar, T> LeafKind<S, T> for OneByOne {
    const OPERANDS: usize = 0;
    const IS_SETTLED_IN_LANES: bool = false;
}

/// A test in lanes that selects the primitives of a leaf that a ray may hit.
///
/// [`Intersect::put_operands`](crate::Intersect::put_operands) writes the scalars of a primitive
/// that the sieve needs. [`candidates`](Self::candidates) selects the lanes that a ray may hit. The
/// primitives of these lanes are tested one by one, so answers are the same with and without a
/// sieve. `examples/own_leaf.rs` is a whole program.
///
/// A sieve is for speed alone. All primitives are tested where there can be no sieve: in the binary
/// [`Tree`](crate::Tree), in a [`CompactTree`](crate::CompactTree) if there are more than 16
/// operands, and where coordinates are beyond 1e18 (`f32`). The sieve gets rays of any interval,
/// with a `t_min` below 0 too.
pub trait Sieve<S: Scalar>: 'static {
    /// The number of scalars of each primitive in the leaf.
    const OPERANDS: usize;

    /// Returns the lanes whose primitives the ray may hit.
    ///
    /// These are all lanes for which [`Intersect::intersect`](crate::Intersect::intersect)
    /// returns a hit, and as few others as can be found quickly. Lanes without a primitive hold
    /// NaN, and their values in the mask do not count. `ray.t_max` is the t of the closest hit so
    /// far, as in `intersect`.
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &Ray<S>) -> L::Mask;
}

/// A leaf that tests the primitives that the sieve `T` lets through.
#[derive(Clone, Copy, Debug)]
pub struct Sieved<T>(PhantomData<T>);

impl<S: Scalar, T, K: Sieve<S>> LeafKind<S, T> for Sieved<K> {
    const OPERANDS: usize = K::OPERANDS;
    const IS_SETTLED_IN_LANES: bool = false;

    #[inline(always)]
    fn candidates(backend: Backend, rows: &[[S; LEAF_WIDTH]], ray: &Ray<S>) -> u32 {
        backend.run(Candidates { rows, ray, sieve: PhantomData::<K> })
    }
}

struct Candidates<'q, S, K> {
    rows: &'q [[S; LEAF_WIDTH]],
    ray: &'q Ray<S>,
    sieve: PhantomData<K>,
}

impl<S: Scalar, K: Sieve<S>> Kernel for Candidates<'_, S, K> {
    const IS_WIDE: bool = true;
    type Output = u32;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> u32 {
        let operands = Operands::<S, S::Times8<I>>::new(isa, self.rows);
        <S::Times8<I> as Lanes<S>>::bits(K::candidates(&operands, self.ray))
    }
}
