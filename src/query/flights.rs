//! Rays in turns: while one waits for memory, others go on.
//!
//! Some rays are in flight, each with its own stack. They take turns: a step each, after which what it will need next is
//! fetched into the cache. Each ray makes the steps that it would make alone.

use super::Visitor;
use super::pending::{Memory, Pending};
use super::wide::{Row, WideRay, first, step};
use crate::geometry::{PreparedRay, Ray, Shear, Slabs};
use crate::layout::{Form, Reference, WideTree};
use crate::primitive::Intersect;
use crate::simd::{Count, Width};
use alloc::vec::Vec;
use fearless_simd::Simd;

/// Rays in flight.
const IN_FLIGHT: usize = 16;

/// A ray under way.
struct Flight<P: Intersect, V> {
    number: usize,
    ray: Ray<P::Scalar>,
    slabs: Slabs<P::Scalar>,
    shear: Shear<P::Scalar>,
    next: Reference,
    /// On the stack.
    waiting: usize,
    visitor: V,
}

#[inline(always)]
pub(super) fn traverse_in_turns<
    'r,
    P: Intersect,
    I: Simd,
    V: Visitor<P>,
    F: Form<P::Scalar, N>,
    const N: usize,
>(
    tree: &WideTree<P::Scalar, N, F>,
    isa: I,
    mut rays: impl Iterator<Item = (usize, &'r Ray<P::Scalar>)>,
    start: impl Fn(&Ray<P::Scalar>) -> V,
    mut finish: impl FnMut(usize, V),
) where
    Count<N>: Width,
{
    let mut launch = |finish: &mut dyn FnMut(usize, V)| {
        for (number, &ray) in rays.by_ref() {
            let visitor = start(&ray);
            let prepared = ray.prepare();
            let PreparedRay { slabs, shear, .. } = prepared;
            match first(tree, &prepared, visitor.limit()) {
                Some(next) => {
                    return Some(Flight::<P, V> { number, ray, slabs, shear, next, waiting: 0, visitor });
                }
                None => finish(number, visitor),
            }
        }
        None
    };
    // On the heap: they are too large for a small thread's stack.
    let mut stacks: Vec<Memory<P::Scalar>> = (0..IN_FLIGHT).map(|_| Memory::new()).collect();
    let mut flights = Vec::with_capacity(IN_FLIGHT);
    while flights.len() < IN_FLIGHT
        && let Some(flight) = launch(&mut finish)
    {
        flights.push(Some(flight));
    }
    let mut under_way = flights.len();
    while under_way > 0 {
        for (slot, stack) in flights.iter_mut().zip(&mut stacks) {
            let Some(flight) = slot else { continue };
            let prepared = PreparedRay::of_parts(&flight.ray, flight.slabs, flight.shear);
            let ray: WideRay<'_, _, Row<P::Scalar, I, N>> =
                WideRay::new::<P, F, N>(isa, tree, &prepared, &flight.ray, &flight.shear).in_turns();
            let mut pending = Pending::new(stack, flight.waiting);
            match step(isa, tree, flight.next, &ray, &mut pending, &mut flight.visitor, &mut ()) {
                Some(next) => {
                    F::prefetch(tree, next);
                    flight.next = next;
                    flight.waiting = pending.len();
                }
                None => {
                    let done = core::mem::replace(slot, launch(&mut finish));
                    under_way -= usize::from(slot.is_none());
                    if let Some(Flight { number, visitor, .. }) = done {
                        finish(number, visitor);
                    }
                }
            }
        }
    }
}
