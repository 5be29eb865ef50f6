//! A table by size: the time on one thread and on all, and the memory.

use crate::check::{Facts, Scene};
use crate::columns::{decimal, table};
use crate::methods::Method;
use crate::scenes::{soup, surface};
use crate::timing::interleaved;
use crate::{Extent, Pools};
use bvhkit::Triangle;
use std::cell::Cell;

const HEADER: [&str; 11] = [
    "scene",
    "triangles",
    "layout",
    "preset",
    "one thread, ns per triangle",
    "all threads",
    "one / all",
    "peak of one, bytes per triangle",
    "peak of all",
    "result with triangles",
    "depth",
];

/// Makes a scene of about so many triangles.
type Make = fn(usize) -> Vec<Triangle>;

const SCENES: [(&str, Make); 2] = [("soup", soup::scattered), ("surface", surface::closed_mesh)];

pub fn print(extent: &Extent, pools: &Pools, methods: &[Method]) {
    let mut table = table(HEADER, 4);
    for &size in &extent.sizes {
        for (name, make) in SCENES {
            let scene = Scene::new(name, make(size), extent);
            table.add_rows(rows(&scene, extent, pools, methods));
        }
    }
    let threads = pools[1].current_num_threads();
    println!(
        "\nBy size, in `Fast` mode, owned: medians of times, builds taking turns; all threads are {threads}. The peak is \
         what a build has\nallocated at the most beside the triangles, counted in a build that is not timed.\n\n{table}"
    );
}

fn rows(scene: &Scene, extent: &Extent, pools: &Pools, methods: &[Method]) -> Vec<Vec<String>> {
    let triangles = scene.triangles.len();
    let facts: Vec<Facts> = methods.iter().map(|method| scene.facts(method, pools)).collect();
    let input = Cell::new(Vec::new());
    // Each method runs on one thread, then on all.
    let times = interleaved(
        2 * methods.len(),
        extent.repetitions(triangles),
        |_| input.set(scene.triangles.clone()),
        |i| {
            let triangles = input.take();
            pools[i % 2].install(|| methods[i / 2].build(triangles))
        },
    );
    let row = |i: usize| {
        let (Method { layout, preset, .. }, Facts { peaks, bytes, depth }) = (&methods[i], &facts[i]);
        let [one, all] = [0, 1].map(|pool| times[2 * i + pool].as_secs_f64() * 1e9 / triangles as f64);
        let mut row = [scene.name, &triangles.to_string(), layout, preset].map(String::from).to_vec();
        row.extend([one, all].map(|ns| decimal(Some(ns), 0)));
        row.push(decimal(Some(one / all), 2));
        row.extend([peaks[0], peaks[1], *bytes].map(|bytes| decimal(Some(bytes), 0)));
        row.push(depth.to_string());
        row
    };
    (0..methods.len()).map(row).collect()
}
