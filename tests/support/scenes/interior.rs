//! A hall: a few huge triangles around a great many long thin ones.
//!
//! Interiors are hard because most boxes are large, overlap, and are nearly empty.

use super::quad;
use bvhkit::Triangle;
use glam::{Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::f32::consts::TAU;

/// The hall is 10 by 8 m and 4 m high, with a corner at the origin.
const SIZE: Vec3 = Vec3::new(10.0, 4.0, 8.0);
const COLUMNS: usize = 8;
const WINDOWS: usize = 6;
/// The number of pieces of a pipe, one behind the other.
const PIECES: usize = 4;

/// Returns a hall of about `n` triangles.
///
/// A third of them each are in round columns from floor to ceiling, in the slats of the blinds at
/// the windows, and in pipes below the ceiling.
pub fn interior(n: usize) -> Vec<Triangle> {
    let share = n.saturating_sub(12) / 3;
    let mut triangles = cuboid(0.5 * SIZE, 0.5 * SIZE, Quat::IDENTITY);

    let sides = (share / COLUMNS / 2).max(3);
    for i in 0..COLUMNS {
        let (along, across) = ((i / 2) as f32, (i % 2) as f32);
        let foot = Vec3::new(2.0 + 2.0 * along, 0.0, 2.5 + 3.0 * across);
        triangles.extend(tube(foot, foot.with_y(SIZE.y), 0.15, sides));
    }

    let slats = (share / WINDOWS / 12).max(1);
    for window in 0..WINDOWS {
        for slat in 0..slats {
            let y = 0.8 + 2.4 * (slat as f32 + 0.5) / slats as f32;
            let center = Vec3::new(SIZE.x * (window as f32 + 0.5) / WINDOWS as f32, y, 0.1);
            let half = Vec3::new(0.7, 0.0005, 1.0 / slats as f32);
            triangles.extend(cuboid(center, half, Quat::from_rotation_x(0.6)));
        }
    }

    let mut rng = Pcg32::seed_from_u64(1);
    for _ in 0..n.saturating_sub(triangles.len()) / (PIECES * 48) {
        let [start, end, y]: [f32; 3] = rng.random();
        // Most pipes run nearly along the walls, some askew.
        let askew = 0.3 * (end - start) * rng.random::<f32>().powi(3);
        let along_x = rng.random();
        let [from, to] = [0.0, 1.0].map(|along| {
            let (across, y) = (start + askew * along, 0.77 + 0.2 * y);
            SIZE * if along_x { Vec3::new(along, y, across) } else { Vec3::new(across, y, along) }
        });
        let radius = 0.01 + 0.03 * rng.random::<f32>();
        for piece in 0..PIECES {
            let end = |i: usize| from.lerp(to, i as f32 / PIECES as f32);
            triangles.extend(tube(end(piece), end(piece + 1), radius, 24));
        }
    }
    triangles
}

/// Returns a box around its center, rotated by `turn`.
fn cuboid(center: Vec3, half: Vec3, turn: Quat) -> Vec<Triangle> {
    let corner = |x: f32, y: f32, z: f32| center + turn * (half * Vec3::new(x, y, z));
    let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut faces = Vec::new();
    for side in [-1.0, 1.0] {
        faces.extend(quad(ring.map(|(a, b)| corner(side, a, b))));
        faces.extend(quad(ring.map(|(a, b)| corner(a, side, b))));
        faces.extend(quad(ring.map(|(a, b)| corner(a, b, side))));
    }
    faces
}

/// Returns the wall of an open tube, two triangles of full length for each side.
fn tube(from: Vec3, to: Vec3, radius: f32, sides: usize) -> impl Iterator<Item = Triangle> {
    let (u, v) = (to - from).normalize().any_orthonormal_pair();
    let rim = move |i: usize| {
        let (sin, cos) = (TAU * (i % sides) as f32 / sides as f32).sin_cos();
        radius * (cos * u + sin * v)
    };
    (0..sides).flat_map(move |i| quad([from + rim(i), from + rim(i + 1), to + rim(i + 1), to + rim(i)]))
}
