//! Comparison of all methods' answers, before anything is timed.

use crate::hierarchy::{Hierarchy, Method};
use crate::shared::agreement::{Answers, Disagreements, assert_exact};
use crate::workload::Workload;
use bvhkit::Ray;

/// Tests of one triangle that the naive reference may spend on a scene.
///
/// They take a few seconds.
const NAIVE_TESTS: usize = 300_000_000;

/// For each method, the rays that it answers otherwise than expected.
pub struct Check {
    /// The number of rays that the naive reference answers too.
    pub sample: usize,
    /// For each method: the disagreements with the naive reference, on the sample.
    pub from_naive: Vec<Disagreements>,
    /// For each method: the disagreements with ours, on all rays.
    pub from_ours: Vec<Disagreements>,
}

impl Check {
    /// Compares the answers of all methods.
    ///
    /// # Panics
    ///
    /// If ours do not agree, bit for bit, with the naive reference and with each other.
    pub fn new(workload: &Workload, methods: &[Method], built: &[Box<dyn Hierarchy>]) -> Self {
        let triangles = &workload.triangles;
        let rays = workload.all_rays();
        let step = (rays.len() * triangles.len()).div_ceil(NAIVE_TESTS).max(1);
        let sample: Vec<Ray> = rays.iter().step_by(step).copied().collect();
        let naive = Answers::naive(triangles, &sample);
        let ours = built[0].answers(&rays);
        let mut check = Self { sample: sample.len(), from_naive: Vec::new(), from_ours: Vec::new() };
        for (method, hierarchy) in methods.iter().zip(built) {
            let on_sample = hierarchy.answers(&sample);
            let on_all = hierarchy.answers(&rays);
            if method.ours {
                let what = format!("{} on {}", method.name, workload.name);
                assert_exact(&what, &sample, &naive, &on_sample);
                assert_exact(&what, &rays, &ours, &on_all);
            }
            check.from_naive.push(Disagreements::count(triangles, &sample, &naive, &on_sample));
            check.from_ours.push(Disagreements::count(triangles, &rays, &ours, &on_all));
        }
        check
    }
}
