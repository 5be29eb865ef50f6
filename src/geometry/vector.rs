//! Arithmetic on vectors of three scalars, each operation rounded once.

use super::Scalar;

/// Returns the cross product: each coordinate a difference of rounded products.
#[inline(always)]
pub(crate) fn cross<S: Scalar>([ax, ay, az]: [S; 3], [bx, by, bz]: [S; 3]) -> [S; 3] {
    [ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay]
}

/// Returns the dot product, summed from the left.
#[inline(always)]
pub(crate) fn dot<S: Scalar>([ax, ay, az]: [S; 3], [bx, by, bz]: [S; 3]) -> S {
    ax * bx + ay * by + az * bz
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails if the build fuses multiplication and addition.
    #[test]
    fn swapped_operands_negate_the_cross_product_and_dot_products_round_each_step() {
        // Two products that differ by less than a rounding.
        let (a, b) = ([1.0f32 + f32::EPSILON, 3.0, 0.7], [3.0f32 * (1.0 + f32::EPSILON), 9.0, 2.1]);
        fn check<S: Scalar>(a: [S; 3], b: [S; 3]) {
            let products = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
            assert_eq!(cross(a, b), [products(1, 2), products(2, 0), products(0, 1)]);
            assert_eq!(cross(b, a), cross(a, b).map(|x| -x));
            assert_eq!(dot(a, b), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        }
        check(a, b);
        check(a.map(|x| f64::from(x) / 3.0), b.map(|x| f64::from(x) / 7.0));
    }
}
