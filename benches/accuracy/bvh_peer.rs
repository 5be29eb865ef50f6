//! The crate `bvh`: its tree and its triangle test.
//!
//! Every box that the ray meets is visited: in a torus, `traverse_iterator` was the fastest of its queries, by a
//! tenth over `traverse` and by half over those that go by distance and can be stopped early. Its
//! triangle test leaves out triangles seen from behind, so both windings are asked, as other crates'
//! tests see both sides. The ray is put together from its parts: `Ray::new` would round the direction to
//! another one first.

use crate::tracer::{Hit, Tracer, smallest};
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray;
use bvhkit::Triangle;
use nalgebra::{Point3, Vector3};

pub struct Peer {
    bvh: Bvh<f32, 3>,
    /// In the order of the input.
    faces: Vec<Face>,
    /// The iterator has room for so many levels, and panics beyond.
    is_deep: bool,
}

/// The iterator's stack.
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

    /// Infinite for a miss.
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

/// With t in [0, infinity]: an interval it does not have.
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
