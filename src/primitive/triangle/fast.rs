//! The fast ray test.

use super::Barycentrics;
use super::watertight::is_outside;
use crate::geometry::{Scalar, Shear, Vector};

/// As [`watertight`](super::watertight::watertight), but what is not settled by the signs of rounded
/// differences is left at that, and the division is one.
///
/// Refused, on three scenes: Moller and Trumbore's test, its products grouped around the normal (4 % faster
/// to 17 % slower); an affine map to the unit triangle computed beforehand (Baldwin and Weber, JCGT
/// 2016), which takes twice the memory (1 to 30 % slower). Three lanes for three corners suit one
/// triangle at a time best.
#[inline(always)]
pub(super) fn fast<S: Scalar>(corners: [[S; 3]; 3], shear: &Shear<S>) -> Option<(S, Barycentrics<S>)> {
    let [x, y, z] = shear.apply(corners);
    let weights = x.cross(y);
    let [a, b, c] = weights.to_array();
    if is_outside([a, b, c]) {
        return None;
    }
    // Without area this is infinite, and t NaN.
    let scale = S::ONE / (a + b + c);
    Some((shear.t(weights.dot(z) * scale), Barycentrics { u: b * scale, v: c * scale }))
}
