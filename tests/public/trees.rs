//! Tests of builds beyond plain splits.
//!
//! They cover reinsertion, spatial splits, progress callbacks, builds
//! in a hurry, clusters and codes.

use crate::common::heuristics;
use bvhkit::heuristic::{BinnedSah, BuildNode, Clustered, Heuristic, Median, Morton, SpatialSah, Split};
use bvhkit::{
    Aabb, Axis, BuildControl, BuildError, Bvh, Fast, Hit, MAX_DEPTH, Optimise, PrimRef, Quality, Ray, Tree,
    Triangle, reference,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A heuristic that derives its split only from the number of references.
struct Stubborn(fn(usize) -> Split);

impl Heuristic<f32> for Stubborn {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        self.0(node.references.len())
    }
}

/// Returns small triangles, and every tenth as long as the scene.
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
        let mut bvh = builder().optimise(Optimise::NONE).build(&triangles).unwrap();
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
            BuildControl::Steady
        }
    };
    Bvh::builder().threads(1).progress(watcher).build(triangles(50_000)).unwrap();
    let seen = seen.lock().unwrap();
    assert!(seen.len() > 10 && seen.is_sorted(), "{seen:?}");
    assert_eq!((seen[0], seen[seen.len() - 1]), (0.0, 1.0));
}

#[test]
fn a_build_stops_when_it_is_told_to() {
    for limit in [0.0, 0.5, 1.0] {
        let watcher =
            move |progress| if progress >= limit { BuildControl::Stop } else { BuildControl::Steady };
        let error = Bvh::builder().progress(watcher).build(triangles(50_000)).unwrap_err();
        assert_eq!(error, BuildError::Stopped, "at {limit}");
    }
}

/// Returns a progress callback that answers `pace` from the progress `limit` on.
fn from(limit: f64, pace: BuildControl) -> impl Fn(f64) -> BuildControl + Send + Sync + 'static {
    move |progress| if progress >= limit { pace } else { BuildControl::Steady }
}

#[test]
fn a_build_in_a_hurry_is_coarser_and_answers_alike() {
    let triangles = triangles(50_000);
    let builder = || Bvh::builder().heuristic(BinnedSah::default()).threads(1).layout::<Tree>();
    let hurried = |limit: f64| {
        let bvh = builder().progress(from(limit, BuildControl::Hurry)).build(&triangles).unwrap();
        bvh.check().unwrap();
        bvh
    };
    let cost = |limit: f64| hurried(limit).report().sah_cost;
    let (at_once, half_way, never) = (cost(0.0), cost(0.5), cost(2.0));
    assert!(at_once > half_way && half_way > never, "{at_once} {half_way} {never}");
    let sorted = builder().heuristic(Morton).build(&triangles).unwrap();
    assert!(hurried(0.0).layout() == sorted.layout(), "what is left is sorted");
    let out_of_time = builder().time_budget(Duration::ZERO).build(&triangles).unwrap();
    assert!(out_of_time.layout() == sorted.layout(), "no time at all");
    for limit in [0.0, 0.3] {
        assert_answers(&triangles[..20_000], Bvh::builder().progress(from(limit, BuildControl::Hurry)));
    }
}

#[test]
fn a_hurry_below_a_long_path_keeps_the_depth_bound() {
    let triangles: Vec<_> = triangles(20_000).into_iter().chain(converging()).collect();
    // The heuristic splits off single triangles down to half of the
    // depth, then the build has to hurry.
    let asked = Arc::new(AtomicUsize::new(0));
    let watcher = {
        let asked = Arc::clone(&asked);
        move |_| if asked.fetch_add(1, Relaxed) < 40 { BuildControl::Steady } else { BuildControl::Hurry }
    };
    let builder = Bvh::builder().heuristic(Stubborn(|_| Split::Count { axis: Axis::X, left: 1 }));
    let bvh =
        builder.threads(1).max_leaf_size(1).progress(watcher).layout::<Tree>().build(triangles).unwrap();
    bvh.check().unwrap();
    let depth = bvh.report().max_depth;
    assert!(depth > 50 && depth <= MAX_DEPTH, "{depth}");
}

