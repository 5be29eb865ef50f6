//! How much a bench is to do.

/// Whether to measure: by `cargo bench`. `cargo test` passes no `--bench`, and wants to see that everything runs.
pub fn is_bench() -> bool {
    // Criterion's own rule.
    let argument = |wanted: &str| std::env::args().any(|argument| argument == wanted);
    argument("--bench") && !argument("--test")
}
