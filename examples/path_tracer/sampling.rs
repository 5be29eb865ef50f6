//! Random directions and points on shapes.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use rand::RngExt;
use rand_pcg::Pcg32;

use crate::scene::Shape;

/// Returns the random numbers of one pixel.
///
/// They are a stream of their own, whichever thread renders the pixel.
pub fn pixel_rng(index: usize) -> Pcg32 {
    Pcg32::new(0x853c_49e6_748f_ea9b, index as u64)
}

/// Returns a random point of the unit square.
pub fn square(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.random(), rng.random())
}

/// Returns a direction about `normal` with density cos / pi.
///
/// It is a point of the unit disc, lifted to the hemisphere (Malley's method).
pub fn cosine_hemisphere(normal: Vec3, rng: &mut Pcg32) -> Vec3 {
    let Vec2 { x, y } = square(rng);
    let (sin, cos) = (TAU * x).sin_cos();
    let r = y.sqrt();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    r * cos * tangent + r * sin * bitangent + (1.0 - y).max(0.0).sqrt() * normal
}

/// Returns a point of the shape, with uniform density over its area.
pub fn surface_point(shape: &Shape, rng: &mut Pcg32) -> Vec3 {
    let Vec2 { x, y } = square(rng);
    match shape {
        Shape::Triangle(triangle) => {
            let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::from);
            let root = x.sqrt();
            (1.0 - root) * a + root * (1.0 - y) * b + root * y * c
        }
        Shape::Sphere(sphere) => {
            let z = 1.0 - 2.0 * x;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let (sin, cos) = (TAU * y).sin_cos();
            Vec3::from(sphere.center) + sphere.radius * Vec3::new(r * cos, r * sin, z)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_weighted_directions_have_mean_cosine_two_thirds() {
        let mut rng = pixel_rng(7);
        let normal = Vec3::new(1.0, -2.0, 0.5).normalize();
        let count = 20_000;
        let mean = (0..count)
            .map(|_| cosine_hemisphere(normal, &mut rng).dot(normal))
            .inspect(|&cos| assert!(cos >= 0.0))
            .sum::<f32>()
            / count as f32;
        assert!((mean - 2.0 / 3.0).abs() < 0.01, "{mean}");
    }
}
