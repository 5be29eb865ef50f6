//! The queries of each layout: they choose a kernel, and convert its answer.

use super::HitOf;
use super::any::AnyTest;
use super::closest::{ClosestTest, hit_of};
use super::hits::AllTest;
use crate::geometry::{Ray, Scalar};
use crate::layout::{Layout, NO_PRIMITIVE, WIDTH, WideTree};
use crate::leaf::Primitives;
use crate::leaf::sealed::LeafKind;
use crate::primitive::Intersect;
use crate::simd::Backend;
use crate::traverse::{BestFirst, Counters, EncodingKernels, Found, RayState, ScalarKernels};
use crate::tree::Tree;

/// A layout that rays can be traced through.
///
/// Every layout is one. This trait is sealed.
pub trait Traverse<P: Intersect>: Layout<P> {
    #[doc(hidden)]
    fn closest_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> Option<HitOf<P>>;

    #[doc(hidden)]
    fn any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> bool;

    #[doc(hidden)]
    fn counted_closest_hit(
        &self,
        backend: Backend,
        primitives: &[P],
        ray: &Ray<P::Scalar>,
    ) -> (Option<HitOf<P>>, Counters);

    #[doc(hidden)]
    fn counted_any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> (bool, Counters);

    /// Writes the closest hit of each ray; the longer list's rest is left alone.
    #[doc(hidden)]
    fn closest_hits(
        &self,
        backend: Backend,
        primitives: &[P],
        rays: &[Ray<P::Scalar>],
        hits: &mut [Option<HitOf<P>>],
    ) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest_hit(backend, primitives, ray);
        }
    }

    /// Writes whether each ray hits anything; the longer list's rest is left alone.
    #[doc(hidden)]
    fn any_hits(&self, backend: Backend, primitives: &[P], rays: &[Ray<P::Scalar>], hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any_hit(backend, primitives, ray);
        }
    }

    /// Opens boxes until the next hit of a valid ray is known; returns the steps.
    #[doc(hidden)]
    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        leaf_test: &mut AllTest<'_, P>,
    ) -> Counters;
}

/// A kernel of the leaves of a type whose operands tell all about its primitives.
macro_rules! in_lanes {
    ($primitive:ty, $encoding:ty, $kernel:ident) => {
        const {
            <$encoding as EncodingKernels<_>>::IN_LANES[<<$primitive as Intersect>::Leaf as LeafKind<
                _,
                <$primitive as Intersect>::Payload,
            >>::KERNEL as usize]
                .$kernel
        }
    };
}

impl<P: Intersect, F: EncodingKernels<P::Scalar>> Traverse<P> for WideTree<P::Scalar, WIDTH, F> {
    #[inline]
    fn closest_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> Option<HitOf<P>> {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let (put, mut found) = (&Primitives(primitives), Found::none(ray.t_max));
            in_lanes!(P, F, closest)(self, backend, put, ray, &mut found);
            hit_of::<P>(&found)
        } else {
            self.counted_closest_hit(backend, primitives, ray).0
        }
    }

    #[inline]
    fn any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> bool {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            in_lanes!(P, F, any)(self, backend, &Primitives(primitives), ray)
        } else {
            self.counted_any_hit(backend, primitives, ray).0
        }
    }

    #[inline]
    fn counted_closest_hit(
        &self,
        backend: Backend,
        primitives: &[P],
        ray: &Ray<P::Scalar>,
    ) -> (Option<HitOf<P>>, Counters) {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let put = &Primitives(primitives);
            let (found, steps) = in_lanes!(P, F, counted)(self, backend, put, ray, true);
            (hit_of::<P>(&found), steps)
        } else {
            let (mut ray, mut leaf_test) =
                (self.ray_state(backend, ray), ClosestTest { primitives, payload: None });
            (const { F::DYN.closest })(self, backend, &mut ray, &mut leaf_test);
            (leaf_test.hit(&ray), ray.steps)
        }
    }

    #[inline]
    fn counted_any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> (bool, Counters) {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let put = &Primitives(primitives);
            let (found, steps) = in_lanes!(P, F, counted)(self, backend, put, ray, false);
            (found.index != NO_PRIMITIVE, steps)
        } else {
            let (mut ray, mut leaf_test) =
                (self.ray_state(backend, ray), AnyTest { primitives, is_hit: false });
            (const { F::DYN.any })(self, backend, &mut ray, &mut leaf_test);
            (leaf_test.is_hit, ray.steps)
        }
    }

    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        leaf_test: &mut AllTest<'_, P>,
    ) -> Counters {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            in_lanes!(P, F, open)(self, backend, &Primitives(leaf_test.primitives), ray, ahead)
        } else {
            let mut ray = self.ray_state(backend, ray);
            (const { F::DYN.open })(self, backend, &mut ray, leaf_test, ahead);
            ray.steps
        }
    }
}

impl<S: Scalar, F: EncodingKernels<S>> WideTree<S, WIDTH, F> {
    fn ray_state(&self, backend: Backend, ray: &Ray<S>) -> RayState<S> {
        RayState { sieve: self.is_ordinary().then_some(backend), ..RayState::new(ray) }
    }
}

