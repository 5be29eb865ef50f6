//! Measures the accuracy of triangle tests against exact arithmetic, and its cost.
//!
//! The tests are those of this crate's modes, of [obvhs](https://github.com/DGriffin91/obvhs) and
//! of [bvh](https://github.com/svenstaro/bvh).
//!
//! `cargo bench --bench accuracy` prints two tables. It writes `accuracy.csv` and
//! `accuracy.svg` into `target/accuracy`, or into the folder that the environment variable
//! `BVHKIT_ACCURACY` names. If `BVHKIT_SCENE` names the file of a scene, the scene is
//! measured too, in a table of its own.

mod aim;
mod bvh_peer;
mod judge;
mod mesh;
mod miss;
mod ours;
mod peers;
mod picture;
mod self_hits;
mod sheet;
mod speed;
mod table;
mod tally;
mod tracer;
mod truth;

#[path = "../../tests/support/closed.rs"]
mod closed;
#[path = "../shared/columns.rs"]
#[expect(dead_code, reason = "this bench has its own way with numbers")]
mod columns;
#[path = "../shared/environment.rs"]
mod environment;
#[path = "../shared/extent.rs"]
mod extent;
#[path = "../shared/file.rs"]
#[expect(unused_imports, reason = "the loader's unit tests are left out here")]
mod file;
#[path = "../shared/labels.rs"]
mod labels;
#[path = "../shared/obvhs.rs"]
#[expect(dead_code, reason = "any hit is not judged")]
mod obvhs_peer;
#[path = "../../tests/support/mod.rs"]
mod support;
#[path = "../shared/timing.rs"]
mod timing;

use judge::{Amount, Outcome, judge};
use mesh::{Mesh, Place};
use std::path::PathBuf;
use tracer::Contestant;

/// The amount of work.
struct Extent {
    /// Triangles of each mesh whose errors are counted.
    triangles: usize,
    amount: Amount,
    /// Triangles of the mesh that is timed.
    timed_triangles: usize,
    /// Timed rays of each kind.
    timed_rays: usize,
    repetitions: usize,
}

const BENCH: Extent = Extent {
    triangles: 10_000,
    amount: Amount { aimed: 30_000, naive_tests: 5_000_000 },
    timed_triangles: 100_000,
    timed_rays: 1 << 16,
    repetitions: 15,
};

/// Just enough to see that everything runs.
const TEST: Extent = Extent {
    triangles: 200,
    amount: Amount { aimed: 200, naive_tests: 2_000 },
    timed_triangles: 500,
    timed_rays: 64,
    repetitions: 1,
};

fn places() -> impl Iterator<Item = Place> {
    let near_and_far = |scale: f64| [0.0, 1e3].map(|sizes| Place { scale, offset: sizes * scale });
    let places = [1e-6, 1.0, 1e6].into_iter().flat_map(near_and_far);
    places.chain([1.0, 1e6].map(|scale| Place { scale, offset: 1e6 }))
}

fn main() -> anyhow::Result<()> {
    let extent = if extent::is_bench() { BENCH } else { TEST };
    mesh::check();
    let contestants: Vec<Contestant> = ours::contestants().into_iter().chain(peers::contestants()).collect();

    let torus = |n: usize| support::scenes::all(n).swap_remove(0);
    let speeds =
        speed::mega_rays(&torus(extent.timed_triangles), &contestants, extent.timed_rays, extent.repetitions);
    let meshes: Vec<Mesh> = [("torus", torus(extent.triangles).triangles)]
        .into_iter()
        .chain(closed::all(extent.triangles))
        .map(|(name, triangles)| Mesh::new(name, triangles))
        .collect();
    let at_all_places = |mesh| places().map(move |place| (mesh, place));
    let mut outcomes: Vec<Outcome> = meshes
        .iter()
        .flat_map(at_all_places)
        .map(|(mesh, place)| judge(mesh, place, &contestants, extent.amount))
        .collect();
    table::print(&contestants, &speeds, &outcomes);

    let folder = std::env::var_os("BVHKIT_ACCURACY").map_or_else(default_folder, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    picture::draw(&folder.join("accuracy.svg"), &contestants, &speeds, &outcomes)?;

    if let Some(scene) = environment::scene()? {
        let mesh = Mesh::new(scene.name, scene.triangles);
        let outcome = judge(&mesh, Place::HOME, &contestants, extent.amount);
        table::print_file(&contestants, &mesh, &outcome);
        outcomes.push(outcome);
    }
    sheet::write(&folder.join("accuracy.csv"), &contestants, &speeds, &outcomes)?;
    println!("\naccuracy.csv and accuracy.svg are in {}", folder.display());
    Ok(())
}

/// Returns a folder in the build folder.
fn default_folder() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).with_file_name("accuracy")
}