#[test]
fn a_build_in_a_hurry_is_not_optimised_and_may_still_be_stopped() {
    let triangles = triangles(20_000);
    let builder = || Bvh::builder().threads(1).layout::<Tree>();
    let plain = builder().optimise(Optimise::NONE).build(&triangles).unwrap();
    let hurried = builder().progress(from(1.0, BuildControl::Hurry)).build(&triangles).unwrap();
    assert!(hurried.layout() == plain.layout());
    assert!(hurried.layout() != builder().build(&triangles).unwrap().layout());
    let asked = AtomicUsize::new(0);
    let watcher =
        move |_| if asked.fetch_add(1, Relaxed) == 0 { BuildControl::Hurry } else { BuildControl::Stop };
    assert_eq!(builder().progress(watcher).build(&triangles).unwrap_err(), BuildError::Stopped);
}

#[test]
fn optimisation_asks_on() {
    let asked = Arc::new(AtomicUsize::new(0));
    let watcher = {
        let asked = Arc::clone(&asked);
        move |progress| {
            let done = progress >= 1.0 && asked.fetch_add(1, Relaxed) > 20;
            if done { BuildControl::Stop } else { BuildControl::Steady }
        }
    };
    let builder = Bvh::builder().optimise(Optimise { share: 0.5, rounds: 9 }).progress(watcher);
    assert_eq!(builder.build(triangles(20_000)).unwrap_err(), BuildError::Stopped);
}

#[test]
fn options_are_kept_in_any_order() {
    let triangles = triangles(3_000);
    let (optimise, builder) = (Optimise { share: 0.3, rounds: 4 }, || Bvh::builder().layout::<Tree>());
    let before = builder().optimise(optimise).heuristic(Median).build(&triangles).unwrap();
    let behind = builder().heuristic(Median).optimise(optimise).build(&triangles).unwrap();
    let without = builder().heuristic(Median).build(&triangles).unwrap();
    assert!(before.layout() == behind.layout() && before.layout() != without.layout());
    let preset = builder().quality(Quality::High).build(&triangles).unwrap();
    let plain = builder()
        .optimise(Optimise { share: 0.0, rounds: 0 })
        .quality(Quality::High)
        .build(&triangles)
        .unwrap();
    assert!(preset.layout() != plain.layout());
}

/// Returns triangles that converge to each of 64 points.
///
/// Along the morton curve, each triangle hangs below the one before.
fn converging() -> Vec<Fast<Triangle>> {
    let at = |[x, y, z]: [f32; 3]| Fast(Triangle::new([x, y, z], [x + 1e-6, y, z], [x, y + 1e-6, z]));
    let places = (0..64u8).map(|place| [place & 3, place >> 2 & 3, place >> 4].map(|k| f32::from(k) * 0.25));
    let near = |place: [f32; 3]| {
        (0..39).map(move |i| {
            let mut point = place;
            point[i % 3] += 0.5f32.powi(3 + i as i32 / 3);
            at(point)
        })
    };
    places.flat_map(near).collect()
}

#[test]
fn clusters_below_a_long_path_keep_the_depth_bound() {
    let one_by_one = Stubborn(|_| Split::Count { axis: Axis::X, left: 1 });
    let heuristic = Clustered { size: 64, heuristic: one_by_one };
    for triangles in [triangles(30_000), converging()] {
        let builder = || Bvh::builder().heuristic(&heuristic).max_leaf_size(1).layout::<Tree>();
        let bvh = builder().threads(1).build(&triangles).unwrap();
        bvh.check().unwrap();
        let depth = bvh.report().max_depth;
        assert!(depth > 48 && depth <= MAX_DEPTH, "{depth}");
        assert!(bvh.layout() == builder().threads(3).build(&triangles).unwrap().layout());
    }
    assert_answers(&converging(), Bvh::builder().quality(Quality::Fast));
}

