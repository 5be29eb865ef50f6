//! The command line.

use clap::Parser;
use std::path::PathBuf;

/// Measures every way to build a hierarchy: its build time and its speed of rays.
#[derive(Parser)]
#[command(name = "chooser", version)]
pub struct Options {
    /// COLLADA (.dae), OBJ or glTF (.glb, .gltf) files; without any, procedural scenes
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,

    /// Path of the picture
    #[arg(long, value_name = "FILE", default_value = "target/chooser.svg")]
    pub svg: PathBuf,

    /// Rays of each kind
    #[arg(long, value_name = "N", default_value_t = 1 << 13, value_parser = parse_rays)]
    pub rays: usize,
}

/// Maximum number of rays of each kind, whose answers are kept in memory.
const MAX_RAYS: usize = 1 << 24;

fn parse_rays(text: &str) -> Result<usize, String> {
    let rays = text.parse().map_err(|_| "not a number")?;
    if (1..=MAX_RAYS).contains(&rays) { Ok(rays) } else { Err(format!("expected 1 to {MAX_RAYS}")) }
}
