//! Vectors: one trait for all code, and a second one for kernels alone.

use super::{Isa, ScalarLanes};
use core::mem::MaybeUninit;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// Space on the traversal stack for all children of one node.
pub(crate) type Window<T> = [MaybeUninit<T>; 16];

/// A vector of scalars, to write tests of packed primitives with. Sealed.
///
/// Each operation works on every lane by plain IEEE 754 arithmetic: the bits of a lane are those of
/// the same operations on one scalar.
pub trait Lanes<S>:
    KernelLanes<S, Flags = <Self as Lanes<S>>::Mask>
    + Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The number of lanes.
    const COUNT: usize;
    /// A truth value for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// Returns the smaller in each lane, and `other`'s where either is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// Returns the larger in each lane, and `other`'s where either is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// Returns the absolute values.
    #[must_use]
    fn abs(self) -> Self;
    /// Returns the square roots, rounded correctly, and NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns the lanes of `self` where the mask is true, else those of `other`.
    #[must_use]
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// Returns `self < other` for each lane, false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns `self <= other` for each lane, false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns the mask as bits: bit k is that of lane k.
    fn bits(mask: Self::Mask) -> u32;
}

/// The operations on lanes that kernels use and users do not.
pub trait KernelLanes<S>: Sized {
    /// The proof that the processor has the instructions.
    type Isa: Isa;
    /// The same type as `Lanes::Mask`.
    type Flags;

    /// Returns a vector with the same value in all lanes.
    fn splat(isa: Self::Isa, value: S) -> Self;
    /// Reads `COUNT` scalars.
    ///
    /// # Safety
    ///
    /// `from` points to `COUNT` initialised scalars.
    unsafe fn load(isa: Self::Isa, from: *const S) -> Self;
    /// Reads `COUNT` bytes, each as one scalar.
    ///
    /// # Safety
    ///
    /// `from` points to `COUNT` initialised bytes.
    unsafe fn load_bytes(isa: Self::Isa, from: *const u8) -> Self;
    /// Reads the first `COUNT` scalars of a slice.
    ///
    /// # Panics
    ///
    /// Panics if the slice has fewer.
    #[inline(always)]
    fn from_slice(isa: Self::Isa, from: &[S]) -> Self
    where
        Self: Lanes<S>,
    {
        assert!(from.len() >= Self::COUNT);
        // SAFETY: the slice has at least `COUNT` scalars, as asserted above.
        unsafe { Self::load(isa, from.as_ptr()) }
    }
    /// Reads the first `COUNT` bytes of a slice, each as one scalar.
    ///
    /// # Panics
    ///
    /// Panics if the slice has fewer.
    #[inline(always)]
    fn from_bytes(isa: Self::Isa, from: &[u8]) -> Self
    where
        Self: Lanes<S>,
    {
        assert!(from.len() >= Self::COUNT);
        // SAFETY: the slice has at least `COUNT` bytes, as asserted above.
        unsafe { Self::load_bytes(isa, from.as_ptr()) }
    }
    /// Writes `COUNT` scalars.
    fn store(self, to: &mut [S]);
    /// Returns the scalar of one lane.
    fn lane(self, lane: usize) -> S;
    /// Returns the first three lanes as integers, rounded toward zero.
    ///
    /// The lanes have to be in the range from 0 to 2^31 - 1.
    #[inline(always)]
    fn to_integers(self) -> [i32; 3]
    where
        Self: Copy,
        S: ScalarLanes,
    {
        [self.lane(0).to_i32(), self.lane(1).to_i32(), self.lane(2).to_i32()]
    }
    /// Sorts two or more children by distance and returns the lane of the nearest.
    ///
    /// Takes the mask of the children, all children, and two windows of the traversal stack. No
    /// distance is below +0. Writes all children of the mask to the windows, the farthest
    /// first, and with each an entry that is never larger than its distance. Returns `None`
    /// where there is no fast way, and writes nothing then: with AVX-512 for more than eight.
    #[inline(always)]
    fn sort(self, _: u32, _: &[u32], _: &mut Window<u32>, _: &mut Window<S>) -> Option<u32> {
        None
    }
    /// Writes the children of a mask to the window, in the order of their lanes.
    ///
    /// Returns false where there is no fast way.
    #[inline(always)]
    fn compress(_: Self::Isa, _: u32, _: &[u32], _: &mut Window<u32>) -> bool {
        false
    }
    /// Returns `self * factor + more`, rounded once if the processor can, else twice.
    ///
    /// No answer may be computed with it.
    fn mul_add(self, factor: Self, more: Self) -> Self;
    /// Whether the three order operations compare bits, as integers.
    ///
    /// These are [`later`](Self::later), [`earlier`](Self::earlier) and
    /// [`not_after`](Self::not_after). Numbers above -0 have the order of their bits, and some
    /// processors compare integers in a quarter of the time.
    fn orders_by_bits(isa: Self::Isa) -> bool;
    /// Returns the larger in each lane, where neither is NaN.
    ///
    /// Of two with a minus sign it returns either.
    fn later(self, other: Self) -> Self;
    /// Returns the smaller in each lane, where neither is NaN.
    ///
    /// Of two with a minus sign it returns either.
    fn earlier(self, other: Self) -> Self;
    /// Returns `self <= other` for each lane.
    ///
    /// Neither is NaN, `self` has a plus sign, and `other` is not -0.
    fn not_after(self, other: Self) -> Self::Flags;
    /// Returns the token of the instruction set.
    fn isa(self) -> Self::Isa;
}

/// A vector that splits into two vectors of half as many lanes.
pub trait Halves<H>: Sized {
    /// Joins the lanes of the first half and those of the second.
    fn of_halves(halves: [H; 2]) -> Self;
    fn to_halves(self) -> [H; 2];
}

/// The lanes for nodes of 4, 8 or 16 children.
pub trait Width: 'static {
    /// A vector with one scalar for each child of a node.
    type Lanes<S: ScalarLanes, I: Isa>: Lanes<S, Isa = I>;
}

/// A number of children of a node, as a type.
pub struct Count<const N: usize>;

impl Width for Count<4> {
    type Lanes<S: ScalarLanes, I: Isa> = S::Times4<I>;
}
impl Width for Count<8> {
    type Lanes<S: ScalarLanes, I: Isa> = S::Times8<I>;
}
impl Width for Count<16> {
    type Lanes<S: ScalarLanes, I: Isa> = S::Times16<I>;
}

/// The vectors in which the primitives of a leaf are tested.
pub trait LeafLanes: 'static {
    /// A vector with one scalar for each primitive.
    type Lanes<S: ScalarLanes, I: Isa>: Lanes<S, Isa = I>;
}

/// Vectors of as many lanes as a leaf has primitives.
pub struct Single;

/// Vectors of `f32` as wide as those of a node's children, which hold each lane twice.
///
/// Other scalars and instruction sets have single ones in their place. See `x86::doubled`.
pub struct Doubled;

impl LeafLanes for Single {
    type Lanes<S: ScalarLanes, I: Isa> = S::Times8<I>;
}
impl LeafLanes for Doubled {
    type Lanes<S: ScalarLanes, I: Isa> = S::Times8Doubled<I>;
}
