//! Criterion's groups: build, closest hit and any hit, for each scene and size.

use crate::hierarchy::Method;
use crate::shared::criterion::flat_group;
use crate::workload::Workload;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion};

/// Measures builds and queries of a scene.
///
/// `size` is the nominal number of triangles; the scene may have a few less.
pub fn measure(criterion: &mut Criterion, size: usize, workload: &Workload, methods: &[Method]) {
    let Workload { name, triangles, closest, any } = workload;
    let mut group = |query: &str, elements: usize, bench: &dyn Fn(&mut BenchmarkGroup<'_, WallTime>)| {
        let mut group = flat_group(criterion, format!("{query}/{name}/{size}"), elements);
        bench(&mut group);
        group.finish();
    };

    let builds: Vec<_> = methods.iter().map(|method| (method.name, (method.prepare)(triangles))).collect();
    group("build", triangles.len(), &|group| {
        for (name, build) in &builds {
            group.bench_function(*name, |bencher| bencher.iter_with_large_drop(build));
        }
    });

    let built: Vec<_> = builds.iter().map(|(name, build)| (name, build())).collect();
    group("closest", closest.len(), &|group| {
        for (name, hierarchy) in &built {
            let mut hits = Vec::new();
            group.bench_function(**name, |bencher| {
                bencher.iter(|| hierarchy.closest_hits(closest, &mut hits))
            });
        }
    });
    group("any", any.len(), &|group| {
        for (name, hierarchy) in &built {
            let mut hits = Vec::new();
            group.bench_function(**name, |bencher| bencher.iter(|| hierarchy.any_hits(any, &mut hits)));
        }
    });
}
