//! The first build against later ones, in new memory and in memory that earlier ones left.

use crate::check::Scene;
use crate::columns::{self, decimal};
use crate::methods::{Built, Item, Method};
use crate::scenes::soup;
use crate::timing::median;
use crate::{Extent, Pools};
use bvhkit::{Fast, Workspace};
use std::time::{Duration, Instant};

const HEADER: [&str; 5] =
    ["triangles", "preset", "first build, ns per triangle", "later ones", "later ones in a workspace"];

const LEGEND: &str = "\
The soup in the default layout, one thread. The first build of each size, the first row's being the first of the process, and
medians of later ones, those in new memory and those in a workspace taking turns.";

pub fn print(extent: &Extent, pools: &Pools, methods: &[Method]) {
    let mut table = columns::table(HEADER, 1);
    for &size in &extent.sizes {
        let triangles = soup::scattered(size);
        let items: Vec<_> = triangles.iter().copied().map(Fast).collect();
        let times = methods[..2].iter().map(|method| times(method, &items, extent.repetitions(size), pools));
        let times: Vec<_> = times.collect();
        // Only now: this builds too. What fails here is not printed.
        let scene = Scene::new("soup", triangles, extent);
        for (method, times) in methods.iter().zip(times) {
            scene.facts(method, pools);
            let ns = times.map(|time| decimal(Some(time.as_secs_f64() * 1e9 / size as f64), 0));
            let mut row = vec![size.to_string(), method.preset.into()];
            row.extend(ns);
            table.add_row(row);
        }
    }
    println!("\n{LEGEND}\n\n{table}");
}

/// The first build's, later ones', and those in a workspace.
fn times(method: &Method, items: &[Item], repetitions: usize, pools: &Pools) -> [Duration; 3] {
    let timed = |build: &mut (dyn FnMut(Vec<Item>) -> Box<dyn Built> + Send), items: Vec<Item>| {
        pools[0].install(|| {
            let start = Instant::now();
            let built = build(items);
            (start.elapsed(), built)
        })
    };
    let mut in_new = |triangles| method.build(triangles);
    let first = timed(&mut in_new, items.to_vec()).0;
    let mut workspace = Workspace::new();
    method.build_in(&mut workspace, items.to_vec()).recycle(&mut workspace);
    let (mut new, mut old) = (Vec::new(), Vec::new());
    for _ in 0..repetitions {
        new.push(timed(&mut in_new, items.to_vec()).0);
        let mut in_old = |triangles| method.build_in(&mut workspace, triangles);
        let (time, built) = timed(&mut in_old, items.to_vec());
        old.push(time);
        built.recycle(&mut workspace);
    }
    [first, median(new), median(old)]
}
