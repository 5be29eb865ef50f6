//! Queries of each layout: which kernel is asked, and what its answer is made into.

use super::HitOf;
use super::any::AskAny;
use super::closest::{AskClosest, hit_of, none};
use super::hits::AskAll;
use crate::geometry::{Ray, Scalar};
use crate::layout::{Layout, NOBODY, WIDTH, WideTree};
use crate::leaf::Primitives;
use crate::leaf::sealed::LeafKind;
use crate::primitive::Intersect;
use crate::simd::Backend;
use crate::traverse::{AskedRay, BestFirst, Counters, FormKernels, Found, ScalarKernels};
use crate::tree::Tree;
use core::slice::{from_mut, from_ref};

/// A layout that rays can be traced through: all of them. Sealed.
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

    /// Of as many rays as there are places.
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

    /// Of as many rays as there are places.
    #[doc(hidden)]
    fn any_hits(&self, backend: Backend, primitives: &[P], rays: &[Ray<P::Scalar>], hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any_hit(backend, primitives, ray);
        }
    }

    /// Opens boxes until the next hit of a valid ray is known.
    #[doc(hidden)]
    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        ask: &mut AskAll<'_, P>,
    ) -> Counters;
}

/// Rays of a list whose hits are kept until their payloads are made.
const CHUNK: usize = 64;

/// The kernels of a type's leaves, if operands say all of its primitives.
macro_rules! in_lanes {
    ($primitive:ty, $form:ty, $kernel:ident) => {
        const {
            <$form as FormKernels<_>>::IN_LANES[<<$primitive as Intersect>::Leaf as LeafKind<
                _,
                <$primitive as Intersect>::Payload,
            >>::KERNEL as usize]
                .$kernel
        }
    };
}

impl<P: Intersect, F: FormKernels<P::Scalar>> Traverse<P> for WideTree<P::Scalar, WIDTH, F> {
    #[inline]
    fn closest_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> Option<HitOf<P>> {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let (put, mut found) = (&Primitives(primitives), Found::none(ray.t_max));
            in_lanes!(P, F, closest)(self, backend, put, from_ref(ray), from_mut(&mut found));
            hit_of::<P>(found)
        } else {
            self.counted_closest_hit(backend, primitives, ray).0
        }
    }

    #[inline]
    fn any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> bool {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let mut found = false;
            let put = &Primitives(primitives);
            in_lanes!(P, F, any)(self, backend, put, from_ref(ray), from_mut(&mut found));
            found
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
            (hit_of::<P>(found), steps)
        } else {
            let (mut ray, mut ask) = (self.asked_ray(backend, ray), AskClosest { primitives, payload: None });
            (const { F::ASKED.closest })(self, backend, &mut ray, &mut ask);
            (ask.hit(&ray), ray.steps)
        }
    }

    #[inline]
    fn counted_any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> (bool, Counters) {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let put = &Primitives(primitives);
            let (found, steps) = in_lanes!(P, F, counted)(self, backend, put, ray, false);
            (found.index != NOBODY, steps)
        } else {
            let (mut ray, mut ask) = (self.asked_ray(backend, ray), AskAny { primitives, is_hit: false });
            (const { F::ASKED.any })(self, backend, &mut ray, &mut ask);
            (ask.is_hit, ray.steps)
        }
    }

    fn closest_hits(
        &self,
        backend: Backend,
        primitives: &[P],
        rays: &[Ray<P::Scalar>],
        hits: &mut [Option<HitOf<P>>],
    ) {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            let mut found = none::<P::Scalar, CHUNK>();
            for (rays, hits) in rays.chunks(CHUNK).zip(hits.chunks_mut(CHUNK)) {
                in_lanes!(P, F, closest)(self, backend, &Primitives(primitives), rays, &mut found);
                for (hit, found) in hits.iter_mut().zip(&found[..rays.len()]) {
                    *hit = hit_of::<P>(*found);
                }
            }
        } else {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.closest_hit(backend, primitives, ray);
            }
        }
    }

    fn any_hits(&self, backend: Backend, primitives: &[P], rays: &[Ray<P::Scalar>], hits: &mut [bool]) {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            in_lanes!(P, F, any)(self, backend, &Primitives(primitives), rays, hits);
        } else {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.any_hit(backend, primitives, ray);
            }
        }
    }

    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        ask: &mut AskAll<'_, P>,
    ) -> Counters {
        if <P::Leaf as LeafKind<P::Scalar, P::Payload>>::IS_SETTLED_IN_LANES {
            in_lanes!(P, F, open)(self, backend, &Primitives(ask.primitives), ray, ahead)
        } else {
            let mut ray = self.asked_ray(backend, ray);
            (const { F::ASKED.open })(self, backend, &mut ray, ask, ahead);
            ray.steps
        }
    }
}

impl<S: Scalar, F: FormKernels<S>> WideTree<S, WIDTH, F> {
    fn asked_ray(&self, backend: Backend, ray: &Ray<S>) -> AskedRay<S> {
        AskedRay { sieve: self.is_ordinary().then_some(backend), ..AskedRay::new(ray) }
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
        let (mut ray, mut ask) = (AskedRay::new(ray), AskClosest { primitives, payload: None });
        (const { P::Scalar::BINARY.closest })(self, backend, &mut ray, &mut ask);
        (ask.hit(&ray), ray.steps)
    }

    #[inline]
    fn counted_any_hit(&self, backend: Backend, primitives: &[P], ray: &Ray<P::Scalar>) -> (bool, Counters) {
        let (mut ray, mut ask) = (AskedRay::new(ray), AskAny { primitives, is_hit: false });
        (const { P::Scalar::BINARY.any })(self, backend, &mut ray, &mut ask);
        (ask.is_hit, ray.steps)
    }

    fn open_ahead(
        &self,
        backend: Backend,
        ray: &Ray<P::Scalar>,
        ahead: &mut BestFirst<P::Scalar, Self::Place>,
        ask: &mut AskAll<'_, P>,
    ) -> Counters {
        let mut ray = AskedRay::new(ray);
        (const { P::Scalar::BINARY.open })(self, backend, &mut ray, ask, ahead);
        ray.steps
    }
}
