//! The presets.

use crate::builders::Optimise;
use crate::builders::heuristic::{BinnedSah, BuildNode, Heuristic, Own, Proposal, Split};
use crate::geometry::Scalar;

/// How much time a build may take for how quick a tree: a heuristic, and how much of its tree is reinserted.
///
/// `docs/building.md` has the figures. To choose for yourself:
/// [`Builder::heuristic`](crate::Builder::heuristic) and
/// [`Builder::optimise`](crate::Builder::optimise).
///
/// None of them has [`SweepSah`](crate::heuristic::SweepSah), which tries every split: on six scenes
/// its trees are 1 to 7 % better than those of 32 bins on four and 2 to 45 % worse on two, where
/// greedy exactness misleads, and it takes ten times as long as bins. Nor
/// [`SpatialSah`](crate::heuristic::SpatialSah): in nodes of 16 children its trees, reinserted, are within 10 % of
/// `High`'s either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quality {
    /// [`BinnedSah`] of 16 bins down to [clusters](crate::heuristic::Clustered) of up to 128 neighbours, a sorting below.
    Fast,
    /// [`BinnedSah`] of 16 bins, up to a hundredth of it reinserted, in 8 rounds.
    #[default]
    Balanced,
    /// [`BinnedSah`] of 16 bins, up to a tenth of it reinserted, in 16 rounds: rays take 4 % fewer steps in the mean over
    /// six scenes, and up to 9 % fewer, for 1.1 to 1.4 times the time. For scenes that are built once and traced for minutes.
    High,
}

impl Quality {
    /// How much is reinserted.
    pub fn optimise(self) -> Optimise {
        match self {
            Self::Fast => Optimise::NONE,
            Self::Balanced => Optimise::default(),
            Self::High => Optimise { share: 0.1, rounds: 16 },
        }
    }
}

impl<S: Scalar> Heuristic<S> for Quality {
    fn split(&self, node: &BuildNode<'_, S>) -> Split<S> {
        BinnedSah::new(16).split(node)
    }

    fn proposal(&self, node: &BuildNode<'_, S>, own: Own) -> Proposal<S> {
        BinnedSah::new(16).proposal(node, own)
    }

    fn cluster_size(&self) -> usize {
        match self {
            Self::Fast => 128,
            Self::Balanced | Self::High => 1,
        }
    }

    fn optimise(&self) -> Option<Optimise> {
        Some(Self::optimise(*self))
    }
}
