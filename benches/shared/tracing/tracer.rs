//! Tracers: implementations that answer rays, which are measured.

use crate::shared::agreement::{Answers, Hit};
use bvhkit::{Counters, Ray};

/// A query for a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Query {
    Closest,
    Any,
    /// All hits in order.
    All,
}

/// The way in which rays are passed on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Way {
    Single,
    Batch,
}

impl Way {
    pub const ALL: [Self; 2] = [Self::Single, Self::Batch];

    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Batch => "batch",
        }
    }
}

/// A job that traces a list of rays once, into memory that it already has.
///
/// Then it tells the answers, if it is asked to. The loop is inside the job, so that there is a
/// virtual call for each list and none for each ray.
pub type Job<'a> = Box<dyn FnMut(Option<&mut Answers>) + Send + 'a>;

/// Returns a job that stores the answers of `trace`, one for each ray.
///
/// Until then each answer is `none`.
pub fn job<'a, A: Clone + Send + 'a>(
    rays: &'a [Ray],
    none: A,
    trace: impl Fn(&[Ray], &mut [A]) + Send + 'a,
    tell: fn(&[A], &mut Answers),
) -> Job<'a> {
    let mut room = vec![none; rays.len()];
    Box::new(move |answers| {
        trace(rays, &mut room);
        if let Some(answers) = answers {
            tell(&room, answers);
        }
    })
}

/// Stores the answer of `ask` to each ray. Inlined, together with `ask`.
#[inline(always)]
pub fn one_by_one<A>(rays: &[Ray], answers: &mut [A], ask: impl Fn(&Ray) -> A) {
    for (ray, answer) in rays.iter().zip(answers) {
        *answer = ask(ray);
    }
}

/// Primitives in a tree.
pub trait Tracer: Sync {
    /// Returns a job for a list of rays, or `None` if there is no such query.
    fn job<'a>(&'a self, query: Query, way: Way, rays: &'a [Ray]) -> Option<Job<'a>>;

    /// Returns all hits of a ray in order, or `None` if there is no such query.
    fn all_hits(&self, ray: &Ray) -> Option<Vec<Hit>>;

    /// Returns the steps of the query for all the rays together, if the tracer counts.
    fn steps(&self, query: Query, rays: &[Ray]) -> Option<Counters>;

    /// Returns the bytes for each primitive, if known: of the tree alone, and of all.
    fn bytes(&self) -> Option<[f64; 2]>;
}
