//! The crate `bvh`: its tree and its triangle test.
//!
//! The query is `traverse_iterator`, which visits every box that the ray meets and is the fastest
//! of the crate's queries in a torus (measured: docs/decisions.md, 41).
//!
//! The triangle test of the crate leaves out triangles seen from behind. So both windings are
//! asked, as the tests of other crates see both sides. The ray is put together from its parts,
//! because `Ray::new` would first round the direction to another one.

use crate::tracer::{Hit, Tracer, smallest};
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray;
use bvhkit::Triangle;
use nalgebra::{Point3, Vector3};

pub struct Peer {
    bvh: Bvh<f32, 3>,
    /// The faces in the order of the input.
    faces: Vec<Face>,
    /// Whether the tree is too deep for the iterator, which would panic.
    is_deep: bool,
}

/// The number of levels on the iterator's stack.
const LEVELS: usize = 32;

struct Face {
    corners: [Point3<f32>; 3],
    aabb: Aabb<f32, 3>,
    index: usize,
    node_index: usize,
}

impl Bounded<f32, 3> for Face {
    fn aabb(&self) -> Aabb<f32, 3> {
        self.aabb
    }
}

impl BHShape<f32, 3> for Face {
    fn set_bh_node_index(&mut self, node_index: usize) {
        self.node_index = node_index;
    }

    fn bh_node_index(&self) -> usize {
        self.node_index
    }
}

impl Face {
    fn new((index, triangle): (usize, &Triangle)) -> Self {
        let corners = [triangle.a, triangle.b, triangle.c].map(Point3::from);
        let aabb = corners.iter().fold(Aabb::empty(), |aabb, corner| aabb.grow(corner));
        Self { corners, aabb, index, node_index: 0 }
    }

    /// Returns the t of the hit, infinite for a miss.
    #[inline(always)]
    fn t(&self, ray: &Ray<f32, 3>) -> f32 {
        let [a, b, c] = &self.corners;
        let front = ray.intersects_triangle(a, b, c).distance;
        if front < f32::INFINITY { front } else { ray.intersects_triangle(a, c, b).distance }
    }
}

impl Peer {
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut faces: Vec<_> = triangles.iter().enumerate().map(Face::new).collect();
        let bvh = Bvh::build(&mut faces);
        Self { is_deep: depth(&bvh) >= LEVELS, bvh, faces }
    }

    #[inline(always)]
    fn nearest<'a>(ray: &Ray<f32, 3>, faces: impl Iterator<Item = &'a Face>) -> Option<Hit> {
        let mut best = (f32::INFINITY, 0);
        for face in faces {
            let t = face.t(ray);
            if t < best.0 {
                best = (t, face.index);
            }
        }
        (best.0 < f32::INFINITY).then_some(Hit { t: f64::from(best.0), index: best.1 })
    }
}

fn depth(bvh: &Bvh<f32, 3>) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0, 0)];
    while let Some((node, depth)) = open.pop() {
        deepest = deepest.max(depth);
        if let BvhNode::Node { child_l_index, child_r_index, .. } = bvh.nodes[node] {
            open.extend([child_l_index, child_r_index].map(|child| (child, depth + 1)));
        }
    }
    deepest
}

/// Converts a ray. The peer's ray has no interval: its t is in [0, infinity].
#[inline(always)]
fn convert(ray: &bvhkit::Ray) -> Ray<f32, 3> {
    let direction = Vector3::from(ray.direction);
    Ray { origin: ray.origin.into(), direction, inv_direction: direction.map(f32::recip) }
}

impl Tracer for Peer {
    fn closest_hit(&self, ray: &bvhkit::Ray) -> Option<Hit> {
        let ray = convert(ray);
        if self.is_deep {
            Self::nearest(&ray, self.bvh.traverse(&ray, &self.faces).into_iter())
        } else {
            Self::nearest(&ray, self.bvh.traverse_iterator(&ray, &self.faces))
        }
    }

    fn test(&self, index: usize, ray: &bvhkit::Ray) -> Option<f64> {
        let t = self.faces[index].t(&convert(ray));
        (t < f32::INFINITY).then_some(f64::from(t))
    }

    fn naive_t(&self, ray: &bvhkit::Ray) -> Option<f64> {
        smallest(self.faces.len(), |index| self.test(index, ray))
    }
}