impl<P: Intersect> Traverse<P> for Tree<P::Scalar> {
    #[inline]
    fn closest_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> Option<HitOf<P>> {
        self.counted_closest_hit(backend, primitives, ray).0
    }

    #[inline]
    fn any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> bool {
        self.counted_any_hit(backend, primitives, ray).0
    }

    #[inline]
    fn counted_closest_hit(
        &self,
        backend: Backend,
        primitives: &[P],
        ray: &Ray<P::Scalar>,
    ) -> (Option<HitOf<P>>, Counters) {
        let (mut ray, mut leaf_test) = (RayState::new(ray), ClosestTest { primitives, payload: None });
        (const { P::Scalar::BINARY.closest })(self, backend, &mut ray, &mut leaf_test);
        (leaf_test.hit(&ray), ray.steps)
    }

    #[inline]
    fn counted_any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> (bool, Counters) {
        let (mut ray, mut leaf_test) = (RayState::new(ray), AnyTest { primitives, is_hit: false });
        (const { P::Scalar::BINARY.any })(self, backend, &mut ray, &mut leaf_test);
        (leaf_test.is_hit, ray.steps)
    }

    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        leaf_test: &mut AllTest<'_, P>,
    ) -> Counters {
        let mut ray = RayState::new(ray);
        (const { P::Scalar::BINARY.open })(self, backend, &mut ray, leaf_test, ahead);
        ray.steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, Fast, Precise, Sphere, Triangle, reference};
    use alloc::vec::Vec;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Returns a scalar, on a coarse lattice or not.
    ///
    /// On the lattice, rays meet corners and edges.
    fn scalar<S: Scalar>(rng: &mut Pcg64Mcg) -> S {
        let x: f64 = rng.random_range(-4.0..4.0);
        S::from_f64(if rng.random() { x } else { x.round() })
    }

    fn point<S: Scalar>(rng: &mut Pcg64Mcg) -> [S; 3] {
        [scalar(rng), scalar(rng), scalar(rng)]
    }

    /// Returns rays from points on a lattice or not, along the axes or not.
    ///
    /// Some of them look behind their origin.
    fn rays<S: Scalar>(rng: &mut Pcg64Mcg) -> Vec<Ray<S>> {
        let mut ray = || {
            let ray = Ray::new(point(rng), point(rng));
            match rng.random_range(0..8) {
                0 => ray.with_interval(S::NEG_INFINITY, S::INFINITY),
                1 => ray.with_interval(S::ZERO, S::HALF),
                2 => Ray { direction: [S::ZERO, -S::ZERO, ray.direction[2]], ..ray },
                _ => ray,
            }
        };
        (0..2000).map(|_| ray()).collect()
    }

    /// Checks the answers of every variant of every instruction set.
    ///
    /// Some instruction sets have two variants, of which users get the quicker one.
    fn answers_are_those_of_the_loop<P: Intersect<Payload: PartialEq + core::fmt::Debug> + Clone>(
        primitive: impl Fn(&mut Pcg64Mcg) -> P,
    ) {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let primitives: Vec<P> = (0..500).map(|_| primitive(&mut rng)).collect();
        let bvh = Bvh::build(primitives.clone()).unwrap();
        let mut hits = 0;
        for ray in rays::<P::Scalar>(&mut rng) {
            let expected = reference::closest_hit(&primitives, &ray);
            hits += usize::from(expected.is_some());
            for backend in Backend::all() {
                let answers = (
                    bvh.layout().closest_hit(backend, &primitives, &ray),
                    bvh.layout().any_hit(backend, &primitives, &ray),
                );
                assert_eq!(answers, (expected, expected.is_some()), "{backend:?}: {ray:?}");
            }
        }
        assert!(hits > 200, "{hits} hits");
    }

    fn triangle<S: Scalar>(rng: &mut Pcg64Mcg) -> Triangle<S> {
        Triangle::new(point(rng), point(rng), point(rng))
    }

    #[test]
    fn fast_triangles() {
        answers_are_those_of_the_loop(|rng| Fast(triangle::<f32>(rng)));
        answers_are_those_of_the_loop(|rng| Fast(triangle::<f64>(rng)));
    }

    #[test]
    fn watertight_triangles() {
        answers_are_those_of_the_loop(triangle::<f32>);
        answers_are_those_of_the_loop(triangle::<f64>);
    }

    #[test]
    fn precise_triangles() {
        answers_are_those_of_the_loop(|rng| Precise(triangle::<f32>(rng)));
    }

    #[test]
    fn spheres() {
        answers_are_those_of_the_loop(|rng| Sphere {
            center: point::<f32>(rng),
            radius: rng.random_range(0.0..1.0),
        });
        answers_are_those_of_the_loop(|rng| Sphere {
            center: point::<f64>(rng),
            radius: rng.random_range(0.0..1.0),
        });
    }
}
