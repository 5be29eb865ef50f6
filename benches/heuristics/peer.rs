//! `obvhs`, called in the way that it recommends for speed: its presets, its triangle made for ray
//! tests, and triangles permuted into the order of its leaves, so that hits need no look-up.

use crate::hierarchy::{Build, Hierarchy, Hit, Method, Statistics};
use bvhkit::Ray;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::cell::Cell;
use std::time::Duration;

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
    Box::new(move || {
        let bvh = build_bvh2_from_tris(&triangles, parameters, &mut Duration::default());
        Box::new(Peer { triangles: permute(&triangles, &bvh.primitive_indices), bvh })
    })
}

fn cwbvh(parameters: BvhBuildParams, triangles: &[bvhkit::Triangle]) -> Build {
    let triangles = convert(triangles);
    Box::new(move || {
        let bvh = build_cwbvh_from_tris(&triangles, parameters, &mut Duration::default());
        Box::new(Peer { triangles: permute(&triangles, &bvh.primitive_indices), bvh })
    })
}

fn convert(triangles: &[bvhkit::Triangle]) -> Vec<Triangle> {
    let corner = Vec3A::from_array;
    triangles.iter().map(|t| Triangle { v0: corner(t.a), v1: corner(t.b), v2: corner(t.c) }).collect()
}

fn permute(triangles: &[Triangle], order: &[u32]) -> Vec<RtTriangle> {
    order.iter().map(|&index| RtTriangle::from(&triangles[index as usize])).collect()
}

struct Peer<B> {
    bvh: B,
    triangles: Vec<RtTriangle>,
}

/// What its two kinds of tree have in common.
trait Traversal {
    fn closest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, test: impl Test) -> bool;
    fn misses(&self, ray: obvhs::ray::Ray, test: impl Test) -> bool;
    fn indices(&self) -> &[u32];
    /// The SAH cost and the depth.
    fn shape(&self) -> Option<(f64, usize)>;
}

trait Test: FnMut(&obvhs::ray::Ray, usize) -> f32 {}
impl<F: FnMut(&obvhs::ray::Ray, usize) -> f32> Test for F {}

impl Traversal for Bvh2 {
    fn closest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, test: impl Test) -> bool {
        self.ray_traverse(ray, hit, test)
    }
    fn misses(&self, ray: obvhs::ray::Ray, test: impl Test) -> bool {
        self.ray_traverse_miss(ray, test)
    }
    fn indices(&self) -> &[u32] {
        &self.primitive_indices
    }
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

impl Traversal for CwBvh {
    fn closest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, test: impl Test) -> bool {
        self.ray_traverse(ray, hit, test)
    }
    fn misses(&self, ray: obvhs::ray::Ray, test: impl Test) -> bool {
        self.ray_traverse_miss(ray, test)
    }
    fn indices(&self) -> &[u32] {
        &self.primitive_indices
    }
    /// Eight children to a node: its cost would not compare with a binary tree's.
    fn shape(&self) -> Option<(f64, usize)> {
        None
    }
}

impl<B: Traversal> Hierarchy for Peer<B> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut hit = RayHit::none();
        let test = |ray: &_, slot: usize| self.triangles[slot].intersect(ray);
        let index = |slot: u32| self.bvh.indices()[slot as usize] as usize;
        self.bvh.closest(convert_ray(ray), &mut hit, test).then(|| Hit {
            t: hit.t,
            index: index(hit.primitive_id),
            payload: (),
        })
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        !self.bvh.misses(convert_ray(ray), |ray, slot| self.triangles[slot].intersect(ray))
    }

    fn statistics(&self, rays: &[Ray]) -> Statistics {
        let tests = Cell::new(0u64);
        for ray in rays {
            self.bvh.closest(convert_ray(ray), &mut RayHit::none(), |ray, slot| {
                tests.set(tests.get() + 1);
                self.triangles[slot].intersect(ray)
            });
        }
        let (sah_cost, max_depth) = self.bvh.shape().unzip();
        let tests_per_ray = Some(tests.get() as f64 / rays.len() as f64);
        Statistics { sah_cost, max_depth, nodes_per_ray: None, tests_per_ray }
    }
}

fn convert_ray(ray: &Ray) -> obvhs::ray::Ray {
    let [origin, direction] = [ray.origin, ray.direction].map(Vec3A::from_array);
    obvhs::ray::Ray::new(origin, direction, ray.t_min, ray.t_max)
}
