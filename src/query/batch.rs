//! A question, asked about many rays: one after another, or in turns where that is clearly quicker.
//!
//! Turns gain where rays wait for memory, and lose where they do not. Which it is hangs on the scene, the rays and the
//! machine, so it is measured: a few rays are traced in each way, and the better way is taken for a stretch of the next ones,
//! until it is time to ask again. Stretches double as long as the answer stays the same, so that asking costs less and less.
//! No answer hangs on it. Without `std` there is no clock, and no turns.
//!
//! Refused: to decide by the size of the tree. On 13 MB of dragon turns gain up to 1.8 times, on 17 MB of sponza they lose
//! up to 16 %, since from inside most rays see little of it. One trial in each way every 16,000 rays, one after the other: 0.86 to
//! 1.00 of the rate of single rays on a kitchen that fits the cache, where it came to 0.98 to 1.03 on that machine, and chance decided more often.
//! To sort the rays along a curve first: of 131,072, random ones gain 10 to 20 % in all scenes, others nothing, less what
//! sorting takes. To let a ray go on until it reaches a leaf: 1.24 in place of 1.43 for random rays on dragon.

use super::Traverse;
use super::ask::{Ask, Question};
use crate::geometry::Ray;
use crate::primitive::Intersect;
use crate::simd::{Backend, Kernel};
use core::marker::PhantomData;
use core::mem::take;
use fearless_simd::Simd;

/// Rays of a trial: enough for the time at its ends, when few are under way, not to count for much.
const TRIAL: usize = 256;

/// Whether each trial is in turns: what changes along the rays changes both ways alike.
const TRIALS: [bool; 4] = [false, true, true, false];

/// Fewer rays are traced one after another: trials would be most of them.
const WORTH_A_TRIAL: usize = 8 * TRIAL;

/// Turns have to take less than this share of what single rays take, for a clock is not exact: where they are level, chance
/// would decide, and what it costs to be wrong is more than what it gains to be right. On an Intel Xeon the rates of lists over
/// those of single rays were 0.90 to 1.02 without it, and 1.08 to 1.23 for random rays beyond the cache; with it 0.94 to 1.02 and
/// 1.07 to 1.23.
const WORTH_TURNS: f64 = 0.95;

/// Rays of a stretch, at first and at most.
const STRETCH: [usize; 2] = [16 * 1024, 256 * 1024];

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
    let mut todo = (&rays[..count], &mut answers[..count]);
    let mut ask = |count: usize, in_turns: bool| {
        let (rays, answers) = take(&mut todo);
        let count = count.min(rays.len());
        let (rays, later_rays) = rays.split_at(count);
        let (answers, later_answers) = answers.split_at_mut(count);
        todo = (later_rays, later_answers);
        let question = PhantomData::<Q>;
        if in_turns {
            backend.run(InTurns { layout, primitives, rays, answers, question });
        } else {
            for (ray, answer) in rays.iter().zip(answers) {
                *answer = backend.run(Ask { layout, primitives, ray, recorder: &mut (), question });
            }
        }
        count
    };
    if !Clock::EXISTS || count < WORTH_A_TRIAL {
        ask(count, false);
        return;
    }
    let [shortest, longest] = STRETCH;
    let (mut stretch, mut was_in_turns) = (shortest, None);
    loop {
        let mut seconds = [0.0; 2];
        for in_turns in TRIALS {
            let clock = Clock::start();
            ask(TRIAL, in_turns);
            seconds[usize::from(in_turns)] += clock.seconds();
        }
        let in_turns = seconds[1] < WORTH_TURNS * seconds[0];
        stretch = if was_in_turns == Some(in_turns) { longest.min(2 * stretch) } else { shortest };
        was_in_turns = Some(in_turns);
        if ask(stretch, in_turns) == 0 {
            return;
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
    /// In a browser there is a standard library without one.
    const EXISTS: bool = cfg!(all(feature = "std", not(all(target_family = "wasm", target_os = "unknown"))));

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
