//! The visitors of a wide tree: the work of a query at each leaf.

use super::child_order::next_lane;
use super::leaf_call::{LeafTest, LeafView, RayState};
use crate::geometry::{Ray, Scalar, Slabs};
use crate::layout::{Encoding, NO_PRIMITIVE, Reference, WideTree};
use crate::leaf::{LEAF_WIDTH, LaneHits, LaneTest, Operands, operands_of};
use crate::primitive::precedes;
use crate::simd::{Count, Isa, Lanes, LeafLanes, Width};
use core::marker::PhantomData;
use core::ops::ControlFlow;

/// A query, as the wide traversal loop uses it.
pub(super) trait Visitor<S: Scalar> {
    /// Whether nearer boxes have to be visited first.
    const IN_ORDER: bool;

    /// Returns the largest t that still counts: boxes entered beyond it are skipped.
    fn limit(&self) -> S;

    /// Is called for each node that is visited.
    #[inline(always)]
    fn node(&mut self) {}

    /// Tests the primitives of a leaf whose box the ray enters before the limit.
    ///
    /// Breaks if nothing more has to be visited.
    ///
    /// # Safety
    ///
    /// `leaf` is one of the tree's leaves, and the tree has as many operands of each primitive as
    /// the visitor takes.
    unsafe fn leaf<I: Isa, F: Encoding<S, N>, const N: usize>(
        &mut self,
        isa: I,
        tree: &WideTree<S, N, F>,
        leaf: Reference,
    ) -> ControlFlow<()>
    where
        Count<N>: Width;
}

/// A kind of query, closest or any, with the hit that it has found so far.
pub(super) trait Query<S: Scalar>: Copy {
    const IN_ORDER: bool;

    /// Returns the query before any hit.
    fn of(ray: &Ray<S>) -> Self;

    fn limit(&self) -> S;

    /// Takes a hit that is not beyond the limit.
    fn hit(&mut self, t: S, index: u32, details: impl FnOnce() -> [S; 3]) -> ControlFlow<()>;
}

/// The closest hit so far, as a query.
#[derive(Clone, Copy)]
pub struct Found<S> {
    /// The t of the hit, or the end of the ray's interval if there is none.
    pub t: S,
    /// The primitive's index, or [`NO_PRIMITIVE`] if there is none.
    pub index: u32,
    /// The details from which the payload is made.
    pub details: [S; 3],
}

impl<S: Scalar> Found<S> {
    #[inline(always)]
    pub fn none(t_max: S) -> Self {
        Self { t: t_max, index: NO_PRIMITIVE, details: [S::ZERO; 3] }
    }
}

impl<S: Scalar> Query<S> for Found<S> {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn of(ray: &Ray<S>) -> Self {
        Self::none(ray.t_max)
    }

    #[inline(always)]
    fn limit(&self) -> S {
        self.t
    }

    #[inline(always)]
    fn hit(&mut self, t: S, index: u32, details: impl FnOnce() -> [S; 3]) -> ControlFlow<()> {
        if precedes(t, index, self.t, self.index) {
            *self = Self { t, index, details: details() };
        }
        ControlFlow::Continue(())
    }
}

/// The query for any hit.
#[derive(Clone, Copy)]
pub(super) struct Any<S> {
    pub t_max: S,
    pub is_hit: bool,
}

impl<S: Scalar> Query<S> for Any<S> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn of(ray: &Ray<S>) -> Self {
        Self { t_max: ray.t_max, is_hit: false }
    }

    #[inline(always)]
    fn limit(&self) -> S {
        self.t_max
    }

    #[inline(always)]
    fn hit(&mut self, _: S, _: u32, _: impl FnOnce() -> [S; 3]) -> ControlFlow<()> {
        self.is_hit = true;
        ControlFlow::Break(())
    }
}

/// The visitor of leaves whose operands describe their primitives completely.
pub(super) struct PackedLeaves<'q, S: Scalar, T: LaneTest<S>, Q, W> {
    ray: &'q Ray<S>,
    slabs: &'q Slabs<S>,
    pub query: Q,
    /// The frame of the ray, computed at the first leaf.
    frame: Option<T::Frame>,
    lanes: PhantomData<W>,
}

impl<'q, S: Scalar, T: LaneTest<S>, Q: Query<S>, W> PackedLeaves<'q, S, T, Q, W> {
    #[inline(always)]
    pub fn new(ray: &'q Ray<S>, slabs: &'q Slabs<S>) -> Self {
        Self { ray, slabs, query: Q::of(ray), frame: None, lanes: PhantomData }
    }
}

