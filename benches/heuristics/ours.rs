//! This crate's heuristics and presets.

use crate::hierarchy::{Build, Hierarchy, Method, Statistics};
use crate::shared::agreement::{Hit, bare};
use bvhkit::heuristic::{BinnedSah, Heuristic, Median, Midpoint, Morton, SpatialSah, SweepSah};
use bvhkit::{Bvh, Quality, Ray, Triangle};

pub fn methods() -> [Method; 9] {
    [
        method("median", |triangles| prepare(Median, triangles)),
        method("midpoint", |triangles| prepare(Midpoint, triangles)),
        method("morton", |triangles| prepare(Morton, triangles)),
        method("binned", |triangles| prepare(BinnedSah::default(), triangles)),
        method("sweep", |triangles| prepare(SweepSah::default(), triangles)),
        method("spatial", |triangles| prepare(SpatialSah::default(), triangles)),
        method("fast", |triangles| prepare(Quality::Fast, triangles)),
        method("balanced", |triangles| prepare(Quality::Balanced, triangles)),
        method("high", |triangles| prepare(Quality::High, triangles)),
    ]
}

fn method(name: &'static str, prepare: fn(&[Triangle]) -> Build) -> Method {
    Method { name, ours: true, prepare }
}

fn prepare(heuristic: impl Heuristic<f32> + Copy + 'static, triangles: &[Triangle]) -> Build {
    let triangles = triangles.to_vec();
    Box::new(move || {
        let builder = Bvh::builder().heuristic(heuristic);
        Box::new(builder.build(triangles.iter().copied()).expect("the coordinates are finite"))
    })
}

impl Hierarchy for Bvh<Triangle> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit(ray).map(bare)
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.any_hit(ray)
    }

    fn statistics(&self, rays: &[Ray]) -> Statistics {
        let steps = self.closest_hit_steps(rays);
        let report = self.report();
        Statistics {
            sah_cost: Some(report.sah_cost),
            epo: Some(self.epo()),
            max_depth: Some(report.max_depth),
            nodes_per_ray: Some(steps.nodes_per_ray()),
            tests_per_ray: Some(steps.primitives_per_ray()),
        }
    }
}
