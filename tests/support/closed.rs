//! Closed meshes: shared corners are bitwise equal, and edges have two triangles.

use bvhkit::reference::exact;
use bvhkit::{Ray, Triangle};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Returns one mesh of each kind, with its name.
///
/// Each has about `n` triangles, a size of about 1, and a place at or around the origin.
pub fn all(n: usize) -> [(&'static str, Vec<Triangle>); 5] {
    let spike = |p: Vec3| (5.0 * p.x).cos().powi(4) * (6.0 * p.z.atan2(p.x)).sin().powi(2);
    [
        ("globe", globe(n, 1, |p| p)),
        ("needles", globe(n, 4, |p| p)),
        ("cube", cube(n)),
        ("star", globe(n, 1, |p| p * (0.2 + 0.8 * spike(p)))),
        ("knot", knot(n)),
    ]
}

/// Returns the mesh with every corner scaled, then shifted, then rounded.
///
/// The shift differs between axes, because the diagonal is a special
/// place. Equal corners stay equal.
pub fn placed(mesh: &[Triangle], scale: f64, offset: f64) -> Vec<Triangle> {
    let shift = [1.0, -0.75, 0.5].map(|x| x * offset);
    let place = |p: [f32; 3]| [0, 1, 2].map(|k| (f64::from(p[k]) * scale + shift[k]) as f32);
    mesh.iter().map(|t| Triangle::new(place(t.a), place(t.b), place(t.c))).collect()
}

/// Returns whether the ray's origin is exactly inside and on no triangle.
///
/// Along a ray that passes no edge, a point inside has an odd number of hits. `None` if this ray
/// passes an edge or starts on a triangle.
pub fn encloses(mesh: &[Triangle], ray: &Ray) -> Option<bool> {
    let hits = exact::hits(mesh, ray);
    let is_generic = hits.iter().all(|hit| {
        let slack = exact::edge_slack(&mesh[hit.index], ray);
        slack.is_some_and(|slack| slack < 0.0) && hit.t.cmp_scalar(0.0f32).is_gt()
    });
    is_generic.then_some(hits.len() % 2 == 1)
}

/// Returns a sphere of columns from pole to pole, deformed by `shape`.
///
/// With an `unevenness` of 1, the triangles are alike. With 4, the widths of columns and
/// the heights of rows each go down to some millionths of the largest. So there are
/// needles of both kinds, and dust.
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
    faces(columns, rows, vertex)
}

/// Returns the unit cube, with about `n` triangles and a corner at the origin.
///
/// Faces are in the planes in which a coordinate is 0 or 1. At 0, a tolerance relative to the
/// coordinate vanishes. Many edges are parallel to axes.
fn cube(n: usize) -> Vec<Triangle> {
    let cells = ((n / 12) as f32).sqrt() as usize;
    let faces = (0..3).flat_map(|axis| [0.0, 1.0].map(|side| (axis, side)));
    let squares = faces.flat_map(|face| (0..cells * cells).map(move |i| (face, i % cells, i / cells)));
    squares
        .flat_map(|((axis, side), i, j)| {
            let vertex = |i: usize, j: usize| {
                let mut corner = [side; 3];
                corner[(axis + 1) % 3] = i as f32 / cells as f32;
                corner[(axis + 2) % 3] = j as f32 / cells as f32;
                corner
            };
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            [Triangle::new(a, b, c), Triangle::new(a, c, d)]
        })
        .collect()
}

/// Returns a tube along a trefoil knot, which passes close to itself.
fn knot(n: usize) -> Vec<Triangle> {
    let columns = ((n / 40) as f32).sqrt() as usize + 3;
    let rows = (n / 2 / columns).max(12);
    let trefoil = |u: f32| {
        let around = 0.6 + 0.25 * (1.5 * u).cos();
        Vec3::new(around * u.cos(), 0.25 * (1.5 * u).sin(), around * u.sin())
    };
    let vertex = |i: usize, j: usize| {
        // Twice around the center, and three times around the torus that carries the knot.
        let u = 2.0 * TAU * (j % rows) as f32 / rows as f32;
        let ahead = trefoil(u + 1e-2) - trefoil(u - 1e-2);
        let (right, up) = ahead.normalize().any_orthonormal_pair();
        let (sin, cos) = (TAU * (i % columns) as f32 / columns as f32).sin_cos();
        trefoil(u) + 0.12 * (cos * right + sin * up)
    };
    faces(columns, rows, vertex)
}

/// Returns two triangles for each cell, without those that have equal corners.
fn faces(columns: usize, rows: usize, vertex: impl Fn(usize, usize) -> Vec3) -> Vec<Triangle> {
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    faces.filter(|[a, b, c]| a != b && b != c && c != a).map(|[a, b, c]| Triangle::new(a, b, c)).collect()
}
