//! Checks trees and records their facts, before anything is timed.

use crate::agreement::{Answers, assert_exact};
use crate::memory::peak;
use crate::methods::{Item, Method};
use crate::{Extent, Pools};
use bvhkit::{Aabb, Fast, Primitive, Ray, Triangle};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// Maximum number of rays. Where all triangles overlap, each ray meets them all.
const MAX_RAYS: usize = 32;

/// Triangles, and rays with the naive reference's answers.
pub struct Scene {
    pub name: &'static str,
    pub triangles: Vec<Item>,
    rays: Vec<Ray>,
    naive: Answers,
}

/// The depth of a method's tree over a scene, and its memory in bytes per triangle.
///
/// Facts are the same on every machine, except for the peak of several threads.
pub struct Facts {
    /// The peak of allocations beside the triangles, on one thread and on all.
    pub peaks: [f64; 2],
    /// The memory of the result, with the triangles.
    pub bytes: f64,
    pub depth: usize,
}

impl Scene {
    pub fn new(name: &'static str, triangles: Vec<Triangle>, extent: &Extent) -> Self {
        let rays = rays(&triangles, (extent.naive_tests / triangles.len()).clamp(4, MAX_RAYS));
        let triangles: Vec<Item> = triangles.into_iter().map(Fast).collect();
        let naive = Answers::naive(&triangles, &rays);
        Self { name, triangles, rays, naive }
    }

    /// Builds a method's tree on one thread and on all, and returns its facts.
    ///
    /// # Panics
    ///
    /// If a tree is broken, or not the same on all threads, or answers
    /// otherwise than the naive reference.
    pub fn facts(&self, method: &Method, pools: &Pools) -> Facts {
        let what = format!("{} {} of {} {}", method.layout, method.preset, self.triangles.len(), self.name);
        let per_triangle = |bytes: usize| bytes as f64 / self.triangles.len() as f64;
        let [one, all] = pools.each_ref().map(|pool| {
            let triangles = self.triangles.clone();
            let (built, peak) = pool.install(|| peak(|| method.build(triangles)));
            built.check(&what);
            assert_exact(&what, &self.rays, &self.naive, &built.answers(&self.rays));
            (built.report(), built.bytes(), per_triangle(peak))
        });
        assert!(one.0 == all.0, "{what} should be the same on all threads as on one, but is\n{}", all.0);
        Facts { peaks: [one.2, all.2], bytes: per_triangle(one.1), depth: one.0.max_depth }
    }
}

/// Returns rays from around the triangles.
///
/// Every other ray aims at a triangle, which may be too small to be hit
/// otherwise. The rest aim anywhere.
fn rays(triangles: &[Triangle], count: usize) -> Vec<Ray> {
    let mut rng = Pcg32::seed_from_u64(7);
    let aabb = triangles.iter().fold(Aabb::EMPTY, |aabb, triangle| aabb.union(triangle.aabb()));
    // A cube around the scene, whose box may be flat.
    let (center, size) = (Vec3::from(aabb.center()), aabb.extent().into_iter().fold(0.0, f32::max));
    let ray = |i: usize| {
        let mut place = || center + size * (Vec3::from_array(rng.random()) - 0.5);
        let (origin, anywhere) = (place(), place());
        let Triangle { a, b, c } = triangles[rng.random_range(0..triangles.len())];
        let [a, b, c] = [a, b, c].map(Vec3::from);
        let target = if i.is_multiple_of(2) { 0.5 * a + 0.3 * b + 0.2 * c } else { anywhere };
        Ray::new(origin, (target - origin).normalize_or(Vec3::X))
    };
    (0..count).map(ray).collect()
}
