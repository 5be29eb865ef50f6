//! Queries in the user's types: a thin layer above the kernels in `traverse`.

mod any;
mod closest;
mod each;
mod hits;
mod traverse;

pub use hits::Hits;
pub use traverse::Traverse;

use crate::primitive::Intersect;

/// A hit of a ray with a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<S, T> {
    /// The position on the ray: the point is `origin + t * direction`.
    pub t: S,
    /// The primitive's index in the input.
    pub index: usize,
    /// The primitive's own data about the hit, such as barycentrics, or `()`.
    pub payload: T,
}

/// The hit of a ray with a primitive of type `P`.
pub(crate) type HitOf<P> = Hit<<P as crate::Primitive>::Scalar, <P as Intersect>::Payload>;
