//! The triangle in exact arithmetic, as a primitive of trees.

use super::intersect;
use crate::geometry::{Aabb, Ray, Scalar};
use crate::leaf::OneByOne;
use crate::primitive::{Corners, Intersect, Primitive, Triangle, Watertight};

/// A triangle that is tested in exact arithmetic.
///
/// It is for tests with more triangles than [`hits`](super::hits) and the other functions can test
/// one by one. It is about a hundred times slower than the modes that renderers use.
///
/// The t of a hit is the exact one, rounded to the nearest number. Rounding keeps the order: of the
/// triangles whose rounded t is the smallest, at least one is exactly the nearest. Use
/// [`closest_hits`](super::closest_hits) of those few to find out which.
///
/// Its box is that of [`Watertight`], a little larger than the triangle. The test of that box is
/// rounded. So all this holds for coordinates and distances within the range of that mode, and a t
/// beyond the largest number is no hit.
///
/// # Examples
///
/// ```
/// use bvhkit::{Bvh, Ray, Triangle, reference::exact::{self, Exact}};
/// let fan: Vec<Triangle> = (0..100)
///     .map(|i| Triangle::new([0.1, 0.7, 0.3], [i as f32, -1.0, 0.0], [i as f32 + 1.0, -1.0, 0.0]))
///     .collect();
/// let bvh = Bvh::build(fan.iter().map(Exact))?;
///
/// // At the corner that all share.
/// let ray = Ray::new([0.1, 0.7, -2.0], [0.0, 0.0, 1.0]);
/// assert_eq!(bvh.hits(&ray).count(), 100);
/// assert_eq!(bvh.closest_hit(&ray).unwrap().t, exact::closest_hits(&fan, &ray)[0].t.to_scalar());
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exact<P>(pub P);

impl<P: Corners> Primitive for Exact<P> {
    type Scalar = P::Scalar;

    fn aabb(&self) -> Aabb<P::Scalar> {
        Watertight(&self.0).aabb()
    }
}

impl<P: Corners> Intersect for Exact<P> {
    type Payload = ();
    type Leaf = OneByOne;

    fn intersect(&self, ray: &Ray<P::Scalar>) -> Option<(P::Scalar, ())> {
        let [a, b, c] = self.0.corners();
        let t: P::Scalar = intersect(&Triangle { a, b, c }, ray)?.to_scalar();
        (t < P::Scalar::INFINITY).then_some((t, ()))
    }
}
