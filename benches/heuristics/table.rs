//! The closing table: every method side by side.

use crate::check::Check;
use crate::hierarchy::{Method, Statistics};
use crate::shared::agreement::Disagreements;
use crate::shared::columns::{decimal, table};
use crate::shared::timing::{interleaved, mega_rays};
use crate::workload::Workload;

const HEADER: [&str; 15] = [
    "scene",
    "method",
    "build\nms",
    "SAH\ncost",
    "EPO",
    "depth",
    "nodes\nper ray",
    "tests\nper ray",
    "closest\nMrays/s",
    "any\nMrays/s",
    "differ\nfrom naive",
    "hit or\nmiss",
    "other\ntriangle",
    "tie",
    "t\nrounded",
];

const LEGEND: &str = "\
One thread; medians of times, methods taking turns. Builds include putting the triangles in the tree's order.
Closest: primary, diffuse and random rays. Any: shadow rays. Nodes and tests: per closest hit.
SAH cost: 1 for the step through an inner node, 1 for the test of a triangle. EPO, end-point overlap: the mean cost, in the
same unit, of nodes around a point of the surface that do not have it below them.
Differ from naive: of a sample, the rays that hit where the naive reference says miss, miss where it says hit,
or hit another triangle. Ours are equal to it in the bits of t and in the index, or there is no table.
Then, of all rays, those that differ from ours, which all agree: by hit or miss, by another triangle, by
another triangle of the same t (tie), by other bits of t on the same triangle (t rounded).";

/// Measures each workload with each method and prints the table.
pub fn print(workloads: impl Iterator<Item = Workload>, methods: &[Method], repetitions: usize) {
    let mut table = table(HEADER, 2);
    for workload in workloads {
        table.add_rows(rows(&workload, methods, repetitions));
    }
    println!("\n{LEGEND}\n");
    println!("{table}");
}

fn rows(workload: &Workload, methods: &[Method], repetitions: usize) -> Vec<Vec<String>> {
    let Workload { name, triangles, closest, any } = workload;
    let builds: Vec<_> = methods.iter().map(|method| (method.prepare)(triangles)).collect();
    let built: Vec<_> = builds.iter().map(|build| build()).collect();
    let check = Check::new(workload, methods, &built);
    // The facts of the scene go down the first column, beside the methods.
    let facts = [
        name.clone(),
        format!("{} triangles", triangles.len()),
        format!("{} rays", closest.len() + any.len()),
        format!("{} of them naively", check.sample),
    ];

    let build_times = interleaved(methods.len(), repetitions, |_| (), |i| builds[i]());
    let mut hits = Vec::with_capacity(closest.len());
    let closest_times =
        interleaved(methods.len(), repetitions, |_| (), |i| built[i].closest_hits(closest, &mut hits));
    let mut hits = Vec::with_capacity(any.len());
    let any_times = interleaved(methods.len(), repetitions, |_| (), |i| built[i].any_hits(any, &mut hits));

    let mut facts = facts.into_iter();
    let row = |i: usize| {
        let Statistics { sah_cost, epo, max_depth, nodes_per_ray, tests_per_ray } =
            built[i].statistics(closest);
        let mut row = vec![
            facts.next().unwrap_or_default(),
            methods[i].name.into(),
            format!("{:.1}", build_times[i].as_secs_f64() * 1e3),
            decimal(sah_cost, 1),
            decimal(epo, 2),
            max_depth.map_or("-".into(), |depth| depth.to_string()),
            decimal(nodes_per_ray, 1),
            decimal(tests_per_ray, 1),
            decimal(Some(mega_rays(closest.len(), closest_times[i])), 2),
            decimal(Some(mega_rays(any.len(), any_times[i])), 2),
        ];
        let Disagreements { hit_or_miss, primitive, tie, rounding } = check.from_ours[i];
        row.push(format!("{} of {}", check.from_naive[i].visible(), check.sample));
        row.extend([hit_or_miss, primitive, tie, rounding].map(|rays| rays.to_string()));
        row
    };
    (0..methods.len()).map(row).collect()
}
