//! A point on a surface, and rays that start there without hitting the surface.

use super::Barycentrics;
use crate::geometry::{Ray, Scalar, cross, dot, max};

/// A point on a surface, from which rays start without hitting the surface.
///
/// [`Corners::surface_point`](crate::Corners::surface_point) and
/// [`Sphere::surface_point`](crate::Sphere::surface_point) return one. For a primitive of your own,
/// fill in the three fields.
///
/// ```
/// use bvhkit::{Bvh, Corners, Ray, Triangle};
/// let floor = Triangle::new([0.1, 0.7, 0.3], [900.1, 0.7, 0.3], [0.1, 0.7, 900.3]);
/// let bvh = Bvh::build([floor])?;
/// let hit = bvh.closest_hit(&Ray::new([30.0, 20.0, 10.0], [0.3, -0.9, 0.2])).unwrap();
/// let point = bvh.primitive(hit.index).surface_point(hit.payload);
/// let [up, along, down] = [[0.0, 1.0, 0.0], [1.0, 1e-5, 0.0], [0.0, -1.0, 0.0]];
/// assert!(![up, along, down].into_iter().any(|direction| bvh.any_hit(&point.spawn(direction))));
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<S = f32> {
    /// The position of the point, rounded.
    pub position: [S; 3],
    /// The normal of the surface, of length 1, on either side; zero if there is none.
    pub normal: [S; 3],
    /// The distance from `position`, on each axis, at which a ray must start.
    ///
    /// At this distance no rounding puts the surface in front of the ray: neither the rounding of
    /// the position nor that of the ray test.
    pub error: [S; 3],
}

impl<S: Scalar> SurfacePoint<S> {
    pub(super) fn of_triangle(corners: [[S; 3]; 3], at: Barycentrics<S>) -> Self {
        let [a, b, c] = corners.map(widened);
        let (edge1, edge2, edge3) = (difference(b, a), difference(c, a), difference(c, b));
        let (u, v) = (at.u.to_f64(), at.v.to_f64());
        let position = [0, 1, 2].map(|axis| a[axis] + edge1[axis] * u + edge2[axis] * v);
        let largest = [edge1, edge2, edge3].as_flattened().iter().fold(0.0, |most, x| max(x.abs(), most));
        // Scaled, so that no square leaves the range.
        let normal = unit(cross(edge1.map(|x| x / largest), edge2.map(|x| x / largest)));
        // The `Watertight` and `Precise` tests decide in `f64`, for both scalars, on which side
        // of the triangle a ray starts. 3,000,000 random triangles and directions need more
        // than 2^14 epsilon.
        let test = f64::from(1 << 18) * f64::EPSILON * largest;
        let position = position.map(S::from_f64);
        let error = position.map(|x| S::EPSILON * x.abs() + S::from_f64(test));
        Self { position, normal: normal.map(S::from_f64), error }
    }

    /// Returns the point of a sphere that is nearest to `position`.
    pub(super) fn of_sphere(center: [S; 3], radius: S, position: [S; 3]) -> Self {
        let (center, radius) = (widened(center), radius.to_f64());
        let normal = unit(difference(widened(position), center));
        let position = [0, 1, 2].map(|axis| S::from_f64(center[axis] + normal[axis] * radius));
        // The ray test subtracts the square of the radius from the square of the distance.
        let test = S::from_f64(8.0 * radius) * S::EPSILON;
        Self {
            position,
            normal: normal.map(S::from_f64),
            error: position.map(|x| S::EPSILON * x.abs() + test),
        }
    }

    /// Returns a ray in `direction` that starts off the surface and does not hit it.
    ///
    /// The ray starts on the side of the surface that `direction` points to, as close to the
    /// surface as it can without hitting it. Its t is in [0, infinity].
    ///
    /// The start is moved from the point along the normal until it is out of the box of `error`,
    /// then away from the surface to the next number on each axis (Pharr, Jakob and Humphreys,
    /// Physically Based Rendering, 4th edition, 6.8.6).
    ///
    /// `direction` must rise from the surface by more than 1e-6 of its length in `f32`. Below that,
    /// the rounding of the normal and of the direction decides which side is meant.
    ///
    /// In [`Watertight`](crate::Watertight) and [`Precise`](crate::Precise) mode, 0 of 2,961,717
    /// rays hit the triangle that they leave. [`Fast`](crate::Fast) has such hits (measured:
    /// docs/decisions.md, 34).
    #[must_use]
    pub fn spawn(&self, direction: impl Into<[S; 3]>) -> Ray<S> {
        let direction = direction.into();
        let (n, e) = (self.normal, self.error);
        let along = n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2];
        let distance = n[0].abs() * e[0] + n[1].abs() * e[1] + n[2].abs() * e[2];
        // Refused: the offset of Wachter and Binder (A Fast and Robust Method for Avoiding
        // Self-Intersection, Ray Tracing Gems, 2019), and the error bound that the book derives for
        // interpolation in `f32`. Both start rays farther from the surface and gain nothing in the
        // modes without such hits (measured: docs/decisions.md, 34).
        let origin = [0, 1, 2].map(|axis| {
            let offset = (n[axis] * distance).xor_sign(along);
            let moved = self.position[axis] + offset;
            if offset > S::ZERO {
                moved.next_up()
            } else if offset < S::ZERO {
                moved.next_down()
            } else {
                moved
            }
        });
        Ray::new(origin, direction)
    }
}

fn widened<S: Scalar>(point: [S; 3]) -> [f64; 3] {
    point.map(S::to_f64)
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the vector of length 1 in the same direction; zero if there is none.
fn unit(vector: [f64; 3]) -> [f64; 3] {
    let inverse = 1.0 / Scalar::sqrt(dot(vector, vector));
    if inverse.is_finite() && inverse > 0.0 { vector.map(|x| x * inverse) } else { [0.0; 3] }
}
