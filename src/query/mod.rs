//! Questions to a hierarchy. One traversal loop for each layout; the queries are visitors of what it reaches.
//!
//! The lazy query in order of t is the one exception: it has a loop of its own, round a queue instead of a stack.

mod accept;
mod ahead;
mod any;
mod ask;
mod batch;
mod binary;
mod children;
mod closest;
mod counters;
mod flights;
mod hits;
mod pending;
mod slab_lanes;
mod stack;
mod wide;

pub(crate) use accept::{accept, precedes};
use ahead::Ahead;
pub(crate) use any::Any;
pub(crate) use ask::Ask;
pub(crate) use batch::ask_all;
pub(crate) use closest::Closest;
pub use counters::{Counters, Recorder};
pub use hits::Hits;

use crate::geometry::{PreparedRay, Ray};
use crate::layout::Layout;
use crate::primitive::{Found, Intersect, LEAF_WIDTH};
use crate::simd::Lanes;
use core::ops::ControlFlow;
use fearless_simd::Simd;

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

/// A layout that rays can be traced through: all of them.
pub trait Traverse<P: Intersect>: Layout<P> {
    /// Whether other instruction sets than the target's own gain anything: else kernels are compiled for that alone.
    #[doc(hidden)]
    const IS_WIDE: bool;

    /// Shows `visitor` the primitives in leaves whose boxes the ray meets, until it breaks. `prepared` and `ray` are the same
    /// valid ray.
    #[doc(hidden)]
    fn traverse<I: Simd>(
        &self,
        isa: I,
        prepared: &PreparedRay<P::Scalar>,
        ray: &Ray<P::Scalar>,
        visitor: &mut impl Visitor<P>,
        recorder: &mut impl Recorder,
    );

    /// The same for many valid rays with their numbers, in turns: `start` makes a visitor for each, and `finish` gets it
    /// back with the number, in any order.
    #[doc(hidden)]
    #[inline(always)]
    fn traverse_in_turns<'r, I: Simd, V: Visitor<P>>(
        &self,
        isa: I,
        rays: impl Iterator<Item = (usize, &'r Ray<P::Scalar>)>,
        start: impl Fn(&Ray<P::Scalar>) -> V,
        mut finish: impl FnMut(usize, V),
    ) {
        for (number, ray) in rays {
            let mut visitor = start(ray);
            self.traverse(isa, &ray.prepare(), ray, &mut visitor, &mut ());
            finish(number, visitor);
        }
    }

    /// Opens the boxes ahead of the ray, the nearest first, until nothing can come before the next hit.
    #[doc(hidden)]
    fn open_ahead<I: Simd>(
        &self,
        isa: I,
        ray: &PreparedRay<P::Scalar>,
        primitives: &[P],
        ahead: &mut Ahead<P, Self::Place>,
        recorder: &mut impl Recorder,
    );
}

/// A query, as the loops see it.
#[doc(hidden)]
pub trait Visitor<P: Intersect>: Copy {
    /// Whether nearer boxes should come first.
    const IN_ORDER: bool;
    /// All primitives, by index.
    fn primitives(&self) -> &[P];
    /// What begins beyond this t is of no interest any more.
    fn limit(&self) -> P::Scalar;
    /// A primitive in a leaf whose box the ray enters before the limit.
    fn primitive(&mut self, index: u32, ray: &PreparedRay<P::Scalar>) -> ControlFlow<()>;
    /// What is surely hit in such a leaf, of the primitives with these indices.
    fn found<L: Lanes<P::Scalar>>(
        &mut self,
        found: &Found<P::Scalar, L>,
        indices: &[u32; LEAF_WIDTH],
    ) -> ControlFlow<()>;
}
