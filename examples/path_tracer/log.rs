//! The program's lines on standard output.
//!
//! A closed pipe is not an error: the picture is the program's real output.

use std::fmt::Display;
use std::io::Write;
use std::time::{Duration, Instant};

/// Prints a line.
pub fn line(text: impl Display) {
    let _ = writeln!(std::io::stdout(), "[PathTracer] {text}");
}

/// Prints text as it is, for tables.
pub fn plain(text: impl Display) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Runs a step of the program between the two halves of a printed line.
///
/// The first half is `text`, the second tells how the step ended. On success it is `done` of the
/// time that the step took.
pub fn step<T, E>(
    text: impl Display,
    done: impl Fn(Duration) -> String,
    run: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    let mut out = std::io::stdout();
    let _ = write!(out, "[PathTracer] {text}... ").and_then(|()| out.flush());
    let start = Instant::now();
    let result = run();
    let end = if result.is_ok() { done(start.elapsed()) } else { "Failed.".to_owned() };
    let _ = writeln!(out, "{end}");
    result
}

/// Returns the usual end of a step's line.
pub fn done(time: Duration) -> String {
    format!("Done! ({:.4} sec)", time.as_secs_f64())
}
