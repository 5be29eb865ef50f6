//! Triangle soups that are hard for a tree, and rays at targets hard to hit.

use bvhkit::{Ray, Scalar, Triangle};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// The number of kinds of soups.
pub const KINDS: usize = 8;

type Point = [f64; 3];

/// Returns `n` triangles of a kind, which is a number below [`KINDS`].
pub fn soup<S: Scalar>(kind: usize, n: usize, rng: &mut Pcg64Mcg) -> Vec<Triangle<S>> {
    let mut point = |size: f64| [0.0; 3].map(|_: f64| rng.random_range(-size..size));
    let whole = |point: Point| point.map(f64::round);
    let near = |center: Point, offset: Point| [0, 1, 2].map(|k| center[k] + offset[k]);
    let mut triangle = |i: usize| -> [Point; 3] {
        let center = point(1.0);
        let mut around = |size: f64| [0; 3].map(|_| near(center, point(size)));
        match kind {
            0 => around(0.5),
            1 => around(0.01),
            // On whole numbers: shared edges, coplanar faces, equal t, no area.
            2 => around(3.0).map(whole),
            // Needles, a million times as long as wide.
            3 => {
                let [a, b, c] = around(2.0);
                [a, b, [0, 1, 2].map(|k| b[k] + 1e-6 * (c[k] - a[k]))]
            }
            // Each triangle has its own size, up to 1e12 times that of another.
            4 => around(0.5).map(|p| p.map(|x| x * 10f64.powi(i as i32 % 13 - 6))),
            5 => around(0.5).map(|p| p.map(|x| x + 1e7)),
            // Coordinates close to both ends of the range of f32.
            6 => around(0.5).map(|p| p.map(|x| x * if i.is_multiple_of(2) { 1e-36 } else { 1e36 })),
            _ => around(0.5),
        }
    };
    let mut corners: Vec<[Point; 3]> = (0..n).map(&mut triangle).collect();
    if kind == KINDS - 1 {
        // Each triangle occurs four times.
        corners = (0..n).map(|i| corners[i / 4]).collect();
    }
    let corner = |p: Point| p.map(S::from_f64);
    corners.into_iter().map(|[a, b, c]| Triangle::new(corner(a), corner(b), corner(c))).collect()
}

/// Returns a ray at a corner, an edge or the inside of some triangle.
///
/// It starts at a corner, inside a triangle or elsewhere. Some rays go along an axis through the
/// target, often in planes of the triangle's box. Some have an interval.
pub fn ray<S: Scalar>(soup: &[Triangle<S>], rng: &mut Pcg64Mcg) -> Ray<S> {
    let mut pick = || soup[rng.random_range(0..soup.len())];
    let (from, to) = (pick(), pick());
    let half = |a: [S; 3], b: [S; 3]| [0, 1, 2].map(|k| a[k] * S::HALF + b[k] * S::HALF);
    let target = match rng.random_range(0..3) {
        0 => to.a,
        1 => half(to.a, to.b),
        _ => half(half(to.a, to.b), to.c),
    };
    let origin = match rng.random_range(0..3) {
        0 => from.c,
        1 => half(half(from.a, from.b), from.c),
        _ => half(from.c, to.b).map(|x| x + x),
    };
    let ray = if rng.random_range(0..4) == 0 {
        let axis = rng.random_range(0..3);
        let (mut start, mut direction) = (target, [S::ZERO, -S::ZERO, S::ZERO]);
        start[axis] = origin[axis];
        direction[axis] = if rng.random() { S::ONE } else { -S::ONE };
        Ray::new(start, direction)
    } else {
        Ray::new(origin, [0, 1, 2].map(|k| target[k] - origin[k]))
    };
    match rng.random_range(0..8) {
        0 => ray.with_interval(S::ZERO, S::ONE),
        1 => ray.with_interval(S::ONE, S::INFINITY),
        2 => ray.with_interval(-S::ONE, S::HALF),
        _ => ray,
    }
}
