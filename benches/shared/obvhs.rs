//! `obvhs`, called in the way that it recommends for speed.
//!
//! That is with its presets, its triangle for ray tests, and triangles permuted into the order of
//! the leaves, so that hits need no look-up.

use bvhkit::{Hit, Ray};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::time::Duration;

/// A tree and its triangles.
pub struct Peer<B> {
    pub bvh: B,
    /// The triangles in the order of the tree's leaves.
    pub triangles: Vec<RtTriangle>,
}

impl Peer<Bvh2> {
    pub fn bvh2(parameters: BvhBuildParams, triangles: &[Triangle]) -> Self {
        let bvh = build_bvh2_from_tris(triangles, parameters, &mut Duration::default());
        Self { triangles: permute(triangles, &bvh.primitive_indices), bvh }
    }
}

impl Peer<CwBvh> {
    pub fn cwbvh(parameters: BvhBuildParams, triangles: &[Triangle]) -> Self {
        let bvh = build_cwbvh_from_tris(triangles, parameters, &mut Duration::default());
        Self { triangles: permute(triangles, &bvh.primitive_indices), bvh }
    }
}

pub fn convert(triangles: &[bvhkit::Triangle]) -> Vec<Triangle> {
    let corner = Vec3A::from_array;
    triangles.iter().map(|t| Triangle { v0: corner(t.a), v1: corner(t.b), v2: corner(t.c) }).collect()
}

pub fn convert_ray(ray: &Ray) -> obvhs::ray::Ray {
    let [origin, direction] = [ray.origin, ray.direction].map(Vec3A::from_array);
    obvhs::ray::Ray::new(origin, direction, ray.t_min, ray.t_max)
}

fn permute(triangles: &[Triangle], order: &[u32]) -> Vec<RtTriangle> {
    order.iter().map(|&index| RtTriangle::from(&triangles[index as usize])).collect()
}

impl<B: Traversal> Peer<B> {
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit<f32, ()>> {
        self.closest_hit_by(ray, |ray, slot| self.triangles[slot].intersect(ray))
    }

    pub fn any_hit(&self, ray: &Ray) -> bool {
        !self.bvh.misses(convert_ray(ray), |ray, slot| self.triangles[slot].intersect(ray))
    }

    /// Returns the closest hit by the caller's triangle test.
    ///
    /// `test` is given the ray and the triangle's place in `triangles`.
    pub fn closest_hit_by(&self, ray: &Ray, test: impl Test) -> Option<Hit<f32, ()>> {
        let mut hit = RayHit::none();
        let index = |slot: u32| self.bvh.indices()[slot as usize] as usize;
        self.bvh.closest(convert_ray(ray), &mut hit, test).then(|| Hit {
            t: hit.t,
            index: index(hit.primitive_id),
            payload: (),
        })
    }
}

/// The queries that both kinds of tree have.
pub trait Traversal {
    fn closest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, test: impl Test) -> bool;
    /// Returns whether the ray hits nothing.
    fn misses(&self, ray: obvhs::ray::Ray, test: impl Test) -> bool;
    /// Returns the input's index of each triangle, in the order of the leaves.
    fn indices(&self) -> &[u32];
}

pub trait Test: FnMut(&obvhs::ray::Ray, usize) -> f32 {}
impl<F: FnMut(&obvhs::ray::Ray, usize) -> f32> Test for F {}

macro_rules! traversal {
    ($tree:ty) => {
        impl Traversal for $tree {
            fn closest(&self, ray: obvhs::ray::Ray, hit: &mut RayHit, test: impl Test) -> bool {
                self.ray_traverse(ray, hit, test)
            }
            fn misses(&self, ray: obvhs::ray::Ray, test: impl Test) -> bool {
                self.ray_traverse_miss(ray, test)
            }
            fn indices(&self) -> &[u32] {
                &self.primitive_indices
            }
        }
    };
}

traversal!(Bvh2);
traversal!(CwBvh);
