//! A minimal path tracer on top of `bvhkit`.
//!
//! It loads a scene, builds a tree, renders, and saves a PNG.
//! `cargo run --release -p path_tracer` renders a Cornell box that needs no file;
//! `-- --help` lists the options.

mod cli;
mod compare;
mod film;
mod heatmap;
mod integrator;
mod lights;
mod log;
mod render;
mod sampling;
#[cfg_attr(not(test), expect(dead_code, reason = "benches and tests include the folder and use more of it"))]
mod scene;
mod tracer;

use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use bvhkit::Counters;
use glam::{UVec2, Vec3};
use image::RgbImage;
use indicatif::{ProgressBar, ProgressStyle};

use cli::{Options, View};
use integrator::Integrator;
use render::{Rendered, Shot, render};
use scene::{Camera, Scene};
use tracer::Tracer;

/// The height of the picture, unless the command line gives a size.
const HEIGHT: u32 = 480;

fn main() -> ExitCode {
    match Options::from_arguments().and_then(|options| run(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // The error is one line, even if a loader's message has several.
            let text = format!("{error:#}");
            let words: Vec<&str> = text.split_whitespace().collect();
            eprintln!("[PathTracer] Error: {}", words.join(" "));
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<()> {
    let output = options.output.clone().unwrap_or_else(|| default_output(options));
    let name = options.scene.as_ref().map(|path| path.display().to_string());
    log::line(format_args!("Input scene file: {}", name.as_deref().unwrap_or("(Cornell box)")));
    let threads = options.threads.map(usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
    log::line(format_args!("Rendering using {} threads", pool.current_num_threads()));

    let mut scene = log::step("Collecting primitives", log::done, || match &options.scene {
        Some(path) => load(path),
        None => Ok(scene::cornell_box()),
    })?;
    if !options.compare {
        ensure_writable(&output, options.scene.as_deref())?;
    }
    let max_leaf_size = options.max_leaf_size.map(usize::from);
    let threads = pool.current_num_threads();
    let building = format!("Building BVH from {} primitives", scene.shapes.len());
    let tracer = log::step(building, log::done, || {
        Tracer::build(scene.shapes.clone(), options.heuristic, max_leaf_size, threads)
    })?;
    scene::view::complete(&mut scene, |ray| {
        tracer.closest_hit(ray, &mut Counters::default()).map(|hit| (hit.t, hit.index))
    });
    let camera = scene.camera.context("the scene has no camera")?;
    let shot = Shot { camera, size: picture_size(options, &camera), samples: samples(options) };

    if options.compare {
        let rays = pool.install(|| collect_rays(options, &scene, &tracer, &shot));
        log::line(format_args!("Comparing on {} rays.", rays.len()));
        log::plain(compare::table(&scene.shapes, &rays, max_leaf_size, threads)?);
    } else {
        let image = pool.install(|| picture(options, &scene, &tracer, &shot));
        let saving = format!("Saving to file: {}", output.display());
        log::step(saving, |_| "Done!".to_owned(), || film::save(&image, &output))?;
    }
    log::line("Job completed.");
    Ok(())
}

/// Loads the scene.
///
/// The loaders may panic on malformed files. Such a panic becomes an
/// error like any other, in one line.
fn load(path: &Path) -> Result<Scene> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let result = std::panic::catch_unwind(|| scene::load(path));
    std::panic::set_hook(hook);
    result.unwrap_or_else(|_| anyhow::bail!("{}: the file is malformed", path.display()))
}

/// Renders, prints how it went, and turns the result into an image.
fn picture(options: &Options, scene: &Scene, tracer: &Tracer, shot: &Shot) -> RgbImage {
    let start = std::time::Instant::now();
    let progress = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent}% {eta} left") {
        progress.set_style(style);
    }
    let rendered = render_view(options, scene, tracer, shot, 0, &progress);
    progress.finish_and_clear();
    report(&rendered.counters, start.elapsed());

    match options.view {
        View::Path => rendered.film.tone_mapped(),
        View::Normals => rendered.film.to_image(|color| color),
        View::Heatmap => {
            let (image, scale) = heatmap::image(&rendered.film);
            log::line(format_args!("Heatmap from 0 to {scale} nodes and primitives per ray."));
            image
        }
    }
}

fn render_view(
    options: &Options,
    scene: &Scene,
    tracer: &Tracer,
    shot: &Shot,
    keep_every: u64,
    progress: &ProgressBar,
) -> Rendered {
    let integrator = Integrator::new(scene, options.bounces);
    render(shot, tracer, keep_every, progress, |ray, caster, rng| match options.view {
        View::Path => integrator.radiance(ray, caster, rng),
        View::Normals => integrator.normal_color(ray, caster),
        View::Heatmap => {
            let before = caster.counters;
            caster.closest_hit(ray);
            let nodes = caster.counters.nodes - before.nodes;
            let primitives = caster.counters.primitives - before.primitives;
            Vec3::splat((nodes + primitives) as f32)
        }
    })
}

/// Returns the rays of the picture, or evenly spaced ones if there are too many.
///
/// The naive loop limits their number. A first picture of one sample per pixel
/// tells how many rays to expect.
fn collect_rays(options: &Options, scene: &Scene, tracer: &Tracer, shot: &Shot) -> Vec<tracer::Query> {
    let hidden = ProgressBar::hidden();
    let first = Shot { samples: 1, ..*shot };
    let per_sample = render_view(options, scene, tracer, &first, 0, &hidden).counters.rays;
    let expected = per_sample * u64::from(shot.samples);
    let keep_every = expected.div_ceil(compare::ray_budget(scene.shapes.len())).max(1);
    render_view(options, scene, tracer, shot, keep_every, &hidden).rays
}

fn report(counters: &Counters, time: Duration) {
    let rays = counters.rays as f64;
    let seconds = time.as_secs_f64();
    log::line(format_args!("Rendering... 100%! ({seconds:.4}s)"));
    log::line(format_args!("BVH traced {} rays.", counters.rays));
    log::line(format_args!("Average speed {:.4} million rays per second.", 1e-6 * rays / seconds));
    log::line(format_args!(
        "Averaged {:.6} intersection tests per ray.",
        counters.primitives as f64 / rays.max(1.0)
    ));
}

fn picture_size(options: &Options, camera: &Camera) -> UVec2 {
    options.size.unwrap_or_else(|| {
        let aspect = match (camera.aspect, &options.scene) {
            (Some(aspect), _) => aspect.clamp(0.1, 10.0),
            (None, Some(_)) => 4.0 / 3.0,
            (None, None) => 1.0,
        };
        UVec2::new((HEIGHT as f32 * aspect).round() as u32, HEIGHT)
    })
}

fn samples(options: &Options) -> u32 {
    options.spp.unwrap_or(match (options.view, &options.scene) {
        _ if options.compare => 1,
        (View::Heatmap, _) => 1,
        (View::Normals, _) => 4,
        (View::Path, Some(_)) => 32,
        (View::Path, None) => 96,
    })
}

fn default_output(options: &Options) -> PathBuf {
    let stem = options.scene.as_ref().and_then(|path| path.file_stem());
    Path::new(stem.unwrap_or("cornell".as_ref())).with_extension("png")
}

/// Checks that the output can be written, so that a failure comes before rendering.
fn ensure_writable(output: &Path, scene: Option<&Path>) -> Result<()> {
    let same =
        |scene: &Path| matches!((output.canonicalize(), scene.canonicalize()), (Ok(a), Ok(b)) if a == b);
    ensure!(!scene.is_some_and(same), "{} is the scene itself: choose another output", output.display());
    let opened = OpenOptions::new().write(true).create(true).truncate(false).open(output);
    opened.with_context(|| format!("cannot write {}", output.display())).map(drop)
}
