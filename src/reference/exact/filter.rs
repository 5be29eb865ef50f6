//! The static filter: cases that plain `f64` arithmetic decides beyond doubt.

use super::volumes::{cross, dot, sub};
use crate::geometry::{Ray, Scalar};
use crate::primitive::Triangle;

/// Whether the ray's line surely passes outside; `false` decides nothing.
pub(super) fn surely_misses<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> bool {
    let [u, v, w] = sure_signs(triangle, ray);
    // Without branches, since nothing could predict them.
    (u.max(v).max(w) > 0) & (u.min(v).min(w) < 0)
}

/// Returns the signs of U, V, W: 1 or -1 where they are beyond doubt, else 0.
///
/// # The bound
///
/// U = d . (c x b) is a sum of products d c b, with c and b relative to the origin. In `f64`, each
/// product passes through 7 roundings: one for each of the two differences (for `f32` coordinates
/// too, if their exponents are far apart), two products, the difference in the cross product, and
/// at most two sums. A rounding changes its result by at most u = 2^-53 of it. Let P be the sum of
/// the exact products' sizes. Then the error is at most ((1 + u)^7 - 1) P. Let p be the same sum of
/// sizes, as computed. It is at least (1 - u)^7 P, so the error is at most
///
/// ```text
/// ((1 + u)^7 - 1) / (1 - u)^7 p < 8 u p
/// ```
///
/// and 8 u p is computed without rounding.
///
/// All this holds while nothing overflows, and nothing that counts underflows. That is so if
/// differences and directions are zero or in [2^-300, 2^300]: a difference of two products of
/// theirs is zero or no smaller than an ulp of 2^-600, and its product with a third still has all
/// its digits. For `f32` data that is no restriction. Other `f64` data is left undecided. If a
/// corner is not finite, two of the three bounds are infinite or NaN, and no value exceeds those.
#[inline(always)]
fn sure_signs<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> [i8; 3] {
    let wide = |p: [S; 3]| p.map(S::to_f64);
    let (origin, d) = (wide(ray.origin), wide(ray.direction));
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| sub(&wide(p), &origin));
    // All numbers of `f32` are in range, and so are their differences.
    if S::ZERO.next_up().to_f64() < SMALL && !in_range([a, b, c, d].as_flattened()) {
        return [0; 3];
    }
    // Three calls: an array's `map` is not inlined, and takes four times as long (63 ns, not 16).
    [sure_sign(c, b, d), sure_sign(a, c, d), sure_sign(b, a, d)]
}

/// Returns the sign of d . (p x q): 1 or -1 where it is beyond doubt, else 0.
#[inline(always)]
fn sure_sign(p: [f64; 3], q: [f64; 3], d: [f64; 3]) -> i8 {
    let value = dot(&d, &cross(&p, &q));
    let bound = BOUND * dot(&d.map(f64::abs), &sum_of_sizes(p, q));
    i8::from(value > bound) - i8::from(value < -bound)
}

/// Whether the sizes of all values are zero or in [`SMALL`, `LARGE`].
fn in_range(values: &[f64]) -> bool {
    values.iter().all(|x| *x == 0.0 || (SMALL..=LARGE).contains(&x.abs()))
}

/// 8 u.
const BOUND: f64 = 4.0 * f64::EPSILON;
/// 2^-300.
const SMALL: f64 = f64::from_bits((1023 - 300) << 52);
/// 2^300.
const LARGE: f64 = f64::from_bits((1023 + 300) << 52);

