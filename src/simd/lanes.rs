//! The vector types, behind one trait.

use crate::geometry::Scalar;
use core::mem::MaybeUninit;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};
use fearless_simd::{Bytes, ExtractToken, Select, Simd, SimdBase, SimdFloat, SimdMask};

/// Room for what a node puts on the stack.
pub(crate) type Window<T> = [MaybeUninit<T>; 16];

pub(super) mod sealed {
    pub trait Sealed {}
}

/// Several scalars side by side, to write tests of packed primitives with. Sealed.
///
/// Each operation is done in every lane, by plain IEEE 754 arithmetic: a lane's bits are those of the same
/// operations on one scalar.
pub trait Lanes<S: Scalar>:
    sealed::Sealed + Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// How many scalars.
    const COUNT: usize;
    /// A truth value for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;
    /// Proof that the processor has the instructions.
    #[doc(hidden)]
    type Isa: Simd;

    /// The same value in all lanes.
    #[doc(hidden)]
    fn splat(isa: Self::Isa, value: S) -> Self;
    /// Reads `COUNT` scalars.
    ///
    /// # Safety
    /// They are there, and initialised.
    #[doc(hidden)]
    unsafe fn load(isa: Self::Isa, from: *const S) -> Self;
    /// Reads `COUNT` bytes, as scalars.
    ///
    /// # Safety
    /// They are there, and initialised.
    #[doc(hidden)]
    unsafe fn load_bytes(isa: Self::Isa, from: *const u8) -> Self;
    /// Writes `COUNT` scalars.
    #[doc(hidden)]
    fn store(self, to: &mut [S]);
    /// One of the scalars.
    #[doc(hidden)]
    fn lane(self, lane: usize) -> S;
    /// Of three children or more, at distances not below +0, the lane of the nearest; the others are written to the
    /// windows, farthest first, with entries that are never larger. None where there is no quick way.
    #[doc(hidden)]
    #[inline(always)]
    fn sort(self, _: u32, _: &[u32], _: &mut Window<u32>, _: &mut Window<S>) -> Option<u32> {
        None
    }
    /// Writes the children whose bits are set to the window, in order. False where there is no quick way.
    #[doc(hidden)]
    #[inline(always)]
    fn compress(_: Self::Isa, _: u32, _: &[u32], _: &mut Window<u32>) -> bool {
        false
    }
    /// `self * factor + more`, rounded once where the processor can, else twice: not for answers.
    #[doc(hidden)]
    fn mul_add(self, factor: Self, more: Self) -> Self;
    /// Whether [`later`](Self::later), [`earlier`](Self::earlier) and [`not_after`](Self::not_after) compare integers.
    #[doc(hidden)]
    #[inline(always)]
    fn orders_by_bits(_: Self::Isa) -> bool {
        false
    }
    /// The larger in each lane, where none is NaN. Which of two with a minus sign is open.
    #[doc(hidden)]
    #[inline(always)]
    fn later(self, other: Self) -> Self {
        self.max(other)
    }
    /// The smaller in each lane, where none is NaN. Which of two with a minus sign is open.
    #[doc(hidden)]
    #[inline(always)]
    fn earlier(self, other: Self) -> Self {
        self.min(other)
    }
    /// `self <= other`, where none is NaN and `self` has a plus sign; false if `other` has a minus sign.
    #[doc(hidden)]
    #[inline(always)]
    fn not_after(self, other: Self) -> Self::Mask {
        self.le(other)
    }
    /// The instruction set.
    #[doc(hidden)]
    fn isa(self) -> Self::Isa;

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
    fn where_else(self, mask: Self::Mask, other: Self) -> Self;
    /// `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Bit k is lane k's.
    fn bits(mask: Self::Mask) -> u32;
}

