//! Other crates' trees and triangle tests.

use crate::bvh_peer;
use crate::obvhs_peer::{Peer, Traversal, convert, convert_ray};
use crate::tracer::{Contestant, Hit, Tracer, smallest};
use bvhkit::{Ray, Triangle};
use obvhs::BvhBuildParams;
use obvhs::rt_triangle::RtTriangle;

pub fn contestants() -> [Contestant; 3] {
    [
        peer("obvhs BVH2", |triangles| obvhs(triangles, Peer::bvh2)),
        peer("obvhs CWBVH", |triangles| obvhs(triangles, Peer::cwbvh)),
        peer("bvh", |triangles| Box::new(bvh_peer::Peer::new(triangles))),
    ]
}

fn peer(name: &'static str, build: fn(&[Triangle]) -> Box<dyn Tracer>) -> Contestant {
    Contestant { name, ours: false, build }
}

/// Builds a tree of `obvhs` with its medium preset.
fn obvhs<B: Traversal + Sync + 'static>(
    triangles: &[Triangle],
    build: fn(BvhBuildParams, &[obvhs::triangle::Triangle]) -> Peer<B>,
) -> Box<dyn Tracer> {
    let triangles = convert(triangles);
    let peer = build(BvhBuildParams::medium_build(), &triangles);
    Box::new(Obvhs { peer, triangles: triangles.iter().map(RtTriangle::from).collect() })
}

struct Obvhs<B> {
    peer: Peer<B>,
    /// The triangles in the order of the input.
    triangles: Vec<RtTriangle>,
}

impl<B: Traversal + Sync> Tracer for Obvhs<B> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.peer.closest_hit(ray).map(|hit| Hit { t: f64::from(hit.t), index: hit.index })
    }

    fn test(&self, index: usize, ray: &Ray) -> Option<f64> {
        let t = self.triangles[index].intersect(&convert_ray(ray));
        t.is_finite().then_some(f64::from(t))
    }

    fn naive_t(&self, ray: &Ray) -> Option<f64> {
        smallest(self.triangles.len(), |index| self.test(index, ray))
    }
}
