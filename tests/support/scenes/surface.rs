//! Surfaces over a grid of parameters: a closed mesh and a terrain.

use super::quad;
use bvhkit::Triangle;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Returns a torus with bumps.
///
/// It is watertight: triangles that share an edge share the bits of its ends.
pub fn closed_mesh(n: usize) -> Vec<Triangle> {
    let (columns, rows) = grid(n, 2.0);
    let vertex = |i: usize, j: usize| {
        let u = TAU * (i % columns) as f32 / columns as f32;
        let v = TAU * (j % rows) as f32 / rows as f32;
        let bump = 0.03 * (17.0 * u).sin() * (9.0 * v).cos() + 0.004 * (83.0 * u + 61.0 * v).sin();
        let tube = 0.35 + bump;
        let around = 1.0 + tube * v.cos();
        Vec3::new(around * u.cos(), tube * v.sin(), around * u.sin())
    };
    tessellate(columns, rows, vertex)
}

/// Returns hills on a square of side 2.
///
/// They are octaves of waves, each rotated against the one before.
pub fn terrain(n: usize) -> Vec<Triangle> {
    let (columns, rows) = grid(n, 1.0);
    let vertex = |i: usize, j: usize| {
        let x = 2.0 * i as f32 / columns as f32 - 1.0;
        let z = 2.0 * j as f32 / rows as f32 - 1.0;
        Vec3::new(x, height(Vec2::new(x, z)), z)
    };
    tessellate(columns, rows, vertex)
}

fn height(mut at: Vec2) -> f32 {
    let turn = Vec2::from_angle(0.65);
    let (mut height, mut amplitude) = (0.0, 0.1);
    at *= 3.0;
    for _ in 0..7 {
        height += amplitude * at.x.sin() * (1.3 * at.y + 0.7).cos();
        at = 1.9 * turn.rotate(at);
        amplitude *= 0.52;
    }
    height
}

/// Returns the columns and rows of a grid of about `n` triangles.
///
/// There are about `aspect` columns for each row.
fn grid(n: usize, aspect: f32) -> (usize, usize) {
    let columns = ((n as f32 / 2.0 * aspect).sqrt() as usize).max(3);
    (columns, (n / 2 / columns).max(3))
}

fn tessellate(columns: usize, rows: usize, vertex: impl Fn(usize, usize) -> Vec3) -> Vec<Triangle> {
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    cells
        .flat_map(|(i, j)| quad([vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)]))
        .collect()
}
