//! What is done to trees beside splitting: reinsertion, references in several leaves, builds in a hurry.

mod common {
    pub mod heuristics;
    pub mod hostile;
}

use bvhkit::heuristic::{Heuristic, Median, SpatialSah};
use bvhkit::{
    BuildError, Bvh, Fast, Hit, MAX_DEPTH, Optimise, Pace, Quality, Ray, Tree, Triangle, reference,
};
use common::heuristics;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Small triangles, and every tenth as long as the scene.
fn triangles(n: usize) -> Vec<Fast<Triangle>> {
    let mut rng = Pcg64Mcg::seed_from_u64(n as u64);
    let mut point = |size: f32| [0.0; 3].map(|_: f32| rng.random_range(-size..size));
    let add = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|k| a[k] + b[k]);
    let triangle = |i: usize| {
        let (center, b, c) = (point(10.0), point(if i.is_multiple_of(10) { 10.0 } else { 0.3 }), point(0.3));
        Fast(Triangle::new(center, add(center, b), add(center, c)))
    };
    (0..n).map(triangle).collect()
}

fn rays(n: usize) -> Vec<Ray> {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut point = || [0.0; 3].map(|_: f32| rng.random_range(-10.0..10.0));
    (0..n).map(|_| Ray::new(point(), point())).collect()
}

fn assert_answers<H: Heuristic<f32>>(
    triangles: &[Fast<Triangle>],
    builder: bvhkit::Builder<Fast<Triangle>, H>,
) {
    let bvh = builder.build(triangles.iter().copied()).unwrap();
    bvh.check().unwrap();
    for ray in rays(200) {
        let all = reference::hits(triangles, &ray);
        let index = |hit: &Hit<_, _>| (hit.t, hit.index);
        assert_eq!(bvh.closest_hit(&ray).as_ref().map(index), all.first().map(index));
        assert!(bvh.hits(&ray).map(|hit| index(&hit)).eq(all.iter().map(index)));
    }
}

#[test]
fn reinsertion_gains_keeps_every_invariant_and_does_the_same_on_any_number_of_threads() {
    let triangles = triangles(20_000);
    let optimise = Optimise { share: 0.2, rounds: 3 };
    for (name, heuristic) in heuristics::all() {
        let builder = || Bvh::builder().heuristic(&*heuristic).max_leaf_size(2).layout::<Tree>();
        let mut bvh = builder().build(&triangles).unwrap();
        let before = bvh.report();
        let gain = bvh.optimise(&optimise);
        bvh.check().unwrap();
        let after = bvh.report();
        assert!(gain.moves > 0 && gain.after < gain.before, "{name}: {gain:?}");
        assert!(after.sah_cost < before.sah_cost && after.max_depth <= MAX_DEPTH, "{name}");
        assert_eq!((after.leaves, after.references), (before.leaves, before.references), "{name}");
        for threads in [1, 2, 4] {
            let other = builder().optimise(optimise).threads(threads).build(&triangles).unwrap();
            assert!(bvh.layout() == other.layout(), "{name}, {threads} threads");
        }
    }
}

#[test]
fn reinsertion_takes_any_size_and_any_share() {
    for n in [0, 1, 2, 3, 4, 9] {
        for share in [f64::NAN, -1.0, 0.0, 1.0, f64::INFINITY] {
            let mut bvh = Bvh::builder().max_leaf_size(1).layout::<Tree>().build(triangles(n)).unwrap();
            let gain = bvh.optimise(&Optimise { share, rounds: 2 });
            bvh.check().unwrap();
            assert!(gain.after <= gain.before, "{n} at {share}: {gain:?}");
        }
    }
}

#[test]
fn what_is_cut_is_an_answer_once_and_no_more_of_it_than_there_is_room_for() {
    let triangles = triangles(3_000);
    for growth in [0.0, 0.01, 0.5, 10.0] {
        let heuristic = SpatialSah { overlap: 0.0, growth, ..SpatialSah::default() };
        let bvh = Bvh::builder().heuristic(heuristic).build(&triangles).unwrap();
        let report = bvh.report();
        assert_eq!((report.primitives, bvh.len()), (3_000, 3_000));
        let more = report.references - report.primitives;
        assert!(more <= (3_000.0 * growth) as usize && (more > 0) == (growth > 0.0), "{growth}: {more}");
        assert_answers(&triangles, Bvh::builder().heuristic(heuristic));
        assert_answers(&triangles, Bvh::builder().heuristic(heuristic).optimise(Optimise::default()));
    }
}

#[test]
fn presets_answer_as_the_naive_loop_does() {
    let triangles = triangles(5_000);
    for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
        assert_answers(&triangles, Bvh::builder().quality(quality));
    }
}

#[test]
fn progress_goes_from_0_to_1() {
    let seen = Arc::new(Mutex::new(Vec::new()));
    let watcher = {
        let seen = Arc::clone(&seen);
        move |progress| {
            seen.lock().unwrap().push(progress);
            Pace::Steady
        }
    };
    Bvh::builder().threads(1).watch(watcher).build(triangles(50_000)).unwrap();
    let seen = seen.lock().unwrap();
    assert!(seen.len() > 10 && seen.is_sorted(), "{seen:?}");
    assert_eq!((seen[0], seen[seen.len() - 1]), (0.0, 1.0));
}

#[test]
fn a_build_stops_when_it_is_told_to() {
    for limit in [0.0, 0.5, 1.0] {
        let watcher = move |progress| if progress >= limit { Pace::Stop } else { Pace::Steady };
        let error = Bvh::builder().watch(watcher).build(triangles(50_000)).unwrap_err();
        assert_eq!(error, BuildError::Stopped, "at {limit}");
    }
}

#[test]
fn a_build_in_a_hurry_is_coarser_and_answers_alike() {
    let triangles = triangles(50_000);
    let cost = |limit: f64| {
        let watcher = move |progress| if progress >= limit { Pace::Hurry } else { Pace::Steady };
        let builder = Bvh::builder().heuristic(Median).threads(1).watch(watcher);
        let bvh = builder.build(&triangles).unwrap();
        bvh.check().unwrap();
        bvh.report().sah_cost
    };
    let (at_once, half_way, never) = (cost(0.0), cost(0.5), cost(2.0));
    assert!(at_once > half_way && half_way > never, "{at_once} {half_way} {never}");
    assert_answers(&triangles[..3_000], Bvh::builder().time_budget(Duration::ZERO));
}
