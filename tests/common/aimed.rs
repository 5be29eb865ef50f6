//! A fixed soup of triangles, and rays at targets that are hard to hit.

use bvhkit::{Aabb, Ray, Scalar, Triangle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Returns `n` triangles in the cube from -1 to 1, each about half its size.
pub fn soup(n: usize) -> Vec<[[f64; 3]; 3]> {
    let mut rng = Pcg64Mcg::seed_from_u64(n as u64);
    let mut point = |size: f64| [0.0; 3].map(|_| rng.random_range(-size..size));
    let mut triangle = || {
        let (center, corners) = (point(0.5), [0; 3].map(|_| point(0.5)));
        corners.map(|corner| [0, 1, 2].map(|axis| center[axis] + corner[axis]))
    };
    (0..n).map(|_| triangle()).collect()
}

/// Returns the soup, with `change` applied to each triangle's index and coordinate.
pub fn triangles<S: Scalar>(soup: &[[[f64; 3]; 3]], change: impl Fn(usize, f64) -> f64) -> Vec<Triangle<S>> {
    let point = |i: usize, point: [f64; 3]| point.map(|x| S::from_f64(change(i, x)));
    soup.iter()
        .enumerate()
        .map(|(i, &[a, b, c])| Triangle::new(point(i, a), point(i, b), point(i, c)))
        .collect()
}

/// Returns four rays for each triangle.
///
/// Three go from a corner of another triangle to a corner, the middle of an edge and the inside.
/// One goes along an axis through a corner, often in planes of the triangle's box.
pub fn aimed<S: Scalar>(triangles: &[Triangle<S>]) -> Vec<Ray<S>> {
    let half = |a: [S; 3], b: [S; 3]| [0, 1, 2].map(|k| a[k] * S::HALF + b[k] * S::HALF);
    let bounds = Aabb::of_points(triangles.iter().flat_map(|t| [t.a, t.b, t.c]));
    let mut rays = Vec::new();
    for (i, &Triangle { a, b, c }) in triangles.iter().enumerate() {
        let origin = triangles[(7 * i + 3) % triangles.len()].c;
        for target in [a, half(a, b), half(half(a, b), c)] {
            rays.push(Ray::new(origin, [0, 1, 2].map(|k| target[k] - origin[k])));
        }
        let (mut origin, mut direction) = (b, [S::ZERO, -S::ZERO, S::ZERO]);
        origin[i % 3] = bounds.min[i % 3];
        direction[i % 3] = S::ONE;
        rays.push(Ray::new(origin, direction));
    }
    rays
}
