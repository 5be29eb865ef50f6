//! Questions to a tree. One traversal loop; the queries are visitors of the leaves it reaches.
//!
//! The lazy query in order of t, whose loop is a queue instead of a stack, is the one exception.

mod accept;
mod any;
mod closest;
mod counters;
mod hits;
mod stack;
mod traverse;

pub(crate) use accept::{accept, precedes};
pub(crate) use any::any_hit;
pub(crate) use closest::closest_hit;
pub use counters::{Counters, Recorder};
pub use hits::Hits;

use crate::primitive::Intersect;
use crate::tree::Tree;

/// A ray's hit with a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<S, T> {
    /// Where on the ray: the point is `origin + t * direction`.
    pub t: S,
    /// The primitive's index in the input.
    pub index: usize,
    /// What the primitive tells of the hit: barycentrics, `()`, whatever its type says.
    pub payload: T,
}

/// The hit that a primitive of type `P` gives.
pub(crate) type HitOf<P> = Hit<<P as crate::Primitive>::Scalar, <P as Intersect>::Payload>;

/// A tree with its primitives in the order of its slots: what queries ask.
pub(crate) struct Scene<'a, P: Intersect> {
    pub tree: &'a Tree<P::Scalar>,
    pub primitives: &'a [P],
}

impl<P: Intersect> Clone for Scene<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Intersect> Copy for Scene<'_, P> {}
