//! What counts as a hit: one rule for the tree, the naive loop, and every query.

use super::Intersect;
use crate::geometry::{Ray, Scalar, Slabs, max};

/// The t and the payload of the ray's hit with `primitive`, if it has one in the ray's interval, whose end a query narrows to
/// the closest hit so far. `slabs` are the ray's.
///
/// # The own-box rule
///
/// The primitive's test and the slab test round differently, so a hit may lie a few roundings
/// before the boxes that lead to it: a tree that prunes by t would lose what the naive loop finds.
/// Therefore a hit's t is raised to the ray's entry into the primitive's *own* box, and a primitive
/// whose own box the ray misses is not hit. The naive loop does the same; then both agree bit for
/// bit, whatever the primitive's test computes:
///
/// Let h be a hit accepted with t >= near(own box). Every ancestor's box contains the own box, so by
/// the monotony of the slab test (see `Slabs`) near(ancestor) <= near(own box) <= t and
/// far(ancestor) >= far(own box) >= near(own box), t_min. An ancestor is pruned only if near > far, far < t_min
/// or near > t_max. The first two are excluded; the third too as long as t_max >= t, which holds
/// until a hit with a smaller t has been found. So the hit with the smallest (t, index) is always
/// reached, and being the smallest by a total order, it does not depend on the order of visits.
///
/// Raising t, instead of rejecting hits outside the own box's interval, loses nothing where the box
/// is flat and its interval a single rounding wide. A t beyond the far side prunes nothing and is
/// left alone; only if the whole box ends before t_min is the primitive not hit.
///
/// A NaN or infinite t is no hit; -0 becomes +0. The primitive is valid, or the caller makes nothing of the answer.
#[inline(always)]
pub(crate) fn accept<P: Intersect>(
    primitive: &P,
    ray: &Ray<P::Scalar>,
    slabs: &Slabs<P::Scalar>,
) -> Option<(P::Scalar, P::Payload)> {
    let (t, payload) = primitive.intersect(ray)?;
    // Most hits end here, and every NaN; raising t would not bring them back.
    if !ray.includes(t) {
        return None;
    }
    let t = max(t, slabs.entry(&primitive.aabb_of_valid())?) + P::Scalar::ZERO;
    (t <= ray.t_max && t.is_finite()).then_some((t, payload))
}

/// Whether a hit at (`t`, `index`) comes before another: by t, equal ones by index.
#[inline(always)]
pub(crate) fn precedes<S: Scalar, I: Ord>(t: S, index: I, other_t: S, other_index: I) -> bool {
    t < other_t || (t == other_t && index < other_index)
}
