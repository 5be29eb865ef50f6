//! Meshes, whether they are closed, and their places.

use crate::closed;
use bvhkit::Triangle;
use std::collections::HashMap;
use std::fmt;

/// A mesh; corners that triangles share are equal bit for bit.
#[derive(Clone)]
pub struct Mesh {
    pub name: String,
    pub triangles: Vec<Triangle>,
    /// Whether every edge belongs to an even number of triangles.
    ///
    /// Then no ray that starts inside leaves without a hit.
    pub is_closed: bool,
}

impl Mesh {
    pub fn new(name: impl Into<String>, triangles: Vec<Triangle>) -> Self {
        Self { name: name.into(), is_closed: is_closed(&triangles), triangles }
    }

    /// Returns the mesh at a place, rounded to `f32`; equal corners stay equal.
    pub fn placed(&self, place: Place) -> Vec<Triangle> {
        closed::placed(&self.triangles, place.scale, place.offset)
    }
}

/// A place for a mesh: a scale, then a shift.
///
/// Far from the origin, coordinates are coarse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub scale: f64,
    pub offset: f64,
}

impl Place {
    /// The place of a mesh as made: about 1 in size, around the origin.
    pub const HOME: Self = Self { scale: 1.0, offset: 0.0 };
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scale, offset } = self;
        write!(f, "size {scale:e} at {offset:e}")
    }
}

/// Returns whether every edge belongs to an even number of triangles.
///
/// Edges are compared by the bits of their ends, in either order. Edges of no length do not count.
fn is_closed(triangles: &[Triangle]) -> bool {
    let mut uses: HashMap<[[u32; 3]; 2], usize> = HashMap::new();
    for triangle in triangles {
        // -0 and +0 are the same coordinate.
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.map(|x| (x + 0.0).to_bits()));
        for (p, q) in [(a, b), (b, c), (c, a)].into_iter().filter(|(p, q)| p != q) {
            *uses.entry([p.min(q), p.max(q)]).or_default() += 1;
        }
    }
    uses.values().all(|uses| uses % 2 == 0)
}

/// Tests [`is_closed`]. Every run of the bench calls it: there is no test harness.
pub fn check() {
    for (name, mesh) in closed::all(200) {
        assert!(is_closed(&mesh), "every edge of the {name} is shared");
        assert!(!is_closed(&mesh[1..]), "a hole in the {name} is seen");
    }
}
