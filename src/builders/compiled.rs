//! The functions that are compiled in this crate, for `f32` and for `f64`.
//!
//! A generic function is compiled again in each crate that uses it. The functions here know the
//! primitives, the heuristic and the layout at most by reference. So a client compiles a loop over
//! the boxes of its primitives, and calls these functions.

use super::heuristic::{BinnedSah, BuildNode, Proposal, SpatialSah, Split, SweepSah, new_codes};
use super::reference::PrimRef;
use super::reinsertion::{Optimise, OptimiseStats};
use crate::geometry::{Aabb, Scalar};
use crate::tree::Tree;
use alloc::vec::Vec;

/// The builders of a scalar.
pub trait CompiledBuilders: Sized {
    /// Improves a tree by reinsertion.
    fn optimise(tree: &mut Tree<Self>, optimise: &Optimise) -> OptimiseStats
    where
        Self: Scalar;

    /// Returns the proposal of [`BinnedSah`].
    fn binned(heuristic: &BinnedSah, node: &BuildNode<'_, Self>) -> Proposal<Self>
    where
        Self: Scalar;

    /// Returns the proposal of [`SpatialSah`].
    fn spatial(heuristic: &SpatialSah, node: &BuildNode<'_, Self>) -> Proposal<Self>
    where
        Self: Scalar;

    /// Returns the proposal of [`SweepSah`].
    fn sweep(heuristic: &SweepSah, node: &BuildNode<'_, Self>) -> Split<Self>
    where
        Self: Scalar;

    /// Returns the Morton code of each reference: its place on the curve in a box.
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
