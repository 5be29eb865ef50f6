//! The options of a build.

use super::error::BuildError;
use crate::builders::{Optimise, ProgressCallback};
use crate::simd::{Backend, InstructionSet};
#[cfg(feature = "std")]
use std::time::{Duration, Instant};

/// What to do with a primitive whose box has a NaN, an infinity, or a minimum above its maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum OnInvalid {
    /// Fail with [`BuildError::InvalidPrimitive`], which names the first.
    #[default]
    Reject,
    /// Leave it out, so that nothing hits it, and list it in [`Bvh::skipped`]. The others keep
    /// their indices.
    Skip,
}

/// What a [`Builder`](super::Builder) was told.
#[derive(Clone, Debug, Default)]
pub struct Options {
    pub max_leaf_size: Option<usize>,
    pub threads: Option<usize>,
    pub on_invalid: OnInvalid,
    pub optimise: Option<Optimise>,
    pub(crate) watcher: Option<ProgressCallback>,
    #[cfg(feature = "std")]
    pub time_budget: Option<Duration>,
    pub instruction_set: Option<InstructionSet>,
}

/// When a build began.
pub struct Clock {
    #[cfg(feature = "std")]
    pub(super) deadline: Option<Instant>,
}

impl Options {
    /// What queries are to be computed with, if all is as it may be.
    pub(crate) fn backend(&self) -> Result<Backend, BuildError> {
        if self.max_leaf_size == Some(0) {
            return Err(BuildError::ZeroLeafSize);
        }
        match self.instruction_set {
            Some(set) => Backend::of(set).ok_or(BuildError::NoInstructionSet(set)),
            None => Ok(Backend::best()),
        }
    }

    /// Now.
    pub fn clock(&self) -> Clock {
        Clock {
            #[cfg(feature = "std")]
            deadline: self.time_budget.and_then(|budget| Instant::now().checked_add(budget)),
        }
    }
}
