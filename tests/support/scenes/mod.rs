//! Scenes that depend only on a number of triangles.
//!
//! They are the same in every run and on every machine.

mod interior;
pub mod soup;
pub mod surface;

use bvhkit::Triangle;
use glam::Vec3;

/// A scene and a viewpoint.
pub struct NamedScene {
    pub name: String,
    pub triangles: Vec<Triangle>,
    pub eye: Vec3,
    pub target: Vec3,
}

/// Returns one scene of each kind, each of about `n` triangles.
pub fn all(n: usize) -> Vec<NamedScene> {
    let outside = Vec3::new(0.6, 0.5, 0.9);
    [
        ("closed-mesh", surface::closed_mesh(n), 2.2 * outside, Vec3::ZERO),
        ("terrain", surface::terrain(n), Vec3::new(0.9, 0.25, 0.8), Vec3::ZERO),
        ("interior", interior::interior(n), Vec3::new(8.5, 1.6, 7.0), Vec3::new(3.0, 2.0, 2.0)),
        ("clustered-soup", soup::clustered(n), 1.5 * outside, Vec3::splat(0.5)),
        ("scattered-soup", soup::scattered(n), 1.5 * outside, Vec3::splat(0.5)),
    ]
    .map(|(name, triangles, eye, target)| NamedScene { name: name.into(), triangles, eye, target })
    .into()
}

/// Returns the two triangles of a quadrilateral with its corners in order.
fn quad([a, b, c, d]: [Vec3; 4]) -> [Triangle; 2] {
    [Triangle::new(a, b, c), Triangle::new(a, c, d)]
}
