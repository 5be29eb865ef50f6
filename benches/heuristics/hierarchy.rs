//! What is measured: ways to build a hierarchy, whoever wrote it, and the hierarchies they build.

use crate::shared::agreement::{Answers, Hit};
use bvhkit::{Ray, Triangle};

/// One build, which can be repeated.
pub type Build = Box<dyn Fn() -> Box<dyn Hierarchy>>;

/// A way to build.
pub struct Method {
    pub name: &'static str,
    /// Ours, whose answers are promised to be the naive reference's; or a peer's.
    pub ours: bool,
    /// Takes the triangles in its own format, outside of the time of the build.
    pub prepare: fn(&[Triangle]) -> Build,
}

/// A hierarchy that was built.
pub trait Hierarchy {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    fn any_hit(&self, ray: &Ray) -> bool;

    /// The tree's shape, and the mean steps to the closest hits of `rays`.
    fn statistics(&self, rays: &[Ray]) -> Statistics;

    /// The loops are part of the trait so that each implementation has its own, with its queries
    /// inlined: a virtual call for each batch, none for each ray.
    fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.closest_hit(ray)));
    }

    fn any_hits(&self, rays: &[Ray], hits: &mut Vec<bool>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.any_hit(ray)));
    }

    fn answers(&self, rays: &[Ray]) -> Answers {
        let mut answers = Answers::default();
        self.closest_hits(rays, &mut answers.closest);
        self.any_hits(rays, &mut answers.any);
        answers
    }
}

/// `None` for what a hierarchy does not tell.
#[derive(Default)]
pub struct Statistics {
    /// As [`bvhkit::TreeReport`] defines it.
    pub sah_cost: Option<f64>,
    /// As [`bvhkit::Bvh::epo`] defines it.
    pub epo: Option<f64>,
    pub max_depth: Option<usize>,
    pub nodes_per_ray: Option<f64>,
    pub tests_per_ray: Option<f64>,
}
