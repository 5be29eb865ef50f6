//! Any number of rays into a scene; each ray is a function of its number.

use crate::scene::Shape;
use bvhkit::{Aabb, Primitive, Ray};
use glam::Vec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A source of rays for a scene.
pub struct Aims<'a> {
    shapes: &'a [Shape],
    bounds: Aabb,
}

impl<'a> Aims<'a> {
    pub fn new(shapes: &'a [Shape]) -> Self {
        let bounds = shapes.iter().fold(Aabb::EMPTY, |all, shape| all.union(shape.aabb()));
        Self { shapes, bounds }
    }

    /// Returns the ray of a number; four kinds of rays take turns.
    ///
    /// A ray goes between two points of the scene's box, to a corner, to an edge, or
    /// along an axis through a corner.
    pub fn ray(&self, number: u64) -> Ray {
        let rng = &mut Pcg64Mcg::seed_from_u64(number);
        let origin = self.point(rng);
        let [a, b, c] = self.corners(rng);
        let toward = |target: Vec3| Ray::new(origin, target - origin);
        match number % 4 {
            0 => toward(self.point(rng)),
            1 => toward(a),
            2 => toward(b.lerp(c, rng.random())),
            _ => {
                let axis = rng.random_range(0..3);
                let (mut start, mut direction) = (a, Vec3::ZERO);
                start[axis] = origin[axis];
                direction[axis] = if rng.random() { 1.0 } else { -1.0 };
                Ray::new(start, direction)
            }
        }
    }

    /// Returns a point in the scene's box, or slightly outside.
    fn point(&self, rng: &mut impl Rng) -> Vec3 {
        let (min, max) = (Vec3::from(self.bounds.min), Vec3::from(self.bounds.max));
        let fraction = Vec3::from_array([0; 3].map(|_| rng.random_range(-0.1..1.1)));
        min + (max - min) * fraction
    }

    /// Returns three points of a random shape.
    fn corners(&self, rng: &mut impl Rng) -> [Vec3; 3] {
        match self.shapes[rng.random_range(0..self.shapes.len())] {
            Shape::Triangle(triangle) => [triangle.a, triangle.b, triangle.c],
            Shape::Sphere(sphere) => [sphere.aabb().min, sphere.center, sphere.aabb().max],
        }
        .map(Vec3::from)
    }
}
