//! Leaves whose primitives are asked: those of users, and of this crate's boxes.

use super::sealed::LeafKind;
use super::{LEAF_WIDTH, Operands};
use crate::geometry::{Ray, Scalar};
use crate::simd::{Backend, Isa, Kernel, Lanes};
use core::marker::PhantomData;

/// Each primitive by itself, in the order of the leaf.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne;

impl<S: Scalar, T> LeafKind<S, T> for OneByOne {
    const OPERANDS: usize = 0;
    const IS_SETTLED_IN_LANES: bool = false;
}

/// A test in lanes that says which primitives of a leaf are worth asking.
///
/// Which scalars of a primitive it needs, [`Intersect::put_operands`](crate::Intersect::put_operands) writes; which lanes a ray
/// may hit, [`candidates`](Self::candidates) says. Those are asked one by one, so that answers are the same with and without
/// a sieve. `examples/own_leaf.rs` is a whole program.
///
/// It is for speed alone, and all primitives are asked where it cannot be had: in the binary [`Tree`](crate::Tree), in a
/// [`CompactTree`](crate::CompactTree) if there are more than 16 operands, and where coordinates are beyond 1e18 (`f32`). It is
/// asked about rays of any interval, with a `t_min` below 0 too.
pub trait Sieve<S: Scalar>: 'static {
    /// How many scalars of each primitive lie in the leaf.
    const OPERANDS: usize;

    /// Returns the lanes whose primitives the ray may hit: all that
    /// [`Intersect::intersect`](crate::Intersect::intersect) says are hit, and as few others as is quickly found. Lanes
    /// without a primitive hold NaN; what is said of them does not count. `ray.t_max` is the closest hit so far, as in
    /// `intersect`.
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &Ray<S>) -> L::Mask;
}

/// Primitives side by side, of which those are asked that the sieve `T` lets through.
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
