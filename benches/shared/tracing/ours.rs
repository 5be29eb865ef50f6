//! This crate's hierarchies.

use super::tracer::{Job, Query, Tracer, Way, job, one_by_one};
use crate::shared::agreement::{Hit, bare};
use bvhkit::{Bvh, Counters, Intersect, Ray, Traverse};

impl<P, L> Tracer for Bvh<P, L>
where
    P: Intersect<Scalar = f32, Payload: Send> + Sync,
    L: Traverse<P> + Sync,
{
    fn job<'a>(&'a self, query: Query, way: Way, rays: &'a [Ray]) -> Option<Job<'a>> {
        let trace_closest = move |rays: &[Ray], hits: &mut [_]| match way {
            Way::Single => one_by_one(rays, hits, |ray| self.closest_hit(ray)),
            Way::Batch => self.closest_hits(rays, hits),
        };
        let trace_any = move |rays: &[Ray], hits: &mut [_]| match way {
            Way::Single => one_by_one(rays, hits, |ray| self.any_hit(ray)),
            Way::Batch => self.any_hits(rays, hits),
        };
        let count_all =
            |rays: &[Ray], counts: &mut [_]| one_by_one(rays, counts, |ray| self.hits(ray).count());
        match (query, way) {
            (Query::Closest, _) => Some(job(rays, None, trace_closest, |hits, answers| {
                answers.closest = hits.iter().map(|hit| hit.map(bare)).collect();
            })),
            (Query::Any, _) => Some(job(rays, false, trace_any, |hits, answers| answers.any = hits.into())),
            (Query::All, Way::Single) => Some(job(rays, 0, count_all, |_, _| {})),
            (Query::All, Way::Batch) => None,
        }
    }

    fn all_hits(&self, ray: &Ray) -> Option<Vec<Hit>> {
        Some(self.hits(ray).map(bare).collect())
    }

    fn steps(&self, query: Query, rays: &[Ray]) -> Option<Counters> {
        let mut all_hits = Counters::default();
        Some(match query {
            Query::Closest => self.closest_hit_steps(rays),
            Query::Any => self.any_hit_steps(rays),
            Query::All => {
                rays.iter().for_each(|ray| self.hits_with(ray, &mut all_hits).for_each(drop));
                all_hits
            }
        })
    }

    fn bytes(&self) -> Option<[f64; 2]> {
        Some([self.report().memory_bytes, self.memory_bytes()].map(|bytes| bytes as f64 / self.len() as f64))
    }
}
