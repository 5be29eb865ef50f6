//! A wrapper for primitives that are tested one by one.
//!
//! Wrapped primitives share no packed leaf, so different types fit behind one pointer.

use bvhkit::{Aabb, Intersect, OneByOne, Primitive, Ray};

pub struct Alone<P>(pub P);

impl<P: Primitive> Primitive for Alone<P> {
    type Scalar = P::Scalar;

    fn aabb(&self) -> Aabb<P::Scalar> {
        self.0.aabb()
    }
}

impl<P: Intersect> Intersect for Alone<P> {
    type Payload = P::Payload;
    type Leaf = OneByOne;

    fn intersect(&self, ray: &Ray<P::Scalar>) -> Option<(P::Scalar, P::Payload)> {
        self.0.intersect(ray)
    }
}