/// Clusters keep their leaves below other nodes, and after spatial splits.
///
/// A spatial split puts a cluster into two leaves, each with a part of its box.
#[test]
fn clusters_keep_the_leaves_that_they_were_cut_into() {
    let triangles = triangles(6_000);
    let optimise = Optimise { share: 0.3, rounds: 4 };
    let plain = Bvh::builder().quality(Quality::Fast).build(&triangles).unwrap().report();
    let moved = Bvh::builder().quality(Quality::Fast).optimise(optimise).build(&triangles).unwrap();
    moved.check().unwrap();
    assert!(moved.report().sah_cost < plain.sah_cost);
    // Reinsertion may join a few small clusters to one leaf. If clusters were partitioned
    // again, all leaves would be full.
    assert!(plain.leaf_sizes.mean < 7.0);
    assert!((moved.report().leaf_sizes.mean - plain.leaf_sizes.mean).abs() < 0.1);
    let split = Clustered { size: 100, heuristic: SpatialSah { growth: 1.0, ..SpatialSah::default() } };
    for builder in [Bvh::builder().heuristic(split), Bvh::builder().heuristic(split).optimise(optimise)] {
        assert_answers(&triangles, builder);
    }
    assert_answers(&triangles, Bvh::builder().quality(Quality::Fast).optimise(optimise));
}

/// A heuristic with codes from a function, and a number of codes too many.
struct Coded(fn(usize) -> u64, usize);

impl Heuristic<f32> for Coded {
    fn codes(&self, references: &[PrimRef], _: &Aabb) -> Option<Vec<u64>> {
        Some((0..references.len() + self.1).map(self.0).collect())
    }
    fn split(&self, node: &BuildNode<'_>) -> Split {
        Median.split(node)
    }
}

#[test]
fn any_codes_make_a_tree_and_as_many_as_there_are_references() {
    let triangles = triangles(10_000);
    let codes: [fn(usize) -> u64; 6] = [
        |_| 0,
        |_| u64::MAX,
        |i| i as u64,
        |i| (i as u64).reverse_bits(),
        |i| 1u64.checked_shl(i as u32 % 70).unwrap_or(0),
        |i| (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15),
    ];
    for (number, code) in codes.into_iter().enumerate() {
        for max_leaf_size in [1, 8, 20_000] {
            let builder =
                || Bvh::builder().heuristic(Coded(code, 0)).max_leaf_size(max_leaf_size).layout::<Tree>();
            let bvh = builder().threads(1).build(&triangles).unwrap();
            bvh.check().unwrap();
            assert!(
                bvh.report().max_depth <= MAX_DEPTH && bvh.report().leaf_sizes.max <= max_leaf_size,
                "{number}"
            );
            assert!(bvh.layout() == builder().threads(3).build(&triangles).unwrap().layout(), "{number}");
        }
    }
    // Neighbouring keys that differ in each of their 64 bits.
    for n in 2..40 {
        let ends = Coded(|i| if i % 2 == 0 { 0 } else { u64::MAX }, 0);
        let bvh = Bvh::builder().heuristic(ends).max_leaf_size(1).layout::<Tree>();
        let bvh = bvh.build(&triangles[..n]).unwrap();
        bvh.check().unwrap();
        assert_eq!(bvh.report().leaf_sizes.histogram[1], n);
    }
    let in_order = Bvh::builder().heuristic(Coded(|i| i as u64, 0)).max_leaf_size(1).layout::<Tree>();
    assert_eq!(in_order.build(&triangles[..8192]).unwrap().report().max_depth, 13, "13 bits");
    let ignored = Bvh::builder().heuristic(Coded(|_| 0, 1)).layout::<Tree>().build(&triangles).unwrap();
    let median = Bvh::builder().heuristic(Median).layout::<Tree>().build(&triangles).unwrap();
    assert!(ignored.layout() == median.layout(), "one code too many");
}

#[test]
fn an_absurd_growth_is_bounded() {
    for growth in [f64::INFINITY, 1e30, f64::NAN, -1.0] {
        let heuristic = SpatialSah { overlap: 0.0, growth, ..SpatialSah::default() };
        let bvh = Bvh::builder().heuristic(heuristic).build(triangles(500)).unwrap();
        bvh.check().unwrap();
        assert!(bvh.report().references <= 500 * (1 + SpatialSah::MAX_GROWTH as usize));
        assert!(Heuristic::<f32>::extra_references(&heuristic, 1000) <= 4000, "{growth}");
    }
}
