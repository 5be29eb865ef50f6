//! The measured methods of building, whoever wrote them, and their hierarchies.

use crate::shared::agreement::{Answers, Hit};
use bvhkit::{Ray, Triangle};

/// A build that can be repeated.
pub type Build = Box<dyn Fn() -> Box<dyn Hierarchy>>;

/// A method of building.
pub struct Method {
    pub name: &'static str,
    /// Whether it is this crate's, which promises the naive reference's answers.
    pub ours: bool,
    /// Converts the triangles to the method's own format, which is not timed.
    pub prepare: fn(&[Triangle]) -> Build,
}

/// A hierarchy that was built.
pub trait Hierarchy {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    fn any_hit(&self, ray: &Ray) -> bool;

    /// Returns the tree's shape, and the mean steps to the closest hits of `rays`.
    fn statistics(&self, rays: &[Ray]) -> Statistics;

    /// Writes the closest hit of each ray into `hits`.
    ///
    /// The loops are part of the trait, so that each implementation has its own, with its queries
    /// inlined. There is a virtual call for each batch, none for each ray.
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

/// Figures of a hierarchy, `None` for those it does not tell.
#[derive(Default)]
pub struct Statistics {
    /// The SAH cost, as [`bvhkit::TreeReport`] defines it.
    pub sah_cost: Option<f64>,
    /// The end-point overlap, as [`bvhkit::Bvh::epo`] defines it.
    pub epo: Option<f64>,
    pub max_depth: Option<usize>,
    pub nodes_per_ray: Option<f64>,
    pub tests_per_ray: Option<f64>,
}
