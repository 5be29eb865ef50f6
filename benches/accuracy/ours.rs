//! This crate's modes, each in the default tree.

use crate::tracer::{Contestant, Hit, Tracer};
use bvhkit::reference::{self, exact::Fraction};
use bvhkit::{Bvh, Fast, Intersect, Precise, Ray, Scalar, Triangle};

/// The mode of a plain triangle.
pub const DEFAULT: &str = "Watertight";

pub fn contestants() -> [Contestant; 4] {
    [
        ours("Fast", |triangles| build(triangles.iter().copied().map(Fast))),
        ours(DEFAULT, |triangles| build(triangles.iter().copied())),
        ours("Precise", |triangles| build(triangles.iter().copied().map(Precise))),
        ours("Double", |triangles| build(triangles.iter().map(double))),
    ]
}

fn ours(name: &'static str, build: fn(&[Triangle]) -> Box<dyn Tracer>) -> Contestant {
    Contestant { name, ours: true, build }
}

fn build<P>(primitives: impl Iterator<Item = P>) -> Box<dyn Tracer>
where
    P: Intersect + Copy + Send + Sync + 'static,
{
    let primitives: Vec<P> = primitives.collect();
    let bvh = Bvh::build(primitives.iter().copied()).expect("the coordinates are finite");
    Box::new(Ours { primitives, bvh })
}

fn double(triangle: &Triangle) -> Triangle<f64> {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|corner| corner.map(f64::from));
    Triangle { a, b, c }
}

/// Converts a ray without rounding.
fn convert<S: Scalar>(ray: &Ray) -> Ray<S> {
    let [origin, direction] =
        [ray.origin, ray.direction].map(|point| point.map(|x| S::from_f64(f64::from(x))));
    let [t_min, t_max] = [ray.t_min, ray.t_max].map(|t| S::from_f64(f64::from(t)));
    Ray { origin, direction, t_min, t_max }
}

struct Ours<P: Intersect> {
    primitives: Vec<P>,
    bvh: Bvh<P>,
}

impl<P: Intersect + Sync> Tracer for Ours<P> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.bvh.closest_hit(&convert(ray))?;
        Some(Hit { t: hit.t.to_f64(), index: hit.index })
    }

    fn test(&self, index: usize, ray: &Ray) -> Option<f64> {
        let hit = reference::closest_hit(&self.primitives[index..=index], &convert(ray))?;
        Some(hit.t.to_f64())
    }

    fn naive_t(&self, ray: &Ray) -> Option<f64> {
        Some(reference::closest_hit(&self.primitives, &convert(ray))?.t.to_f64())
    }

    fn ulps(&self, exact: &Fraction, t: f64) -> f64 {
        exact.ulps_from(P::Scalar::from_f64(t))
    }
}
