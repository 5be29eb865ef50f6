//! Tables of nasty input: its time over that of the soup, depth and memory.

use crate::check::{Facts, Scene};
use crate::columns::{self, decimal};
use crate::methods::Method;
use crate::timing::interleaved;
use crate::{Extent, Pools, nasty};
use std::cell::Cell;

/// Ratios of times above this one are reported.
const LIMIT: f64 = 3.0;
/// Maximum number of repetitions, for some builds take long.
const REPETITIONS: usize = 3;

pub fn print(extent: &Extent, pools: &Pools, methods: &[Method]) {
    let lists = nasty::all(extent.nasty).into_iter();
    let scenes: Vec<Scene> = lists.map(|(name, triangles)| Scene::new(name, triangles, extent)).collect();
    let facts = |scene: &Scene| methods.iter().map(|method| scene.facts(method, pools)).collect();
    let facts: Vec<Vec<Facts>> = scenes.iter().map(facts).collect();
    let repetitions = extent.repetitions(extent.nasty).min(REPETITIONS);
    let times: Vec<_> = methods.iter().map(|method| times(method, &scenes, pools, repetitions)).collect();

    let grid = |cell: &dyn Fn(usize, usize) -> String| {
        let names = methods.iter().map(|method| format!("{}, {}", method.layout, method.preset));
        let mut table = columns::table([String::new()].into_iter().chain(names).collect::<Vec<_>>(), 1);
        for (i, scene) in scenes.iter().enumerate() {
            let cells = (0..methods.len()).map(|k| cell(i, k));
            table.add_row([scene.name.into()].into_iter().chain(cells).collect::<Vec<_>>());
        }
        table
    };
    println!("\nNasty input, {} triangles each, one thread.", extent.nasty);
    let ratio = |i: usize, k: usize| times[k][i] / times[k][0];
    let cell = |i: usize, k: usize| match i {
        0 => format!("{:.0} ns", times[k][0] * 1e9 / extent.nasty as f64),
        _ => decimal(Some(ratio(i, k)), 2),
    };
    println!(
        "\nTime over the soup's, which is per triangle; medians, lists taking turns.\n\n{}",
        grid(&cell)
    );
    for (i, scene) in scenes.iter().enumerate().skip(1) {
        for (k, method) in methods.iter().enumerate().filter(|&(k, _)| ratio(i, k) > LIMIT) {
            let (layout, preset, ratio) = (method.layout, method.preset, ratio(i, k));
            println!("Beyond {LIMIT} times the soup: {}, {layout}, {preset}: {ratio:.2}", scene.name);
        }
    }
    println!("\nDepth at the most.\n\n{}", grid(&|i, k| facts[i][k].depth.to_string()));
    println!("\nPeak, bytes per triangle.\n\n{}", grid(&|i, k| decimal(Some(facts[i][k].peaks[0]), 0)));
    println!(
        "\nResult with triangles, bytes per triangle.\n\n{}",
        grid(&|i, k| decimal(Some(facts[i][k].bytes), 0))
    );
}

/// Returns the seconds for each list.
fn times(method: &Method, scenes: &[Scene], pools: &Pools, repetitions: usize) -> Vec<f64> {
    let input = Cell::new(Vec::new());
    let prepare = |i: usize| input.set(scenes[i].triangles.clone());
    let build = |_| {
        let triangles = input.take();
        pools[0].install(|| method.build(triangles))
    };
    let times = interleaved(scenes.len(), repetitions, prepare, build);
    times.into_iter().map(|time| time.as_secs_f64()).collect()
}
