//! The edge functions U, V, W, in any arithmetic.

use super::fraction::Fraction;
use super::integers::Integers;
use crate::geometry::{Ray, Scalar};
use crate::primitive::Triangle;
use core::ops::{Add, Mul, Sub};
use dashu_int::IBig;

/// Numbers that can be added and multiplied by reference: `f64`, `i128`, `IBig`.
pub(super) trait Number: Sized {
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
}

impl<T> Number for T
where
    for<'a> &'a T: Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    #[inline(always)]
    fn plus(&self, other: &Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        self * other
    }
}

#[inline(always)]
pub(super) fn sub<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    [a[0].minus(&b[0]), a[1].minus(&b[1]), a[2].minus(&b[2])]
}

#[inline(always)]
pub(super) fn dot<N: Number>(a: &[N; 3], b: &[N; 3]) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

#[inline(always)]
pub(super) fn cross<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    let component = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// U, V, W, and the two parts of t, as integers.
///
/// Each is six times the volume of a tetrahedron, hence the name. That of U has the
/// origin, b, c and the direction's tip as its corners. That of the height has the origin
/// and the triangle's corners.
pub(super) struct Volumes {
    /// U, V, W, in units of length^2 * direction.
    sides: [IBig; 3],
    /// U + V + W.
    sum: IBig,
    /// a . (c x b), in units of length^3.
    height: IBig,
    /// The unit of length over that of the direction, as a power of two.
    exponent: i32,
}

impl Volumes {
    /// Returns them, exactly; `None` if a corner is not finite.
    ///
    /// The ray has to be valid.
    pub fn exact<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> Option<Self> {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz], [ox, oy, oz], direction] =
            [triangle.a, triangle.b, triangle.c, ray.origin, ray.direction].map(|p| p.map(S::to_f64));
        let lengths = [ax, ay, az, bx, by, bz, cx, cy, cz, ox, oy, oz];
        if !lengths.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (lengths, direction) = (Integers::new(lengths), Integers::new(direction));
        let exponent = lengths.exponent - direction.exponent;
        // Let lengths be below 2^l and directions below 2^d. Then differences are below 2^(l + 1),
        // the components of cross products below 2^(2 l + 3), U, V and W below 2^(2 l + d + 5),
        // their sum below 2^(2 l + d + 7), and the height below 2^(3 l + 6). With up to 40 bits
        // each, all fit `i128`, which is several times as fast.
        let fits = lengths.bits.max(direction.bits) <= 40;
        let (sides, sum, height) = if fits {
            let (sides, sum, height) = volumes(&lengths.to_array::<i128>(), &direction.to_array());
            (sides.map(IBig::from), sum.into(), height.into())
        } else {
            volumes(&lengths.to_array::<IBig>(), &direction.to_array())
        };
        Some(Self { sides, sum, height, exponent })
    }

    /// Whether no two of U, V, W have opposite signs.
    pub fn are_of_one_sign(&self) -> bool {
        let zero = IBig::ZERO;
        self.sides.iter().all(|side| *side >= zero) || self.sides.iter().all(|side| *side <= zero)
    }

    /// Returns the t at which the line meets the plane.
    ///
    /// Returns `None` if the line is parallel to the plane or the triangle has no area.
    pub fn t(&self) -> Option<Fraction> {
        Fraction::new(self.height.clone(), self.sum.clone(), self.exponent)
    }

    /// Returns -min(U, V, W) / |U + V + W|, signs turned so that the sum is positive.
    pub fn slack(&self) -> Option<Fraction> {
        // To turn the signs is to turn the order.
        let [u, v, w] = &self.sides;
        let nearest = if self.sum > IBig::ZERO { u.min(v).min(w) } else { u.max(v).max(w) };
        Fraction::new(-nearest, self.sum.clone(), 0)
    }

    /// Returns the signs of U, V, W.
    #[cfg(test)]
    pub fn signs(&self) -> [core::cmp::Ordering; 3] {
        self.sides.each_ref().map(|side| side.cmp(&IBig::ZERO))
    }
}

/// Returns U, V, W, their sum, and a . (c x b).
///
/// `lengths` are the coordinates of the corners a, b, c and of the origin, in this order.
fn volumes<N: Number + Clone>(lengths: &[N; 12], direction: &[N; 3]) -> ([N; 3], N, N) {
    let point = |i: usize| [0, 1, 2].map(|axis| lengths[i + axis].clone());
    let origin = point(9);
    let [a, b, c] = [0, 3, 6].map(|i| sub(&point(i), &origin));
    let c_x_b = cross(&c, &b);
    let height = dot(&a, &c_x_b);
    let [u, v, w] = [c_x_b, cross(&a, &c), cross(&b, &a)].map(|plane| dot(direction, &plane));
    let sum = u.plus(&v).plus(&w);
    ([u, v, w], sum, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machine_integers_are_used_only_where_they_hold_the_result() {
        for bits in 40..=42 {
            // All combinations of signs, among them those that make every term as large as can be.
            let far = ((1u64 << bits) - 1) as f64;
            for signs in 0..1 << 15 {
                let x = |i: usize| if signs >> i & 1 == 0 { far } else { -far };
                let [a, b, c, origin, direction] = [0, 3, 6, 9, 12].map(|i| [x(i), x(i + 1), x(i + 2)]);
                let found = Volumes::exact(&Triangle { a, b, c }, &Ray::new(origin, direction)).unwrap();
                let lengths: [IBig; 12] = core::array::from_fn(|i| IBig::try_from(x(i)).unwrap());
                let wide = volumes(&lengths, &direction.map(|x| IBig::try_from(x).unwrap()));
                assert_eq!(
                    (found.sides, found.sum, found.height, found.exponent),
                    (wide.0, wide.1, wide.2, 0)
                );
            }
        }
    }
}
