//! The speed of all contestants with one kind of ray.

use super::family::Family;
use super::kinds::Kind;
use super::tracer::{Job, Way};
use crate::shared::timing::{interleaved, mega_rays};
use bvhkit::Ray;
use std::sync::{Mutex, PoisonError};

/// The settings that all contestants of a measurement share.
#[derive(Clone, Copy)]
pub struct Pass {
    pub is_shuffled: bool,
    pub way: Way,
    /// The number of threads: 1, or as many as rayon has.
    pub threads: usize,
}

/// A member that has the query, and its jobs.
struct Contestant<'a> {
    place: usize,
    /// The number of rays in all jobs together.
    rays: usize,
    /// One job for each thread.
    jobs: Vec<Mutex<Job<'a>>>,
}

/// Returns millions of rays per second for each member of each family.
///
/// `None`: the member cannot answer such a query. The members take turns.
///
/// Every thread traces all the rays, each from another start. So each thread
/// has as much to do as one alone.
pub fn measure(families: &[Family], kind: usize, pass: Pass, repetitions: usize) -> Vec<Option<f64>> {
    let lists: Vec<_> = families.iter().map(|family| lists(&family.kinds[kind], pass)).collect();
    let members = families.iter().zip(&lists).flat_map(|(family, lists)| {
        let query = family.kinds[kind].query;
        family.members.iter().map(move |member| (&member.tracer, query, lists))
    });
    let mut speeds = Vec::new();
    let mut contestants = Vec::new();
    for (place, (tracer, query, lists)) in members.enumerate() {
        let jobs = lists.iter().map(|rays| tracer.job(query, pass.way, rays).map(Mutex::new)).collect();
        if let Some(jobs) = jobs {
            contestants.push(Contestant { place, rays: lists.iter().map(Vec::len).sum(), jobs });
        }
        speeds.push(None);
    }
    // The other contestants emptied the caches. An untimed run fills them again: that may take
    // longer than the rays.
    let trace = |i: usize| run(&contestants[i].jobs);
    let times = interleaved(contestants.len(), repetitions, trace, trace);
    for (contestant, time) in contestants.iter().zip(times) {
        speeds[contestant.place] = Some(mega_rays(contestant.rays, time));
    }
    speeds
}

/// Returns a list of rays for each thread.
fn lists(kind: &Kind, pass: Pass) -> Vec<Vec<Ray>> {
    let rays = if pass.is_shuffled { &kind.shuffled } else { &kind.natural };
    let from = |thread: usize| {
        let (before, after) = rays.split_at(thread * rays.len() / pass.threads);
        [after, before].concat()
    };
    (0..pass.threads).map(from).collect()
}

fn run(jobs: &[Mutex<Job<'_>>]) {
    let trace = |thread: usize| jobs[thread].lock().unwrap_or_else(PoisonError::into_inner)(None);
    if jobs.len() == 1 {
        trace(0);
    } else {
        rayon::broadcast(|thread| trace(thread.index()));
    }
}
