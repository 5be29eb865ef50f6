//! The kernels: one traversal loop for each layout.
//!
//! They are compiled in this crate, for each kind of leaf, scalar and instruction set, and for
//! no type of primitive.
//!
//! ```text
//! query --> kernel: nodes by box_test and child_order, deferred children on the traversal_stack
//!             at a leaf, a visitor:
//!               PackedLeaves   the leaf's own test, in lanes (leaf::LaneTest)
//!               DynLeaves      one dynamic call for the whole leaf (leaf_call::LeafTest)
//! query <-- t, index, and the details from which the payload is made
//! ```

mod best_first;
mod binary;
mod binary_stack;
mod box_test;
mod child_order;
mod kernels;
mod lane_test;
mod leaf_call;
mod recorder;
mod traversal_stack;
mod visitor;
mod wide;

pub(crate) use best_first::{BestFirst, Details, QueuedHit};
pub use kernels::{EncodingKernels, ScalarKernels};
pub(crate) use leaf_call::{LeafTest, LeafView, RayState};
pub use recorder::{Counters, Recorder};
pub(crate) use visitor::Found;
