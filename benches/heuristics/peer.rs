//! `obvhs` as methods: its presets, timed from triangles in its own format.

use crate::hierarchy::{Build, Hierarchy, Method, Statistics};
use crate::shared::agreement::Hit;
use crate::shared::obvhs::{Peer, Traversal, convert};
use bvhkit::Ray;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::cwbvh::CwBvh;
use std::cell::Cell;

pub fn methods() -> [Method; 6] {
    [
        method("obvhs BVH2 fastest", |triangles| bvh2(BvhBuildParams::fastest_build(), triangles)),
        method("obvhs BVH2 medium", |triangles| bvh2(BvhBuildParams::medium_build(), triangles)),
        method("obvhs BVH2 slow", |triangles| bvh2(BvhBuildParams::slow_build(), triangles)),
        method("obvhs CWBVH fastest", |triangles| cwbvh(BvhBuildParams::fastest_build(), triangles)),
        method("obvhs CWBVH medium", |triangles| cwbvh(BvhBuildParams::medium_build(), triangles)),
        method("obvhs CWBVH slow", |triangles| cwbvh(BvhBuildParams::slow_build(), triangles)),
    ]
}

fn method(name: &'static str, prepare: fn(&[bvhkit::Triangle]) -> Build) -> Method {
    Method { name, ours: false, prepare }
}

fn bvh2(parameters: BvhBuildParams, triangles: &[bvhkit::Triangle]) -> Build {
    let triangles = convert(triangles);
    Box::new(move || Box::new(Peer::bvh2(parameters, &triangles)))
}

fn cwbvh(parameters: BvhBuildParams, triangles: &[bvhkit::Triangle]) -> Build {
    let triangles = convert(triangles);
    Box::new(move || Box::new(Peer::cwbvh(parameters, &triangles)))
}

impl<B: Shape> Hierarchy for Peer<B> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit(ray)
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.any_hit(ray)
    }

    fn statistics(&self, rays: &[Ray]) -> Statistics {
        let tests = Cell::new(0u64);
        for ray in rays {
            self.closest_hit_by(ray, |ray, slot| {
                tests.set(tests.get() + 1);
                self.triangles[slot].intersect(ray)
            });
        }
        let (sah_cost, max_depth) = self.bvh.shape().unzip();
        let tests_per_ray = Some(tests.get() as f64 / rays.len() as f64);
        Statistics { sah_cost, epo: None, max_depth, nodes_per_ray: None, tests_per_ray }
    }
}

/// Properties of a peer's tree that only this bench asks for.
trait Shape: Traversal {
    /// Returns the SAH cost and the depth.
    fn shape(&self) -> Option<(f64, usize)>;
}

impl Shape for Bvh2 {
    fn shape(&self) -> Option<(f64, usize)> {
        let root = self.nodes.first()?;
        let (mut sah_cost, mut max_depth) = (0.0, 0);
        let mut open = vec![(root, 0)];
        while let Some((node, depth)) = open.pop() {
            let weight = f64::from(node.aabb().half_area() / root.aabb().half_area());
            if node.is_leaf() {
                sah_cost += weight * f64::from(node.prim_count);
                max_depth = max_depth.max(depth);
            } else {
                sah_cost += weight;
                let first = node.first_index as usize;
                open.extend(self.nodes[first..first + 2].iter().map(|child| (child, depth + 1)));
            }
        }
        Some((sah_cost, max_depth))
    }
}

impl Shape for CwBvh {
    /// Returns `None`: with eight children to a node, the cost would not compare.
    fn shape(&self) -> Option<(f64, usize)> {
        None
    }
}
