//! The first build against later builds, in new memory and in a workspace.

use crate::check::Scene;
use crate::columns::{self, decimal};
use crate::methods::{Built, Item, Method};
use crate::scenes::soup;
use crate::timing::interleaved;
use crate::{Extent, Pools};
use bvhkit::{Fast, Workspace};
use std::cell::{Cell, RefCell};
use std::time::Duration;

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
        // The check comes after the timing, because it builds too. If it fails, nothing is printed.
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

/// Returns the times of the first build, later builds, and builds in a workspace.
fn times(method: &Method, items: &[Item], repetitions: usize, pools: &Pools) -> [Duration; 3] {
    pools[0].install(|| {
        // The input of the next build, the last hierarchy, and the memory that it leaves.
        let triangles = Cell::new(Vec::new());
        let last = Cell::new(None::<Box<dyn Built>>);
        let workspace = RefCell::new(Workspace::new());
        let prepare = |_| {
            if let Some(built) = last.take() {
                built.recycle(&mut workspace.borrow_mut());
            }
            triangles.set(items.to_vec());
        };
        let in_new = || last.set(Some(method.build(triangles.take())));
        let in_old = || last.set(Some(method.build_in(&mut workspace.borrow_mut(), triangles.take())));
        let first = interleaved(1, 1, prepare, |_| in_new());
        let later = interleaved(2, repetitions, prepare, |way| if way == 0 { in_new() } else { in_old() });
        [first[0], later[0], later[1]]
    })
}
