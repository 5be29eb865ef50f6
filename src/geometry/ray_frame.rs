//! The frame of a ray: coordinates in which the ray is the third axis.

use super::{Axis, Ray, Scalar};

/// The frame in which a ray starts at the origin and runs along the third axis.
///
/// The frame is a shift, a permutation of the axes and a shear (Woop, Benthin and Wald,
/// Watertight Ray/Triangle Intersection, JCGT 2013). It has no rotation, so a point's coordinates
/// take only a few roundings.
///
/// The axis on which the direction is largest becomes the third. The paper divides by the direction
/// on that axis. Here the other two coordinates are multiplied by it instead, and are that much
/// larger. Then nothing is rounded for small whole numbers, and in `f64` for most `f32` numbers, so
/// an edge is met exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayFrame<S> {
    /// The origin of the ray, in the order of `axes`.
    pub origin: [S; 3],
    /// The axes of space that become the first, the second and the third.
    pub axes: [Axis; 3],
    /// The direction in the order of `axes`, scaled by a power of two to about 1.
    ///
    /// Products with the scaled direction do not overflow, and lose nothing to underflow unless a
    /// factor is far smaller than the other coordinates.
    pub direction: [S; 3],
    /// The unscaled direction on the third axis.
    pub forward: S,
}

/// For each axis, the order of the axes that ends with it.
const ORDERS: [[Axis; 3]; 3] =
    [[Axis::Y, Axis::Z, Axis::X], [Axis::Z, Axis::X, Axis::Y], [Axis::X, Axis::Y, Axis::Z]];

impl<S: Scalar> RayFrame<S> {
    #[inline(always)]
    pub fn of(ray: &Ray<S>) -> Self {
        Self::new(&ray.origin, &ray.direction)
    }

    /// Returns the frame of the same ray in the wide scalar.
    #[inline(always)]
    pub fn widened(ray: &Ray<S>) -> RayFrame<S::Wide> {
        let widen = |[x, y, z]: &[S; 3]| [x.widen(), y.widen(), z.widen()];
        RayFrame::new(&widen(&ray.origin), &widen(&ray.direction))
    }

    #[inline(always)]
    pub fn new(origin: &[S; 3], direction: &[S; 3]) -> Self {
        let [x, y, z] = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        // Without a branch: the processor cannot predict which axis is largest.
        let (is_x, is_y) = ((x >= y) & (x >= z), y >= z);
        // The other two axes in either order: both sides of a triangle are hit.
        let axes = ORDERS[usize::from(!is_x) * (2 - usize::from(is_y))];
        let (i, j, k) = (axes[0].index(), axes[1].index(), axes[2].index());
        let forward = direction[k];
        let scale = forward.inverse_power_of_two();
        Self {
            origin: [origin[i], origin[j], origin[k]],
            axes,
            direction: [direction[i] * scale, direction[j] * scale, forward * scale],
            forward,
        }
    }

    /// Returns the first, second and third coordinates of three points in the frame.
    ///
    /// Each point's coordinates depend on the point and the ray alone, whatever the lane and
    /// whatever the other two points. So triangles that share a corner agree about it.
    #[inline(always)]
    pub fn apply(&self, [a, b, c]: [[S; 3]; 3]) -> [[S; 3]; 3] {
        let relative = |k: usize| {
            let (axis, origin) = (self.axes[k].index(), self.origin[k]);
            [a[axis] - origin, b[axis] - origin, c[axis] - origin]
        };
        let (x, y, z) = (relative(0), relative(1), relative(2));
        let [dx, dy, dz] = self.direction;
        [
            [x[0] * dz - z[0] * dx, x[1] * dz - z[1] * dx, x[2] * dz - z[2] * dx],
            [y[0] * dz - z[0] * dy, y[1] * dz - z[1] * dy, y[2] * dz - z[2] * dy],
            z,
        ]
    }

    /// Returns the t at the third coordinate `z`.
    #[inline(always)]
    pub fn t(&self, z: S) -> S {
        z / self.forward
    }
}
