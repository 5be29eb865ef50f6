//! Eight scalars, computed with twice over where that is quicker.
//!
//! While vectors of 512 bits are under way, an Intel processor multiplies vectors of 256 bits in one place, but those of
//! 512 in two. So with AVX-512 a leaf's eight primitives are tested in both halves of a vector that is as wide as a node's. Both
//! hold the same, at no price: a row is spread over them on its way from the cache. On an Intel Xeon (Granite Rapids), means of a
//! kitchen, dragon and sponza in two runs, closest hits of `Fast` triangles were 1.10, 1.07 and 1.07 times as quick (primary,
//! diffuse, random), any hits 1.05, of `Watertight` ones 1.12, 1.10, 1.09 and 1.07.
//!
//! With other instruction sets all is done once.

use super::Lanes;
use super::lanes::sealed::Sealed;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};
use fearless_simd::{ExtractToken, Simd, f32x8, f32x16, mask32x8, mask32x16};

/// With other instruction sets than AVX-512 only the first half counts.
#[derive(Clone, Copy)]
pub struct Twice<I: Simd>(f32x16<I>);

#[derive(Clone, Copy)]
pub struct TwiceMask<I: Simd>(mask32x16<I>);

/// Whether both halves are one vector.
#[inline(always)]
fn is_one_vector<I: Simd>(isa: I) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return isa.level().as_avx512().is_some();
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    {
        let _ = isa;
        false
    }
}

impl<I: Simd> Twice<I> {
    #[inline(always)]
    fn both(half: f32x8<I>) -> Self {
        Self(half.token().combine_f32x8(half, half))
    }

    #[inline(always)]
    fn half(self) -> f32x8<I> {
        self.0.token().split_f32x16(self.0).0
    }
}

impl<I: Simd> TwiceMask<I> {
    #[inline(always)]
    fn both(half: mask32x8<I>) -> Self {
        Self(half.token().combine_mask32x8(half, half))
    }

    #[inline(always)]
    fn half(self) -> mask32x8<I> {
        self.0.token().split_mask32x16(self.0).0
    }
}

/// Methods that do the same to one vector, or to its first half.
macro_rules! lanewise {
    ($($trait:ident::$method:ident($($other:ident: $type:ty),*) -> $result:ident;)*) => {
        $(#[inline(always)]
        fn $method(self, $($other: $type),*) -> $result<I> {
            if is_one_vector(self.0.token()) {
                $result($trait::$method(self.0, $($other.0),*))
            } else {
                $result::both($trait::$method(self.half(), $($other.half()),*))
            }
        })*
    };
}

macro_rules! operators {
    ($($type:ident: $operator:ident::$method:ident($($other:ident)?);)*) => {
        $(impl<I: Simd> $operator for $type<I> {
            type Output = Self;
            lanewise! { $operator::$method($($other: Self)?) -> $type; }
        })*
    };
}

operators! {
    Twice: Add::add(other);
    Twice: Sub::sub(other);
    Twice: Mul::mul(other);
    TwiceMask: BitAnd::bitand(other);
    TwiceMask: BitOr::bitor(other);
    TwiceMask: Not::not();
}

/// In the first half alone: a division of 512 bits takes twice as long as one of 256.
impl<I: Simd> Div for Twice<I> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::both(self.half() / other.half())
    }
}

impl<I: Simd> Sealed for Twice<I> {}

impl<I: Simd> Lanes<f32> for Twice<I> {
    const COUNT: usize = 8;
    type Mask = TwiceMask<I>;
    type Isa = I;

    #[inline(always)]
    fn splat(isa: I, value: f32) -> Self {
        Self(Lanes::splat(isa, value))
    }
    #[inline(always)]
    unsafe fn load(isa: I, from: *const f32) -> Self {
        // SAFETY: the caller's.
        Self::both(unsafe { Lanes::load(isa, from) })
    }
    #[inline(always)]
    unsafe fn load_bytes(isa: I, from: *const u8) -> Self {
        // SAFETY: the caller's.
        Self::both(unsafe { Lanes::load_bytes(isa, from) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        Lanes::store(self.half(), to);
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> f32 {
        self.half().lane(lane)
    }
    #[inline(always)]
    fn isa(self) -> I {
        self.0.token()
    }
    lanewise! {
        Lanes::mul_add(factor: Self, more: Self) -> Twice;
        Lanes::min(other: Self) -> Twice;
        Lanes::max(other: Self) -> Twice;
        Lanes::abs() -> Twice;
        Lanes::where_else(mask: TwiceMask<I>, other: Self) -> Twice;
        Lanes::lt(other: Self) -> TwiceMask;
        Lanes::le(other: Self) -> TwiceMask;
    }
    /// Once, as quotients.
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::both(Lanes::sqrt(self.half()))
    }
    #[inline(always)]
    fn bits(mask: TwiceMask<I>) -> u32 {
        if is_one_vector(mask.0.token()) {
            <f32x16<I> as Lanes<f32>>::bits(mask.0) & 0xFF
        } else {
            <f32x8<I> as Lanes<f32>>::bits(mask.half())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Backend, InstructionSet, Kernel};
    use alloc::vec::Vec;

    /// All operations on two rows: numbers in lanes, and bits of masks.
    struct All([f32; 8], [f32; 8]);

    fn results<L: Lanes<f32>>(isa: L::Isa, a: &[f32; 8], b: &[f32; 8]) -> (Vec<f32>, Vec<u32>) {
        assert_eq!(L::COUNT, 8);
        // SAFETY: eight scalars each.
        let (a, b) = unsafe { (L::load(isa, a.as_ptr()), L::load(isa, b.as_ptr())) };
        let (less, no_more) = (a.lt(b), a.le(b));
        let chosen = a.where_else(less | !no_more, b);
        let numbers =
            [a + b, a - b, a * b, a / b, a.min(b), a.max(b), a.abs(), b.sqrt(), chosen, a.mul_add(b, a)];
        let masks = [less, no_more, !less, less & no_more, less | no_more];
        let lanes = numbers.into_iter().flat_map(|lanes| {
            let mut stored = [0.0; 8];
            lanes.store(&mut stored);
            assert!((0..8).all(|k| lanes.lane(k).to_bits() == stored[k].to_bits()));
            stored
        });
        (lanes.collect(), masks.map(L::bits).to_vec())
    }

    impl Kernel for All {
        const IS_WIDE: bool = true;
        type Output = [(Vec<f32>, Vec<u32>); 2];

        #[inline(always)]
        fn run<I: Simd>(self, isa: I) -> Self::Output {
            [results::<Twice<I>>(isa, &self.0, &self.1), results::<f32x8<I>>(isa, &self.0, &self.1)]
        }
    }

    #[test]
    fn the_same_bits_as_once_on_every_instruction_set() {
        let values = [0.0f32, -0.0, 1.5, -2.25, f32::NAN, f32::INFINITY, 1e-45, -f32::MAX];
        for backend in InstructionSet::available().filter_map(Backend::of) {
            for turn in 0..8 {
                let others = core::array::from_fn(|lane| values[(lane + turn) % 8]);
                let [(twice, twice_masks), (once, once_masks)] = backend.run(All(values, others));
                // The payload of a NaN is nobody's promise.
                let bits = |x: &f32| if x.is_nan() { u32::MAX } else { x.to_bits() };
                assert!(twice.iter().map(bits).eq(once.iter().map(bits)), "{backend:?} {twice:?} {once:?}");
                assert_eq!(twice_masks, once_masks, "{backend:?}");
            }
        }
    }
}
