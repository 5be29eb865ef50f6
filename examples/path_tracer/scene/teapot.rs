//! The Utah teapot, from its published bicubic Bezier patches.
//!
//! Martin Newell measured it in 1975 and published 28 patches. Frank Crow added the four of
//! the bottom ("The Origins of the Teapot", IEEE Computer Graphics and Applications 7(1),
//! 1987, which also prints the data).
//!
//! The control points below are in the published units, z up: the teapot stands on z = 0 and is
//! 3.15 high. The symmetry of the data keeps it short: 24 of the patches turn a profile around the
//! z axis, the other 8 are four patches and their mirror images.

use glam::Vec3;

/// One bicubic patch: control points in rows of four.
pub type Patch = [Vec3; 16];

/// The profiles that are turned around the axis.
///
/// A profile has (radius, tangent, height) for four control points. A quarter of a
/// turn has the control points (r, 0), (r, -k), (k, -r), (0, -r), where the tangent k
/// brings the cubic close to a circle.
#[rustfmt::skip]
const PROFILES: [[(f32, f32, f32); 4]; 6] = [
    // Rim.
    [(1.4, 0.784, 2.4), (1.3375, 0.749, 2.53125), (1.4375, 0.805, 2.53125), (1.5, 0.84, 2.4)],
    // Body, upper and lower part.
    [(1.5, 0.84, 2.4), (1.75, 0.98, 1.875), (2.0, 1.12, 1.35), (2.0, 1.12, 0.9)],
    [(2.0, 1.12, 0.9), (2.0, 1.12, 0.45), (1.5, 0.84, 0.225), (1.5, 0.84, 0.15)],
    // Lid: knob and cover.
    [(0.0, 0.0, 3.15), (0.8, 0.45, 3.15), (0.0, 0.0, 2.85), (0.2, 0.112, 2.7)],
    [(0.2, 0.112, 2.7), (0.4, 0.224, 2.55), (1.3, 0.728, 2.55), (1.3, 0.728, 2.4)],
    // Bottom.
    [(1.5, 0.84, 0.15), (1.5, 0.84, 0.075), (1.425, 0.798, 0.0), (0.0, 0.0, 0.0)],
];

/// The halves of handle and spout with y <= 0, two patches each.
///
/// Each row runs around half of the tube, the next row is farther along it. In a row, the first and
/// the last point are in the plane of symmetry.
#[rustfmt::skip]
const HALVES: [[[f32; 3]; 16]; 4] = [
    // Handle, upper part.
    [
        [-1.6, 0.0, 2.025],
        [-1.6, -0.3, 2.025],
        [-1.5, -0.3, 2.25],
        [-1.5, 0.0, 2.25],
        [-2.3, 0.0, 2.025],
        [-2.3, -0.3, 2.025],
        [-2.5, -0.3, 2.25],
        [-2.5, 0.0, 2.25],
        [-2.7, 0.0, 2.025],
        [-2.7, -0.3, 2.025],
        [-3.0, -0.3, 2.25],
        [-3.0, 0.0, 2.25],
        [-2.7, 0.0, 1.8],
        [-2.7, -0.3, 1.8],
        [-3.0, -0.3, 1.8],
        [-3.0, 0.0, 1.8],
    ],
    // Handle, lower part.
    [
        [-2.7, 0.0, 1.8],
        [-2.7, -0.3, 1.8],
        [-3.0, -0.3, 1.8],
        [-3.0, 0.0, 1.8],
        [-2.7, 0.0, 1.575],
        [-2.7, -0.3, 1.575],
        [-3.0, -0.3, 1.35],
        [-3.0, 0.0, 1.35],
        [-2.5, 0.0, 1.125],
        [-2.5, -0.3, 1.125],
        [-2.65, -0.3, 0.9375],
        [-2.65, 0.0, 0.9375],
        [-2.0, 0.0, 0.9],
        [-2.0, -0.3, 0.9],
        [-1.9, -0.3, 0.6],
        [-1.9, 0.0, 0.6],
    ],
    // Spout, lower part.
    [
        [1.7, 0.0, 1.425],
        [1.7, -0.66, 1.425],
        [1.7, -0.66, 0.6],
        [1.7, 0.0, 0.6],
        [2.6, 0.0, 1.425],
        [2.6, -0.66, 1.425],
        [3.1, -0.66, 0.825],
        [3.1, 0.0, 0.825],
        [2.3, 0.0, 2.1],
        [2.3, -0.25, 2.1],
        [2.4, -0.25, 2.025],
        [2.4, 0.0, 2.025],
        [2.7, 0.0, 2.4],
        [2.7, -0.25, 2.4],
        [3.3, -0.25, 2.4],
        [3.3, 0.0, 2.4],
    ],
    // Spout, upper part.
    [
        [2.7, 0.0, 2.4],
        [2.7, -0.25, 2.4],
        [3.3, -0.25, 2.4],
        [3.3, 0.0, 2.4],
        [2.8, 0.0, 2.475],
        [2.8, -0.25, 2.475],
        [3.525, -0.25, 2.49375],
        [3.525, 0.0, 2.49375],
        [2.9, 0.0, 2.475],
        [2.9, -0.15, 2.475],
        [3.45, -0.15, 2.5125],
        [3.45, 0.0, 2.5125],
        [2.8, 0.0, 2.4],
        [2.8, -0.15, 2.4],
        [3.2, -0.15, 2.4],
        [3.2, 0.0, 2.4],
    ],
];

