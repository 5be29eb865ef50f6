//! The options of a build.

use super::error::BuildError;
use crate::builders::{Optimise, ProgressCallback};
use crate::simd::{Backend, InstructionSet};
#[cfg(feature = "std")]
use std::time::{Duration, Instant};

/// The treatment of primitives with an invalid box.
///
/// A box is invalid if it has a NaN, an infinity, or a minimum above its maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum OnInvalid {
    /// Fails with [`BuildError::InvalidPrimitive`], which names the first one.
    #[default]
    Reject,
    /// Leaves the primitive out, so that nothing hits it.
    ///
    /// [`Bvh::skipped`](crate::Bvh::skipped) lists it. The other primitives keep their indices.
    Skip,
}

/// The options that a [`Builder`](super::Builder) has collected.
#[derive(Clone, Debug, Default)]
pub struct Options {
    pub max_leaf_size: Option<usize>,
    pub threads: Option<usize>,
    pub on_invalid: OnInvalid,
    pub optimise: Option<Optimise>,
    pub(crate) callback: Option<ProgressCallback>,
    #[cfg(feature = "std")]
    pub time_budget: Option<Duration>,
    pub instruction_set: Option<InstructionSet>,
}

/// The deadline of a build, if it has one.
pub struct Clock {
    #[cfg(feature = "std")]
    pub(super) deadline: Option<Instant>,
}

impl Options {
    /// Checks the options, and returns the backend of queries.
    pub(crate) fn backend(&self) -> Result<Backend, BuildError> {
        if self.max_leaf_size == Some(0) {
            return Err(BuildError::ZeroLeafSize);
        }
        match self.instruction_set {
            Some(set) => Backend::of(set).ok_or(BuildError::NoInstructionSet(set)),
            None => Ok(Backend::best()),
        }
    }

    /// Starts the clock of a build.
    pub fn clock(&self) -> Clock {
        Clock {
            #[cfg(feature = "std")]
            deadline: self.time_budget.and_then(|budget| Instant::now().checked_add(budget)),
        }
    }
}
