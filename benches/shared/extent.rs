//! The choice between measuring and a test run.

/// Returns whether to measure, as `cargo bench` asks for.
///
/// `cargo test` passes no `--bench`; then the bench only has to show that everything runs.
pub fn is_bench() -> bool {
    // The same rule as in criterion.
    let argument = |wanted: &str| std::env::args().any(|argument| argument == wanted);
    argument("--bench") && !argument("--test")
}
