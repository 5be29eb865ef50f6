//! How exactly a triangle is tested: a choice by type.

use super::moller_trumbore::moller_trumbore;
use super::watertight::{bounds, watertight};
use super::{Barycentrics, Corners};
use crate::geometry::{Aabb, PreparedRay, Scalar};
use crate::primitive::{Intersect, Primitive};

/// A triangle tested in the least arithmetic: rays may slip between two triangles at their edge, or hit
/// beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fast<P>(pub P);

/// A triangle tested so that no ray slips between it and its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watertight<P>(pub P);

/// A triangle in `f32` tested in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precise<P>(pub P);

impl<P: Corners> Primitive for Fast<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn aabb(&self) -> Aabb<P::Scalar> {
        Aabb::of_points(self.0.corners())
    }
}

impl<P: Corners> Intersect for Fast<P> {
    type Payload = Barycentrics<P::Scalar>;

    #[inline(always)]
    fn intersect(&self, ray: &PreparedRay<P::Scalar>) -> Option<(P::Scalar, Barycentrics<P::Scalar>)> {
        moller_trumbore(self.0.corners(), ray)
    }
}

impl<P: Corners> Primitive for Watertight<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn aabb(&self) -> Aabb<P::Scalar> {
        bounds(self.0.corners())
    }
}

impl<P: Corners> Intersect for Watertight<P> {
    type Payload = Barycentrics<P::Scalar>;

    #[inline(always)]
    fn intersect(&self, ray: &PreparedRay<P::Scalar>) -> Option<(P::Scalar, Barycentrics<P::Scalar>)> {
        watertight(self.0.corners(), ray, &ray.shear)
    }
}

impl<P: Corners<Scalar = f32>> Primitive for Precise<P> {
    type Scalar = f32;

    #[inline(always)]
    fn aabb(&self) -> Aabb {
        bounds(self.0.corners())
    }
}

impl<P: Corners<Scalar = f32>> Intersect for Precise<P> {
    type Payload = Barycentrics;

    #[inline(always)]
    fn intersect(&self, ray: &PreparedRay) -> Option<(f32, Barycentrics)> {
        let corners = self.0.corners().map(|corner| corner.map(Scalar::widen));
        let wide = crate::geometry::Ray {
            origin: ray.origin.map(Scalar::widen),
            direction: ray.direction.map(Scalar::widen),
            t_min: f64::NEG_INFINITY,
            t_max: f64::INFINITY,
        };
        let (t, Barycentrics { u, v }) = watertight(corners, &wide, &ray.wide_shear)?;
        let t = t as f32;
        (t >= ray.t_min && t <= ray.t_max).then_some((t, Barycentrics { u: u as f32, v: v as f32 }))
    }
}
