//! The frame of a ray: what a point looks like from behind the ray.

use super::{Scalar, Vector};

/// The frame in which a ray starts at the origin and runs along the third axis: a shift, a permutation
/// of the axes and a shear (Woop, Benthin and Wald, Watertight Ray/Triangle Intersection, JCGT 2013).
/// No rotation, so a point's coordinates take but a few roundings.
///
/// The axis on which the direction is largest becomes the third. The paper divides by the direction
/// there; here the other two coordinates are multiplied by it instead, and are that much larger: of
/// small whole numbers, and in `f64` of most `f32`, nothing is rounded then, and an edge is met exactly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear<S> {
    origin: [S; 3],
    /// Which axes of space become the first, the second and the third.
    axes: [usize; 3],
    /// The direction on these axes, scaled by a power of two to about 1, so that products with it
    /// neither overflow nor underflow.
    direction: [S; 3],
    /// The direction on the third, unscaled.
    forward: S,
}

impl<S: Scalar> Shear<S> {
    #[inline(always)]
    pub fn new(origin: [S; 3], direction: [S; 3]) -> Self {
        let [x, y, z] = direction.map(S::abs);
        // The other two in either order: both sides of a triangle are hit.
        let axes = if x >= y && x >= z {
            [1, 2, 0]
        } else if y >= z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let direction = axes.map(|axis| direction[axis]);
        let forward = direction[2];
        let scale = (S::ONE / forward).power_of_two();
        Self { origin, axes, direction: direction.map(|x| x * scale), forward }
    }

    /// Three points in the ray's frame, one in each lane of the vectors: their first, second and third
    /// coordinates.
    ///
    /// Each point's coordinates are a function of the point and the ray alone, whatever the lane and
    /// whatever the other two: triangles that share a corner agree about it.
    #[inline(always)]
    pub fn apply(&self, [a, b, c]: [[S; 3]; 3]) -> [S::Vec3; 3] {
        let lanes = |axis: usize| {
            let origin = self.origin[axis];
            S::Vec3::from_array([a[axis], b[axis], c[axis]]) - S::Vec3::from_array([origin; 3])
        };
        let [x, y, z] = self.axes.map(lanes);
        let [dx, dy, dz] = self.direction;
        [x * dz - z * dx, y * dz - z * dy, z]
    }

    /// The t at a third coordinate.
    #[inline(always)]
    pub fn t(&self, z: S) -> S {
        z / self.forward
    }
}
