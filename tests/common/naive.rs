//! Answers of the naive loop, and hierarchies compared with them.

use super::answers::{Answers, Payload};
use bvhkit::heuristic::Heuristic;
use bvhkit::{Builder, Bvh, Intersect, MAX_DEPTH, OnInvalid, Ray, Traverse};
use std::fmt;

/// Primitives, rays, and the answers of the naive loop.
pub struct Naive<'a, P: Intersect> {
    primitives: &'a [P],
    rays: &'a [Ray<P::Scalar>],
    answers: Vec<Answers>,
}

impl<'a, P: Intersect<Payload: Payload>> Naive<'a, P> {
    pub fn new(primitives: &'a [P], rays: &'a [Ray<P::Scalar>]) -> Self {
        let answers: Vec<_> = rays.iter().map(|ray| Answers::naive(primitives, ray)).collect();
        for (ray, answers) in rays.iter().zip(&answers) {
            assert_eq!(answers.hits.first(), answers.closest.as_ref(), "the naive loop itself, {ray:?}");
            assert_eq!(!answers.hits.is_empty(), answers.any, "the naive loop itself, {ray:?}");
        }
        Self { primitives, rays, answers }
    }

    /// Returns the number of hits, so that a test can show that it tested something.
    pub fn hits(&self) -> usize {
        self.answers.iter().map(|answers| answers.hits.len()).sum()
    }

    /// Builds over the valid primitives, checks the hierarchy and compares its answers.
    pub fn assert_same<H: Heuristic<P::Scalar>, L: Traverse<&'a P>>(
        &self,
        builder: Builder<&'a P, H, L>,
        options: fmt::Arguments<'_>,
    ) -> Bvh<&'a P, L> {
        let bvh = builder.on_invalid(OnInvalid::Skip).build(self.primitives).unwrap();
        self.assert_well_formed(&bvh);
        for (ray, expected) in self.rays.iter().zip(&self.answers) {
            let (layout, set) = (std::any::type_name::<L>(), bvh.instruction_set());
            assert_eq!(Answers::of(&bvh, ray), *expected, "{options}, {layout}, {set}, {ray:?}");
        }
        bvh
    }

    /// Checks the invariants and the report.
    fn assert_well_formed<L: Traverse<&'a P>>(&self, bvh: &Bvh<&'a P, L>) {
        bvh.check().unwrap();
        let report = bvh.report();
        assert_eq!(report.primitives, bvh.len());
        assert_eq!(bvh.len() + bvh.skipped().len(), self.primitives.len());
        // Each inner node has at least two children.
        assert!(if bvh.is_empty() { report.leaves == 0 } else { report.leaves > report.inner_nodes });
        assert_eq!(report.leaf_sizes.histogram.iter().sum::<usize>(), report.leaves);
        assert!(report.max_depth <= MAX_DEPTH);
        assert!(report.mean_leaf_depth <= report.max_depth as f64);
    }
}
