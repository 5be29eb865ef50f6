//! Leaf tests by a dynamic call, for kernels that do not know the primitives' type.
//!
//! There is one call for each leaf.

use super::best_first::HitQueue;
use super::recorder::Counters;
use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::NO_PRIMITIVE;
use crate::leaf::LEAF_WIDTH;
use crate::primitive::precedes;
use crate::simd::Backend;
use core::ops::ControlFlow;

/// The part of a query that knows the type of its primitives.
pub trait LeafTest<S> {
    /// Tests the primitives of a leaf and counts them.
    ///
    /// Breaks if nothing more has to be visited.
    fn test(&mut self, leaf: LeafView<'_, S>, ray: &mut RayState<S>) -> ControlFlow<()>;
}

/// The primitives of a leaf.
#[derive(Clone, Copy)]
pub struct LeafView<'q, S> {
    /// Their indices in the input.
    pub indices: &'q [u32],
    /// Their operands if the leaf stores them, else empty: they have to be gathered.
    pub rows: &'q [[S; LEAF_WIDTH]],
}

/// A ray on its way, with the hits that were found so far.
pub struct RayState<S> {
    /// The ray. In a closest-hit query its interval ends at the closest hit so far.
    pub ray: Ray<S>,
    pub slabs: Slabs<S>,
    /// The index of the closest hit so far, or [`NO_PRIMITIVE`] if there is none.
    pub index: u32,
    /// The details from which the payload of that hit is made.
    ///
    /// They are used if operands describe the primitives completely.
    pub details: [S; 3],
    /// All hits, if the query is for all.
    pub hits: HitQueue<S>,
    /// The steps taken.
    pub steps: Counters,
    /// The instruction set for sieves; `None` where lanes cannot be tested.
    pub sieve: Option<Backend>,
}

impl<S: Scalar> RayState<S> {
    #[inline(always)]
    pub fn new(ray: &Ray<S>) -> Self {
        let (ray, slabs) = (*ray, Slabs::new(ray));
        let (details, hits, steps) = ([S::ZERO; 3], HitQueue::new(), Counters::default());
        Self { ray, slabs, index: NO_PRIMITIVE, details, hits, steps, sieve: None }
    }

    /// Whether a hit in the ray's interval comes before the closest hit so far.
    #[inline(always)]
    pub fn is_closer(&self, t: S, index: u32) -> bool {
        // Without a hit the index is the largest, and t_max is the interval's end.
        precedes(t, index, self.ray.t_max, self.index)
    }
}
