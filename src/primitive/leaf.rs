//! How the primitives of a leaf lie in memory, and how they are tested.

use crate::geometry::{PreparedRay, Scalar};
use crate::simd::Lanes;
use core::marker::PhantomData;

/// How many primitives lie side by side in a leaf of the wide layouts.
pub const LEAF_WIDTH: usize = 8;

/// How primitives lie in a leaf of the wide layouts, and how a ray meets them there: chosen by
/// [`Intersect::Leaf`](crate::Intersect::Leaf).
///
/// [`OneByOne`] asks each primitive by itself, and asks nothing of its author. Triangles and spheres have leaves of
/// their own, in which they lie side by side and are tested all at once.
///
/// To do the same for a primitive of yours: say which scalars of it its test needs
/// ([`Intersect::put_operands`](crate::Intersect::put_operands)), and which lanes a ray may hit
/// ([`candidates`](Self::candidates)). Those are asked one by one, so the answer is the same whether or not
/// there is a leaf of your own; `examples/own_leaf.rs` is a whole program.
pub trait Leaf<S: Scalar, T: Copy>: 'static {
    /// How many scalars of each primitive lie in the leaf; 0 for none.
    const OPERANDS: usize;

    /// The lanes whose primitives the ray may hit at a t up to `limit`: all that
    /// [`Intersect::intersect`](crate::Intersect::intersect) says are hit, and as few others as is quickly found. Lanes
    /// without a primitive hold NaN; what is said of them does not count.
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, limit: S) -> L::Mask;

    /// Whether [`test`](Self::test) settles most lanes, and is not only what [`candidates`](Self::candidates) says.
    #[doc(hidden)]
    const SETTLES: bool = false;

    /// Whether [`test`](Self::test) may be asked about this ray, in a tree whose coordinates are below
    /// `Scalar::LARGE_AREA`: else all primitives are, one by one.
    #[doc(hidden)]
    #[inline(always)]
    fn suits(_ray: &PreparedRay<S>) -> bool {
        true
    }

    /// The whole test in lanes, bit for bit that of the primitives.
    #[doc(hidden)]
    #[inline(always)]
    fn test<L: Lanes<S>>(operands: &Operands<'_, S, L>, ray: &PreparedRay<S>, limit: S) -> Found<S, L> {
        Found::to_be_asked(L::bits(Self::candidates(operands, ray, limit)), operands)
    }

    /// The payload of a lane that is surely hit, made of its details.
    #[doc(hidden)]
    #[inline(always)]
    fn payload(_details: [S; 3]) -> Option<T> {
        None
    }
}

/// What was found in a leaf.
#[doc(hidden)]
#[derive(Clone, Copy)]
pub struct Found<S, L> {
    /// A bit for each lane that is hit, at `t`, as `query::accept` would say.
    pub(crate) sure: u32,
    /// A bit for each lane that has to be asked by itself.
    pub(crate) unsure: u32,
    pub(crate) t: L,
    /// What the payload is made of.
    pub(crate) details: [L; 3],
    pub(crate) scalar: PhantomData<S>,
}

impl<S: Scalar, L: Lanes<S>> Found<S, L> {
    #[inline(always)]
    pub(crate) fn new(sure: u32, unsure: u32, t: L, details: [L; 3]) -> Self {
        Self { sure, unsure, t, details, scalar: PhantomData }
    }

    #[inline(always)]
    pub(crate) fn to_be_asked(unsure: u32, operands: &Operands<'_, S, L>) -> Self {
        let nothing = operands.splat(S::ZERO);
        Self::new(0, unsure, nothing, [nothing; 3])
    }
}

/// Each primitive by itself, in the order of the leaf.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne;

impl<S: Scalar, T: Copy> Leaf<S, T> for OneByOne {
    const OPERANDS: usize = 0;

    #[inline(always)]
    fn candidates<L: Lanes<S>>(operands: &Operands<'_, S, L>, _: &PreparedRay<S>, _: S) -> L::Mask {
        let zero = operands.splat(S::ZERO);
        zero.le(zero)
    }
}

/// The scalars of a leaf's primitives: a vector for each operand, a lane for each primitive.
#[derive(Clone, Copy)]
pub struct Operands<'a, S: Scalar, L: Lanes<S>> {
    isa: L::Isa,
    rows: &'a [[S; LEAF_WIDTH]],
}

impl<'a, S: Scalar, L: Lanes<S>> Operands<'a, S, L> {
    #[inline(always)]
    pub(crate) fn new(isa: L::Isa, rows: &'a [[S; LEAF_WIDTH]]) -> Self {
        const { assert!(L::COUNT == LEAF_WIDTH) }
        Self { isa, rows }
    }

    /// One operand of all the leaf's primitives.
    ///
    /// # Panics
    /// If there are fewer than [`Leaf::OPERANDS`].
    #[inline(always)]
    pub fn get(&self, operand: usize) -> L {
        let row = &self.rows[operand];
        // SAFETY: a row is as many scalars as the lanes are (`new`).
        unsafe { L::load(self.isa, row.as_ptr()) }
    }

    /// A scalar, the same in all lanes.
    #[inline(always)]
    pub fn splat(&self, scalar: S) -> L {
        L::splat(self.isa, scalar)
    }
}
