//! The same tree on any number of threads, and twice on the same.

mod common {
    pub mod heuristics;
    pub mod hostile;
}

use bvhkit::{Bvh, Quality, Scalar, Tree, Triangle};
use common::heuristics;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// `n` triangles, a third of them copies, a third with whole coordinates: ties wherever a build
/// could break them by chance.
fn triangles<S: Scalar>(n: usize) -> Vec<Triangle<S>> {
    let mut rng = Pcg64Mcg::seed_from_u64(n as u64);
    let mut point = |size: f64| [0.0; 3].map(|_: f64| rng.random_range(-size..size));
    let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| S::from_f64(a[k] + b[k]));
    let whole = |p: [f64; 3]| p.map(f64::round);
    let mut triangles: Vec<Triangle<S>> = Vec::with_capacity(n);
    for i in 0..n {
        let (center, b, c) = (point(100.0), point(2.0), point(2.0));
        triangles.push(match i % 3 {
            0 => Triangle::new(add(center, [0.0; 3]), add(center, b), add(center, c)),
            1 => {
                let center = whole(center);
                Triangle::new(add(center, [0.0; 3]), add(center, whole(b)), add(center, whole(c)))
            }
            _ => triangles[i / 2],
        });
    }
    triangles
}

/// With every heuristic, the trees on 1, 2 and 4 threads and on the caller's own pool are equal.
fn assert_deterministic<S: Scalar>(n: usize) {
    let triangles = triangles::<S>(n);
    for (name, heuristic) in heuristics::all() {
        let builder = || Bvh::builder().layout::<Tree<S>>().heuristic(&*heuristic).max_leaf_size(2);
        let first = builder().threads(1).build(&triangles).unwrap();
        first.check().unwrap();
        for threads in [1, 2, 4] {
            let other = builder().threads(threads).build(&triangles).unwrap();
            assert!(first.layout() == other.layout(), "{name}, {n} triangles, {threads} threads");
        }
        let other = builder().build(&triangles).unwrap();
        assert!(first.layout() == other.layout(), "{name}, {n} triangles, the caller's threads");
        assert!(other.primitives().iter().copied().eq(&triangles), "{name}: the order of the input");
    }
}

#[test]
fn within_one_task() {
    assert_deterministic::<f32>(3_000);
}

#[test]
fn over_several_tasks() {
    assert_deterministic::<f32>(20_000);
    assert_deterministic::<f64>(20_000);
}

#[test]
fn over_several_chunks_of_bins() {
    assert_deterministic::<f32>(110_000);
}

#[test]
fn presets() {
    let triangles = triangles::<f32>(20_000);
    for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
        let [one, two, four] = [1, 2, 4]
            .map(|threads| Bvh::builder().quality(quality).threads(threads).build(&triangles).unwrap());
        assert!(one.layout() == two.layout() && two.layout() == four.layout(), "{quality:?}");
    }
}
