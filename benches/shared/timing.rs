//! Times of several candidates, measured side by side.

use std::time::{Duration, Instant};

/// Returns the median duration of each candidate's `run`; see [`turns`].
pub fn interleaved<T>(
    candidates: usize,
    repetitions: usize,
    prepare: impl FnMut(usize),
    run: impl FnMut(usize) -> T,
) -> Vec<Duration> {
    turns(candidates, repetitions, prepare, run).into_iter().map(median).collect()
}

/// Returns the durations of each candidate's `run`, by the candidate's position.
///
/// The call of `prepare` before each `run` and the drop of the result are not timed.
///
/// Candidates take turns, in an order that is reversed each time (A B C, C B A, ...). So a machine
/// that slows down meanwhile slows all of them down alike.
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

/// Returns the median; for an even number, the later of the two in the middle.
pub fn median(mut durations: Vec<Duration>) -> Duration {
    durations.sort_unstable();
    durations[durations.len() / 2]
}

/// Returns millions of rays per second.
pub fn mega_rays(rays: usize, time: Duration) -> f64 {
    rays as f64 / time.as_secs_f64() / 1e6
}
