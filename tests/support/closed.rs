//! Closed meshes: triangles that share the very bits of their corners, each edge between two of them.

use super::scenes::torus;
use bvhkit::Triangle;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// One of each kind, of about `n` triangles, about 1 in size around the origin, with names.
pub fn all(n: usize) -> [(&'static str, Vec<Triangle>); 5] {
    [
        ("torus", torus(n)),
        ("globe", globe(n, 1, |p| p)),
        ("needles", globe(n, 4, |p| p)),
        ("cube", globe(n, 1, |p| p / p.abs().max_element())),
        ("star", globe(n, 1, |p| p * (0.2 + 0.8 * (5.0 * p.x).cos().powi(4) * (6.0 * p.z.atan2(p.x)).sin().powi(2)))),
    ]
}

/// A sphere by columns from pole to pole, then shaped. With an `unevenness` of 1 its triangles are alike; with 4
/// the widths of columns and the heights of rows each go down to some millionths of the largest, so
/// that there are needles of both kinds, and dust.
fn globe(n: usize, unevenness: i32, shape: impl Fn(Vec3) -> Vec3) -> Vec<Triangle> {
    let count = ((n / 2) as f32).sqrt() as usize;
    let (columns, rows) = (count.max(3), count.max(2));
    let share = |i: usize, of: usize| (i as f32 / of as f32).powi(unevenness);
    let vertex = |i: usize, j: usize| {
        if j == 0 || j == rows {
            return shape(Vec3::Y * if j == 0 { 1.0 } else { -1.0 });
        }
        let (around, down) = (TAU * share(i % columns, columns), PI * share(j, rows));
        shape(Vec3::new(down.sin() * around.cos(), down.cos(), down.sin() * around.sin()))
    };
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    faces.filter(|[a, b, c]| a != b && b != c && c != a).map(|[a, b, c]| Triangle::new(a, b, c)).collect()
}

/// Every corner scaled, then shifted, not the same on all axes, and rounded: equal ones stay equal.
pub fn placed(mesh: &[Triangle], scale: f64, offset: f64) -> Vec<Triangle> {
    let shift = [1.0, -0.75, 0.5].map(|x| x * offset);
    let place = |p: [f32; 3]| [0, 1, 2].map(|k| (f64::from(p[k]) * scale + shift[k]) as f32);
    mesh.iter().map(|t| Triangle::new(place(t.a), place(t.b), place(t.c))).collect()
}
