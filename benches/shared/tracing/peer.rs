//! `obvhs`, which takes rays one by one.

use super::tracer::{Job, Query, Tracer, Way, job, one_by_one};
use crate::shared::agreement::Hit;
use crate::shared::obvhs::{Peer, Traversal};
use bvhkit::{Counters, Ray};

impl<B: Traversal + Sync> Tracer for Peer<B> {
    fn job<'a>(&'a self, query: Query, way: Way, rays: &'a [Ray]) -> Option<Job<'a>> {
        let trace_closest =
            |rays: &[Ray], hits: &mut [_]| one_by_one(rays, hits, |ray| self.closest_hit(ray));
        let trace_any = |rays: &[Ray], hits: &mut [_]| one_by_one(rays, hits, |ray| self.any_hit(ray));
        match (query, way) {
            (Query::Closest, Way::Single) => {
                Some(job(rays, None, trace_closest, |hits, answers| answers.closest = hits.into()))
            }
            (Query::Any, Way::Single) => {
                Some(job(rays, false, trace_any, |hits, answers| answers.any = hits.into()))
            }
            _ => None,
        }
    }

    /// Returns `None`: the peer does not find all hits in order.
    fn all_hits(&self, _: &Ray) -> Option<Vec<Hit>> {
        None
    }

    fn steps(&self, _: Query, _: &[Ray]) -> Option<Counters> {
        None
    }

    fn bytes(&self) -> Option<[f64; 2]> {
        None
    }
}
