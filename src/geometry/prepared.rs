//! The ray with what is computed from it once, for all boxes and primitives that it meets.

use super::{Ray, Scalar, Shear, Slabs};
use core::ops::Deref;

/// A [`Ray`], and what is computed from it once for all the boxes and primitives that it meets: from
/// [`Ray::prepare`]. Dereferences to the ray, so `ray.origin`, `ray.at(t)` and the rest are the same.
///
/// Queries prepare the ray that they are given. Only what the primitive's test asks for is computed:
/// the rest is dropped by the compiler, unless the test is hidden behind a `dyn`.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay<S: Scalar = f32> {
    ray: Ray<S>,
    /// For boxes.
    pub(crate) slabs: Slabs<S>,
    /// For watertight triangles.
    pub(crate) shear: Shear<S>,
    /// For triangles in doubled precision.
    pub(crate) wide_shear: Shear<S::Wide>,
}

impl<S: Scalar> PreparedRay<S> {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray<S>) -> Self {
        let ray = &ray.read();
        Self::of_parts(ray, Slabs::new(ray), Shear::new(&ray.origin, &ray.direction))
    }

    /// The rest, for one whose parts are at hand.
    #[inline(always)]
    pub(crate) fn of_parts(ray: &Ray<S>, slabs: Slabs<S>, shear: Shear<S>) -> Self {
        // Written out: `array::map` is not inlined in builds of several codegen units.
        let widen = |[x, y, z]: [S; 3]| [x.widen(), y.widen(), z.widen()];
        Self { ray: *ray, slabs, shear, wide_shear: Shear::new(&widen(ray.origin), &widen(ray.direction)) }
    }
}

impl<S: Scalar> Deref for PreparedRay<S> {
    type Target = Ray<S>;

    #[inline(always)]
    fn deref(&self) -> &Ray<S> {
        &self.ray
    }
}
