//! Tests of determinism: the same tree in every run, on any number of threads.

use crate::common::{heuristics, scattered};
use bvhkit::{Bvh, Quality, Scalar, Tree, Triangle};

/// Returns triangles, a third with whole coordinates and a third copies.
///
/// So there are ties wherever chance could decide a build.
fn with_ties<S: Scalar>(n: usize) -> Vec<Triangle<S>> {
    let mut triangles = scattered::triangles::<S>(n);
    let whole = |point: [S; 3]| point.map(|x| S::from_f64(x.to_f64().round()));
    for i in 0..n {
        let Triangle { a, b, c } = triangles[i];
        match i % 3 {
            0 => {}
            1 => triangles[i] = Triangle::new(whole(a), whole(b), whole(c)),
            _ => triangles[i] = triangles[i / 2],
        }
    }
    triangles
}

/// Asserts that trees built on 1, 2 and 4 threads and the caller's pool are equal.
///
/// Every heuristic builds such trees.
fn assert_deterministic<S: Scalar>(n: usize) {
    let triangles = with_ties::<S>(n);
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
    let triangles = with_ties::<f32>(20_000);
    for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
        let [one, two, four] = [1, 2, 4]
            .map(|threads| Bvh::builder().quality(quality).threads(threads).build(&triangles).unwrap());
        assert!(one.layout() == two.layout() && two.layout() == four.layout(), "{quality:?}");
    }
}
