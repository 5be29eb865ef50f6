//! What is measured: whoever answers rays.

use crate::shared::agreement::{Answers, Hit};
use bvhkit::{Counters, Ray};

/// What is asked of a ray.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Query {
    Closest,
    Any,
    /// All hits in order.
    All,
}

/// How rays are handed over.
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

/// Traces a list of rays once, into room of its own that is there already; then tells the answers if it is asked to.
/// The loop is inside, so that a virtual call is made for each list and none for each ray.
pub type Job<'a> = Box<dyn FnMut(Option<&mut Answers>) + Send + 'a>;

/// The job that puts the answers of `trace` in room for one of each ray, whose answer is `none` until then.
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

/// What `ask` answers to each ray; inlined with it.
#[inline(always)]
pub fn one_by_one<A>(rays: &[Ray], answers: &mut [A], ask: impl Fn(&Ray) -> A) {
    for (ray, answer) in rays.iter().zip(answers) {
        *answer = ask(ray);
    }
}

/// Primitives in a tree.
pub trait Tracer: Sync {
    /// None if it has no such query.
    fn job<'a>(&'a self, query: Query, way: Way, rays: &'a [Ray]) -> Option<Job<'a>>;

    /// All hits of a ray in order; none if it has no such query.
    fn all_hits(&self, ray: &Ray) -> Option<Vec<Hit>>;

    /// The steps that the query takes for all the rays together, if it tells.
    fn steps(&self, query: Query, rays: &[Ray]) -> Option<Counters>;

    /// Bytes for each primitive, if it tells: of the hierarchy, and with the primitives.
    fn bytes(&self) -> Option<[f64; 2]>;
}
