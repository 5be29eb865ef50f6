//! What a tree can hold: anything with bounds; and what a ray can hit.

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

/// Something with a bounding box: all that a tree needs to be built. `Sync`, for builds read it on several threads.
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
    /// `f32` or `f64`: the scalar of its coordinates, and of the rays that it meets.
    type Scalar: Scalar;

    /// The smallest box known to contain the primitive.
    ///
    /// Called several times and expected to give the same answer each time. A box with a bound
    /// that is NaN or infinite, or with a minimum above its maximum, makes the primitive invalid:
    /// see [`OnInvalid`](crate::OnInvalid).
    fn aabb(&self) -> Aabb<Self::Scalar>;

    /// [`aabb`](Self::aabb) of a primitive that is known to be valid, to the bit: each hit asks for it. For those
    /// of this crate that spend time on finding out whether they are.
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
    /// What a hit tells beside t: barycentrics, a normal, `()`.
    type Payload: Copy;

    /// How primitives of this type lie in the leaves of the wide layouts, and how they are tested there:
    /// [`OneByOne`](crate::OneByOne), or [`Sieved`](crate::Sieved) by a test in lanes. The leaves of triangles and spheres are for
    /// types that forward to those: [`intersect`](Self::intersect) is not called there, operands say all.
    type Leaf: Leaf<Self::Scalar, Self::Payload>;

    /// Returns the ray's first hit with this primitive at a t in [`ray.t_min`, `ray.t_max`], and its payload.
    ///
    /// [`Bvh::closest_hit`](crate::Bvh::closest_hit) narrows the ray: its `t_max` is that of the closest hit found so far,
    /// so that a primitive which is a hierarchy itself prunes by it.
    ///
    /// Expected to be a pure function: equal primitives and rays give equal answers. A t outside
    /// the interval, NaN or infinite is no hit. Where rounding puts t before the ray's entry into the
    /// primitive's own box, queries report the entry instead, a difference of the rounding error:
    /// by this rule the tree's answer is the naive loop's, bit for bit. For the same reason a hit within
    /// a few roundings of the interval's end may be on either side of it: to find a hit again, leave
    /// `t_min` a little below its t.
    fn intersect(&self, ray: &Ray<Self::Scalar>) -> Option<(Self::Scalar, Self::Payload)>;

    /// Writes the scalars that lie in the leaf, [`Sieve::OPERANDS`](crate::Sieve::OPERANDS) for a [`Sieved`](crate::Sieved) one;
    /// none for [`OneByOne`](crate::OneByOne).
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
// A list of them is read on several threads.
forward!(Arc<P> where P: Send);
