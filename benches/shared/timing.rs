//! Times of several candidates, measured side by side.

use std::time::{Duration, Instant};

/// The median duration of each candidate's `run`; see [`turns`].
pub fn interleaved<T>(
    candidates: usize,
    repetitions: usize,
    prepare: impl FnMut(usize),
    run: impl FnMut(usize) -> T,
) -> Vec<Duration> {
    turns(candidates, repetitions, prepare, run).into_iter().map(median).collect()
}

/// The durations of each candidate's `run`, by its position, without dropping its result; what comes of `prepare` just
/// before is not timed.
///
/// Candidates take turns, in an order reversed each time (A B C, C B A, ...), so that a machine that
/// slows down meanwhile slows all of them down alike.
pub fn turns<T>(
    candidates: usize,
    repetitions: usize,
    mut prepare: impl FnMut(usize),
    mut run: impl FnMut(usize) -> T,
) -> Vec<Vec<Duration>> {
    let mut durations = vec![Vec::with_capacity(repetitions); candidates];
    for repetition in 0..repetitions {
        for turn in 0..candidates {
            let candidate = if repetition % 2 == 0 { turn } else { candidates - 1 - turn };
            prepare(candidate);
            let start = Instant::now();
            let result = run(candidate);
            durations[candidate].push(start.elapsed());
            drop(result);
        }
    }
    durations
}

/// Of an even number, the later of the two in the middle.
pub fn median(mut durations: Vec<Duration>) -> Duration {
    durations.sort_unstable();
    durations[durations.len() / 2]
}

/// Millions a second.
pub fn mega_rays(rays: usize, time: Duration) -> f64 {
    rays as f64 / time.as_secs_f64() / 1e6
}
