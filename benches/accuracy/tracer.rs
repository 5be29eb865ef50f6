//! Contestants: implementations that find the closest hit of a ray.

use bvhkit::reference::exact::Fraction;
use bvhkit::{Ray, Triangle};

/// An implementation to measure.
pub struct Contestant {
    pub name: &'static str,
    /// Whether it is this crate's, which promises the answers of its naive loop.
    pub ours: bool,
    pub build: fn(&[Triangle]) -> Box<dyn Tracer>,
}

/// A hit on a triangle, with its t in `f64`, which holds every `f32` too.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f64,
    pub index: usize,
}

/// Triangles in a tree.
pub trait Tracer: Sync {
    /// Returns the hit with the smallest t in the ray's interval.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Returns the t at which the ray meets one triangle, by the tree's own test.
    fn test(&self, index: usize, ray: &Ray) -> Option<f64>;

    /// Returns the smallest t of all triangles, tested one by one without the tree.
    fn naive_t(&self, ray: &Ray) -> Option<f64>;

    /// Returns how far `t` is from the exact one, in ulps of its original scalar.
    fn ulps(&self, exact: &Fraction, t: f64) -> f64 {
        exact.ulps_from(t as f32)
    }

    /// Returns the number of rays that hit.
    ///
    /// The loop is part of the trait, so that each implementation has
    /// its own, with its query inlined.
    fn count_hits(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|ray| self.closest_hit(ray).is_some()).count()
    }
}

/// Returns the smallest t of `n` tests.
pub fn smallest(n: usize, test: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    (0..n).filter_map(test).min_by(f64::total_cmp)
}