impl<S: Scalar, T: LaneTest<S>, Q: Query<S>, W: LeafLanes> Visitor<S> for PackedLeaves<'_, S, T, Q, W> {
    const IN_ORDER: bool = Q::IN_ORDER;

    #[inline(always)]
    fn limit(&self) -> S {
        self.query.limit()
    }

    #[inline(always)]
    unsafe fn leaf<I: Isa, F: Encoding<S, N>, const N: usize>(
        &mut self,
        isa: I,
        tree: &WideTree<S, N, F>,
        leaf: Reference,
    ) -> ControlFlow<()>
    where
        Count<N>: Width,
    {
        // SAFETY: the caller promises one of the tree's leaves. `check_operands` has compared the
        // number of operands at the entry of the kernel.
        let indices = unsafe { F::indices(tree, leaf, T::OPERANDS) };
        // SAFETY: as above.
        let rows = unsafe { F::rows(tree, leaf, T::OPERANDS) };
        let frame = self.frame.get_or_insert_with(
            #[inline(always)]
            || T::frame(self.ray, self.slabs),
        );
        let operands = Operands::<_, W::Lanes<S, I>>::new(isa, rows);
        let hits = T::test(&operands, self.ray, frame, self.query.limit());
        self.settled(&hits, indices)?;
        let undecided = hits.undecided;
        if undecided == 0 {
            return ControlFlow::Continue(());
        }
        let flow;
        (self.query, flow) = decide::<S, T, Q>(self.query, undecided, indices, rows, self.ray);
        flow
    }
}

impl<S: Scalar, T: LaneTest<S>, Q: Query<S>, W> PackedLeaves<'_, S, T, Q, W> {
    #[inline(always)]
    fn settled<L: Lanes<S>>(&mut self, hits: &LaneHits<L>, indices: &[u32; LEAF_WIDTH]) -> ControlFlow<()> {
        let mut lanes = hits.settled;
        while lanes != 0 {
            let lane = next_lane(&mut lanes) % LEAF_WIDTH;
            let [a, b, c] = hits.details;
            let details = || [a.lane(lane), b.lane(lane), c.lane(lane)];
            self.query.hit(hits.t.lane(lane), indices[lane], details)?;
        }
        ControlFlow::Continue(())
    }
}

/// Tests some lanes one by one, with a copy of the query.
///
/// A reference to the query would keep it in memory on all other paths too.
#[cold]
#[inline(never)]
fn decide<S: Scalar, T: LaneTest<S>, Q: Query<S>>(
    mut query: Q,
    mut lanes: u32,
    indices: &[u32; LEAF_WIDTH],
    rows: &[[S; LEAF_WIDTH]],
    ray: &Ray<S>,
) -> (Q, ControlFlow<()>) {
    let slabs = Slabs::new(ray);
    while lanes != 0 {
        let lane = next_lane(&mut lanes) % LEAF_WIDTH;
        let ray = ray.with_interval(ray.t_min, query.limit());
        if let Some((t, details)) = T::one(&operands_of(rows, lane), &ray, &slabs)
            && query.hit(t, indices[lane], || details).is_break()
        {
            return (query, ControlFlow::Break(()));
        }
    }
    (query, ControlFlow::Continue(()))
}

/// The visitor of leaves that are tested by a dynamic call.
pub(super) struct DynLeaves<'q, S: Scalar, const IN_ORDER: bool> {
    pub leaf_test: &'q mut dyn LeafTest<S>,
    pub ray: &'q mut RayState<S>,
}

impl<S: Scalar, const IN_ORDER: bool> Visitor<S> for DynLeaves<'_, S, IN_ORDER> {
    const IN_ORDER: bool = IN_ORDER;

    #[inline(always)]
    fn limit(&self) -> S {
        self.ray.ray.t_max
    }

    #[inline(always)]
    fn node(&mut self) {
        self.ray.steps.nodes += 1;
    }

    #[inline(always)]
    unsafe fn leaf<I: Isa, F: Encoding<S, N>, const N: usize>(
        &mut self,
        _: I,
        tree: &WideTree<S, N, F>,
        leaf: Reference,
    ) -> ControlFlow<()>
    where
        Count<N>: Width,
    {
        // SAFETY: the caller promises one of the tree's leaves, and the number of
        // operands is the tree's.
        let (indices, rows) =
            unsafe { (F::indices(tree, leaf, tree.operands()), F::rows(tree, leaf, tree.operands())) };
        let count =
            indices.iter().enumerate().take_while(|&(lane, &index)| F::has(leaf, lane, index)).count();
        self.ray.steps.leaves += 1;
        self.leaf_test.test(LeafView { indices: &indices[..count], rows }, self.ray)
    }
}
