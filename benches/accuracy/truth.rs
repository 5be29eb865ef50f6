//! The hits of rays in exact arithmetic.

use bvhkit::reference::exact::{self, Exact, ExactHit};
use bvhkit::{Bvh, Ray, Triangle};

pub struct Truth<'a> {
    pub triangles: &'a [Triangle],
    bvh: Bvh<Exact<&'a Triangle>>,
}

impl<'a> Truth<'a> {
    pub fn new(triangles: &'a [Triangle]) -> Self {
        let bvh = Bvh::build(triangles.iter().map(Exact)).expect("the coordinates are finite");
        Self { triangles, bvh }
    }

    /// Returns the same as [`exact::closest_hits`].
    pub fn closest_hits(&self, ray: &Ray) -> Vec<ExactHit> {
        let mut hits = self.bvh.hits(ray).peekable();
        let Some(first) = hits.peek().map(|hit| hit.t) else { return Vec::new() };
        // Only hits with the smallest rounded t can be the exactly nearest.
        let mut candidates: Vec<usize> = hits.take_while(|hit| hit.t == first).map(|hit| hit.index).collect();
        candidates.sort_unstable();
        let triangles: Vec<Triangle> = candidates.iter().map(|&index| self.triangles[index]).collect();
        let mut closest = exact::closest_hits(&triangles, ray);
        for hit in &mut closest {
            hit.index = candidates[hit.index];
        }
        closest
    }
}
