//! Vectors, behind one trait for all and one more for kernels.

use super::Isa;
use crate::geometry::Scalar;
use core::mem::MaybeUninit;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// Room for what a node puts on the stack.
pub(crate) type Window<T> = [MaybeUninit<T>; 16];

/// Several scalars side by side, to write tests of packed primitives with. Sealed.
///
/// Each operation is done in every lane, by plain IEEE 754 arithmetic: a lane's bits are those of
/// the same operations on one scalar.
pub trait Lanes<S>:
    KernelLanes<S, Flags = <Self as Lanes<S>>::Mask>
    + Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// How many scalars.
    const COUNT: usize;
    /// A truth value for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// The smaller in each lane, `other`'s where either is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The larger in each lane, `other`'s where either is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The absolute values.
    #[must_use]
    fn abs(self) -> Self;
    /// The square roots, rounded correctly; NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;
    /// This lane where the mask is true, else `other`'s.
    #[must_use]
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Bit k is lane k's.
    fn bits(mask: Self::Mask) -> u32;
}

/// What kernels do with lanes, and users do not.
pub trait KernelLanes<S>: Sized {
    /// Proof that the processor has the instructions.
    type Isa: Isa;
    /// `Lanes::Mask`.
    type Flags;

    /// The same value in all lanes.
    fn splat(isa: Self::Isa, value: S) -> Self;
    /// Reads `COUNT` scalars.
    ///
    /// # Safety
    /// They are there, and initialised.
    unsafe fn load(isa: Self::Isa, from: *const S) -> Self;
    /// Reads `COUNT` bytes, as scalars.
    ///
    /// # Safety
    /// They are there, and initialised.
    unsafe fn load_bytes(isa: Self::Isa, from: *const u8) -> Self;
    /// Reads the first `COUNT` scalars.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    fn from_slice(isa: Self::Isa, from: &[S]) -> Self
    where
        Self: Lanes<S>,
    {
        assert!(from.len() >= Self::COUNT);
        // SAFETY: so many are there.
        unsafe { Self::load(isa, from.as_ptr()) }
    }
    /// Reads the first `COUNT` bytes, as scalars.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    fn from_bytes(isa: Self::Isa, from: &[u8]) -> Self
    where
        Self: Lanes<S>,
    {
        assert!(from.len() >= Self::COUNT);
        // SAFETY: so many are there.
        unsafe { Self::load_bytes(isa, from.as_ptr()) }
    }
    /// Writes `COUNT` scalars.
    fn store(self, to: &mut [S]);
    /// One of the scalars.
    fn lane(self, lane: usize) -> S;
    /// The first three rounded toward zero, where they are from 0 to 2^31 - 1.
    #[inline(always)]
    fn to_integers(self) -> [i32; 3]
    where
        Self: Copy,
        S: Scalar,
    {
        [self.lane(0).to_f64() as i32, self.lane(1).to_f64() as i32, self.lane(2).to_f64() as i32]
    }
    /// Of two children or more, at distances not below +0, the lane of the nearest; all are written
    /// to the windows, farthest first, with entries that are never larger. None where there is no
    /// quick way.
    #[inline(always)]
    fn sort(self, _: u32, _: &[u32], _: &mut Window<u32>, _: &mut Window<S>) -> Option<u32> {
        None
    }
    /// Writes the children whose bits are set to the window, in order. False where there is no
    /// quick way.
    #[inline(always)]
    fn compress(_: Self::Isa, _: u32, _: &[u32], _: &mut Window<u32>) -> bool {
        false
    }
    /// `self * factor + more`, rounded once where the processor can, else twice: not for answers.
    fn mul_add(self, factor: Self, more: Self) -> Self;
    /// Whether [`later`](Self::later), [`earlier`](Self::earlier) and
    /// [`not_after`](Self::not_after) compare integers: the order of numbers above -0 is that of
    /// their bits, which some processors find in a quarter of the time.
    fn orders_by_bits(isa: Self::Isa) -> bool;
    /// The larger in each lane, where none is NaN. Which of two with a minus sign is open.
    fn later(self, other: Self) -> Self;
    /// The smaller in each lane, where none is NaN. Which of two with a minus sign is open.
    fn earlier(self, other: Self) -> Self;
    /// `self <= other`, where none is NaN, `self` has a plus sign, and `other` is not -0.
    fn not_after(self, other: Self) -> Self::Flags;
    /// The instruction set.
    fn isa(self) -> Self::Isa;
}

/// Lanes that are two times as many.
pub trait Halves<H>: Sized {
    /// The one's lanes, then the other's.
    fn of_halves(halves: [H; 2]) -> Self;
    fn to_halves(self) -> [H; 2];
}

/// The lanes of a tree whose nodes have so many children: 4, 8 or 16.
pub trait Width: 'static {
    /// A scalar for each child of a node.
    type Lanes<S: Scalar, I: Isa>: Lanes<S, Isa = I>;
}

/// A number of children.
pub struct Count<const N: usize>;

impl Width for Count<4> {
    type Lanes<S: Scalar, I: Isa> = S::Times4<I>;
}
impl Width for Count<8> {
    type Lanes<S: Scalar, I: Isa> = S::Times8<I>;
}
impl Width for Count<16> {
    type Lanes<S: Scalar, I: Isa> = S::Times16<I>;
}

/// The vectors that a leaf's primitives are tested in.
pub trait LeafLanes: 'static {
    /// A scalar for each primitive.
    type Lanes<S: Scalar, I: Isa>: Lanes<S, Isa = I>;
}

/// Vectors of as many lanes as a leaf has primitives.
pub struct Single;

/// Vectors as wide as those of a node's children, which hold everything twice: see `x86::doubled`.
pub struct Doubled;

impl LeafLanes for Single {
    type Lanes<S: Scalar, I: Isa> = S::Times8<I>;
}
impl LeafLanes for Doubled {
    type Lanes<S: Scalar, I: Isa> = S::Times8Doubled<I>;
}
