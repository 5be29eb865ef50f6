//! The whole way from the ray to the hits, against exact arithmetic in integers.
//!
//! The naive loop shares the acceptance of hits with the trees; this oracle shares nothing. Corners,
//! origins and directions are small whole numbers, so that the rounded test sees every edge, corner
//! and coplanar face exactly, and only t is rounded.

mod common {
    pub mod heuristics;
    pub mod hostile;
}

use bvhkit::{Bvh, Ray, Scalar, Triangle};
use common::heuristics;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Point = [i32; 3];

fn sub(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> i32 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The t at which the line meets the triangle, edges and corners included, coplanar ones excluded.
/// The nearest `f64` to the exact fraction.
fn exact_t([a, b, c]: [Point; 3], origin: Point, direction: Point) -> Option<f64> {
    let [a, b, c] = [a, b, c].map(|corner| sub(corner, origin));
    let normal = cross(sub(b, a), sub(c, a));
    let det = dot(normal, direction);
    // Which side of each edge the line passes.
    let sides = [cross(c, b), cross(a, c), cross(b, a)].map(|plane| dot(plane, direction));
    let inside = sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0);
    (det != 0 && inside).then(|| f64::from(dot(normal, a)) / f64::from(det))
}

/// Intervals that end nowhere, at zero, or at powers of the golden ratio, which stay clear of all
/// fractions that occur.
const AHEAD: [(f64, f64); 4] =
    [(0.0, f64::INFINITY), (PHI, f64::INFINITY), (0.0, 1.0 / PHI), (1.0 / PHI, PHI)];
const BEHIND: [(f64, f64); 4] =
    [(f64::NEG_INFINITY, f64::INFINITY), (-PHI * PHI, 0.0), (-PHI, PHI), (f64::NEG_INFINITY, -1.0 / PHI)];
const PHI: f64 = 1.618_033_988_75;

/// Grid scenes of 12 triangles, 100 rays each; returns the number of hits.
fn check<S: Scalar>(seed: u64, intervals: &[(f64, f64)]) -> usize {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut hits = 0;
    for _ in 0..100 {
        let mut point = |low, high| [0; 3].map(|_: i32| rng.random_range(low..=high));
        let scene: Vec<[Point; 3]> = (0..12).map(|_| [0; 3].map(|_| point(0, 3))).collect();
        // Every other ray starts far away and meets a corner at t = 1, where the roundings of the three
        // axes' slabs differ.
        let mut rays: Vec<_> = (0..100).map(|_| (point(-2, 5), point(-3, 3))).collect();
        for i in (1..100).step_by(2) {
            let origin = point(-60, 63);
            rays[i] = (origin, sub(scene[i % 12][i % 3], origin));
        }
        let s = |p: Point| p.map(|x| S::from_f64(f64::from(x)));
        let triangles: Vec<_> = scene.iter().map(|&[a, b, c]| Triangle::new(s(a), s(b), s(c))).collect();
        for (name, heuristic) in heuristics::all() {
            let bvh = Bvh::builder().heuristic(&*heuristic).max_leaf_size(2).build(&triangles).unwrap();
            for (i, &(origin, direction)) in rays.iter().enumerate().filter(|(_, ray)| ray.1 != [0; 3]) {
                // A fraction of such large numbers may come close to any end.
                let (from, to) = if i % 2 == 1 { intervals[0] } else { intervals[i / 2 % intervals.len()] };
                let ray = Ray::new(s(origin), s(direction)).with_interval(S::from_f64(from), S::from_f64(to));
                let mut expected: Vec<_> = (0..scene.len())
                    .filter_map(|index| Some((index, exact_t(scene[index], origin, direction)?)))
                    .filter(|&(_, t)| from <= t && t <= to)
                    .collect();
                let mut found: Vec<_> = bvh.hits(&ray).map(|hit| (hit.index, hit.t.to_f64())).collect();
                assert!(found.is_sorted_by(|a, b| (a.1, a.0) < (b.1, b.0)), "{name}: {found:?}");
                found.sort_by_key(|hit| hit.0);
                expected.sort_by_key(|hit| hit.0);
                hits += found.len();
                let near = |a: f64, b: f64| (a - b).abs() <= 8.0 * S::EPSILON.to_f64() * b.abs();
                assert!(
                    found.len() == expected.len()
                        && found.iter().zip(&expected).all(|(f, e)| f.0 == e.0 && near(f.1, e.1)),
                    "{name}, {ray:?}: {found:?}, exactly {expected:?}",
                );
            }
        }
    }
    hits
}

#[test]
fn grid_scenes_f32() {
    assert!(check::<f32>(1, &AHEAD) > 10_000);
}

#[test]
fn grid_scenes_f64() {
    assert!(check::<f64>(2, &AHEAD) > 10_000);
}

/// The interval is the ray's, wherever its origin is.
#[test]
fn grid_scenes_behind_the_origin() {
    assert!(check::<f32>(3, &BEHIND) + check::<f64>(4, &BEHIND) > 20_000);
}
