//! The lane test of a leaf as a function of its own, for late-bound calls.

use super::{LEAF_WIDTH, LaneTest, Operands};
use crate::geometry::{Ray, Scalar};
use crate::simd::{Backend, Isa, Kernel, KernelLanes};
use core::marker::PhantomData;

/// The hits in the lanes of a leaf, stored in memory.
pub(crate) struct StoredHits<S> {
    pub settled: u32,
    pub undecided: u32,
    pub t: [S; LEAF_WIDTH],
    pub details: [[S; LEAF_WIDTH]; 3],
}

impl<S: Scalar> StoredHits<S> {
    #[inline(always)]
    pub fn none() -> Self {
        Self { settled: 0, undecided: 0, t: [S::ZERO; LEAF_WIDTH], details: [[S::ZERO; LEAF_WIDTH]; 3] }
    }
}

/// The test of a leaf's rows with a ray, for hits up to the ray's end.
pub(crate) struct TestLanes<'q, S, T: LaneTest<S>>
where
    S: Scalar,
{
    pub rows: &'q [[S; LEAF_WIDTH]],
    pub ray: &'q Ray<S>,
    pub frame: &'q T::Frame,
    pub hits: &'q mut StoredHits<S>,
    pub test: PhantomData<T>,
}

impl<S: Scalar, T: LaneTest<S>> TestLanes<'_, S, T> {
    pub fn run_on(self, backend: Backend) {
        backend.run(self);
    }
}

impl<S: Scalar, T: LaneTest<S>> Kernel for TestLanes<'_, S, T> {
    const IS_WIDE: bool = true;
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let Self { rows, ray, frame, hits, .. } = self;
        let operands = Operands::<S, S::Times8<I>>::new(isa, rows);
        let found = T::test(&operands, ray, frame, ray.t_max);
        (hits.settled, hits.undecided) = (found.settled, found.undecided);
        if found.settled != 0 {
            found.t.store(&mut hits.t);
            let [a, b, c] = found.details;
            a.store(&mut hits.details[0]);
            b.store(&mut hits.details[1]);
            c.store(&mut hits.details[2]);
        }
    }
}
