//! No ray leaves a closed mesh, and no tree differs from the naive loop.
//!
//! Some 100,000 rays run with the other tests; `BVHKIT_RAYS` sets any other number:
//!
//! ```sh
//! BVHKIT_RAYS=100000000 cargo test --release --test public many_rays:: -- \
//!     --nocapture --test-threads 1
//! ```

#[path = "../support/closed.rs"]
mod closed;

use crate::common::answers::Answers;
use crate::common::modes::Mode;
use crate::common::soups::{self, KINDS, soup};
use crate::common::textbook::Textbook;
use bvhkit::heuristic::{BinnedSah, Heuristic, Median, Midpoint, SweepSah};
use bvhkit::{Bvh, Fast, Intersect, Precise, Ray, Scalar, Triangle, Watertight};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

fn wanted() -> usize {
    std::env::var("BVHKIT_RAYS").map_or(100_000, |rays| rays.parse().expect("BVHKIT_RAYS is a number"))
}

/// Scales and offsets of meshes.
///
/// The last two offsets are a million times the size of the mesh.
const PLACES: [(f64, f64); 8] =
    [(1e-6, 0.0), (1.0, 0.0), (1e6, 0.0), (1e-6, 1e-3), (1.0, 1e3), (1e6, 1e6), (1e-6, 1.0), (1.0, 1e6)];

/// Maximum number of rays from one origin.
const BATCH: usize = 20_000;

/// Returns a point of the mesh's box that is exactly inside the mesh.
fn origin_inside(mesh: &[Triangle], rng: &mut Pcg64Mcg) -> [f32; 3] {
    let corners = || mesh.iter().flat_map(|t| [t.a, t.b, t.c]);
    let end = |axis: usize, pick: fn(f32, f32) -> f32| corners().map(|p| p[axis]).reduce(pick).unwrap();
    loop {
        let point = [0, 1, 2].map(|k| {
            let (min, max) = (end(k, f32::min), end(k, f32::max));
            min + (max - min) * rng.random::<f32>()
        });
        let direction = [0.0; 3].map(|_: f32| rng.random_range(-1.0..1.0));
        if closed::encloses(mesh, &Ray::new(point, direction)) == Some(true) {
            return point;
        }
    }
}

/// Returns a ray aimed at a corner, or at a rounded point of an edge.
///
/// `number` chooses the target, and a direction of any length or of about length 1.
fn aimed(mesh: &[Triangle], origin: [f32; 3], number: usize, rng: &mut Pcg64Mcg) -> Ray {
    let triangle = &mesh[rng.random_range(0..mesh.len())];
    let mut corners = [triangle.a, triangle.b, triangle.c];
    corners.rotate_left(rng.random_range(0..3));
    let [a, b, _] = corners;
    let along = if number.is_multiple_of(2) { 0.0 } else { rng.random::<f32>() };
    let way = [0, 1, 2].map(|k| a[k] + along * (b[k] - a[k]) - origin[k]);
    let length = way.map(|x| f64::from(x) * f64::from(x)).iter().sum::<f64>().sqrt();
    if number % 4 < 2 || length == 0.0 {
        Ray::new(origin, way)
    } else {
        Ray::new(origin, way.map(|x| (f64::from(x) / length) as f32))
    }
}

/// Returns the number of rays that hit nothing.
fn leaks<P: Intersect + Sync>(triangles: impl Iterator<Item = P>, rays: &[Ray]) -> usize {
    let bvh = Bvh::build(triangles).unwrap();
    let widened = |p: [f32; 3]| p.map(|x| P::Scalar::from_f64(f64::from(x)));
    let leaks = |ray: &&Ray| !bvh.any_hit(&Ray::new(widened(ray.origin), widened(ray.direction)));
    rays.par_iter().filter(leaks).count()
}