/// A triangle and the normals at its vertices.
pub struct Facet {
    pub points: [Vec3; 3],
    pub normals: [Vec3; 3],
}

/// Returns the teapot as triangles.
///
/// Every patch becomes `n` by `n` quads, each cut into two triangles. Where a patch shrinks to a
/// point (top and bottom), a quad is a single triangle.
pub fn tessellate(n: usize) -> Vec<Facet> {
    let mut facets = Vec::new();
    for patch in patches() {
        let vertex = |i: usize, j: usize| {
            let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
            (point(&patch, u, v), normal(&patch, u, v))
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let quad = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            for corners in [[0, 2, 1], [0, 3, 2]] {
                let points = corners.map(|corner: usize| quad[corner].0);
                let normals = corners.map(|corner: usize| quad[corner].1);
                let [a, b, c] = points;
                if a != b && b != c && c != a {
                    facets.push(Facet { points, normals });
                }
            }
        }
    }
    facets
}

/// Returns the 32 patches, each with its outside where d/dv x d/du points.
fn patches() -> Vec<Patch> {
    let mut patches = Vec::with_capacity(32);
    for profile in PROFILES {
        let mut quarter: Patch = std::array::from_fn(|i| {
            let (r, k, z) = profile[i / 4];
            [Vec3::new(r, 0.0, z), Vec3::new(r, -k, z), Vec3::new(k, -r, z), Vec3::new(0.0, -r, z)][i % 4]
        });
        for _ in 0..4 {
            patches.push(quarter);
            // A quarter of a turn moves coordinates without rounding, so edges stay shared.
            quarter = quarter.map(|p| Vec3::new(p.y, -p.x, p.z));
        }
    }
    for half in HALVES {
        let half = half.map(Vec3::from);
        let mirrored = half.map(|p| Vec3::new(p.x, -p.y, p.z));
        patches.push(half);
        // A mirror image is inside out. The reversed order of points in its rows turns it right.
        patches.push(std::array::from_fn(|i| mirrored[i / 4 * 4 + 3 - i % 4]));
    }
    patches
}

fn point(patch: &Patch, u: f32, v: f32) -> Vec3 {
    combine(patch, bernstein(u), bernstein(v))
}

/// Returns the unit normal.
///
/// Where the patch shrinks to a point, its derivative vanishes. There the normal is that of a
/// point a little further inside.
fn normal(patch: &Patch, u: f32, v: f32) -> Vec3 {
    let across = |u: f32, v: f32| {
        let du = combine(patch, bernstein_derivative(u), bernstein(v));
        let dv = combine(patch, bernstein(u), bernstein_derivative(v));
        dv.cross(du).try_normalize()
    };
    let inside = |t: f32| t.clamp(0.01, 0.99);
    across(u, v).or_else(|| across(inside(u), inside(v))).unwrap_or(Vec3::Z)
}

fn combine(patch: &Patch, row: [f32; 4], column: [f32; 4]) -> Vec3 {
    (0..16).map(|i| row[i / 4] * column[i % 4] * patch[i]).sum()
}

fn bernstein(t: f32) -> [f32; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

fn bernstein_derivative(t: f32) -> [f32; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t]
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn it_has_32_patches_and_its_published_size() {
        assert_eq!(patches().len(), 32);
        let points: Vec<Vec3> = tessellate(10).iter().flat_map(|facet| facet.points).collect();
        let min = points.iter().copied().reduce(Vec3::min).unwrap();
        let max = points.iter().copied().reduce(Vec3::max).unwrap();
        assert!((min - Vec3::new(-3.0, -2.0, 0.0)).abs().max_element() < 0.01, "{min}");
        assert!((max - Vec3::new(3.434, 2.0, 3.15)).abs().max_element() < 0.01, "{max}");
    }

    /// Neighbouring patches share their edges bit for bit.
    ///
    /// The only open edges are those of the published teapot: lid and body do not touch, and handle
    /// and spout only pierce the body.
    #[test]
    fn only_the_published_gaps_are_open() {
        let n = 6;
        let key = |p: Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
        let mut uses: HashMap<_, i32> = HashMap::new();
        for facet in tessellate(n) {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (key(facet.points[a]), key(facet.points[b]));
                // A closed, consistently wound surface crosses each edge once in each direction.
                let (edge, direction) = if a < b { ((a, b), 1) } else { ((b, a), -1) };
                *uses.entry(edge).or_default() += direction;
            }
        }
        let open = uses.values().filter(|&&sum| sum != 0).count();
        // Lower edge of the lid, upper edge of the rim; both ends of the handle and of the spout.
        assert_eq!(open, 4 * n + 4 * n + 4 * (2 * n));
    }

    #[test]
    fn facets_and_normals_face_outward() {
        let facets = tessellate(5);
        let volume: f32 = facets.iter().map(|Facet { points: [a, b, c], .. }| a.dot(b.cross(*c)) / 6.0).sum();
        assert!(volume > 0.0, "{volume}");

        let agree = facets.iter().filter(|facet| {
            let [a, b, c] = facet.points;
            let geometric = (b - a).cross(c - a);
            facet.normals.iter().all(|normal| normal.dot(geometric) > -1e-6)
        });
        // Only at the lip of the spout does the surface turn more sharply than the facets.
        assert!(facets.len() - agree.count() <= 4);
    }
}
