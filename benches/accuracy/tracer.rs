//! What is measured: whoever finds the closest hit of a ray.

use bvhkit::reference::exact::Fraction;
use bvhkit::{Ray, Triangle};

/// One that is measured.
pub struct Contestant {
    pub name: &'static str,
    /// This crate's, whose answers are promised to be the naive loop's; or a peer's.
    pub ours: bool,
    pub build: fn(&[Triangle]) -> Box<dyn Tracer>,
}

/// Which triangle, and where. `f64` holds every t, `f32` or not.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f64,
    pub index: usize,
}

/// Triangles in a tree.
pub trait Tracer: Sync {
    /// The hit with the smallest t in the ray's interval.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// The t at which the ray meets one triangle, by the test that the tree's queries use.
    fn test(&self, index: usize, ray: &Ray) -> Option<f64>;

    /// The smallest t of all triangles, asked one by one without the tree.
    fn naive_t(&self, ray: &Ray) -> Option<f64>;

    /// How far `t` is from the exact one, in ulps of the scalar that it was computed in.
    fn ulps(&self, exact: &Fraction, t: f64) -> f64 {
        exact.ulps_from(t as f32)
    }

    /// How many of the rays hit. The loop is part of the trait so that each implementation has its
    /// own, with its query inlined.
    fn count_hits(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.closest_hit(ray).is_some()).count()
    }
}

/// The smallest of `n` tests.
pub fn smallest(n: usize, test: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    (0..n).filter_map(test).min_by(f64::total_cmp)
}
