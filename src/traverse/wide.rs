//! The traversal loop of the wide trees.
//!
//! ```text
//! step: an inner node tests the boxes of all its children at once:
//!         none met   pop
//!         one met    it is next
//!         more met   the nearest is next, the others go on the stack by entry distance, the
//!                    nearest on top; if any hit will do, they go there in the order of their
//!                    lanes, and the last is next
//!       a leaf tests its primitives, all at once if there is a lane test for them, then pop
//! pop:  entries beyond the visitor's limit, which may have moved nearer, are dropped
//! ```

use super::best_first::BestFirst;
use super::box_test::BoxTest;
use super::child_order::{Distances, last, nearest, next_lane};
use super::traversal_stack::{Memory, TraversalStack};
use super::visitor::{DynLeaves, Visitor};
use crate::geometry::{Aabb, Ray, Scalar, Slabs};
use crate::layout::{Encoding, Outline, Reference, WideNode, WideTree};
use crate::simd::{Count, Isa, KernelLanes, Width};
use core::mem::take;

/// Shows `visitor` the leaves whose boxes a valid ray meets, until it breaks.
///
/// `is_ordinary` is [`Ray::is_ordinary`] of the ray. If `AHEAD`, its t_min is not negative.
#[inline(always)]
pub(super) fn traverse<S: Scalar, I: Isa, F: Encoding<S, N>, const N: usize, const AHEAD: bool>(
    isa: I,
    tree: &WideTree<S, N, F>,
    ray: &Ray<S>,
    slabs: &Slabs<S>,
    is_ordinary: bool,
    visitor: &mut impl Visitor<S>,
) where
    Count<N>: Width,
{
    let Some(mut next) = first(tree, ray, visitor.limit()) else { return };
    let boxes: BoxTest<S, Row<S, I, N>, AHEAD> = BoxTest::new(isa, slabs, is_ordinary);
    let fetches = tree.is_large();
    let mut memory = Memory::new();
    let mut stack = TraversalStack::new(&mut memory);
    // SAFETY: `next` is the tree's root, or a child of one of its nodes, and so
    // is all on the stack.
    while let Some(place) = unsafe { step(isa, tree, next, ray, &boxes, &mut stack, visitor, fetches) } {
        next = place;
    }
}

/// Opens the boxes ahead of a valid ray, nearest first, up to the next hit.
///
/// It stops when nothing can come before that hit. While a leaf is tested, the
/// hits are in `ray.hits`.
#[inline(always)]
pub(super) fn open<S: Scalar, I: Isa, F: Encoding<S, N>, const N: usize>(
    isa: I,
    tree: &WideTree<S, N, F>,
    ahead: &mut BestFirst<S, Reference>,
    visitor: &mut DynLeaves<'_, S, true>,
) where
    Count<N>: Width,
{
    let ray = visitor.ray.ray;
    let boxes: BoxTest<S, Row<S, I, N>, false> = BoxTest::new(isa, &visitor.ray.slabs, ray.is_ordinary());
    while let Some(place) = ahead.next_box() {
        if place.is_leaf() {
            visitor.ray.hits = take(&mut ahead.hits);
            // The whole leaf is tested, whatever the result.
            // SAFETY: `ahead` holds the tree's root and children of its nodes.
            let _ = unsafe { visitor.leaf(isa, tree, place) };
            ahead.hits = take(&mut visitor.ray.hits);
        } else {
            visitor.node();
            // SAFETY: as above.
            let node = unsafe { tree.node(place) };
            let (near, mut met) = boxes.enter(node, &ray, ray.t_max);
            let mut entries = Distances([S::ZERO; 16]);
            near.store(&mut entries.0);
            while met != 0 {
                let lane = next_lane(&mut met);
                let child = node.children()[lane % N];
                // Most boxes that are met will be opened, and others before them, so there is time
                // to fetch them. With this, all hits of 300,000 triangles take a quarter to two
                // fifths less time.
                F::prefetch(tree, child);
                ahead.add(child, entries.0[lane % 16]);
            }
        }
    }
}

/// Returns the reference at which a ray begins, if it may meet the tree.
#[inline(always)]
fn first<S: Scalar, F: Encoding<S, N>, const N: usize>(
    tree: &WideTree<S, N, F>,
    ray: &Ray<S>,
    limit: S,
) -> Option<Reference> {
    let root = tree.root()?;
    // The boxes of an inner root's children will tell whether it is met.
    if root.is_leaf() && !meets(&tree.aabb(), ray, limit) {
        return None;
    }
    Some(root)
}

#[cold]
#[inline(never)]
fn meets<S: Scalar>(aabb: &Aabb<S>, ray: &Ray<S>, limit: S) -> bool {
    Slabs::new(ray).entry(aabb).is_some_and(|entry| entry <= limit)
}

/// A vector with one scalar for each child of a node.
type Row<S, I, const N: usize> = <Count<N> as Width>::Lanes<S, I>;

/// Visits a node or a leaf, and returns the next one, if there is any.
///
/// # Safety
///
/// `place` is one of the tree's nodes or leaves, and so are those on the stack.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a loop's state, in registers")]
unsafe fn step<S: Scalar, I: Isa, V: Visitor<S>, F: Encoding<S, N>, const N: usize, const AHEAD: bool>(
    isa: I,
    tree: &WideTree<S, N, F>,
    place: Reference,
    ray: &Ray<S>,
    boxes: &BoxTest<S, Row<S, I, N>, AHEAD>,
    stack: &mut TraversalStack<'_, S>,
    visitor: &mut V,
    fetches: bool,
) -> Option<Reference>
where
    Count<N>: Width,
{
    if place.is_leaf() {
        // SAFETY: the caller promises that `place` is one of the tree's leaves.
        if unsafe { visitor.leaf(isa, tree, place) }.is_break() {
            return None;
        }
    } else {
        visitor.node();
        // SAFETY: the caller promises that `place` is one of the tree's nodes.
        let node = unsafe { tree.node(place) };
        let (near, met) = boxes.enter(node, ray, visitor.limit());
        if met != 0 {
            if met & (met - 1) == 0 {
                return Some(node.children()[met.trailing_zeros() as usize % N]);
            }
            let next = if V::IN_ORDER {
                nearest(node, near, met, boxes.is_ahead(), stack)
            } else {
                last::<_, Row<S, I, N>, N>(isa, node, met, stack)
            };
            fetch_top(fetches, tree, stack);
            return Some(next);
        }
    }
    let next = if V::IN_ORDER { stack.pop_before(visitor.limit()) } else { stack.pop() };
    fetch_top(fetches, tree, stack);
    next
}

/// Prefetches the stack's top, which is popped next unless the next step pushes.
///
/// Its memory has the time of that step to arrive. This pays in large trees alone
/// (measured: docs/decisions.md, 33).
#[inline(always)]
fn fetch_top<S: Scalar, F: Encoding<S, N>, const N: usize>(
    fetches: bool,
    tree: &WideTree<S, N, F>,
    stack: &TraversalStack<'_, S>,
) {
    if fetches && let Some(place) = stack.top() {
        F::prefetch(tree, place);
    }
}
