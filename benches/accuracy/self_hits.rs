//! Rays that start on the surface, as bounces and shadow rays do.

use bvhkit::{Bvh, Corners, Ray, Triangle};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::f32::consts::{FRAC_PI_2, TAU};

/// The smallest angle to the surface, in radians.
///
/// Each decade of larger angles has the same share of rays.
const GRAZING: f32 = 1e-4;

/// Returns a ray from each hit of `rays`, and the triangle that the ray leaves.
///
/// The hits are those of the default mode. The rays leave on either side.
pub fn spawned(triangles: &[Triangle], rays: impl Iterator<Item = Ray>) -> Vec<(usize, Ray)> {
    let mut rng = Pcg32::seed_from_u64(6);
    let bvh = Bvh::build(triangles).expect("the coordinates are finite");
    let spawn = |ray| {
        let hit = bvh.closest_hit(&ray)?;
        let point = triangles[hit.index].surface_point(hit.payload);
        // A triangle without area has no normal.
        let normal = Vec3::from(point.normal).try_normalize()?;
        let (u, v) = normal.any_orthonormal_pair();
        let (around_v, around_u) = (TAU * rng.random::<f32>()).sin_cos();
        let (up, along) = (GRAZING * (FRAC_PI_2 / GRAZING).powf(rng.random())).sin_cos();
        let side = if rng.random() { normal } else { -normal };
        Some((hit.index, point.spawn(up * side + along * (around_u * u + around_v * v))))
    };
    rays.filter_map(spawn).collect()
}
