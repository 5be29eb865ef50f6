//! Families: hierarchies over the same primitives, measured with the same rays.

use super::kinds::Kind;
use super::tracer::Tracer;
use crate::shared::agreement::{Answers, Disagreements, Hit, bare};
use bvhkit::{Intersect, Ray, reference};
use std::rc::Rc;

pub struct Family {
    pub primitives: &'static str,
    pub kinds: Rc<[Kind]>,
    pub naive: Box<dyn Naive>,
    /// The hierarchies, of which the first is ours.
    pub members: Vec<Member>,
}

pub struct Member {
    /// The layout, or whatever tells the member from the others.
    pub name: String,
    /// Whether it is this crate's, which promises the naive reference's answers.
    pub ours: bool,
    pub tracer: Box<dyn Tracer>,
}

/// Queries of primitives without a tree.
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
