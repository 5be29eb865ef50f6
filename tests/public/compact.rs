//! Tests of the compact layout: its memory, and boxes of any size.

use crate::common::naive::Naive;
use bvhkit::{Aabb, Bvh, CompactTree, Ray, Scalar, Triangle};

/// Returns a height field of `2 * size * size` triangles.
fn terrain(size: usize) -> Vec<Triangle> {
    let point = |i: usize, k: usize| {
        let (x, z) = (i as f32, k as f32);
        [x, (x * 0.3).sin() * (z * 0.2).cos(), z]
    };
    let square = |i: usize, k: usize| {
        let [a, b, c, d] = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)].map(|(i, k)| point(i, k));
        [Triangle::new(a, b, c), Triangle::new(a, c, d)]
    };
    (0..size).flat_map(|i| (0..size).flat_map(move |k| square(i, k))).collect()
}

#[test]
fn a_triangle_takes_at_most_45_bytes_all_in() {
    let triangles = terrain(100);
    let owned = Bvh::builder().layout::<CompactTree>().build(triangles.clone()).unwrap();
    let borrowed = Bvh::builder().layout::<CompactTree>().build(&triangles).unwrap();
    let bytes = |bytes: usize| bytes as f64 / triangles.len() as f64;
    let (owned, borrowed) = (bytes(owned.memory_bytes()), bytes(borrowed.memory_bytes()));
    assert!(owned <= 45.0 && borrowed <= 17.0, "{owned} {borrowed}");
}

/// Returns boxes with corners from `-scale` to `scale`.
///
/// At the largest scales some extents overflow; the smallest extents are zero.
fn boxes<S: Scalar>(scale: S) -> Vec<Aabb<S>> {
    let corners = [-1.0, -0.999, -0.5, -0.0, 0.0, 1e-6, 0.25, 1.0];
    let corners = corners.map(|x| scale * S::from_f64(x));
    let pairs = corners.iter().flat_map(|&a| corners.iter().map(move |&b| [a, b]));
    pairs.clone().zip(pairs.skip(3)).map(|([a, b], [c, d])| Aabb::of_points([[a, c, b], [d, b, a]])).collect()
}

/// Compares trees over boxes with the naive loop and returns the number of hits.
///
/// There are no hits where distances overflow.
fn compare<S: Scalar>(scale: S) -> usize {
    let boxes = boxes(scale);
    let (small, half) = (S::from_f64(1e-3), S::HALF);
    let directions = [[1.0, 0.0, 0.0], [-1.0, 0.5, 0.25], [0.3, -1.0, -0.0], [0.1, 0.2, -1.0]];
    let mut rays = Vec::new();
    for direction in directions.map(|direction| direction.map(|x| S::from_f64(x) * scale * small)) {
        for origin in
            [[scale, scale * half, S::ZERO], [-scale; 3], [S::ZERO; 3], [scale * small, -scale, scale]]
        {
            let ray = Ray::new(origin, direction);
            rays.extend([ray, ray.with_interval(S::NEG_INFINITY, S::INFINITY)]);
        }
    }
    let naive = Naive::new(&boxes, &rays);
    naive.assert_same(Bvh::builder().layout::<CompactTree<S>>(), format_args!("scale {scale:?}"));
    naive.hits()
}

#[test]
fn boxes_as_large_as_the_range_and_as_small() {
    let singles = [f32::MAX, 1e38, 1e37, 1e30, 1.0, 1e-30, 1e-37].map(compare);
    let doubles = [f64::MAX, 1e300, 1.0, 1e-300].map(compare);
    let hits: usize = singles.iter().chain(&doubles).sum();
    assert!(hits > 1000, "{singles:?} {doubles:?}");
}
