//! The tables: counts over all meshes, and leaks by place.

use crate::columns;
use crate::judge::Outcome;
use crate::mesh::Mesh;
use crate::tally::{Tally, by_place};
use crate::tracer::Contestant;

const HEADER: [&str; 11] = [
    "",
    "closest\nMrays/s",
    "leaks at\nvertices",
    "leaks at\nedges",
    "false hits",
    "largest\nslack",
    "largest\nmiss",
    "wrong\ntriangle",
    "t error, ulps\np50, p99, max",
    "self-hits",
    "unlike\nnaive",
];

const LEGEND: &str = "\
obvhs 0.4, its medium presets; bvh 0.13. Six closed meshes at eight places. Rays from points exactly inside, aimed at
corners and at points of edges, with t from 0 on; each is answered in exact arithmetic too.
Closest: million closest hits a second on one thread, of primary, diffuse, shadow and random rays in a torus of
  100,000 triangles; medians, contestants taking turns. In brackets, over the default's, Watertight.
Leaks: rays that leave the mesh, of those that exactly hit something, which all do.
False hits: hits whose triangle the ray misses, of all hits. Slack: by how much of the triangle's height (dust is missed
  by many times its own; inf: the ray lies in its plane). Miss: the same in roundings of f32 (2^-24) of the triangle's distance.
Wrong triangle: hits, false ones included, whose triangle is not, or not together with others, exactly the nearest.
T error: of hits that are not false, from the exact t on the triangle that was named, in ulps of the
  contestant's scalar.
Self-hits: rays spawned by `SurfacePoint::spawn`, one from each aimed ray's hit, at angles of 1e-4 rad and more to
  the surface, that hit the triangle they leave.
Unlike naive: rays whose t differs, by any bit, from that of the contestant's own test on all triangles, on a sample.";

pub fn print(contestants: &[Contestant], speeds: &[f64], outcomes: &[Outcome]) {
    println!("\n{LEGEND}\n");
    let is_default = |contestant: &Contestant| contestant.name == crate::ours::DEFAULT;
    let default = contestants.iter().position(is_default).map_or(f64::NAN, |i| speeds[i]);
    let mut totals = columns::table(HEADER, 1);
    for (i, (contestant, speed)) in contestants.iter().zip(speeds).enumerate() {
        let mut tally = Tally::default();
        outcomes.iter().for_each(|outcome| tally += &outcome.tallies[i]);
        let speed = format!("{speed:.2} ({:.2})", speed / default);
        totals.add_row(row(contestant, &speed, &tally));
    }
    println!("{totals}\n\nLeaks by place, at vertices and edges:\n");

    let names = contestants.iter().map(|contestant| contestant.name.to_string());
    let mut leaks = columns::table([String::new()].into_iter().chain(names).collect::<Vec<_>>(), 1);
    let columns: Vec<_> = (0..contestants.len()).map(|i| by_place(outcomes, i)).collect();
    for (row, (place, _)) in columns[0].iter().enumerate() {
        let cells = columns.iter().map(|column| column[row].1.to_string());
        leaks.add_row([place.to_string()].into_iter().chain(cells));
    }
    println!("{leaks}");
}

/// Prints a table for a mesh that is not in the totals.
pub fn print_file(contestants: &[Contestant], mesh: &Mesh, outcome: &Outcome) {
    println!("\n{}, {} triangles:", mesh.name, mesh.triangles.len());
    if !mesh.is_closed {
        println!("not closed (some edge belongs to an odd number of triangles), so leaks are not counted");
    }
    let mut table = columns::table(HEADER, 1);
    for (contestant, tally) in contestants.iter().zip(&outcome.tallies) {
        table.add_row(row(contestant, "-", tally));
    }
    println!("\n{table}");
}

fn row(contestant: &Contestant, speed: &str, tally: &Tally) -> Vec<String> {
    let quantiles = tally.quantiles().map_or("-".into(), |ulps| ulps.map(short).join(", "));
    let of_false = |x: f64| if tally.false_hits.found == 0 { "-".into() } else { short(x as f32) };
    vec![
        contestant.name.into(),
        speed.into(),
        tally.vertex_leaks.to_string(),
        tally.edge_leaks.to_string(),
        tally.false_hits.to_string(),
        of_false(tally.slack),
        of_false(tally.beside),
        tally.wrong.to_string(),
        quantiles,
        tally.self_hits.to_string(),
        tally.unlike_naive.to_string(),
    ]
}

fn short(x: f32) -> String {
    if x < 1e4 { format!("{x:.1}") } else { format!("{x:.0e}") }
}
