//! Comparison of all contestants' answers to the same rays with the exact ones.

use crate::aim::{self, Target};
use crate::mesh::{Mesh, Place};
use crate::miss;
use crate::self_hits::spawned;
use crate::tally::{Tally, merge};
use crate::tracer::{Contestant, Tracer};
use crate::truth::Truth;
use bvhkit::Ray;
use bvhkit::reference::exact;
use rayon::prelude::*;

/// The amount of work for each mesh at each place.
#[derive(Clone, Copy)]
pub struct Amount {
    /// Rays aimed at corners, and as many at edges.
    pub aimed: usize,
    /// Tests of one triangle that each contestant may spend on its naive loop.
    pub naive_tests: usize,
}

/// The tallies of all contestants for one mesh at one place.
pub struct Outcome {
    pub mesh: String,
    pub place: Place,
    pub tallies: Vec<Tally>,
}

pub fn judge(mesh: &Mesh, place: Place, contestants: &[Contestant], amount: Amount) -> Outcome {
    let triangles = mesh.placed(place);
    let truth = Truth::new(&triangles);
    let tracers: Vec<_> = contestants.iter().map(|contestant| (contestant.build)(&triangles)).collect();
    let rays = aim::rays(&truth, mesh.is_closed, amount.aimed);
    let each = |judge_ray: &(dyn Fn(usize, &mut [Tally]) + Sync), n: usize| {
        let none = || vec![Tally::default(); tracers.len()];
        let one = |mut tallies: Vec<Tally>, i| {
            judge_ray(i, &mut tallies);
            tallies
        };
        (0..n).into_par_iter().fold(none, one).reduce(none, merge)
    };

    let aimed =
        |i: usize, tallies: &mut [Tally]| judge_aimed(&truth, mesh.is_closed, rays[i], &tracers, tallies);
    let mut tallies = each(&aimed, rays.len());

    let sample = (amount.naive_tests / triangles.len()).clamp(1, rays.len());
    let naive = |i: usize, tallies: &mut [Tally]| {
        // The step is odd, so that both kinds of target occur.
        let (_, ray) = rays[i * ((rays.len() / sample) | 1) % rays.len()];
        assert_eq!(truth.closest_hits(&ray), exact::closest_hits(&triangles, &ray), "{ray:?}");
        for (tracer, tally) in tracers.iter().zip(tallies) {
            let bits = |t: Option<f64>| t.map(f64::to_bits);
            let t = tracer.closest_hit(&ray).map(|hit| hit.t);
            tally.unlike_naive.add(bits(t) != bits(tracer.naive_t(&ray)));
        }
    };
    tallies = merge(tallies, each(&naive, sample));

    let spawned = spawned(&triangles, rays.iter().map(|&(_, ray)| ray));
    let leaves = |i: usize, tallies: &mut [Tally]| {
        let (source, ray) = spawned[i];
        for (tracer, tally) in tracers.iter().zip(tallies) {
            tally.self_hits.add(tracer.test(source, &ray).is_some());
        }
    };
    tallies = merge(tallies, each(&leaves, spawned.len()));
    Outcome { mesh: mesh.name.clone(), place, tallies }
}

fn judge_aimed(
    truth: &Truth<'_>,
    is_closed: bool,
    (target, ray): (Target, Ray),
    tracers: &[Box<dyn Tracer>],
    tallies: &mut [Tally],
) {
    let nearest = truth.closest_hits(&ray);
    for (tracer, tally) in tracers.iter().zip(tallies) {
        let hit = tracer.closest_hit(&ray);
        if is_closed && !nearest.is_empty() {
            let leaks = match target {
                Target::Vertex => &mut tally.vertex_leaks,
                Target::Edge => &mut tally.edge_leaks,
            };
            leaks.add(hit.is_none());
        }
        let Some(hit) = hit else { continue };
        let right = nearest.iter().find(|exact| exact.index == hit.index);
        let triangle = &truth.triangles[hit.index];
        let t = right.map(|exact| exact.t.clone()).or_else(|| exact::intersect(triangle, &ray));
        tally.wrong.add(right.is_none());
        tally.false_hits.add(t.is_none());
        match t {
            Some(t) => tally.ulps.push(tracer.ulps(&t, hit.t).abs() as f32),
            None => {
                tally.slack = tally.slack.max(exact::edge_slack(triangle, &ray).unwrap_or(f64::INFINITY));
                tally.beside = tally.beside.max(miss::roundings(triangle, &ray));
            }
        }
    }
}
