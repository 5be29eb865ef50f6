//! Criterion as the benches use it.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode, Throughput};
use std::time::Duration;

/// Returns a criterion with brief measurements, for there are many.
///
/// The command line may say otherwise.
pub fn brief_criterion() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_millis(300))
        .without_plots()
        .configure_from_args()
}

/// Returns a group whose iterations each take milliseconds.
///
/// All samples have equally many iterations: more in later samples would only cost time.
pub fn flat_group(criterion: &mut Criterion, name: String, elements: usize) -> BenchmarkGroup<'_, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(elements as u64));
    group
}
