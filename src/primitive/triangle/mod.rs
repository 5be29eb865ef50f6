//! The triangle, alone or in a mesh, and the modes of its ray test.

mod mesh;
mod modes;
mod sheared;
mod watertight;

pub use mesh::{MeshError, MeshTriangle, TriangleMesh};
pub use modes::{Fast, Precise, Watertight};
pub(crate) use watertight::DOUBT;

use super::{Intersect, Primitive, SurfacePoint};
use crate::geometry::{Aabb, Ray, Scalar};
use crate::leaf::WatertightLeaf;

/// A flat shape with three corners.
///
/// The modes [`Fast`], [`Watertight`] and [`Precise`] make a primitive of it.
///
/// ```
/// use bvhkit::{Bvh, Corners, Ray, Watertight};
///
/// struct Face { corners: [[f64; 3]; 3], material: u16 }
///
/// impl Corners for Face {
///     type Scalar = f64;
///     fn corners(&self) -> [[f64; 3]; 3] {
///         self.corners
///     }
/// }
///
/// let face = Face { corners: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material: 7 };
/// let bvh = Bvh::build([Watertight(face)])?;
/// let hit = bvh.closest_hit(&Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0])).unwrap();
/// assert_eq!(bvh.primitive(hit.index).0.material, 7);
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
pub trait Corners: Sync {
    /// The scalar of the coordinates: `f32` or `f64`.
    type Scalar: Scalar;

    /// Returns the corners where u = v = 0, u = 1 and v = 1 (see [`Barycentrics`]).
    ///
    /// It must return the same corners each time.
    fn corners(&self) -> [[Self::Scalar; 3]; 3];

    /// Returns the point with the barycentrics `at`, to start rays from.
    ///
    /// For a hit, `at` is its payload. The point `ray.at(hit.t)` may be far off the surface.
    ///
    /// The point is computed in `f64` for both scalars. Its error is one rounding of the position,
    /// plus 2^18 epsilon of `f64` (6e-11) times the triangle's largest extent. [`Watertight`] and
    /// [`Precise`] decide in `f64` on which side of the triangle a ray starts. In these modes the
    /// error is large enough for triangles 10,000 times as long as wide. [`Fast`] in `f32` decides
    /// in `f32`, and may hit the triangle again at grazing angles.
    fn surface_point(&self, at: Barycentrics<Self::Scalar>) -> SurfacePoint<Self::Scalar> {
        SurfacePoint::of_triangle(self.corners(), at)
    }
}

impl<P: Corners + ?Sized> Corners for &P {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn corners(&self) -> [[P::Scalar; 3]; 3] {
        (**self).corners()
    }
}

/// A triangle that owns its three corners. Both sides are hit.
///
/// By itself it is tested in [`Watertight`] mode. [`Fast`] and [`Precise`] wrap it:
/// `triangles.iter().map(Precise)`.
///
/// ```
/// use bvhkit::{Bvh, Ray, Triangle};
/// let floor = Triangle::new([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
/// let bvh = Bvh::build([floor])?;
/// let hit = bvh.closest_hit(&Ray::new([1.0, 3.0, 2.0], [0.0, -1.0, 0.0])).unwrap();
/// assert_eq!((hit.t, hit.payload.u, hit.payload.v), (3.0, 0.25, 0.5));
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<S = f32> {
    /// The corner where u = v = 0.
    pub a: [S; 3],
    /// The corner where u = 1.
    pub b: [S; 3],
    /// The corner where v = 1.
    pub c: [S; 3],
}

/// The position of a hit on a triangle.
///
/// The hit is the point (1 - u - v) a + u b + v c. The weights u, v and 1 - u - v are in [0,
/// 1] up to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barycentrics<S = f32> {
    /// The weight of corner b.
    pub u: S,
    /// The weight of corner c.
    pub v: S,
}

impl<S: Scalar> Triangle<S> {
    /// Creates the triangle with corners `a`, `b` and `c`.
    #[inline(always)]
    pub fn new(a: impl Into<[S; 3]>, b: impl Into<[S; 3]>, c: impl Into<[S; 3]>) -> Self {
        Self { a: a.into(), b: b.into(), c: c.into() }
    }
}

impl<S: Scalar> Corners for Triangle<S> {
    type Scalar = S;

    #[inline(always)]
    fn corners(&self) -> [[S; 3]; 3] {
        [self.a, self.b, self.c]
    }
}

impl<S: Scalar> Primitive for Triangle<S> {
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

impl<S: Scalar> Intersect for Triangle<S> {
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
