//! The presets.

use crate::build::heuristic::{BinnedSah, BuildNode, Heuristic, Morton, Split};
use crate::build::{Optimise, PrimRef};
use crate::geometry::{Aabb, Scalar};
use alloc::vec::Vec;

/// How much time a build may take for how quick a tree: a heuristic, and how much of its tree is reinserted.
///
/// The README has the figures. To choose for yourself: [`Builder::heuristic`](crate::Builder::heuristic) and [`Builder::optimise`](crate::Builder::optimise).
///
/// None of them has [`SweepSah`](crate::heuristic::SweepSah), which tries every split: on six scenes
/// its trees are 1 to 7 % better than those of 32 bins on four and 2 to 45 % worse on two, where
/// greedy exactness misleads, and it takes ten times as long as bins. Nor
/// [`SpatialSah`](crate::heuristic::SpatialSah): in nodes of 16 children its trees, reinserted, are within 10 % of
/// `High`'s either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// [`Morton`], a hundredth reinserted 8 times.
    Fast,
    /// [`BinnedSah`] of 16 bins, a hundredth reinserted 8 times.
    #[default]
    Balanced,
    /// [`BinnedSah`] of 16 bins, a tenth reinserted 16 times: takes 1.7 to 2.3 times as long as `Balanced`, for rays that are
    /// from 3 % slower to 12 % quicker. For scenes that are built once and traced for minutes.
    High,
}

impl Quality {
    /// How much is reinserted.
    pub fn optimise(self) -> Optimise {
        match self {
            Self::Fast | Self::Balanced => Optimise::default(),
            Self::High => Optimise { share: 0.1, rounds: 16 },
        }
    }
}

impl<S: Scalar> Heuristic<S> for Quality {
    fn codes(&self, references: &[PrimRef<S>], scene: &Aabb<S>) -> Option<Vec<u64>> {
        if *self == Self::Fast { Morton.codes(references, scene) } else { None }
    }

    fn optimise(&self) -> Option<Optimise> {
        Some(Self::optimise(*self))
    }

    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        match self {
            Self::Fast => Morton.split(node),
            Self::Balanced | Self::High => BinnedSah::new(16).split(node),
        }
    }
}
