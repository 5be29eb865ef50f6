//! The triangle test in the ray's frame, without a second test.

use super::Barycentrics;
use crate::geometry::{RayFrame, Scalar, cross, dot, max, min};

/// Returns t and the weights of the ray's hit with a triangle.
///
/// The test is that of Woop, Benthin and Wald (Watertight Ray/Triangle Intersection, JCGT 2013). In
/// the ray's frame, the ray is the third axis. The ray's point is in the triangle if it is on the
/// same side of all three edges. Both sides of the triangle are hit.
///
/// The side of an edge is the sign of a difference of two products, and zero counts as inside.
///
/// Refused, on three scenes: the test of Moller and Trumbore, with its products grouped around
/// the normal (4 % faster to 17 % slower). Also refused: an affine map to the unit triangle,
/// computed beforehand (Baldwin and Weber, JCGT 2016), which takes twice the memory and is
/// slower (measured: docs/decisions.md, 37). Three lanes for three corners suit one
/// triangle at a time best.
#[inline(always)]
pub(super) fn sheared<S: Scalar>(corners: [[S; 3]; 3], shear: &RayFrame<S>) -> Option<(S, Barycentrics<S>)> {
    // Without area, t is NaN, which is no hit.
    Sight::new(corners, shear).map(|sight| sight.hit(shear))
}

/// A triangle that contains the ray's point, as far as rounding tells.
///
/// All coordinates are in the ray's frame.
pub(super) struct Sight<S: Scalar> {
    /// The first, second and third coordinates of the three corners.
    pub corners: [[S; 3]; 3],
    /// The weights of the corners, times the area.
    pub weights: [S; 3],
    pub area: S,
    /// The depth of the hit, times the area.
    pub volume: S,
}

impl<S: Scalar> Sight<S> {
    /// Computes the weights. Returns `None` if the ray passes outside.
    #[inline(always)]
    pub fn new(corners: [[S; 3]; 3], shear: &RayFrame<S>) -> Option<Self> {
        let [x, y, z] = shear.apply(corners);
        let weights = cross(x, y);
        if is_outside(weights) {
            return None;
        }
        let [a, b, c] = weights;
        Some(Self { corners: [x, y, z], weights, area: a + b + c, volume: dot(weights, z) })
    }

    /// Returns t and the weights of the hit.
    #[inline(always)]
    pub fn hit(&self, shear: &RayFrame<S>) -> (S, Barycentrics<S>) {
        let Self { weights: [_, b, c], area, volume, .. } = *self;
        (shear.t(volume / area), Barycentrics { u: b / area, v: c / area })
    }
}

/// Returns whether the point is on different sides of two edges.
///
/// A NaN may hide a side, but does not add one.
#[inline(always)]
pub(super) fn is_outside<S: Scalar>([a, b, c]: [S; 3]) -> bool {
    min(min(a, b), c) < S::ZERO && max(max(a, b), c) > S::ZERO
}
