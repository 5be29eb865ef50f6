//! The presets.

use crate::builders::Optimise;
use crate::builders::heuristic::{BinnedSah, BuildNode, Heuristic, Own, Proposal, Split};
use crate::geometry::Scalar;

/// A preset: a compromise between build time and the speed of the tree.
///
/// Each preset is a heuristic and an amount of reinsertion. `docs/building.md` has the figures. For
/// your own choice: [`Builder::heuristic`](crate::Builder::heuristic) and
/// [`Builder::optimise`](crate::Builder::optimise).
///
/// No preset uses [`SweepSah`](crate::heuristic::SweepSah), which tries every split. It takes ten
/// times as long as bins, and in some scenes greedy exactness misleads it. Nor does any preset use
/// [`SpatialSah`](crate::heuristic::SpatialSah): in nodes of 16 children, its reinserted trees are
/// neither clearly better nor worse than those of `High` (measured: docs/decisions.md, 38).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quality {
    /// [`BinnedSah`] with 16 bins above clusters, without reinsertion.
    ///
    /// [Clusters](crate::heuristic::Clustered) have up to 128 neighbours. Inside of them, the
    /// primitives are only sorted.
    Fast,
    /// [`BinnedSah`] with 16 bins; up to 1 % of the nodes reinserted, in 8 rounds.
    #[default]
    Balanced,
    /// [`BinnedSah`] with 16 bins; up to 10 % of the nodes reinserted, in 16 rounds.
    ///
    /// For scenes that are built once and traced for minutes: rays take 4 % fewer steps than with
    /// `Balanced`, in the mean over six scenes (measured: docs/decisions.md, 38).
    High,
}

impl Quality {
    /// Returns the reinsertion of the preset.
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
