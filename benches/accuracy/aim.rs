//! Rays that find gaps: from points exactly inside, at corners and edges.
//!
//! Rays in random directions find none.

use crate::closed::encloses;
use crate::truth::Truth;
use bvhkit::{Aabb, Primitive, Ray};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// The kind of point that a ray is aimed at.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Target {
    Vertex,
    /// A point of an edge, rounded to the nearest.
    Edge,
}

/// The number of points from which rays are aimed.
const ORIGINS: usize = 16;

/// Returns `n` rays at each kind of target, with t in [0, infinity].
///
/// If the mesh is closed, rays start inside it, else anywhere in its box. The direction is
/// the difference of target and origin, which is about as well as one can aim. For half of
/// the rays it is times a power of two that makes it about 1 long; for the other half it
/// is normalised, as in renderers.
pub fn rays(truth: &Truth<'_>, is_closed: bool, n: usize) -> Vec<(Target, Ray)> {
    let mut rng = Pcg32::seed_from_u64(5);
    let origins: Vec<Vec3> = (0..ORIGINS).map(|_| origin(truth, is_closed, &mut rng)).collect();
    let mut rays = Vec::with_capacity(2 * n);
    for i in 0..n {
        let origin = origins[i % ORIGINS];
        let triangle = &truth.triangles[rng.random_range(0..truth.triangles.len())];
        let corners = [triangle.a, triangle.b, triangle.c].map(Vec3::from);
        let corner = rng.random_range(0..3);
        let (p, q) = (corners[corner], corners[(corner + 1) % 3]);
        let between = p + rng.random::<f32>() * (q - p);
        for (target, point) in [(Target::Vertex, p), (Target::Edge, between)] {
            let way = point - origin;
            let direction = if (i / ORIGINS).is_multiple_of(2) {
                way * about_one(way)
            } else {
                way.normalize_or(Vec3::X)
            };
            rays.push((target, Ray::new(origin, direction)));
        }
    }
    rays
}

/// Returns a point of the mesh's box, exactly inside the mesh if that is closed.
fn origin(truth: &Truth<'_>, is_closed: bool, rng: &mut Pcg32) -> Vec3 {
    let aabb = truth.triangles.iter().fold(Aabb::EMPTY, |aabb, triangle| aabb.union(triangle.aabb()));
    let [min, max] = [aabb.min, aabb.max].map(Vec3::from);
    loop {
        let point = min + (max - min) * Vec3::from_array(rng.random());
        let anywhere = Vec3::from_array(rng.random()) - 0.5;
        if !is_closed || encloses(truth.triangles, &Ray::new(point, anywhere)) == Some(true) {
            return point;
        }
    }
}

/// Returns a power of two that makes `way` about 1 long, without rounding.
fn about_one(way: Vec3) -> f32 {
    let exponent = way.abs().max_element().log2().floor();
    2f32.powi(-exponent as i32)
}