/// Returns the cross product, with the sizes of all products added.
#[inline(always)]
fn sum_of_sizes(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let component = |i: usize, j: usize| (a[i] * b[j]).abs() + (a[j] * b[i]).abs();
    [component(1, 2), component(2, 0), component(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::super::volumes::Volumes;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Counts the decided signs and all signs, and checks those decided.
    ///
    /// The integers tell the true signs.
    fn decided<S: Scalar>(cases: impl Iterator<Item = (Triangle<S>, Ray<S>)>) -> (usize, usize) {
        let (mut decided, mut all) = (0, 0);
        for (triangle, ray) in cases {
            let exact = Volumes::exact(&triangle, &ray).unwrap().signs();
            for (sure, exact) in sure_signs(&triangle, &ray).into_iter().zip(exact) {
                assert!(sure == 0 || sure == exact as i8, "{triangle:?} {ray:?}");
                (decided, all) = (decided + usize::from(sure != 0), all + 1);
            }
        }
        (decided, all)
    }

    /// Returns a triangle with coordinates from a source, and a ray aimed at it.
    ///
    /// The ray begins at another point of the source. Its aim is the middle of an edge (rounded), a
    /// corner, a point inside, or nothing.
    fn aimed<S: Scalar>(mut coordinate: impl FnMut() -> f64, aim: [f64; 3]) -> (Triangle<S>, Ray<S>) {
        let mut point = || [0; 3].map(|_| S::from_f64(coordinate()));
        let (a, b, c, origin) = (point(), point(), point(), point());
        let [u, v, w] = aim.map(S::from_f64);
        let direction = [0, 1, 2].map(|i| a[i] * u + b[i] * v + c[i] * w - origin[i]);
        (Triangle { a, b, c }, Ray::new(origin, direction))
    }

    const EDGE: [f64; 3] = [0.5, 0.5, 0.0];
    const CORNER: [f64; 3] = [0.0, 1.0, 0.0];
    const INSIDE: [f64; 3] = [0.25, 0.25, 0.5];
    const NOTHING: [f64; 3] = [3.0, -4.0, 5.0];

    /// Cases with coordinates from -1 to 1.
    fn ordinary<S: Scalar>(aim: [f64; 3]) -> impl Iterator<Item = (Triangle<S>, Ray<S>)> {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        (0..20_000).map(move |_| aimed(|| rng.random_range(-1.0..1.0), aim))
    }

    #[test]
    fn ordinary_cases_are_decided_and_edges_are_not() {
        for aim in [INSIDE, NOTHING] {
            let (sure, all) = decided(ordinary::<f32>(aim));
            assert!(sure * 1000 > all * 999, "{sure} of {all}");
            let (sure, all) = decided(ordinary::<f64>(aim));
            assert!(sure * 1000 > all * 999, "{sure} of {all}");
        }
        // At one of three edges, or at two that meet in a corner: with `f64` data the functions of
        // these edges are all rounding.
        for (aim, edges) in [(EDGE, 1), (CORNER, 2)] {
            let (sure, all) = decided(ordinary::<f64>(aim));
            let open = all - sure;
            assert!(open * 10 > all / 3 * edges * 9 && sure > all / 4, "{open} of {all}");
            let (sure, all) = decided(ordinary::<f32>(aim));
            assert!(sure < all && sure > all / 4, "{sure} of {all}");
        }
    }

    #[test]
    fn mixed_magnitudes_are_decided_rightly() {
        for range in [5.0, 20.0, 38.0, 150.0, 300.0] {
            let mut rng = Pcg64Mcg::seed_from_u64(2);
            let mut coordinate =
                || 10f64.powf(rng.random_range(-range..range)) * [1.0, -1.0][rng.random_range(0..2)];
            for aim in [EDGE, CORNER, INSIDE, NOTHING] {
                let finite = |(_, ray): &(Triangle<f64>, Ray<f64>)| ray.is_valid();
                decided((0..2000).map(|_| aimed(&mut coordinate, aim)).filter(finite));
                if range < 38.0 {
                    decided(
                        (0..2000)
                            .map(|_| aimed::<f32>(&mut coordinate, aim))
                            .filter(|case| case.1.is_valid()),
                    );
                }
            }
        }
    }

    #[test]
    fn what_may_overflow_underflow_or_is_not_finite_is_left_open() {
        let ray = Ray::new([0.0; 3], [0.1, 0.2, 1.0]);
        for size in [1e-100, 1e-95, 1e95, f64::MAX, f64::INFINITY, f64::NAN] {
            let far = Triangle::new([size, 0.0, size], [0.0, size, size], [-size, -size, size]);
            assert_eq!(sure_signs(&far, &ray), [0; 3]);
        }
        let f32_size = [1e-45f32, f32::MAX];
        for size in f32_size {
            let far = Triangle::new([size, 0.0, size], [0.0, size, size], [-size, -size, size]);
            assert_ne!(sure_signs(&far, &Ray::new([0.0; 3], [0.0, 0.0, f32::MIN_POSITIVE])), [0; 3]);
        }
    }
}
