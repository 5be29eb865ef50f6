//! Who is measured: families of hierarchies over the same primitives, to which the same rays are put.

use super::kinds::Kind;
use super::tracer::Tracer;
use crate::shared::agreement::{Answers, Disagreements, Hit, bare};
use bvhkit::{Intersect, Ray, reference};
use std::rc::Rc;

pub struct Family {
    pub primitives: &'static str,
    pub kinds: Rc<[Kind]>,
    pub naive: Box<dyn Naive>,
    /// The first is ours.
    pub members: Vec<Member>,
}

pub struct Member {
    /// Its layout, or whatever sets it apart from the others.
    pub name: String,
    /// Whose answers are promised to be the naive reference's; or a peer's.
    pub ours: bool,
    pub tracer: Box<dyn Tracer>,
}

/// The primitives without a tree.
pub trait Naive {
    fn count(&self) -> usize;
    fn answers(&self, rays: &[Ray]) -> Answers;
    fn all_hits(&self, ray: &Ray) -> Vec<Hit>;
    fn disagreements(&self, rays: &[Ray], expected: &Answers, actual: &Answers) -> Disagreements;
}

impl<P: Intersect<Scalar = f32>> Naive for Vec<P> {
    fn count(&self) -> usize {
        self.len()
    }
    fn answers(&self, rays: &[Ray]) -> Answers {
        Answers::naive(self, rays)
    }
    fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        reference::hits(self, ray).into_iter().map(bare).collect()
    }
    fn disagreements(&self, rays: &[Ray], expected: &Answers, actual: &Answers) -> Disagreements {
        Disagreements::count(self, rays, expected, actual)
    }
}
