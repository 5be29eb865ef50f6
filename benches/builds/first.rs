//! The first build against later ones, which find memory that the process has already.

use crate::check::Scene;
use crate::columns::{self, decimal};
use crate::methods::Method;
use crate::scenes::soup;
use crate::timing::{median, turns};
use crate::{Extent, Pools};
use bvhkit::Fast;
use std::cell::Cell;

const HEADER: [&str; 3] = ["triangles", "first build, ns per triangle", "later ones"];

const LEGEND: &str = "\
The soup with the default, one thread. The first build of each size, the first row's being the first of the process, and
the median of later ones.";

/// Larger ones have fresh pages from the system every time.
const LARGEST: usize = 1_000_000;

pub fn print(extent: &Extent, pools: &Pools, methods: &[Method]) {
    let mut table = columns::table(HEADER, 0);
    let method = &methods[1];
    for &size in extent.sizes.iter().filter(|&&size| size <= LARGEST) {
        let triangles = soup::scattered(size);
        let items: Vec<_> = triangles.iter().copied().map(Fast).collect();
        let input = Cell::new(Vec::new());
        let prepare = |_| input.set(items.clone());
        let build = |_| {
            let items = input.take();
            pools[0].install(|| (method.build)(items))
        };
        let times = turns(1, 1 + extent.repetitions(size), prepare, build).swap_remove(0);
        // Only now: this builds too. What fails here is not printed.
        Scene::new("soup", triangles, extent).facts(method, pools);
        let ns = |time: std::time::Duration| time.as_secs_f64() * 1e9 / size as f64;
        let (first, later) = (ns(times[0]), ns(median(times[1..].to_vec())));
        table.add_row([size.to_string(), decimal(Some(first), 0), decimal(Some(later), 0)]);
    }
    println!("\n{LEGEND}\n\n{table}");
}
