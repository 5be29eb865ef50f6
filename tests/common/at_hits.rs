//! Intervals that begin, end, or begin and end at a hit.

use bvhkit::{Intersect, Ray, reference};

/// Returns the rays, and again each ray that hits, with intervals at its hit.
pub fn at_hits<P: Intersect>(primitives: &[P], mut rays: Vec<Ray<P::Scalar>>) -> Vec<Ray<P::Scalar>> {
    for i in 0..rays.len() {
        let ray = rays[i];
        if let Some(hit) = reference::closest_hit(primitives, &ray) {
            let intervals = [(hit.t, hit.t), (ray.t_min, hit.t), (hit.t, ray.t_max)];
            rays.extend(intervals.map(|(t_min, t_max)| ray.with_interval(t_min, t_max)));
        }
    }
    rays
}
