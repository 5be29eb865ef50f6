//! What is compiled in this crate, for `f32` and for `f64`.
//!
//! Generic functions are compiled anew in each crate that uses them. Here are those that know
//! nothing of the primitives, the heuristic and the layout but by reference: a client compiles a
//! loop over its primitives' boxes, and calls.

use super::heuristic::{BinnedSah, BuildNode, Proposal, SpatialSah, Split, SweepSah, new_codes};
use super::reference::PrimRef;
use super::reinsertion::{Optimise, OptimiseStats};
use crate::geometry::{Aabb, Scalar};
use crate::tree::Tree;
use alloc::vec::Vec;

/// Builders of a scalar.
pub trait CompiledBuilders: Sized {
    /// Makes a tree better.
    fn optimise(tree: &mut Tree<Self>, optimise: &Optimise) -> OptimiseStats
    where
        Self: Scalar;

    /// What [`BinnedSah`] proposes.
    fn binned(heuristic: &BinnedSah, node: &BuildNode<'_, Self>) -> Proposal<Self>
    where
        Self: Scalar;

    /// What [`SpatialSah`] proposes.
    fn spatial(heuristic: &SpatialSah, node: &BuildNode<'_, Self>) -> Proposal<Self>
    where
        Self: Scalar;

    /// What [`SweepSah`] proposes.
    fn sweep(heuristic: &SweepSah, node: &BuildNode<'_, Self>) -> Split<Self>
    where
        Self: Scalar;

    /// Each reference's place on Morton's curve through a box.
    fn codes(references: &[PrimRef<Self>], scene: &Aabb<Self>) -> Vec<u64>
    where
        Self: Scalar;
}

macro_rules! compiled_here {
    ($($scalar:ty)*) => {$(
        impl CompiledBuilders for $scalar {
            #[inline(never)]
            fn optimise(tree: &mut Tree<Self>, optimise: &Optimise) -> OptimiseStats {
                optimise.run(tree, &mut Vec::new(), &|| true)
            }

            #[inline(never)]
            fn binned(heuristic: &BinnedSah, node: &BuildNode<'_, Self>) -> Proposal<Self> {
                heuristic.propose(node)
            }

            #[inline(never)]
            fn spatial(heuristic: &SpatialSah, node: &BuildNode<'_, Self>) -> Proposal<Self> {
                heuristic.propose(node)
            }

            #[inline(never)]
            fn sweep(heuristic: &SweepSah, node: &BuildNode<'_, Self>) -> Split<Self> {
                heuristic.propose(node)
            }

            #[inline(never)]
            fn codes(references: &[PrimRef<Self>], scene: &Aabb<Self>) -> Vec<u64> {
                new_codes(references, scene)
            }
        }
    )*};
}

compiled_here!(f32 f64);
