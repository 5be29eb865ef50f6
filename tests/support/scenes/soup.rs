//! Triangles that share no corners, in the unit cube.

use bvhkit::Triangle;
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// Returns `n` evenly scattered triangles.
///
/// More triangles are smaller ones, so that they fill the cube about equally.
pub fn scattered(n: usize) -> Vec<Triangle> {
    let mut rng = Pcg32::seed_from_u64(2);
    let size = (n as f32).cbrt().recip();
    (0..n)
        .map(|_| {
            let center = cube(&mut rng);
            triangle(center, size, &mut rng)
        })
        .collect()
}

/// Returns triangles in 32 clusters, denser towards their centers.
///
/// Some clusters are a hundred times smaller than others.
pub fn clustered(n: usize) -> Vec<Triangle> {
    let mut rng = Pcg32::seed_from_u64(3);
    let clusters: Vec<(Vec3, f32)> =
        (0..32).map(|_| (cube(&mut rng), 0.2 * 0.01_f32.powf(rng.random()))).collect();
    let size = (n as f32 / clusters.len() as f32).cbrt().recip();
    (0..n)
        .map(|i| {
            let (center, radius) = clusters[i % clusters.len()];
            let away = cube(&mut rng) - 0.5;
            triangle(center + 4.0 * radius * away.length() * away, radius * size, &mut rng)
        })
        .collect()
}

/// Returns a triangle with corners anywhere in a cube of side `size`.
pub fn triangle(center: Vec3, size: f32, rng: &mut Pcg32) -> Triangle {
    let [a, b, c] = [(); 3].map(|()| center + size * (cube(rng) - 0.5));
    Triangle::new(a, b, c)
}

/// Returns a random point of the unit cube.
pub fn cube(rng: &mut Pcg32) -> Vec3 {
    Vec3::from_array(rng.random())
}
