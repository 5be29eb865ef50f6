//! Traces rays of every kind through every layout, and through `obvhs`.
//!
//! Rays are traced one by one and in batches, on one thread and on all, over several kinds of
//! primitives. The scenes are procedural ones and the file that the environment variable
//! `BVHKIT_SCENE` names, if it is set.
//!
//! `cargo bench --bench rays` measures with criterion, then prints one table of everything side
//! by side. No scene is timed before its answers are compared with those of the naive
//! reference. A filter, such as `-- shadow/interior`, applies to criterion alone: one that
//! matches nothing leaves the table. `RAYON_NUM_THREADS` is the number of threads where all are
//! used; if it is 1, columns are not repeated.

mod families;
mod groups;
mod primitives;
mod table;

#[path = "../shared/mod.rs"]
mod shared;
#[path = "../../tests/support/mod.rs"]
mod support;
#[path = "../shared/tracing/mod.rs"]
mod tracing;

/// Scenes seen from outside, from inside, and without a surface.
///
/// Scenes between these tell little more about a layout.
const SCENES: [&str; 3] = ["closed-mesh", "interior", "clustered-soup"];

/// The amount of work.
struct Extent {
    /// Triangles of the procedural scenes.
    size: usize,
    /// Rays of each kind.
    rays: usize,
    /// Tests of one primitive that the naive reference may spend on a family and scene.
    ///
    /// They take about a second.
    naive_tests: usize,
    /// Repetitions of the table's measurements.
    repetitions: usize,
}

const BENCH: Extent = Extent { size: 100_000, rays: 1 << 14, naive_tests: 100_000_000, repetitions: 5 };

/// Just enough to see that everything runs.
const TEST: Extent = Extent { size: 300, rays: 1100, naive_tests: 2_000_000, repetitions: 1 };

fn main() -> anyhow::Result<()> {
    let extent = if shared::extent::is_bench() { BENCH } else { TEST };
    let procedural = support::scenes::all(extent.size).into_iter();
    let scenes =
        procedural.filter(|scene| SCENES.contains(&&*scene.name)).chain(shared::environment::scene()?);

    let mut criterion = shared::criterion::brief_criterion();
    let mut table = table::empty();
    for scene in scenes {
        let families = families::all(&scene, extent.rays);
        let checks: Vec<_> = families
            .iter()
            .map(|family| tracing::check::check(&scene.name, family, extent.naive_tests))
            .collect();
        groups::measure(&mut criterion, &scene.name, &families);
        table::add(&mut table, &scene, &families, &checks, extent.repetitions);
    }
    criterion.final_summary();
    table::print(&table);
    Ok(())
}