macro_rules! lanes {
    ($scalar:ty, $lanes:ident, $mask:ident, $count:literal, { $($more:item)* }) => {
        impl<I: Simd> sealed::Sealed for fearless_simd::$lanes<I> {}

        impl<I: Simd> Lanes<$scalar> for fearless_simd::$lanes<I> {
            const COUNT: usize = $count;
            type Mask = fearless_simd::$mask<I>;
            type Isa = I;

            #[inline(always)]
            fn splat(isa: I, value: $scalar) -> Self {
                <Self as SimdBase<I>>::splat(isa, value)
            }
            #[inline(always)]
            unsafe fn load(isa: I, from: *const $scalar) -> Self {
                // SAFETY: the caller's, and an array asks for no more alignment than a scalar.
                Self::load_array_ref(isa, unsafe { &*from.cast::<[$scalar; $count]>() })
            }
            #[inline(always)]
            unsafe fn load_bytes(isa: I, from: *const u8) -> Self {
                // SAFETY: the caller's, and an array of bytes asks for no alignment.
                let bytes = unsafe { *from.cast::<[u8; $count]>() };
                Self::load_array(isa, bytes.map(<$scalar>::from))
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                self.store_slice(&mut to[..$count]);
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> $scalar {
                self.as_slice()[lane]
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, more: Self) -> Self {
                SimdFloat::mul_add(self, factor, more)
            }
            #[inline(always)]
            fn isa(self) -> I {
                self.token()
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // The instruction of x86 does just this. Elsewhere a NaN has to be looked for.
                if has_x86_minimum(self.isa()) {
                    <Self as SimdBase<I>>::min(self, other)
                } else {
                    self.simd_lt(other).select(self, other)
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if has_x86_minimum(self.isa()) {
                    <Self as SimdBase<I>>::max(self, other)
                } else {
                    self.simd_gt(other).select(self, other)
                }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <Self as SimdBase<I>>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <Self as SimdFloat<I>>::sqrt(self)
            }
            #[inline(always)]
            fn where_else(self, mask: Self::Mask, other: Self) -> Self {
                mask.select(self, other)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn bits(mask: Self::Mask) -> u32 {
                mask.to_bitmask() as u32
            }
            $($more)*
        }
    };
}

#[inline(always)]
fn has_x86_minimum<I: Simd>(isa: I) -> bool {
    cfg!(target_arch = "x86_64") && !isa.level().is_fallback()
}

/// The order of numbers above -0 is that of their bits as integers, which some processors find in a quarter of the time.
macro_rules! by_bits {
    ($integers:ident) => {
        #[inline(always)]
        fn orders_by_bits(isa: I) -> bool {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            return isa.level().as_avx2().is_some();
            // NEON and SIMD128 have them, and their minima of numbers have to look for NaN.
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
            return !isa.level().is_fallback();
        }
        #[inline(always)]
        fn later(self, other: Self) -> Self {
            let [a, b] = [self, other].map(|x| x.bitcast::<fearless_simd::$integers<I>>());
            SimdBase::max(a, b).bitcast()
        }
        #[inline(always)]
        fn earlier(self, other: Self) -> Self {
            let [a, b] = [self, other].map(|x| x.bitcast::<fearless_simd::$integers<I>>());
            SimdBase::min(a, b).bitcast()
        }
        #[inline(always)]
        fn not_after(self, other: Self) -> Self::Mask {
            let [a, b] = [self, other].map(|x| x.bitcast::<fearless_simd::$integers<I>>());
            a.simd_le(b)
        }
    };
}

lanes!(f32, f32x4, mask32x4, 4, {
    by_bits!(i32x4);
});
lanes!(f32, f32x8, mask32x8, 8, {
    by_bits!(i32x8);
});
lanes!(f32, f32x16, mask32x16, 16, {
    by_bits!(i32x16);
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn sort(
        self,
        met: u32,
        children: &[u32],
        references: &mut Window<u32>,
        entries: &mut Window<f32>,
    ) -> Option<u32> {
        let isa = self.isa().level().as_avx512()?;
        let near = fearless_simd::f32x16::load_array(isa, self.to_array());
        let children = fearless_simd::u32x16::from_slice(isa, children);
        Some(super::avx512::sort(isa, near.into(), met as u16, children.into(), references, entries))
    }
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn compress(isa: I, met: u32, children: &[u32], references: &mut Window<u32>) -> bool {
        let Some(isa) = isa.level().as_avx512() else { return false };
        let children = fearless_simd::u32x16::from_slice(isa, children);
        super::avx512::compress(isa, met as u16, children.into(), references);
        true
    }
});
lanes!(f64, f64x4, mask64x4, 4, {});
lanes!(f64, f64x8, mask64x8, 8, {});

/// Lanes that are two times as many.
pub trait Halves<H>: Sized {
    /// The one's lanes, then the other's.
    fn of_halves(halves: [H; 2]) -> Self;
    fn to_halves(self) -> [H; 2];
}

macro_rules! halves {
    ($lanes:ident, $half:ident, $combine:ident, $split:ident) => {
        impl<I: Simd> Halves<fearless_simd::$half<I>> for fearless_simd::$lanes<I> {
            #[inline(always)]
            fn of_halves([first, second]: [fearless_simd::$half<I>; 2]) -> Self {
                first.token().$combine(first, second)
            }
            #[inline(always)]
            fn to_halves(self) -> [fearless_simd::$half<I>; 2] {
                let (first, second) = self.token().$split(self);
                [first, second]
            }
        }
    };
}

halves!(f32x8, f32x4, combine_f32x4, split_f32x8);
halves!(f64x8, f64x4, combine_f64x4, split_f64x8);

/// Twice as many lanes.
#[derive(Clone, Copy)]
pub struct Pair<L>(L, L);

macro_rules! pairwise {
    ($($operator:ident $method:ident),*) => {
        $(impl<L: $operator<Output = L>> $operator for Pair<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        })*
    };
}

pairwise!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor);

impl<M: Not<Output = M>> Not for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

/// Methods that do the same to both.
macro_rules! in_both {
    ($($method:ident($($other:ident),*) -> $result:ty,)*) => {
        $(#[inline(always)]
        fn $method(self, $($other: Self),*) -> $result {
            Pair(self.0.$method($($other.0),*), self.1.$method($($other.1),*))
        })*
    };
}

impl<L> sealed::Sealed for Pair<L> {}

impl<S: Scalar, L: Lanes<S>> Lanes<S> for Pair<L> {
    const COUNT: usize = 2 * L::COUNT;
    type Mask = Pair<L::Mask>;
    type Isa = L::Isa;

    #[inline(always)]
    fn splat(isa: L::Isa, value: S) -> Self {
        Self(L::splat(isa, value), L::splat(isa, value))
    }
    #[inline(always)]
    unsafe fn load(isa: L::Isa, from: *const S) -> Self {
        // SAFETY: the caller's: there are twice as many.
        unsafe { Self(L::load(isa, from), L::load(isa, from.add(L::COUNT))) }
    }
    #[inline(always)]
    unsafe fn load_bytes(isa: L::Isa, from: *const u8) -> Self {
        // SAFETY: the caller's: there are twice as many.
        unsafe { Self(L::load_bytes(isa, from), L::load_bytes(isa, from.add(L::COUNT))) }
    }
    #[inline(always)]
    fn store(self, to: &mut [S]) {
        let (first, second) = to.split_at_mut(L::COUNT);
        self.0.store(first);
        self.1.store(second);
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> S {
        if lane < L::COUNT { self.0.lane(lane) } else { self.1.lane(lane - L::COUNT) }
    }
    #[inline(always)]
    fn orders_by_bits(isa: L::Isa) -> bool {
        L::orders_by_bits(isa)
    }
    #[inline(always)]
    fn isa(self) -> L::Isa {
        self.0.isa()
    }
    #[inline(always)]
    fn where_else(self, mask: Self::Mask, other: Self) -> Self {
        Self(self.0.where_else(mask.0, other.0), self.1.where_else(mask.1, other.1))
    }
    in_both! {
        mul_add(factor, more) -> Self,
        later(other) -> Self,
        earlier(other) -> Self,
        min(other) -> Self,
        max(other) -> Self,
        abs() -> Self,
        sqrt() -> Self,
        not_after(other) -> Self::Mask,
        lt(other) -> Self::Mask,
        le(other) -> Self::Mask,
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        L::bits(mask.0) | L::bits(mask.1) << L::COUNT
    }
}

/// The lanes of a tree whose nodes have so many children: 4, 8 or 16.
pub trait Width: 'static {
    /// A scalar for each child of a node.
    type Lanes<S: Scalar, I: Simd>: Lanes<S, Isa = I>;
    /// A scalar for each primitive of a leaf.
    type Leaf<S: Scalar, I: Simd>: Lanes<S, Isa = I>;
}

/// A number of children.
pub struct Count<const N: usize>;

impl Width for Count<4> {
    type Lanes<S: Scalar, I: Simd> = S::Times4<I>;
    type Leaf<S: Scalar, I: Simd> = S::Times8<I>;
}
impl Width for Count<8> {
    type Lanes<S: Scalar, I: Simd> = S::Times8<I>;
    type Leaf<S: Scalar, I: Simd> = S::Times8<I>;
}
impl Width for Count<16> {
    type Lanes<S: Scalar, I: Simd> = S::Times16<I>;
    type Leaf<S: Scalar, I: Simd> = S::Times8Of16<I>;
}
