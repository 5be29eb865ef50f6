//! The ray test in the ray's frame, without a second look.

use super::Barycentrics;
use crate::geometry::{RayFrame, Scalar, cross, dot, max, min};

/// t and the weights of the ray's hit with a triangle (Woop, Benthin and Wald, Watertight Ray/Triangle
/// Intersection, JCGT 2013): in the ray's frame, where the ray is the third axis, its point lies in
/// the triangle if it is on the same side of all three edges. Both sides are hit.
///
/// The side of an edge is the sign of a difference of two products, and zero counts as inside.
///
/// Refused, on three scenes: Moller and Trumbore's test, its products grouped around the normal (4 % faster
/// to 17 % slower); an affine map to the unit triangle computed beforehand (Baldwin and Weber, JCGT
/// 2016), which takes twice the memory (1 to 30 % slower). Three lanes for three corners suit one
/// triangle at a time best.
#[inline(always)]
pub(super) fn sheared<S: Scalar>(corners: [[S; 3]; 3], shear: &RayFrame<S>) -> Option<(S, Barycentrics<S>)> {
    // Without area, t is NaN and no hit.
    Sight::new(corners, shear).map(|sight| sight.hit(shear))
}

/// A triangle around the ray's point, as far as rounding tells, in the ray's frame.
pub(super) struct Sight<S: Scalar> {
    /// First, second and third coordinates of the three corners.
    pub corners: [[S; 3]; 3],
    /// The corners' weights, times the area.
    pub weights: [S; 3],
    pub area: S,
    /// The depth of the hit, times the area.
    pub volume: S,
}

impl<S: Scalar> Sight<S> {
    /// None if the ray passes outside.
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

    /// t and the weights.
    #[inline(always)]
    pub fn hit(&self, shear: &RayFrame<S>) -> (S, Barycentrics<S>) {
        let Self { weights: [_, b, c], area, volume, .. } = *self;
        (shear.t(volume / area), Barycentrics { u: b / area, v: c / area })
    }
}

/// On different sides of two edges. A NaN may hide a side, but does not make one up.
#[inline(always)]
pub(super) fn is_outside<S: Scalar>([a, b, c]: [S; 3]) -> bool {
    min(min(a, b), c) < S::ZERO && max(max(a, b), c) > S::ZERO
}
