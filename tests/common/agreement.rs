//! The claim that all tests come back to: every tree answers as the naive loop does, bit for bit.

use super::answers::{Answers, Payload};
use super::heuristics;
use bvhkit::{Bvh, Intersect, MAX_DEPTH, OnInvalid, Primitive, Ray};

/// Small, ordinary, and one leaf for everything.
const LEAF_SIZES: [usize; 5] = [1, 2, 4, 8, usize::MAX];

/// Builds a tree with every heuristic and leaf size, checks it, and compares its answers with the
/// naive loop's. Invalid primitives are skipped. Returns the number of hits, so that a test can tell
/// that it has tested something.
pub fn assert_agreement<P: Intersect<Payload: Payload>>(primitives: &[P], rays: &[Ray<P::Scalar>]) -> usize {
    let expected: Vec<_> = rays.iter().map(|ray| Answers::naive(primitives, ray)).collect();
    for (ray, answers) in rays.iter().zip(&expected) {
        assert_eq!(answers.hits.first(), answers.closest.as_ref(), "the naive loop itself, {ray:?}");
        assert_eq!(!answers.hits.is_empty(), answers.any, "the naive loop itself, {ray:?}");
    }
    for (name, heuristic) in heuristics::all() {
        for max_leaf_size in LEAF_SIZES {
            let bvh = Bvh::builder()
                .on_invalid(OnInvalid::Skip)
                .heuristic(&*heuristic)
                .max_leaf_size(max_leaf_size)
                .build(primitives)
                .unwrap();
            assert_well_formed(&bvh, primitives.len(), max_leaf_size);
            for (ray, expected) in rays.iter().zip(&expected) {
                let answers = Answers::of(&bvh, ray);
                assert_eq!(answers, *expected, "{name}, leaves of {max_leaf_size}, {ray:?}");
            }
        }
    }
    expected.iter().map(|answers| answers.hits.len()).sum()
}

/// The tree's invariants, and a report that fits the tree.
fn assert_well_formed<P: Primitive>(bvh: &Bvh<P>, input: usize, max_leaf_size: usize) {
    bvh.check().unwrap();
    let report = bvh.report();
    assert_eq!(report.primitives, bvh.len());
    assert_eq!(bvh.len() + bvh.skipped().len(), input);
    assert_eq!(report.leaves, if bvh.is_empty() { 0 } else { report.inner_nodes + 1 });
    assert_eq!(report.leaf_sizes.histogram.iter().sum::<usize>(), report.leaves);
    assert!(report.leaf_sizes.max <= max_leaf_size);
    assert!(report.max_depth <= MAX_DEPTH);
    assert!(report.mean_leaf_depth <= report.max_depth as f64);
}