fn widened(triangle: &Triangle) -> Triangle<f64> {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.map(f64::from));
    Triangle::new(a, b, c)
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let size = if wanted() > 1_000_000 { 10_000 } else { 500 };
    let meshes = closed::all(size);
    let batches = wanted().div_ceil(meshes.len() * PLACES.len() * BATCH.min(wanted() / 40));
    let per_batch = wanted().div_ceil(batches * meshes.len() * PLACES.len());
    let (mut rays, mut leaking) = (0, [0; 5]);
    for (name, mesh) in &meshes {
        for (scale, offset) in PLACES {
            let mesh = closed::placed(mesh, scale, offset);
            let mut rng = Pcg64Mcg::seed_from_u64(1);
            let aimed: Vec<Ray> = (0..batches)
                .flat_map(|_| {
                    let origin = origin_inside(&mesh, &mut rng);
                    (0..per_batch).map(|i| aimed(&mesh, origin, i, &mut rng)).collect::<Vec<_>>()
                })
                .filter(|ray| ray.validate().is_ok())
                .collect();
            let here = [
                leaks(mesh.iter().map(Watertight), &aimed),
                leaks(mesh.iter().map(Precise), &aimed),
                leaks(mesh.iter().map(widened), &aimed),
                leaks(mesh.iter().map(Fast), &aimed),
                leaks(mesh.iter().copied().map(Textbook), &aimed),
            ];
            rays += aimed.len();
            println!("{name}, size {scale:e} at {offset:e}: {here:?} of {} rays leak", aimed.len());
            for (all, here) in leaking.iter_mut().zip(here) {
                *all += here;
            }
        }
    }
    println!("Watertight, Precise, f64, Fast, textbook: {leaking:?} of {rays} rays leak");
    assert_eq!(leaking[..3], [0; 3]);
    assert!(leaking[4] > rays / 1000, "the rays find no gaps where there are some");
    assert!(rays > wanted() / 10 * 9);
}

/// Returns the number of compared answers and the number of those that differ.
///
/// Four heuristics build trees, each with another leaf size.
fn differences<M: Mode>(kind: usize, seed: u64) -> [usize; 2] {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let bare = soup::<M::Number>(kind, rng.random_range(1..64), &mut rng);
    let triangles: Vec<M> = bare.iter().copied().map(M::of).collect();
    let heuristics: [&dyn Heuristic<M::Number>; 4] =
        [&Median, &Midpoint, &BinnedSah::default(), &SweepSah::default()];
    let trees: Vec<Bvh<&M>> = heuristics
        .iter()
        .zip([1, 2, 4, 8])
        .map(|(heuristic, size)| {
            Bvh::builder().heuristic(*heuristic).max_leaf_size(size).build(&triangles).unwrap()
        })
        .collect();
    let mut counts = [0; 2];
    for _ in 0..500 {
        let ray = soups::ray(&bare, &mut rng);
        let expected = Answers::naive(&triangles, &ray);
        for tree in &trees {
            let is_same = Answers::of(tree, &ray) == expected;
            counts[0] += 1;
            counts[1] += usize::from(!is_same);
            if !is_same {
                println!("kind {kind}, seed {seed}: {ray:?}");
            }
        }
    }
    counts
}

#[test]
fn every_tree_is_the_naive_loop() {
    type Differences = fn(usize, u64) -> [usize; 2];
    let modes: [(&str, Differences); 5] = [
        ("Fast", differences::<Fast<Triangle>>),
        ("Watertight", differences::<Watertight<Triangle>>),
        ("Precise", differences::<Precise<Triangle>>),
        ("Fast f64", differences::<Fast<Triangle<f64>>>),
        ("Watertight f64", differences::<Watertight<Triangle<f64>>>),
    ];
    // A scene compares 2,000 answers: 500 rays in four trees.
    let scenes = wanted().div_ceil(2000 * KINDS * modes.len()) as u64;
    let mut all = [0; 2];
    for (name, differences) in modes {
        let sum = |a: [usize; 2], b: [usize; 2]| [a[0] + b[0], a[1] + b[1]];
        let jobs: Vec<_> = (0..KINDS).flat_map(|kind| (0..scenes).map(move |seed| (kind, seed))).collect();
        let counts = jobs.into_par_iter().map(|(kind, seed)| differences(kind, seed)).reduce(|| [0; 2], sum);
        println!("{name}: {} of {} answers differ from the naive loop's", counts[1], counts[0]);
        all = sum(all, counts);
    }
    assert!(all[0] >= wanted());
    assert_eq!(all[1], 0);
}
