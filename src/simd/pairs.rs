//! Four lanes, for the slab test of two boxes at once.
//!
//! They are a vector for `f32` where the target has one, else an array. Both round alike, and both
//! leave a NaN out of the maximum alike, so results have the same bits everywhere.

/// Four lanes of `S`.
pub trait Lanes4<S>: Copy {
    /// Joins two pairs: lanes 0 and 1, then lanes 2 and 3.
    fn of_pairs(first: &[S; 2], second: &[S; 2]) -> Self;
    /// Puts one value in the first two lanes and another in the last two.
    fn of_halves(first: S, second: S) -> Self;
    /// Returns a vector with the same value in all lanes.
    fn splat(value: S) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// Returns the larger in each lane, and `other`'s where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Returns the first two lanes, and the last two with opposite signs.
    fn to_pairs_negating_second(self) -> [[S; 2]; 2];
}

macro_rules! portable {
    ($scalar:ty) => {
        impl Lanes4<$scalar> for [$scalar; 4] {
            #[inline(always)]
            fn of_pairs(&[a, b]: &[$scalar; 2], &[c, d]: &[$scalar; 2]) -> Self {
                [a, b, c, d]
            }
            #[inline(always)]
            fn of_halves(first: $scalar, second: $scalar) -> Self {
                [first, first, second, second]
            }
            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                [value; 4]
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                [self[0] - other[0], self[1] - other[1], self[2] - other[2], self[3] - other[3]]
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                [self[0] * other[0], self[1] * other[1], self[2] * other[2], self[3] * other[3]]
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                let larger = |a, b| if a > b { a } else { b };
                let of = |lane: usize| larger(self[lane], other[lane]);
                [of(0), of(1), of(2), of(3)]
            }
            #[inline(always)]
            fn to_pairs_negating_second(self) -> [[$scalar; 2]; 2] {
                [[self[0], self[1]], [-self[2], -self[3]]]
            }
        }
    };
}

portable!(f64);
#[cfg(any(test, not(target_arch = "x86_64")))]
portable!(f32);

/// Four lanes of `f32`: a vector if every processor of the target has one.
#[cfg(target_arch = "x86_64")]
pub type F32Lanes4 = sse2::Lanes;
#[cfg(not(target_arch = "x86_64"))]
pub type F32Lanes4 = [f32; 4];

#[cfg(target_arch = "x86_64")]
mod sse2 {
    use super::Lanes4;
    use core::arch::x86_64::*;

    #[derive(Clone, Copy)]
    pub struct Lanes(__m128);

    impl Lanes4<f32> for Lanes {
        #[inline(always)]
        fn of_pairs(first: &[f32; 2], second: &[f32; 2]) -> Self {
            // Two loads of eight bytes, instead of the five that compilers make of four scalars.
            // SAFETY: SSE2 is part of every x86-64. Each reference is valid for reads of eight
            // bytes, the reads need no alignment, and any bits are an `f64`.
            unsafe {
                let pair = |pair: &[f32; 2]| pair.as_ptr().cast::<f64>().read_unaligned();
                Self(_mm_castpd_ps(_mm_set_pd(pair(second), pair(first))))
            }
        }
        #[inline(always)]
        fn of_halves(first: f32, second: f32) -> Self {
            // SAFETY: SSE2 is part of every x86-64.
            Self(unsafe { _mm_setr_ps(first, first, second, second) })
        }
        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: SSE2 is part of every x86-64.
            Self(unsafe { _mm_set1_ps(value) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of every x86-64.
            Self(unsafe { _mm_sub_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of every x86-64.
            Self(unsafe { _mm_mul_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: SSE2 is part of every x86-64.
            Self(unsafe { _mm_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn to_pairs_negating_second(self) -> [[f32; 2]; 2] {
            let mut lanes = [[0.0; 2]; 2];
            // SAFETY: SSE2 is part of every x86-64. `lanes` has room for two pairs, each write is
            // one pair long, and the writes need no alignment.
            unsafe {
                let negated = _mm_xor_ps(self.0, _mm_set1_ps(-0.0));
                lanes[0].as_mut_ptr().cast::<f64>().write_unaligned(_mm_cvtsd_f64(_mm_castps_pd(self.0)));
                let high = _mm_castps_pd(_mm_movehl_ps(negated, negated));
                lanes[1].as_mut_ptr().cast::<f64>().write_unaligned(_mm_cvtsd_f64(high));
            }
            lanes
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machines_lanes_give_the_portable_bits() {
        let values = [0.0, -0.0, 1.5, -2.25, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-45, f32::MAX];
        for (i, &a) in values.iter().enumerate() {
            for &b in &values {
                let (first, second) = ([a, b], [b, values[i / 2]]);
                fn run<L: Lanes4<f32>>(first: [f32; 2], second: [f32; 2]) -> [[f32; 2]; 2] {
                    let x = L::of_pairs(&first, &second);
                    let y = L::of_pairs(&second, &first);
                    x.sub(L::splat(0.75)).mul(y).max(x).max(y).to_pairs_negating_second()
                }
                let bits = |lanes: [[f32; 2]; 2]| {
                    // The payload of a NaN is not guaranteed.
                    lanes.map(|pair| pair.map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }))
                };
                assert_eq!(bits(run::<F32Lanes4>(first, second)), bits(run::<[f32; 4]>(first, second)));
            }
        }
    }
}
