//! The rule that accepts hits: one for the tree, the naive loop and every query.

use super::Intersect;
use crate::geometry::{Ray, Scalar, Slabs, max};

/// Returns t and the payload of the ray's hit with `primitive`, if there is one.
///
/// The hit must be in the ray's interval. A query narrows the end of that interval to the closest
/// hit so far. `slabs` must be those of `ray`.
///
/// # The own-box rule
///
/// The primitive's test and the slab test round differently, so a hit may be a few roundings before
/// the boxes that lead to it. A tree that prunes by t would lose such a hit, and the naive loop
/// would find it. Therefore a hit's t is raised to the ray's entry into the primitive's *own* box,
/// and a primitive is not hit if the ray misses its own box. The naive loop does the same. Then
/// both agree bit for bit, whatever the primitive's test computes:
///
/// Let h be a hit accepted with t >= near(own box). Every ancestor's box contains the own box. The
/// slab test is monotone (see `Slabs`), so near(ancestor) <= near(own box) <= t and
/// far(ancestor) >= far(own box) >= near(own box), t_min. An ancestor is pruned only if near > far,
/// far < t_min or near > t_max. The first two are excluded. The third is excluded as long as
/// t_max >= t, which holds until a hit with a smaller t is found. So the hit with the smallest
/// (t, index) is always reached. It is the smallest by a total order, so it does not depend on the
/// order of visits.
///
/// Where the own box is flat and its interval is a single rounding wide, rejecting hits outside of
/// that interval would lose hits. Raising t loses none. A t beyond the far side prunes nothing and
/// stays as it is. If the whole box ends before t_min, the primitive is not hit.
///
/// A NaN or infinite t is no hit, and -0 becomes +0. Either the primitive is valid, or the caller
/// discards the answer.
#[inline(always)]
pub(crate) fn accept<P: Intersect>(
    primitive: &P,
    ray: &Ray<P::Scalar>,
    slabs: &Slabs<P::Scalar>,
) -> Option<(P::Scalar, P::Payload)> {
    let (t, payload) = primitive.intersect(ray)?;
    // Most hits end here, and every NaN. A t outside the interval is no hit, even if raising it
    // would move it inside.
    if !ray.includes(t) {
        return None;
    }
    let t = max(t, slabs.entry(&primitive.aabb_of_valid())?) + P::Scalar::ZERO;
    (t <= ray.t_max && t.is_finite()).then_some((t, payload))
}

/// Returns whether a hit at (`t`, `index`) comes before another: by t, then index.
#[inline(always)]
pub(crate) fn precedes<S: Scalar, I: Ord>(t: S, index: I, other_t: S, other_index: I) -> bool {
    t < other_t || (t == other_t && index < other_index)
}
