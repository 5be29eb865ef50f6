//! Answers as bits, to compare trees with the naive loop without tolerance.

use bvhkit::{Barycentrics, Bvh, Hit, Intersect, Ray, Scalar, Traverse, reference};

/// A payload as bits, so that a NaN in it is equal to itself.
pub trait Payload: Copy {
    fn bits(self) -> [u64; 3];
}

impl Payload for () {
    fn bits(self) -> [u64; 3] {
        [0; 3]
    }
}

impl<P: Payload> Payload for Option<P> {
    fn bits(self) -> [u64; 3] {
        self.map_or([u64::MAX; 3], Payload::bits)
    }
}

impl<S: Scalar> Payload for Barycentrics<S> {
    fn bits(self) -> [u64; 3] {
        [self.u, self.v, S::ZERO].bits()
    }
}

impl<S: Scalar> Payload for [S; 3] {
    fn bits(self) -> [u64; 3] {
        self.map(|x| x.to_f64().to_bits())
    }
}

/// The bits of t, the index, and the bits of the payload.
pub type Key = (u64, usize, [u64; 3]);

pub fn key<S: Scalar>(hit: Hit<S, impl Payload>) -> Key {
    (hit.t.to_f64().to_bits(), hit.index, hit.payload.bits())
}

/// The answers to all queries for one ray.
#[derive(Debug, PartialEq)]
pub struct Answers {
    pub closest: Option<Key>,
    pub any: bool,
    pub hits: Vec<Key>,
}

impl Answers {
    pub fn naive<P: Intersect<Payload: Payload>>(primitives: &[P], ray: &Ray<P::Scalar>) -> Self {
        Self {
            closest: reference::closest_hit(primitives, ray).map(key),
            any: reference::any_hit(primitives, ray),
            hits: reference::hits(primitives, ray).into_iter().map(key).collect(),
        }
    }

    pub fn of<P: Intersect<Payload: Payload>, L: Traverse<P>>(bvh: &Bvh<P, L>, ray: &Ray<P::Scalar>) -> Self {
        Self {
            closest: bvh.closest_hit(ray).map(key),
            any: bvh.any_hit(ray),
            hits: bvh.hits(ray).map(key).collect(),
        }
    }
}
