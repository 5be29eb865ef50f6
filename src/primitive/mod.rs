//! Primitives: shapes with bounds, and those of them that rays can hit.

mod aabb;
mod accept;
mod sphere;
mod surface_point;
mod triangle;

pub(crate) use accept::{accept, precedes};
pub use sphere::Sphere;
pub use surface_point::SurfacePoint;
pub(crate) use triangle::DOUBT;
pub use triangle::{
    Barycentrics, Corners, Fast, MeshError, MeshTriangle, Precise, Triangle, TriangleMesh, Watertight,
};

use crate::geometry::{Aabb, Ray, Scalar};
use crate::leaf::Leaf;
use alloc::boxed::Box;
use alloc::sync::Arc;

/// A shape with a bounding box, which is all that a tree needs to be built.
///
/// Primitives are `Sync`, since builds read them on several threads.
///
/// ```
/// use bvhkit::{Aabb, Primitive};
///
/// struct Particle { position: [f32; 3], size: f32 }
///
/// impl Primitive for Particle {
///     type Scalar = f32;
///     fn aabb(&self) -> Aabb {
///         Aabb::new(self.position.map(|x| x - self.size), self.position.map(|x| x + self.size))
///     }
/// }
/// ```
pub trait Primitive: Sync {
    /// The scalar of its coordinates and of the rays that it meets: `f32` or `f64`.
    type Scalar: Scalar;

    /// Returns the smallest box known to contain the primitive.
    ///
    /// It is called several times and must give the same answer each time. If a bound is NaN or
    /// infinite, or a minimum exceeds its maximum, the primitive is invalid: see
    /// [`OnInvalid`](crate::OnInvalid).
    fn aabb(&self) -> Aabb<Self::Scalar>;

    /// Returns the bits of [`aabb`](Self::aabb), for a primitive known to be valid.
    ///
    /// Each hit asks for this box. Primitives of this crate override the method where `aabb` spends
    /// time on a check of validity.
    #[doc(hidden)]
    fn aabb_of_valid(&self) -> Aabb<Self::Scalar> {
        self.aabb()
    }
}

/// A primitive that rays can hit.
///
/// ```
/// use bvhkit::{Aabb, Bvh, Intersect, OneByOne, Primitive, Ray};
///
/// /// A disc in the plane z = height.
/// struct Disc { center: [f32; 2], height: f32, radius: f32 }
///
/// impl Primitive for Disc {
///     type Scalar = f32;
///     fn aabb(&self) -> Aabb {
///         let ([x, y], z, r) = (self.center, self.height, self.radius);
///         Aabb::new([x - r, y - r, z], [x + r, y + r, z])
///     }
/// }
///
/// impl Intersect for Disc {
///     type Payload = f32; // the distance from the disc's center
///     type Leaf = OneByOne; // how discs lie in a leaf
///     fn intersect(&self, ray: &Ray) -> Option<(f32, f32)> {
///         let t = (self.height - ray.origin[2]) / ray.direction[2];
///         let [x, y, _] = ray.at(t);
///         let distance = (x - self.center[0]).hypot(y - self.center[1]);
///         (distance <= self.radius).then_some((t, distance))
///     }
/// }
///
/// let discs: Vec<Disc> =
///     (0..100).map(|i| Disc { center: [i as f32, 0.0], height: 1.0, radius: 0.4 }).collect();
/// let bvh = Bvh::build(&discs)?;
/// let hit = bvh.closest_hit(&Ray::new([7.25, 0.0, -1.0], [0.0, 0.0, 1.0])).unwrap();
/// assert_eq!((hit.index, hit.t, hit.payload), (7, 2.0, 0.25));
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
pub trait Intersect: Primitive {
    /// The data of a hit besides t: barycentrics, a normal, `()`.
    type Payload: Copy;

    /// The kind of leaf that stores and tests these primitives in the wide layouts.
    ///
    /// Use [`OneByOne`](crate::OneByOne), or [`Sieved`](crate::Sieved) to exclude primitives by a
    /// test in lanes. The leaves of triangles and spheres are for types that forward to a triangle
    /// or a sphere. Their operands hold the whole primitive, so [`intersect`](Self::intersect) is
    /// not called there.
    type Leaf: Leaf<Self::Scalar, Self::Payload>;

    /// Returns t and the payload of the ray's first hit with this primitive.
    ///
    /// A hit's t must be in [`ray.t_min`, `ray.t_max`].
    /// [`Bvh::closest_hit`](crate::Bvh::closest_hit) narrows the ray: its `t_max` is that of the
    /// closest hit found so far, so that a primitive which is a hierarchy itself prunes by it.
    ///
    /// This must be a pure function: equal primitives and rays give equal answers. A t outside the
    /// interval, NaN or infinite is no hit.
    ///
    /// Rounding may put t before the ray's entry into the primitive's own box. Then queries report
    /// the entry instead, which differs from t by the rounding error. By this rule the tree's
    /// answer is the naive loop's, bit for bit. For the same reason a hit within a few roundings of
    /// the interval's end may be on either side of that end: to find a hit again, leave `t_min` a
    /// little below its t.
    fn intersect(&self, ray: &Ray<Self::Scalar>) -> Option<(Self::Scalar, Self::Payload)>;

    /// Writes the scalars that the leaf stores for this primitive.
    ///
    /// A [`Sieved`](crate::Sieved) leaf stores [`Sieve::OPERANDS`](crate::Sieve::OPERANDS) scalars,
    /// a [`OneByOne`](crate::OneByOne) leaf none.
    fn put_operands(&self, _operands: &mut [Self::Scalar]) {}
}

macro_rules! forward {
    ($pointer:ty $(where P: $($bound:path),*)?) => {
        impl<P: Primitive + ?Sized $($(+ $bound)*)?> Primitive for $pointer {
            type Scalar = P::Scalar;
            #[inline(always)]
            fn aabb(&self) -> Aabb<P::Scalar> {
                (**self).aabb()
            }
            #[inline(always)]
            fn aabb_of_valid(&self) -> Aabb<P::Scalar> {
                (**self).aabb_of_valid()
            }
        }

        impl<P: Intersect + ?Sized $($(+ $bound)*)?> Intersect for $pointer {
            type Payload = P::Payload;
            type Leaf = P::Leaf;
            #[inline(always)]
            fn intersect(&self, ray: &Ray<P::Scalar>) -> Option<(P::Scalar, P::Payload)> {
                (**self).intersect(ray)
            }
            #[inline(always)]
            fn put_operands(&self, operands: &mut [P::Scalar]) {
                (**self).put_operands(operands);
            }
        }
    };
}

forward!(&P);
forward!(Box<P>);
// Lists are read on several threads, and `Arc<P>` is `Sync` only if `P` is `Send`.
forward!(Arc<P> where P: Send);
