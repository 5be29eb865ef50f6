//! What builders sort instead of primitives.

use crate::geometry::{Aabb, Scalar};
use crate::primitive::Primitive;

/// A reference to a primitive: its box, its centroid, its index. All that heuristics see of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimRef<S = f32> {
    /// The primitive's box.
    pub aabb: Aabb<S>,
    /// The point that decides on which side of a split the primitive goes.
    pub centroid: [S; 3],
    /// The primitive's index in the input.
    pub index: u32,
}

/// What is wrong with a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// A bound of its box is NaN.
    NanBox,
    /// A bound of its box is infinite.
    InfiniteBox,
    /// Its box has a minimum above its maximum.
    InvertedBox,
    /// Its centroid has a NaN or an infinity.
    Centroid,
}

impl<S: Scalar> PrimRef<S> {
    /// The reference to a primitive.
    pub(crate) fn new<P: Primitive<Scalar = S>>(primitive: &P, index: u32) -> Self {
        Self { aabb: primitive.aabb(), centroid: primitive.centroid(), index }
    }

    /// What makes the primitive invalid, if anything does.
    pub(crate) fn flaw(&self) -> Option<Flaw> {
        let Self { aabb, centroid, .. } = self;
        if aabb.is_valid() {
            return if centroid.iter().all(|x| x.is_finite()) { None } else { Some(Flaw::Centroid) };
        }
        let bounds = || aabb.min.iter().chain(&aabb.max);
        Some(if bounds().any(|x| x.is_nan()) {
            Flaw::NanBox
        } else if aabb.is_empty() {
            Flaw::InvertedBox
        } else {
            Flaw::InfiniteBox
        })
    }
}

/// The box around a set of references, and the box around their centroids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent<S> {
    pub aabb: Aabb<S>,
    pub centroids: Aabb<S>,
}

impl<S: Scalar> Extent<S> {
    pub const EMPTY: Self = Self { aabb: Aabb::EMPTY, centroids: Aabb::EMPTY };

    pub fn of(references: &[PrimRef<S>]) -> Self {
        references.iter().fold(Self::EMPTY, Self::grow)
    }

    #[inline(always)]
    pub fn grow(self, reference: &PrimRef<S>) -> Self {
        let centroid = Aabb { min: reference.centroid, max: reference.centroid };
        Self { aabb: self.aabb.union(reference.aabb), centroids: self.centroids.union(centroid) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_holds_boxes_and_centroids() {
        let reference =
            |x: f32| PrimRef { aabb: Aabb::new([x - 1.0; 3], [x + 1.0; 3]), centroid: [x; 3], index: 0 };
        let extent = Extent::of(&[reference(0.0), reference(5.0)]);
        assert_eq!(extent.aabb, Aabb::new([-1.0; 3], [6.0; 3]));
        assert_eq!(extent.centroids, Aabb::new([0.0; 3], [5.0; 3]));
    }
}
