//! Small triangles in a cube.

use bvhkit::{Scalar, Triangle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Returns `n` random triangles, no two of them alike.
pub fn triangles<S: Scalar>(n: usize) -> Vec<Triangle<S>> {
    let mut rng = Pcg64Mcg::seed_from_u64(n as u64);
    let mut point = |size: f64| [0.0; 3].map(|_: f64| rng.random_range(-size..size));
    let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| S::from_f64(a[k] + b[k]));
    let mut triangle = |_| {
        let (center, b, c) = (point(100.0), point(2.0), point(2.0));
        Triangle::new(add(center, [0.0; 3]), add(center, b), add(center, c))
    };
    (0..n).map(&mut triangle).collect()
}
