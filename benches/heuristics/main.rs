//! Builds and traces with every heuristic, and with `obvhs`.
//!
//! The scenes are procedural ones and the file that the environment variable
//! `BVHKIT_SCENE` names, if it is set.
//!
//! `cargo bench --bench heuristics` measures with criterion, then prints one table of everything
//! side by side. Its times are taken after the answers are compared with those of the naive
//! reference. All of it runs on one thread. A filter, such as `-- build/terrain`, applies to
//! criterion alone: one that matches nothing prints just the table.

mod check;
mod groups;
mod hierarchy;
mod ours;
mod peer;
mod table;
mod workload;

#[path = "../shared/mod.rs"]
mod shared;
#[path = "../../tests/support/mod.rs"]
mod support;

use hierarchy::Method;
use workload::Workload;

/// The amount of work.
struct Extent {
    /// Triangles of the procedural scenes that criterion measures.
    sizes: &'static [usize],
    /// Rays of each kind for criterion.
    rays: usize,
    /// Triangles of the procedural scenes in the table.
    table_size: usize,
    /// Rays of each kind for the table.
    table_rays: usize,
    /// Repetitions of the table's measurements.
    repetitions: usize,
}

const BENCH: Extent = Extent {
    sizes: &[1_000, 10_000, 100_000],
    rays: 1 << 12,
    table_size: 100_000,
    table_rays: 1 << 14,
    repetitions: 5,
};

/// Just enough to see that everything runs.
const TEST: Extent = Extent { sizes: &[200], rays: 64, table_size: 500, table_rays: 256, repetitions: 1 };

fn main() -> anyhow::Result<()> {
    let extent = if shared::extent::is_bench() { BENCH } else { TEST };
    // Parallel builds use the pool that they are called in.
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| run(&extent))
}

fn run(extent: &Extent) -> anyhow::Result<()> {
    let methods: Vec<Method> = ours::methods().into_iter().chain(peer::methods()).collect();
    let file = shared::environment::scene()?;

    let mut criterion = shared::criterion::brief_criterion();
    for &size in extent.sizes {
        for scene in support::scenes::all(size) {
            groups::measure(&mut criterion, size, &Workload::new(&scene, extent.rays), &methods);
        }
    }
    if let Some(scene) = &file {
        let size = scene.triangles.len();
        groups::measure(&mut criterion, size, &Workload::new(scene, extent.rays), &methods);
    }
    criterion.final_summary();

    let scenes = support::scenes::all(extent.table_size).into_iter().chain(file);
    let workloads = scenes.map(|scene| Workload::new(&scene, extent.table_rays));
    table::print(workloads, &methods, extent.repetitions);
    Ok(())
}
