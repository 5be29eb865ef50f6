//! What is compiled in this crate, for `f32` and for `f64`.
//!
//! Generic functions are compiled anew in each crate that uses them. Here are those that know
//! nothing of the primitives, the heuristic and the layout but by reference: a client compiles a
//! loop over its primitives' boxes, and calls.

use super::heuristic::{BinnedSah, BuildNode, Proposal, SpatialSah, Split, SweepSah, new_codes};
use super::optimise::{Gain, Optimise};
use super::reference::PrimRef;
use crate::builder::{BuildError, Job, Workspace};
use crate::geometry::{Aabb, Scalar};
use crate::layout::{self, Collapsed, Contents, Shape};
use crate::tree::Tree;
use alloc::vec::Vec;

/// What is done with a tree once it is built. False if it is too large for that.
pub type LayOut<'l, S> = &'l mut (dyn FnMut(&mut Tree<S>, &mut layout::Buffers) -> bool + Send);

/// Builders of a scalar.
pub trait BuildScalar: Sized {
    /// Builds a tree and has it laid out; the indices of skipped primitives.
    fn build(
        job: &Job<'_, Self>,
        workspace: &mut Workspace<Self>,
        lay_out: LayOut<'_, Self>,
    ) -> Result<Vec<u32>, BuildError>
    where
        Self: Scalar;

    /// The wide tree of nodes of 16.
    fn collapse(
        tree: &Tree<Self>,
        contents: &dyn Contents<Self>,
        shape: &Shape<Self>,
        buffers: &mut layout::Buffers,
    ) -> Option<Collapsed>
    where
        Self: Scalar;

    /// Makes a tree better.
    fn optimise(tree: &mut Tree<Self>, optimise: &Optimise) -> Gain
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
        impl BuildScalar for $scalar {
            #[inline(never)]
            fn build(
                job: &Job<'_, Self>,
                workspace: &mut Workspace<Self>,
                lay_out: LayOut<'_, Self>,
            ) -> Result<Vec<u32>, BuildError> {
                job.run(workspace, lay_out)
            }

            #[inline(never)]
            fn collapse(
                tree: &Tree<Self>,
                contents: &dyn Contents<Self>,
                shape: &Shape<Self>,
                buffers: &mut layout::Buffers,
            ) -> Option<Collapsed> {
                layout::collapse::<Self, 16>(tree, contents, shape, buffers)
            }

            #[inline(never)]
            fn optimise(tree: &mut Tree<Self>, optimise: &Optimise) -> Gain {
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
