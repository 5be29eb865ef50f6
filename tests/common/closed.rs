//! Closed meshes with bitwise equal shared corners, and rays from inside them.

use bvhkit::{Ray, Scalar, Triangle};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::{PI, TAU};

type Point = [f64; 3];

/// A closed mesh, and points that are well inside it.
pub struct Closed {
    vertices: Vec<Point>,
    faces: Vec<[usize; 3]>,
    inside: Vec<Point>,
    /// The approximate radius.
    size: f64,
}

/// Returns two triangles for each quadrilateral of a grid with cyclic columns.
fn quads(columns: usize, rows: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column))).flat_map(
        move |(row, column)| {
            let at = |row: usize, column: usize| row * columns + column % columns;
            let corners =
                [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
            [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
        },
    )
}

/// Returns a sphere of radius 1 around the origin: 16 meridians, 10 rings, 2 poles.
pub fn sphere() -> Closed {
    let (columns, rings) = (16, 10);
    let mut vertices: Vec<Point> = (0..columns * rings)
        .map(|i| {
            let (across, around) = (PI * (i / columns + 1) as f64 / 11.0, TAU * (i % columns) as f64 / 16.0);
            [across.sin() * around.cos(), across.sin() * around.sin(), across.cos()]
        })
        .collect();
    let mut faces: Vec<_> = quads(columns, rings - 1).collect();
    let (top, bottom, last) = (vertices.len(), vertices.len() + 1, columns * (rings - 1));
    vertices.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    for column in 0..columns {
        let next = (column + 1) % columns;
        faces.extend([[top, next, column], [bottom, last + column, last + next]]);
    }
    Closed { vertices, faces, inside: vec![[0.0; 3], [0.25, 0.0, 0.0], [0.1, -0.3, 0.57]], size: 1.0 }
}

/// Returns a torus with dents, in the xy plane.
pub fn torus() -> Closed {
    let (columns, rows) = (10, 20);
    let around = |i: usize| TAU * i as f64 / rows as f64;
    let vertices = (0..columns * rows)
        .map(|i| {
            let (u, v) = (around(i / columns), TAU * (i % columns) as f64 / columns as f64);
            let tube = 0.3 + 0.04 * (3.0 * u).sin() * (2.0 * v).cos();
            let radius = 0.65 + tube * v.cos();
            [radius * u.cos(), radius * u.sin(), tube * v.sin()]
        })
        .collect();
    // The last row of quadrilaterals ends at the first row of vertices.
    let faces = quads(columns, rows).map(|face| face.map(|i| i % (columns * rows))).collect();
    // Along the middle of the tube, just above the plane z = 0 with its ring of vertices.
    let inside = [0.5, 7.25, 13.0].map(|i| {
        let u: f64 = TAU * i / rows as f64;
        [0.65 * u.cos(), 0.65 * u.sin(), 0.01]
    });
    Closed { vertices, faces, inside: inside.to_vec(), size: 1.0 }
}

impl Closed {
    /// Returns the mesh with each coordinate multiplied and shifted.
    pub fn moved(self, scale: f64, shift: Point) -> Self {
        let moved = |point: Point| [0, 1, 2].map(|k| point[k] * scale + shift[k]);
        Self {
            vertices: self.vertices.into_iter().map(moved).collect(),
            inside: self.inside.into_iter().map(moved).collect(),
            size: self.size * scale,
            ..self
        }
    }

    /// Returns the triangles. A corner is rounded once, alike for all its triangles.
    pub fn triangles<S: Scalar>(&self) -> Vec<Triangle<S>> {
        let corner = |i: usize| self.vertices[i].map(S::from_f64);
        self.faces.iter().map(|&[a, b, c]| Triangle::new(corner(a), corner(b), corner(c))).collect()
    }

    /// Returns rays from each inside point to corners and edges, and along the axes.
    ///
    /// Each edge has targets in its middle and at two random points. Each axis has rays both ways.
    pub fn rays<S: Scalar>(&self) -> Vec<Ray<S>> {
        let mut rng = Pcg64Mcg::seed_from_u64(self.faces.len() as u64);
        let mut rays = Vec::new();
        for origin in self.inside.iter().map(|point| point.map(S::from_f64)) {
            let mut toward = |x: [S; 3]| rays.push(Ray::new(origin, [0, 1, 2].map(|k| x[k] - origin[k])));
            for vertex in &self.vertices {
                toward(vertex.map(S::from_f64));
            }
            for Triangle { a, b, c } in self.triangles::<S>() {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    for weight in [0.5, rng.random_range(0.0..1.0), rng.random_range(0.0..1.0)] {
                        let (w, rest) = (S::from_f64(weight), S::from_f64(1.0 - weight));
                        toward([0, 1, 2].map(|k| from[k] * rest + to[k] * w));
                    }
                }
            }
            for axis in 0..3 {
                for length in [self.size, -self.size] {
                    let mut direction = [S::ZERO, -S::ZERO, S::ZERO];
                    direction[axis] = S::from_f64(length);
                    rays.push(Ray::new(origin, direction));
                }
            }
        }
        rays
    }
}
