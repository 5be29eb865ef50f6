//! A question, asked about many rays: one after another or in turns, whichever is quicker.
//!
//! Turns gain where rays wait for memory, and lose where they do not. Which it is hangs on the scene, the rays and the
//! machine, so it is measured: a chunk of the rays is traced in each way, and the quicker way is taken for the next ones,
//! until it is time to ask again. No answer hangs on it. Without `std` there is no clock, and no turns.
//!
//! Refused: to decide by the size of the tree. On 13 MB of dragon turns gain up to 1.8 times, on 17 MB of sponza they lose
//! up to 16 %, since from inside most rays see little of it.

use super::Traverse;
use super::ask::{Ask, Question};
use crate::geometry::Ray;
use crate::primitive::Intersect;
use crate::simd::{Backend, Kernel};
use core::marker::PhantomData;
use fearless_simd::Simd;

/// Rays in a chunk: enough for the time at its ends, when few are under way, not to count.
const CHUNK: usize = 512;

/// Chunks after which both ways are tried again: the slower one then has one ray in so many.
const PERIOD: usize = 32;

/// Answers the question for each ray.
#[inline]
pub(crate) fn ask_all<'a, P: Intersect, L: Traverse<P>, Q: Question<'a, P>>(
    layout: &'a L,
    backend: Backend,
    primitives: &'a [P],
    rays: &[Ray<P::Scalar>],
    answers: &mut [Q::Answer],
) {
    let count = rays.len().min(answers.len());
    let (rays, answers) = (&rays[..count], &mut answers[..count]);
    let (mut one_by_one, mut in_turns) = (0.0, f64::INFINITY);
    for (number, (rays, answers)) in rays.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)).enumerate() {
        let is_trial = number % PERIOD == 1 && rays.len() == CHUNK && Clock::EXISTS;
        let clock = Clock::start();
        let question = PhantomData::<Q>;
        if is_trial || (number % PERIOD > 1 && in_turns < one_by_one) {
            backend.run(InTurns { layout, primitives, rays, answers, question });
        } else {
            for (ray, answer) in rays.iter().zip(answers) {
                *answer = backend.run(Ask { layout, primitives, ray, recorder: &mut (), question });
            }
        }
        match number % PERIOD {
            0 => one_by_one = clock.seconds(),
            1 => in_turns = if is_trial { clock.seconds() } else { f64::INFINITY },
            _ => {}
        }
    }
}

struct InTurns<'c, 'a, P: Intersect, L, Q: Question<'a, P>> {
    layout: &'a L,
    primitives: &'a [P],
    rays: &'c [Ray<P::Scalar>],
    answers: &'c mut [Q::Answer],
    question: PhantomData<Q>,
}

impl<'a, P: Intersect, L: Traverse<P>, Q: Question<'a, P>> Kernel for InTurns<'_, 'a, P, L, Q> {
    const IS_WIDE: bool = L::IS_WIDE;
    type Output = ();

    #[inline(always)]
    fn run<I: Simd>(self, isa: I) {
        let Self { layout, primitives, rays, answers, .. } = self;
        answers.fill(Q::NONE);
        let valid = rays.iter().enumerate().filter(|(_, ray)| ray.is_valid());
        let start = |ray: &Ray<P::Scalar>| Q::new(primitives, ray);
        layout.traverse_in_turns(isa, valid, start, |number, question| answers[number] = question.answer());
    }
}

/// The standard library's, if there is one.
struct Clock {
    #[cfg(feature = "std")]
    start: std::time::Instant,
}

impl Clock {
    const EXISTS: bool = cfg!(feature = "std");

    fn start() -> Self {
        Self {
            #[cfg(feature = "std")]
            start: std::time::Instant::now(),
        }
    }

    fn seconds(&self) -> f64 {
        #[cfg(feature = "std")]
        return self.start.elapsed().as_secs_f64();
        #[cfg(not(feature = "std"))]
        0.0
    }
}
