//! The frame of a ray: what the ray looks like from behind.

use super::{Scalar, Vector};

/// The frame in which the ray starts at the origin and runs along the third axis, by a permutation
/// of the axes, a shift and a shear (Woop, Benthin and Wald, Watertight Ray/Triangle Intersection,
/// JCGT 2013): no rotation, so that each coordinate takes but a few roundings.
///
/// The axis on which the direction is largest becomes the third, so that no division is by less than
/// the others' numerators and |x|, |y| <= 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear<S> {
    origin: [S; 3],
    /// Which axes of space become the first, the second and the third.
    axes: [usize; 3],
    /// How far along the first and the second the direction gets on one unit of the third, and what
    /// t that unit is.
    x: S,
    y: S,
    z: S,
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
        let [dx, dy, dz] = axes.map(|axis| direction[axis]);
        Self { origin, axes, x: dx / dz, y: dy / dz, z: S::ONE / dz }
    }

    /// Three points in the ray's frame, one in each lane of the three vectors: their first, second and
    /// third coordinates.
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
        [x - z * self.x, y - z * self.y, z]
    }

    /// The t at a third coordinate.
    #[inline(always)]
    pub fn t(&self, z: S) -> S {
        z * self.z
    }
}
