//! The indexed triangle mesh, which borrows its buffers.

use super::{Barycentrics, Corners, Triangle, Watertight};
use crate::geometry::{Aabb, Ray, Scalar};
use crate::leaf::WatertightLeaf;
use crate::primitive::{Intersect, Primitive};
use core::fmt;

/// A triangle mesh that borrows its vertices and three indices per triangle.
///
/// Its triangles are hit as [`Triangle`] is. Iterating over a `&TriangleMesh` yields them in order.
/// So a tree is built from a mesh as from a list, and hits carry the index of the triangle:
///
/// ```
/// use bvhkit::{Bvh, Ray, TriangleMesh};
/// let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let triangles = [[0, 1, 2], [0, 2, 3]];
/// let mesh = TriangleMesh::new(&vertices, &triangles)?;
/// let bvh = Bvh::build(&mesh)?;
/// let hit = bvh.closest_hit(&Ray::new([0.25, 0.75, -1.0], [0.0, 0.0, 1.0])).unwrap();
/// assert_eq!((hit.index, hit.t), (1, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TriangleMesh<'a, S = f32> {
    vertices: &'a [[S; 3]],
    triangles: &'a [[u32; 3]],
}

/// The reason why buffers do not form a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshError {
    /// The index of a corner is not below the number of vertices.
    IndexOutOfRange {
        /// The index of the triangle, counted from 0.
        triangle: usize,
        /// The vertex index of the corner.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// The length of a flat buffer is not a multiple of three.
    NotTriples {
        /// The length of the buffer.
        length: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { triangle, index, vertices } => write!(
                f,
                "triangle {triangle} has vertex index {index}, but there are {vertices} vertices: \
                 indices count from 0"
            ),
            Self::NotTriples { length } => write!(
                f,
                "a flat buffer of {length} elements is not made of triples: give three coordinates \
                 per vertex and three indices per triangle"
            ),
        }
    }
}

impl core::error::Error for MeshError {}

impl<'a, S: Scalar> TriangleMesh<'a, S> {
    /// Creates the mesh of `triangles`, each three indices into `vertices`.
    ///
    /// # Errors
    ///
    /// Returns [`MeshError::IndexOutOfRange`], which names the first triangle with a bad index.
    pub fn new(vertices: &'a [[S; 3]], triangles: &'a [[u32; 3]]) -> Result<Self, MeshError> {
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertices.len()) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
            }
        }
        Ok(Self { vertices, triangles })
    }

    /// Creates a mesh from flat buffers, without a copy.
    ///
    /// `coordinates` holds x, y, z, x, ... and `indices` holds one index per corner, as in graphics
    /// interfaces and loaders.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`new`](Self::new), and [`MeshError::NotTriples`].
    pub fn from_flat(coordinates: &'a [S], indices: &'a [u32]) -> Result<Self, MeshError> {
        match (coordinates.as_chunks(), indices.as_chunks()) {
            ((vertices, []), (triangles, [])) => Self::new(vertices, triangles),
            ((_, []), _) => Err(MeshError::NotTriples { length: indices.len() }),
            _ => Err(MeshError::NotTriples { length: coordinates.len() }),
        }
    }

    /// Returns the number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Returns whether the mesh has no triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Returns an iterator over the triangles in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = MeshTriangle<'a, S>> + use<'a, S> {
        let vertices = self.vertices;
        self.triangles.iter().map(move |corners| MeshTriangle { vertices, corners })
    }
}

impl<'a, S: Scalar> IntoIterator for &TriangleMesh<'a, S> {
    type Item = MeshTriangle<'a, S>;
    type IntoIter = core::iter::Map<
        core::iter::Zip<core::slice::Iter<'a, [u32; 3]>, core::iter::Repeat<&'a [[S; 3]]>>,
        fn((&'a [u32; 3], &'a [[S; 3]])) -> MeshTriangle<'a, S>,
    >;

    fn into_iter(self) -> Self::IntoIter {
        let vertices = core::iter::repeat(self.vertices);
        self.triangles.iter().zip(vertices).map(|(corners, vertices)| MeshTriangle { vertices, corners })
    }
}

/// A triangle of a [`TriangleMesh`].
///
/// It consists of three words that refer to the mesh's buffers.
#[derive(Clone, Copy, Debug)]
pub struct MeshTriangle<'a, S = f32> {
    vertices: &'a [[S; 3]],
    corners: &'a [u32; 3],
}

impl<S: Scalar> MeshTriangle<'_, S> {
    /// Returns a triangle with copies of the corners.
    #[inline(always)]
    pub fn triangle(&self) -> Triangle<S> {
        let [a, b, c] = self.corners();
        Triangle { a, b, c }
    }
}

impl<S: Scalar> Corners for MeshTriangle<'_, S> {
    type Scalar = S;

    #[inline(always)]
    fn corners(&self) -> [[S; 3]; 3] {
        // In range: `TriangleMesh::new` checks the indices of every mesh.
        self.corners.map(|i| self.vertices[i as usize])
    }
}

impl<S: Scalar> Primitive for MeshTriangle<'_, S> {
    type Scalar = S;

    #[inline(always)]
    fn aabb(&self) -> Aabb<S> {
        Watertight(self).aabb()
    }

    #[inline(always)]
    fn aabb_of_valid(&self) -> Aabb<S> {
        Watertight(self).aabb_of_valid()
    }
}

impl<S: Scalar> Intersect for MeshTriangle<'_, S> {
    type Payload = Barycentrics<S>;
    type Leaf = WatertightLeaf;

    #[inline(always)]
    fn intersect(&self, ray: &Ray<S>) -> Option<(S, Barycentrics<S>)> {
        Watertight(self).intersect(ray)
    }

    #[inline(always)]
    fn put_operands(&self, operands: &mut [S]) {
        Watertight(self).put_operands(operands);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_index_is_named() {
        let vertices = [[0.0f32; 3]; 3];
        let error = TriangleMesh::new(&vertices, &[[0, 1, 2], [0, 3, 9]]).unwrap_err();
        assert_eq!(error, MeshError::IndexOutOfRange { triangle: 1, index: 3, vertices: 3 });
    }

    #[test]
    fn flat_buffers_are_the_same_mesh() {
        let flat = [0.0f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let mesh = TriangleMesh::from_flat(&flat, &[2, 1, 0]).unwrap();
        let triangle = mesh.iter().next().unwrap().triangle();
        assert_eq!(triangle, Triangle::new([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]));
        let cut = |coordinates, indices| TriangleMesh::from_flat(coordinates, indices).unwrap_err();
        assert_eq!(cut(&flat[..8], &[0, 0, 0]), MeshError::NotTriples { length: 8 });
        assert_eq!(cut(&flat, &[0, 1]), MeshError::NotTriples { length: 2 });
    }
}
