//! What is asked of a hierarchy, in the user's types: thin, above the kernels in `traverse`.

mod any;
mod closest;
mod each;
mod hits;
mod traverse;

pub use hits::Hits;
pub use traverse::Traverse;

use crate::primitive::Intersect;

/// A ray's hit with a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<S, T> {
    /// Where on the ray: the point is `origin + t * direction`.
    pub t: S,
    /// The primitive's index in the input.
    pub index: usize,
    /// What the primitive tells of the hit: barycentrics, `()`, whatever its type says.
    pub payload: T,
}

/// The hit that a primitive of type `P` gives.
pub(crate) type HitOf<P> = Hit<<P as crate::Primitive>::Scalar, <P as Intersect>::Payload>;
