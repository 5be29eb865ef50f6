//! Measures all ways to build a hierarchy on scenes of yours.
//!
//! Prints a table, and draws the speed of the rays against the time of the build.
//!
//! ```sh
//! cargo run --release --example chooser -- scene.glb
//! ```
//!
//! Everything runs on one thread. Without a scene, procedural ones are measured. No scene is timed
//! before its answers are compared with those of the naive reference.

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

/// Procedural scenes: seen from outside, from inside, and without a surface.
const PROCEDURAL: [&str; 3] = ["closed-mesh", "interior", "clustered-soup"];
/// Triangles of each procedural scene.
const SIZE: usize = 100_000;

fn main() -> Result<()> {
    let options = cli::Options::parse();
    // Builds of this crate and of `obvhs` use the pool that they are called in.
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
