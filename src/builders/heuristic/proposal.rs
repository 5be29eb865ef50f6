//! Proposals of this crate's own heuristics: a split, and its sides.

use super::Split;
use crate::builders::reference::PrimRef;
use crate::geometry::{Aabb, Axis, Scalar};

/// A split, and its sides if they are known.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Proposal<S> {
    pub(in crate::builders) split: Split<S>,
    pub(in crate::builders) sides: Option<Sides<S>>,
}

impl<S> From<Split<S>> for Proposal<S> {
    fn from(split: Split<S>) -> Self {
        Self { split, sides: None }
    }
}

/// Token that only this crate can make: `proposal` is trusted unchecked.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Own(());

impl Own {
    pub(in crate::builders) const BUILD: Self = Self(());
}

/// The sides of a plane between two bins.
///
/// The left side has the references that were counted before the plane, the right side the others.
#[derive(Clone, Copy, Debug)]
pub(in crate::builders) struct Sides<S> {
    pub(super) axis: Axis,
    /// The coordinate where the bins begin.
    pub(super) origin: S,
    /// Bins per unit of length.
    pub(super) scale: S,
    /// The number of the first bin on the right side.
    pub(super) bin: S,
    /// The boxes around the references of each side.
    ///
    /// They save another loop over the references, which took a tenth of a build.
    pub boxes: [Aabb<S>; 2],
}

impl<S: Scalar> Sides<S> {
    /// Returns whether a reference was counted before the plane.
    ///
    /// It rounds as `Grid::cells` does, which puts NaN into the first bin.
    #[inline(always)]
    pub fn has_on_the_left(&self, reference: &PrimRef<S>) -> bool {
        let is_behind = (reference.middle(self.axis) - self.origin) * self.scale >= self.bin;
        !is_behind
    }
}
