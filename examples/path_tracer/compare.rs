//! A table of the same rays through the naive loop and the tree of each heuristic.

use std::time::{Duration, Instant};

use anyhow::Result;
use bvhkit::Counters;
use clap::ValueEnum;
use comfy_table::{CellAlignment, Table, presets};

use crate::scene::Shape;
use crate::tracer::{Method, Query, Tracer};

/// Maximum number of tests, which take the naive loop ten to twenty seconds.
const MAX_NAIVE_TESTS: u64 = 2_500_000_000;
/// Maximum number of rays, which keeps the memory for rays and answers small.
const MAX_RAYS: u64 = 2_000_000;

/// Returns the number of rays to compare.
pub fn ray_budget(primitives: usize) -> u64 {
    (MAX_NAIVE_TESTS / primitives.max(1) as u64).clamp(1, MAX_RAYS)
}

/// A method's answer to a query; a hit has the bits of t and the primitive's index.
#[derive(Clone, Copy, PartialEq)]
enum Answer {
    Closest(Option<(u32, usize)>),
    Any(bool),
}

/// Runs the rays through every method, on one thread.
///
/// The first method is the naive loop. The speed and the answers of the
/// others are compared with its own.
pub fn table(
    shapes: &[Shape],
    rays: &[Query],
    max_leaf_size: Option<usize>,
    threads: usize,
) -> Result<Table> {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "method",
        "build ms",
        "SAH cost",
        "max depth",
        "nodes/ray",
        "tests/ray",
        "Mrays/s",
        "x naive",
        "hits that differ",
    ]);
    let mut naive: Option<(Vec<Answer>, Duration)> = None;
    for &method in Method::value_variants() {
        let start = Instant::now();
        let tracer = Tracer::build(shapes.to_vec(), method, max_leaf_size, threads)?;
        let build = start.elapsed();
        let (answers, counters, time) = run(&tracer, rays);

        let [build, sah_cost, max_depth] = match &tracer {
            Tracer::Naive(_) => ["-", "-", "-"].map(str::to_owned),
            Tracer::Tree(bvh) => {
                let report = bvh.report();
                [
                    format!("{:.1}", 1e3 * build.as_secs_f64()),
                    format!("{:.2}", report.sah_cost),
                    report.max_depth.to_string(),
                ]
            }
        };
        let per_ray = |count: u64| count as f64 / rays.len() as f64;
        let (expected, naive_time) = naive.get_or_insert_with(|| (answers.clone(), time));
        let differ = answers.iter().zip(expected.iter()).filter(|(a, b)| a != b).count();
        table.add_row([
            method.name(),
            build,
            sah_cost,
            max_depth,
            format!("{:.2}", per_ray(counters.nodes)),
            format!("{:.2}", per_ray(counters.primitives)),
            format!("{:.3}", 1e-6 * rays.len() as f64 / time.as_secs_f64()),
            format!("{:.1}", naive_time.as_secs_f64() / time.as_secs_f64()),
            format!("{differ} of {}", rays.len()),
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    Ok(table)
}

fn run(tracer: &Tracer, rays: &[Query]) -> (Vec<Answer>, Counters, Duration) {
    let mut counters = Counters::default();
    let mut answers = Vec::with_capacity(rays.len());
    let start = Instant::now();
    for query in rays {
        answers.push(match query {
            Query::Closest(ray) => {
                let hit = tracer.closest_hit(ray, &mut counters);
                Answer::Closest(hit.map(|hit| (hit.t.to_bits(), hit.index)))
            }
            Query::Any(ray) => Answer::Any(tracer.any_hit(ray, &mut counters)),
        });
    }
    (answers, counters, start.elapsed())
}
