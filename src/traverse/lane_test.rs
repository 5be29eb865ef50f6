//! The leaf test in lanes, behind one dynamic call for each leaf.
//!
//! It is for leaves whose operands describe their primitives completely, in queries that have no
//! kernel with the test inlined: all hits, counted steps, compact trees, and rare kinds of rays,
//! primitives and instruction sets.

use super::best_first::{Details, QueuedHit};
use super::child_order::next_lane;
use super::leaf_call::{LeafTest, LeafView, RayState};
use crate::geometry::Scalar;
use crate::leaf::{GATHERED, LEAF_WIDTH, LaneTest, PutOperands, StoredHits, TestLanes, operands_of};
use crate::simd::Backend;
use core::marker::PhantomData;
use core::ops::ControlFlow;

/// The hits that a query asks for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Wanted {
    Closest,
    Any,
    All,
}

pub(super) struct LaneLeafTest<'q, S: Scalar, T: LaneTest<S>> {
    put: &'q dyn PutOperands<S>,
    wanted: Wanted,
    /// The instruction set of the lanes; `None` if they do not suit the ray or tree.
    lanes: Option<Backend>,
    /// The frame of the ray, computed at the first leaf.
    frame: Option<T::Frame>,
}

impl<'q, S: Scalar, T: LaneTest<S>> LaneLeafTest<'q, S, T> {
    pub fn new(put: &'q dyn PutOperands<S>, wanted: Wanted, lanes: Option<Backend>) -> Self {
        Self { put, wanted, lanes, frame: None }
    }

    /// Takes a hit in the ray's interval.
    fn hit(&self, t: S, index: u32, details: [S; 3], ray: &mut RayState<S>) -> ControlFlow<()> {
        match self.wanted {
            Wanted::Closest => {
                if ray.is_closer(t, index) {
                    (ray.ray.t_max, ray.index, ray.details) = (t, index, details);
                }
            }
            Wanted::Any => {
                (ray.index, ray.details) = (index, details);
                return ControlFlow::Break(());
            }
            Wanted::All => ray.hits.push(QueuedHit::new(t, index, Details::OfLane(details))),
        }
        ControlFlow::Continue(())
    }
}

impl<S: Scalar, T: LaneTest<S>> LeafTest<S> for LaneLeafTest<'_, S, T> {
    fn test(&mut self, leaf: LeafView<'_, S>, ray: &mut RayState<S>) -> ControlFlow<()> {
        let LeafView { indices, rows } = leaf;
        ray.steps.primitives += indices.len() as u64;
        let mut gathered = [[S::ZERO; LEAF_WIDTH]; GATHERED];
        let rows = if rows.is_empty() {
            let gathered = &mut gathered[..T::OPERANDS];
            self.put.put_rows(indices, gathered);
            gathered
        } else {
            rows
        };
        let mut undecided = (1u32 << indices.len()) - 1;
        if let Some(backend) = self.lanes {
            let frame = *self.frame.get_or_insert_with(|| T::frame(&ray.ray, &ray.slabs));
            let mut hits = StoredHits::none();
            TestLanes::<S, T> { rows, ray: &ray.ray, frame: &frame, hits: &mut hits, test: PhantomData }
                .run_on(backend);
            let mut settled = hits.settled;
            while settled != 0 {
                let lane = next_lane(&mut settled) % LEAF_WIDTH;
                let [a, b, c] = &hits.details;
                self.hit(hits.t[lane], indices[lane], [a[lane], b[lane], c[lane]], ray)?;
            }
            undecided = hits.undecided;
        }
        while undecided != 0 {
            let lane = next_lane(&mut undecided) % LEAF_WIDTH;
            if let Some((t, details)) = T::one(&operands_of(rows, lane), &ray.ray, &ray.slabs) {
                self.hit(t, indices[lane], details, ray)?;
            }
        }
        ControlFlow::Continue(())
    }
}
