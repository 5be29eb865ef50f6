//! Real scene files against the naive loop, if the files are there.
//!
//! The folder is the one that `BVHKIT_SCENES` names, or `../shared/scenes` beside the crate.
//! Without the folder, the tests pass and say so.

use crate::common::answers::{Answers, key};
use crate::common::rays::Aims;
use crate::scene::{self, Shape};
use bvhkit::heuristic::{BinnedSah, Heuristic, Median, Midpoint, SweepSah};
use bvhkit::{Bvh, reference};
use rayon::prelude::*;
use std::path::PathBuf;

/// The files, each with its number of triangles and spheres.
const FILES: [(&str, usize); 15] = [
    ("cow.dae", 5_856),
    ("teapot.dae", 2_464),
    ("CBempty.dae", 12),
    ("CBspheres.dae", 14),
    ("CBbunny.dae", 28_588),
    ("sphere_diffuse.dae", 1),
    ("sponza.glb", 279_163),
    ("kitchen.glb", 56_939),
    ("spaceship.glb", 258_446),
    ("hotel_room.glb", 99_029),
    ("building.glb", 39_506),
    ("armadillo.glb", 86_482),
    ("bunny.glb", 69_630),
    ("dragon.glb", 202_520),
    ("hairball.glb", 240_000),
];

/// Returns the shapes of a file; if it is missing, says so and returns `None`.
fn load(name: &str) -> Option<Vec<Shape>> {
    let folder = std::env::var_os("BVHKIT_SCENES").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes")),
        PathBuf::from,
    );
    let path = folder.join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there (BVHKIT_SCENES names the folder)", path.display());
        return None;
    }
    Some(scene::load(&path).unwrap().shapes)
}

fn trees(shapes: &[Shape]) -> [Bvh<&Shape>; 4] {
    let heuristics: [&dyn Heuristic<f32>; 4] =
        [&Median, &Midpoint, &BinnedSah::default(), &SweepSah::default()];
    heuristics.map(|heuristic| {
        let bvh = Bvh::builder().heuristic(heuristic).build(shapes).unwrap();
        bvh.check().unwrap();
        bvh
    })
}

#[test]
fn every_file_loads_and_agrees_with_the_naive_loop() {
    for (name, count) in FILES {
        let Some(shapes) = load(name) else { continue };
        assert_eq!(shapes.len(), count, "{name}");
        let aims = Aims::new(&shapes);
        let trees = trees(&shapes);
        // Larger scenes get fewer rays.
        let rays: Vec<_> = (0..(10_000_000 / shapes.len() as u64).min(400)).map(|i| aims.ray(i)).collect();
        let hits: usize = rays
            .par_iter()
            .map(|ray| {
                let answers = Answers::naive(&shapes, ray);
                for bvh in &trees {
                    assert_eq!(Answers::of(bvh, ray), answers, "{name}, {ray:?}");
                }
                answers.hits.len()
            })
            .sum();
        assert!(hits > rays.len() / 4, "{name}: {hits} hits of {} rays", rays.len());
    }
}

/// Tests of one shape to spend on each file, so that smaller files get more rays.
const TESTS: u64 = 3_000_000_000;
/// Maximum number of rays for one file.
const MOST_RAYS: u64 = 3_000_000;

#[test]
#[ignore = "takes minutes: cargo test --release --test public real_files:: -- --ignored --nocapture"]
fn ten_million_rays_agree_with_the_naive_loop() {
    let (mut rays, mut differences) = (0, 0);
    println!("{:<20} {:>9} {:>10} {:>10} {:>11}", "file", "shapes", "rays", "hits", "differences");
    for (name, _) in FILES {
        let Some(shapes) = load(name) else { continue };
        let aims = Aims::new(&shapes);
        let trees = trees(&shapes);
        let count = (TESTS / shapes.len() as u64).min(MOST_RAYS);
        let agree = |i: u64| {
            let ray = aims.ray(i);
            let closest = reference::closest_hit(&shapes, &ray).map(key);
            let differ = |bvh: &Bvh<_>| bvh.closest_hit(&ray).map(key) != closest;
            (u64::from(closest.is_some()), trees.iter().filter(|bvh| differ(bvh)).count())
        };
        let (hits, differ) =
            (0..count).into_par_iter().map(agree).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        println!("{name:<20} {:>9} {count:>10} {hits:>10} {differ:>11}", shapes.len());
        rays += count;
        differences += differ;
    }
    println!("{differences} differences of {rays} rays, each through four trees");
    assert_eq!(differences, 0);
    assert!(rays == 0 || rays >= 10_000_000, "only {rays} rays: are files missing?");
}
