//! Which way to build? Measures all of them on scenes of yours, prints a table, and draws how quick the build is against
//! how quick the rays are.
//!
//! ```sh
//! cargo run --release --example chooser -- scene.glb
//! ```
//!
//! On one thread; without a scene, on procedural ones. No time is taken on a scene before the answers there were compared
//! with the naive reference's.

mod cli;
mod pareto;
mod picture;
mod survey;
mod table;
mod ways;

#[path = "../../benches/shared"]
mod shared {
    pub mod agreement;
    pub mod columns;
    pub mod file;
    pub mod labels;
    pub mod obvhs;
    pub mod timing;
}
#[path = "../../tests/support/mod.rs"]
mod support;
#[path = "../../benches/shared/tracing/mod.rs"]
mod tracing;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use support::scenes::NamedScene;
use survey::Survey;

/// Seen from outside, from inside, and without a surface.
const PROCEDURAL: [&str; 3] = ["closed-mesh", "interior", "clustered-soup"];
/// Triangles of each.
const SIZE: usize = 100_000;

fn main() -> Result<()> {
    let options = cli::Options::parse();
    // Builds use the pool that they are called in, ours and obvhs's.
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| run(&options))
}

fn run(options: &cli::Options) -> Result<()> {
    let mut surveys = Vec::new();
    for scene in scenes(options)? {
        eprintln!("{}: {} triangles", scene.name, scene.triangles.len());
        surveys.push(Survey::new(&scene, options.rays));
    }
    table::print(&surveys);
    let path = &options.svg;
    picture::draw(path, &surveys).with_context(|| format!("cannot draw {}", path.display()))?;
    println!("\n{}", path.display());
    Ok(())
}

fn scenes(options: &cli::Options) -> Result<Vec<NamedScene>> {
    if options.scenes.is_empty() {
        let procedural = support::scenes::all(SIZE).into_iter();
        return Ok(procedural.filter(|scene| PROCEDURAL.contains(&&*scene.name)).collect());
    }
    let load = |path: &std::path::PathBuf| {
        let scene = shared::file::scene(path)?;
        ensure!(!scene.triangles.is_empty(), "{} has no triangles", path.display());
        Ok(scene)
    };
    options.scenes.iter().map(load).collect()
}
