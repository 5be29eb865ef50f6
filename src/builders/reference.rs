//! The references that builders sort in place of primitives.

use crate::geometry::{Aabb, Axis, Scalar};
use crate::simd::{Backend, Kernel, Lanes};
use crate::simd::{Isa, KernelLanes};

/// A reference to a primitive: its box and its index.
///
/// Builders and heuristics see nothing else of a primitive.
// Aligned, so that a reference is copied in whole registers. Otherwise partitioning reads
// back parts of other sizes than it has written, and waits for the cache each time (a
// third of the build).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct PrimRef<S = f32> {
    /// The primitive's box.
    pub aabb: Aabb<S>,
    /// The primitive's index in the input.
    pub index: u32,
    /// Explicit padding, so that a reference is copied without gaps.
    padding: u32,
}

/// The reason why the box of a primitive is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InvalidBox {
    /// A bound of its box is NaN.
    NanBox,
    /// A bound of its box is infinite.
    InfiniteBox,
    /// Its box has a minimum above its maximum.
    InvertedBox,
}

impl<S: Scalar> PrimRef<S> {
    /// Makes a reference to a primitive from its box and its index in the input.
    ///
    /// Use it to try a heuristic by itself.
    #[inline(always)]
    pub fn new(aabb: Aabb<S>, index: u32) -> Self {
        Self { aabb, index, padding: 0 }
    }

    /// Returns the box's minimum and maximum, each in the first three of four lanes.
    ///
    /// The fourth lane of the minimum is another scalar of the box, that of the maximum is zero.
    /// The index is stored after the maximum: as a floating-point number it is subnormal, and
    /// arithmetic with subnormal numbers is slow.
    #[inline(always)]
    pub(super) fn corners<I: Isa>(&self, isa: I) -> [S::Times4<I>; 2] {
        let Aabb { min: [a, b, c], max: [x, y, z] } = self.aabb;
        [[a, b, c, x], [x, y, z, S::ZERO]].map(|corner| S::Times4::from_slice(isa, &corner))
    }

    /// Returns the middle of the box, which decides the primitive's side of a split.
    #[inline(always)]
    pub fn centroid(&self) -> [S; 3] {
        self.aabb.center()
    }

    /// Returns one coordinate of the centroid.
    #[inline(always)]
    pub(super) fn middle(&self, axis: Axis) -> S {
        let axis = axis.index();
        self.aabb.min[axis] * S::HALF + self.aabb.max[axis] * S::HALF
    }

    /// Returns the reason why the box is invalid; `None` if it is valid.
    pub(crate) fn invalid_box(&self) -> Option<InvalidBox> {
        let aabb = &self.aabb;
        if aabb.is_valid() {
            return None;
        }
        let bounds = || aabb.min.iter().chain(&aabb.max);
        Some(if bounds().any(|x| x.is_nan()) {
            InvalidBox::NanBox
        } else if aabb.is_empty() {
            InvalidBox::InvertedBox
        } else {
            InvalidBox::InfiniteBox
        })
    }
}

/// Returns the box around the centroids of references.
pub(super) fn centroids<S: Scalar>(references: &[PrimRef<S>]) -> Aabb<S> {
    references.iter().fold(Aabb::EMPTY, |all, reference| all.grow(reference.centroid()))
}

/// Returns the box around references; [`Aabb::EMPTY`] if there are none.
pub(super) fn bounds<'r, S: Scalar>(references: impl IntoIterator<Item = &'r PrimRef<S>>) -> Aabb<S> {
    Backend::best().run(Bounds(references))
}

struct Bounds<R>(R);

impl<'r, S: Scalar, R: IntoIterator<Item = &'r PrimRef<S>>> Kernel for Bounds<R> {
    const IS_WIDE: bool = false;
    type Output = Aabb<S>;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Aabb<S> {
        let (mut min, mut max) = (S::Times4::splat(isa, S::INFINITY), S::Times4::splat(isa, S::NEG_INFINITY));
        for reference in self.0 {
            let [low, high] = reference.corners::<I>(isa);
            (min, max) = (low.min(min), high.max(max));
        }
        Aabb { min: three(min), max: three(max) }
    }
}

/// Returns the first three lanes.
#[inline(always)]
pub(super) fn three<S: Scalar>(lanes: impl Lanes<S>) -> [S; 3] {
    [lanes.lane(0), lanes.lane(1), lanes.lane(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_all_boxes() {
        let reference = |x: f32| PrimRef::new(Aabb::new([x - 1.0; 3], [x + 1.0; 3]), 0);
        assert_eq!(bounds(&[reference(0.0), reference(5.0)]), Aabb::new([-1.0; 3], [6.0; 3]));
        assert_eq!(bounds::<f64>(&[]), Aabb::EMPTY);
    }
}
