//! What kernels ask of primitives whose type they do not know: one late-bound call for each leaf.

use super::best_first::HitQueue;
use super::recorder::Counters;
use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::NO_PRIMITIVE;
use crate::leaf::LEAF_WIDTH;
use crate::primitive::precedes;
use crate::simd::Backend;
use core::ops::ControlFlow;

/// A query, as far as it knows the type of its primitives.
pub trait LeafTest<S> {
    /// Tests the primitives of a leaf, and counts them. Breaks if nothing more needs to be visited.
    fn test(&mut self, leaf: LeafView<'_, S>, ray: &mut RayState<S>) -> ControlFlow<()>;
}

/// The primitives of a leaf.
#[derive(Clone, Copy)]
pub struct LeafView<'q, S> {
    /// By index in the input.
    pub indices: &'q [u32],
    /// Operands that lie in the leaf; none if they would have to be gathered.
    pub rows: &'q [[S; LEAF_WIDTH]],
}

/// A ray on its way, and what was hit so far.
pub struct RayState<S> {
    /// Its interval ends at the closest hit so far, if the query is for the closest.
    pub ray: Ray<S>,
    pub slabs: Slabs<S>,
    /// The index of the closest hit so far; [`NO_PRIMITIVE`] if there is none.
    pub index: u32,
    /// What the payload of that hit is made of, if operands say all of the primitives.
    pub details: [S; 3],
    /// All hits, if the query is for all.
    pub hits: HitQueue<S>,
    /// What was visited.
    pub steps: Counters,
    /// For tests in lanes; none where lanes are no good.
    pub sieve: Option<Backend>,
}

impl<S: Scalar> RayState<S> {
    #[inline(always)]
    pub fn new(ray: &Ray<S>) -> Self {
        let (ray, slabs) = (*ray, Slabs::new(ray));
        let (details, hits, steps) = ([S::ZERO; 3], HitQueue::new(), Counters::default());
        Self { ray, slabs, index: NO_PRIMITIVE, details, hits, steps, sieve: None }
    }

    /// Whether a hit in the ray's interval comes before the closest so far.
    #[inline(always)]
    pub fn is_closer(&self, t: S, index: u32) -> bool {
        // Without a hit the index is the largest, and its t the interval's end.
        precedes(t, index, self.ray.t_max, self.index)
    }
}
