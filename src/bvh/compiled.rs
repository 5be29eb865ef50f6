//! Builds compiled in this crate, for `f32` and `f64`: see `builders::compiled`.

use super::error::BuildError;
use super::job::{Job, LayOut};
use super::workspace::Workspace;
use crate::geometry::Scalar;
use alloc::vec::Vec;

/// The build for a scalar.
pub trait CompiledBuild: Sized {
    /// Builds a tree and lays it out; returns the indices of skipped primitives.
    fn build(
        job: &Job<'_, Self>,
        workspace: &mut Workspace<Self>,
        lay_out: LayOut<'_, Self>,
    ) -> Result<Vec<u32>, BuildError>
    where
        Self: Scalar;
}

macro_rules! compiled_here {
    ($($scalar:ty)*) => {$(
        impl CompiledBuild for $scalar {
            #[inline(never)]
            fn build(
                job: &Job<'_, Self>,
                workspace: &mut Workspace<Self>,
                lay_out: LayOut<'_, Self>,
            ) -> Result<Vec<u32>, BuildError> {
                job.run(workspace, lay_out)
            }
        }
    )*};
}

compiled_here!(f32 f64);
