//! What this crate's own heuristics know of a split beside where it is.

use super::Split;
use crate::builders::reference::PrimRef;
use crate::geometry::{Aabb, Axis, Scalar};

/// A split, and its sides, if they are known.
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

/// Asked for by this crate alone, since what is answered is believed.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Own(());

impl Own {
    pub(in crate::builders) const BUILD: Self = Self(());
}

/// The sides of a plane between two bins: what was counted before it and behind it.
#[derive(Clone, Copy, Debug)]
pub(in crate::builders) struct Sides<S> {
    pub(super) axis: Axis,
    /// Where bins begin.
    pub(super) origin: S,
    /// Bins per unit of length.
    pub(super) scale: S,
    /// The first on the right.
    pub(super) bin: S,
    /// Around the references of each: no other loop over them is needed, which took a tenth of a build.
    pub boxes: [Aabb<S>; 2],
}

impl<S: Scalar> Sides<S> {
    /// Whether a reference was counted before the plane: as `Grid::cells` rounds, where a NaN is the first bin's.
    #[inline(always)]
    pub fn has_on_the_left(&self, reference: &PrimRef<S>) -> bool {
        let is_behind = (reference.middle(self.axis) - self.origin) * self.scale >= self.bin;
        !is_behind
    }
}
