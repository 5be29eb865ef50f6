//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Parser, ValueEnum};
use glam::UVec2;

use crate::tracer::Method;

/// Maximum number of pixels; a picture of more is taken for a mistake.
const MAX_PIXELS: u64 = 1 << 26;

/// Renders a scene by path tracing, with or without a bounding volume hierarchy.
#[derive(Parser)]
#[command(name = "path_tracer", version)]
pub struct Options {
    /// A COLLADA (.dae), OBJ or glTF (.glb, .gltf) file; without it, a Cornell box is rendered
    pub scene: Option<PathBuf>,

    /// The heuristic that builds the tree; none tests every primitive
    #[arg(long, value_enum, default_value_t = Method::BinnedSah)]
    pub heuristic: Method,

    /// The most primitives in a leaf of the binary tree; leaves of the wide tree hold up
    /// to 8 [default: the library's]
    #[arg(long, value_name = "N")]
    pub max_leaf_size: Option<NonZeroUsize>,

    /// Threads to render with [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,

    /// Samples per pixel [default: 1 to compare or for a heatmap, 4 for
    /// normals, else 32; 96 for the box]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub spp: Option<u32>,

    /// Maximum number of bounces of a path; 0 is direct light alone
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub bounces: u32,

    /// Width and height of the picture in pixels [default: 480 high, as wide as the camera says]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<UVec2>,

    /// Path of the PNG [default: the scene's name in the current directory]
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Contents of the picture
    #[arg(long, value_enum, default_value_t = View::Path)]
    pub view: View,

    /// Casts the same rays by every method and prints a table instead of saving a picture
    #[arg(long)]
    pub compare: bool,
}

/// The contents of the picture.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum View {
    /// Light
    Path,
    /// Shading normals as colours
    Normals,
    /// Nodes plus primitives tested by each pixel's camera rays
    Heatmap,
}

impl Options {
    /// Parses the program's arguments.
    ///
    /// If they ask for help, prints it and ends the program.
    ///
    /// # Errors
    ///
    /// If the arguments are wrong; the message is one line.
    pub fn from_arguments() -> anyhow::Result<Self> {
        Self::try_parse().map_err(|error| {
            if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
                error.exit();
            }
            // The first paragraph is the error. The rest is advice on usage.
            let text = error.to_string();
            let first = text.split("\n\n").next().unwrap_or_default();
            let line: Vec<&str> = first.split_whitespace().collect();
            anyhow::anyhow!("{}", line.join(" ").trim_start_matches("error: "))
        })
    }
}

fn parse_size(text: &str) -> Result<UVec2, String> {
    let sides = text
        .split_once(['x', 'X'])
        .and_then(|(width, height)| Some(UVec2::new(width.parse().ok()?, height.parse().ok()?)));
    let size = sides.ok_or("expected WIDTHxHEIGHT, such as 640x480")?;
    match u64::from(size.x) * u64::from(size.y) {
        0 => Err("width and height must be at least 1".to_owned()),
        pixels if pixels > MAX_PIXELS => Err(format!("more than {MAX_PIXELS} pixels")),
        _ => Ok(size),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok(UVec2::new(640, 480)));
        for bad in ["", "640", "0x480", "640x0", "-1x5", "640x480x3", "axb", "65536x65536"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
