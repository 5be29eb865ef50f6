//! What rays hit in exact arithmetic.

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

    /// As [`exact::closest_hits`].
    pub fn closest_hits(&self, ray: &Ray) -> Vec<ExactHit> {
        let mut hits = self.bvh.hits(ray).peekable();
        let Some(first) = hits.peek().map(|hit| hit.t) else { return Vec::new() };
        // Only those that are equal once rounded can be the exactly nearest.
        let mut candidates: Vec<usize> = hits.take_while(|hit| hit.t == first).map(|hit| hit.index).collect();
        candidates.sort_unstable();
        let triangles: Vec<Triangle> = candidates.iter().map(|&index| self.triangles[index]).collect();
        let mut closest = exact::closest_hits(&triangles, ray);
        for hit in &mut closest {
            hit.index = candidates[hit.index];
        }
        closest
    }

    /// Whether the point is enclosed and on no triangle: along a ray that passes no edge, the number of hits
    /// is odd. `None` if this ray passes an edge or does not say.
    pub fn encloses(&self, ray: &Ray) -> Option<bool> {
        let hits = exact::hits(self.triangles, ray);
        let is_generic = hits.iter().all(|hit| {
            let slack = exact::edge_slack(&self.triangles[hit.index], ray);
            slack.is_some_and(|slack| slack < 0.0) && hit.t.cmp_scalar(0.0f32).is_gt()
        });
        is_generic.then_some(hits.len() % 2 == 1)
    }
}
