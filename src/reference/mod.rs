//! Naive queries, which test every primitive in a loop.
//!
//! The answers of a tree are tested against these, be it a tree of this crate or, if you like, your
//! own: the functions take any slice of primitives. They accept hits by the same rule as the
//! queries of [`Bvh`](crate::Bvh) (see [`Intersect::intersect`]), and answer by the smallest (t,
//! index). So a tree of this crate gives the same t, bit for bit, and the same index.
//!
//! With the feature `exact`, the module `exact` answers for triangles without any rounding.
//!
//! An invalid primitive (see [`InvalidBox`](crate::InvalidBox)) is not hit, as in a tree that is
//! told to skip invalid primitives.
//!
//! # Examples
//!
//! ```
//! use bvhkit::{Bvh, Ray, Sphere, reference};
//! let spheres: Vec<Sphere> = (0..100).map(|i| Sphere::new([0.0, 0.0, i as f32], 0.4)).collect();
//! let bvh = Bvh::build(&spheres)?;
//! let ray = Ray::new([0.1, 0.2, -3.0], [0.0, 0.0, 1.0]);
//! assert_eq!(bvh.closest_hit(&ray), reference::closest_hit(&spheres, &ray));
//! assert_eq!(bvh.hits(&ray).collect::<Vec<_>>(), reference::hits(&spheres, &ray));
//! # Ok::<(), bvhkit::BuildError>(())
//! ```

#[cfg(feature = "exact")]
pub mod exact;

use crate::builders::PrimRef;
use crate::geometry::{Ray, Slabs};
use crate::primitive::{Intersect, accept, precedes};
use crate::query::{Hit, HitOf};
use crate::traverse::Recorder;
use alloc::vec::Vec;

/// Returns the hit with the smallest t in the ray's interval.
///
/// Of hits with equal t, it is the one with the lowest index.
pub fn closest_hit<P: Intersect>(primitives: &[P], ray: &Ray<P::Scalar>) -> Option<HitOf<P>> {
    closest_hit_with(primitives, ray, &mut ())
}

/// Returns the same as [`closest_hit`], and tells `recorder` of each step.
pub fn closest_hit_with<P: Intersect>(
    primitives: &[P],
    ray: &Ray<P::Scalar>,
    recorder: &mut impl Recorder,
) -> Option<HitOf<P>> {
    let mut best: Option<HitOf<P>> = None;
    for hit in all(primitives, ray, recorder) {
        if best.is_none_or(|best| precedes(hit.t, hit.index, best.t, best.index)) {
            best = Some(hit);
        }
    }
    best
}

/// Whether anything is hit in the ray's interval; stops at the first hit.
pub fn any_hit<P: Intersect>(primitives: &[P], ray: &Ray<P::Scalar>) -> bool {
    any_hit_with(primitives, ray, &mut ())
}

/// Returns the same as [`any_hit`], and tells `recorder` of each step.
pub fn any_hit_with<P: Intersect>(
    primitives: &[P],
    ray: &Ray<P::Scalar>,
    recorder: &mut impl Recorder,
) -> bool {
    all(primitives, ray, recorder).next().is_some()
}

/// Returns all hits in the ray's interval, by increasing t, equal ones by index.
pub fn hits<P: Intersect>(primitives: &[P], ray: &Ray<P::Scalar>) -> Vec<HitOf<P>> {
    let mut hits: Vec<_> = all(primitives, ray, &mut ()).collect();
    // The hits are in the order of their indices, and the sort is stable. No t is NaN.
    hits.sort_by(|a, b| a.t.partial_cmp(&b.t).unwrap_or(core::cmp::Ordering::Equal));
    hits
}

/// Returns the hits in the order of the input.
fn all<'a, P: Intersect>(
    primitives: &'a [P],
    ray: &Ray<P::Scalar>,
    recorder: &'a mut impl Recorder,
) -> impl Iterator<Item = HitOf<P>> {
    let (ray, slabs) = (*ray, Slabs::new(ray));
    let valid = ray.is_valid();
    if valid {
        recorder.ray();
    }
    let asked = if valid { primitives } else { &[] };
    asked.iter().enumerate().filter_map(move |(index, primitive)| {
        recorder.primitive();
        let (t, payload) = accept(primitive, &ray, &slabs)?;
        PrimRef::new(primitive.aabb(), 0).invalid_box().is_none().then_some(Hit { t, index, payload })
    })
}
