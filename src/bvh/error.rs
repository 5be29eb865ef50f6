//! The errors of a build.

use crate::builders::InvalidBox;
use crate::parallel::ThreadPoolError;
use crate::simd::InstructionSet;
use core::fmt;

/// The reason why a build failed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// A primitive has an invalid box.
    ///
    /// [`OnInvalid::Reject`](crate::OnInvalid::Reject) is in force.
    InvalidPrimitive {
        /// The index of the primitive in the input.
        index: usize,
        /// The fault of its box.
        reason: InvalidBox,
    },
    /// The input has more primitives than 32 bits can number, 2^32 - 1.
    ///
    /// The build finds this before it allocates anything, if the input tells its length.
    TooManyPrimitives {
        /// A lower bound of the number of primitives.
        count: usize,
    },
    /// `max_leaf_size` is 0.
    ZeroLeafSize,
    /// The layout needs more memory than its references can address.
    ///
    /// See [`WideTree`](crate::WideTree) and [`CompactTree`](crate::CompactTree).
    TooLarge,
    /// The processor, or this build of the crate, lacks the instruction set asked for.
    NoInstructionSet(InstructionSet),
    /// The progress callback stopped the build.
    ///
    /// See [`Builder::progress`](crate::Builder::progress).
    Stopped,
    /// The threads asked for could not be started.
    ThreadPool(ThreadPoolError),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidPrimitive { index, reason } => {
                let what = match reason {
                    InvalidBox::NanBox => "a bounding box with a NaN",
                    InvalidBox::InfiniteBox => "a bounding box with an infinite bound",
                    InvalidBox::InvertedBox => "a bounding box whose minimum is above its maximum",
                };
                write!(f, "primitive {index} has {what}: repair it, or build with OnInvalid::Skip")
            }
            Self::TooManyPrimitives { count } => {
                write!(f, "{count} primitives or more, but indices have 32 bits: split the scene")
            }
            Self::ZeroLeafSize => {
                f.write_str("max_leaf_size is 0, but a leaf has a primitive: give 1 or more")
            }
            Self::TooLarge => {
                f.write_str("there are more primitives, or nodes, than the layout can number: use the layout Tree, or split the scene")
            }
            Self::NoInstructionSet(set) => {
                write!(f, "no {set} here: InstructionSet::available() tells what there is")
            }
            Self::Stopped => f.write_str("the build was stopped by its callback"),
            Self::ThreadPool(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BuildError {}
