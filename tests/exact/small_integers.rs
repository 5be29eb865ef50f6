//! Queries, from the ray to the hits, against exact arithmetic in integers.
//!
//! The naive loop shares the acceptance of hits with the trees; this oracle shares nothing.
//! Corners, origins and directions are small whole numbers. So the rounded test sees every edge,
//! corner and coplanar face exactly, and only t is rounded.

use crate::common::heuristics;
use crate::common::in_every_mode::in_every_mode;
use crate::common::integers::{self, Point, assert_exact, exact_t, sub};
use crate::common::modes::Mode;
use bvhkit::{Bvh, Ray, Scalar};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Intervals with ends at infinity, zero, or powers of the golden ratio.
///
/// Powers of the golden ratio stay clear of all fractions that occur.
const AHEAD: [(f64, f64); 4] =
    [(0.0, f64::INFINITY), (PHI, f64::INFINITY), (0.0, 1.0 / PHI), (1.0 / PHI, PHI)];
const BEHIND: [(f64, f64); 4] =
    [(f64::NEG_INFINITY, f64::INFINITY), (-PHI * PHI, 0.0), (-PHI, PHI), (f64::NEG_INFINITY, -1.0 / PHI)];
const PHI: f64 = 1.618_033_988_75;

/// Checks 100 scenes of 12 triangles, each with 100 rays; returns the hits.
fn check<M: Mode>(seed: u64, intervals: &[(f64, f64)]) -> usize {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut hits = 0;
    for _ in 0..100 {
        let mut point = |low, high| [0; 3].map(|_: i32| rng.random_range(low..=high));
        let scene: Vec<[Point; 3]> = (0..12).map(|_| [0; 3].map(|_| point(0, 3))).collect();
        // Every other ray starts far away and meets a corner at t = 1. There, the roundings of
        // the three axes' slabs differ.
        let mut rays: Vec<_> = (0..100).map(|_| (point(-2, 5), point(-3, 3))).collect();
        for i in (1..100).step_by(2) {
            let origin = point(-60, 63);
            rays[i] = (origin, sub(scene[i % 12][i % 3], origin));
        }
        let triangles: Vec<_> = scene.iter().map(|&corners| M::of(integers::triangle(corners))).collect();
        for (name, heuristic) in heuristics::all() {
            let bvh = Bvh::builder().heuristic(&*heuristic).max_leaf_size(2).build(&triangles).unwrap();
            for (i, &(origin, direction)) in rays.iter().enumerate().filter(|(_, ray)| ray.1 != [0; 3]) {
                // With such large numbers a fraction may come close to any end.
                let (from, to) = if i % 2 == 1 { intervals[0] } else { intervals[i / 2 % intervals.len()] };
                let s = M::Number::from_f64;
                let ray = Ray::new(integers::point::<M::Number>(origin), integers::point(direction))
                    .with_interval(s(from), s(to));
                let expected: Vec<_> = (0..scene.len())
                    .filter_map(|index| Some((index, exact_t(scene[index], origin, direction)?)))
                    .filter(|&(_, t)| from <= t && t <= to)
                    .collect();
                let found: Vec<_> = bvh.hits(&ray).map(|hit| (hit.index, hit.t)).collect();
                hits += found.len();
                assert_exact(&found, &expected, &(name, ray));
            }
        }
    }
    hits
}

fn grid_scenes<M: Mode>() {
    assert!(check::<M>(1, &AHEAD) > 10_000);
}

/// Intervals are the ray's own, whatever its origin; here they reach behind it.
fn grid_scenes_behind_the_origin<M: Mode>() {
    assert!(check::<M>(3, &BEHIND) > 10_000);
}

in_every_mode!(grid_scenes grid_scenes_behind_the_origin);
