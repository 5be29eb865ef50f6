//! A question, asked about one ray.

use super::counters::Recorder;
use super::{Traverse, Visitor};
use crate::geometry::Ray;
use crate::primitive::Intersect;
use crate::simd::Kernel;
use core::marker::PhantomData;
use fearless_simd::Simd;

/// A visitor that knows the answer in the end.
pub(crate) trait Question<'a, P: Intersect>: Visitor<P> {
    type Answer: Copy;
    /// The answer for an invalid ray.
    const NONE: Self::Answer;
    fn new(primitives: &'a [P], ray: &Ray<P::Scalar>) -> Self;
    fn answer(&self) -> Self::Answer;
}

/// One ray.
pub(crate) struct Ask<'r, 'a, P: Intersect, L, R, Q> {
    pub layout: &'a L,
    pub primitives: &'a [P],
    pub ray: &'r Ray<P::Scalar>,
    pub recorder: &'r mut R,
    pub question: PhantomData<Q>,
}

impl<'a, P: Intersect, L: Traverse<P>, R: Recorder, Q: Question<'a, P>> Kernel for Ask<'_, 'a, P, L, R, Q> {
    const IS_WIDE: bool = L::IS_WIDE;
    type Output = Q::Answer;

    #[inline(always)]
    fn run<I: Simd>(self, isa: I) -> Q::Answer {
        let Self { layout, primitives, ray, recorder, .. } = self;
        let prepared = ray.prepare();
        if !prepared.slabs.is_ordinary && !ray.is_valid() {
            return Q::NONE;
        }
        recorder.ray();
        let mut question = Q::new(primitives, ray);
        layout.traverse(isa, &prepared, ray, &mut question, recorder);
        question.answer()
    }
}
