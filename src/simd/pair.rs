//! A vector of two vectors: twice as many lanes as the processor's own.

use super::{Halves, KernelLanes, Lanes};
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// The lanes of the first vector, then those of the second.
#[derive(Clone, Copy)]
pub struct Pair<L>(L, L);

macro_rules! operators {
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

operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor);

impl<M: Not<Output = M>> Not for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

/// Methods that do the same on both vectors.
macro_rules! in_both {
    ($($method:ident($($other:ident),*) -> $result:ty,)*) => {
        $(#[inline(always)]
        fn $method(self, $($other: Self),*) -> $result {
            Pair(self.0.$method($($other.0),*), self.1.$method($($other.1),*))
        })*
    };
}

impl<S, L: Lanes<S>> Lanes<S> for Pair<L> {
    const COUNT: usize = 2 * L::COUNT;
    type Mask = Pair<L::Mask>;

    in_both! {
        min(other) -> Self,
        max(other) -> Self,
        abs() -> Self,
        sqrt() -> Self,
        lt(other) -> Self::Mask,
        le(other) -> Self::Mask,
    }
    #[inline(always)]
    fn select(self, mask: Self::Mask, other: Self) -> Self {
        Self(self.0.select(mask.0, other.0), self.1.select(mask.1, other.1))
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        L::bits(mask.0) | L::bits(mask.1) << L::COUNT
    }
}

impl<S, L: Lanes<S>> KernelLanes<S> for Pair<L> {
    type Isa = L::Isa;
    type Flags = Pair<L::Mask>;

    #[inline(always)]
    fn splat(isa: L::Isa, value: S) -> Self {
        let one = L::splat(isa, value);
        Self(one, one)
    }
    #[inline(always)]
    unsafe fn load(isa: L::Isa, from: *const S) -> Self {
        // SAFETY: the caller promises `COUNT` scalars, which are two times `L::COUNT`.
        unsafe { Self(L::load(isa, from), L::load(isa, from.add(L::COUNT))) }
    }
    #[inline(always)]
    unsafe fn load_bytes(isa: L::Isa, from: *const u8) -> Self {
        // SAFETY: the caller promises `COUNT` bytes, which are two times `L::COUNT`.
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
    in_both! {
        mul_add(factor, more) -> Self,
        later(other) -> Self,
        earlier(other) -> Self,
        not_after(other) -> Self::Flags,
    }
}

impl<L> Halves<L> for Pair<L> {
    #[inline(always)]
    fn of_halves([first, second]: [L; 2]) -> Self {
        Self(first, second)
    }
    #[inline(always)]
    fn to_halves(self) -> [L; 2] {
        [self.0, self.1]
    }
}
