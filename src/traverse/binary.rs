//! The traversal loop of the binary tree.
//!
//! ```text
//! step: an inner node tests both children's boxes:
//!         both met   the nearer is next, the farther goes on the stack with its entry distance
//!         one met    it is next
//!         none met   pop
//!       a leaf is visited, then pop
//! pop:  entries beyond the closest hit so far, which may have moved nearer, are dropped
//! ```
//!
//! Refused: to choose the children without branches; to prefetch the child that goes on the stack;
//! unchecked indexing; in the triangle test, vectors of three scalars instead of four lanes
//! (measured: docs/decisions.md, 32).

use super::best_first::BestFirst;
use super::binary_stack::Stack;
use super::leaf_call::{LeafTest, LeafView, RayState};
use crate::geometry::{Scalar, Slabs, max, min};
use crate::simd::Lanes4;
use crate::tree::{Child, MAX_DEPTH, Node, Tree};
use core::ops::ControlFlow;

#[derive(Clone, Copy)]
struct Deferred<S> {
    entry: S,
    child: Child,
}

/// Shows `leaf_test` the leaves whose boxes the ray meets, until it breaks.
///
/// Nearer children come first.
#[inline(always)]
pub(super) fn traverse<S: Scalar>(
    tree: &Tree<S>,
    ray: &mut RayState<S>,
    leaf_test: &mut dyn LeafTest<S>,
) -> ControlFlow<()> {
    let slabs = ray.slabs;
    let mut child = match tree.root() {
        Some(root) if slabs.entry(&tree.aabb).is_some_and(|entry| entry <= ray.ray.t_max) => root,
        _ => return ControlFlow::Continue(()),
    };
    // At most one entry for each level.
    let mut memory = Stack::memory();
    let mut stack = Stack::<Deferred<S>, MAX_DEPTH>::new(&mut memory);
    loop {
        if child.is_leaf() {
            leaf(tree, child, ray, leaf_test)?;
        } else {
            ray.steps.nodes += 1;
            let node = &tree.nodes[child.first as usize];
            let (entry, met) = enter_children(node, &slabs, ray.ray.t_max);
            let [left, right] = node.children;
            match met {
                [true, true] => {
                    let swap = entry[1] < entry[0];
                    let (near, far) = if swap { (right, left) } else { (left, right) };
                    stack.push(Deferred { entry: max(entry[0], entry[1]), child: far });
                    child = near;
                    continue;
                }
                [true, false] => {
                    child = left;
                    continue;
                }
                [false, true] => {
                    child = right;
                    continue;
                }
                [false, false] => {}
            }
        }
        loop {
            match stack.pop() {
                Some(deferred) if deferred.entry <= ray.ray.t_max => {
                    child = deferred.child;
                    break;
                }
                Some(_) => {}
                None => return ControlFlow::Continue(()),
            }
        }
    }
}

#[inline(always)]
fn leaf<S: Scalar>(
    tree: &Tree<S>,
    leaf: Child,
    ray: &mut RayState<S>,
    leaf_test: &mut dyn LeafTest<S>,
) -> ControlFlow<()> {
    let indices = &tree.indices[leaf.slots()];
    ray.steps.leaves += 1;
    leaf_test.test(LeafView { indices, rows: &[] }, ray)
}

/// Opens the boxes ahead of the ray, nearest first, up to the next hit.
///
/// It stops when nothing can come before that hit.
#[inline(always)]
pub(super) fn open<S: Scalar>(
    tree: &Tree<S>,
    ahead: &mut BestFirst<S, Child>,
    ray: &mut RayState<S>,
    leaf_test: &mut dyn LeafTest<S>,
) {
    let slabs = ray.slabs;
    while let Some(child) = ahead.next_box() {
        if child.is_leaf() {
            ray.hits = core::mem::take(&mut ahead.hits);
            // The whole leaf is tested, whatever the result.
            let _ = leaf(tree, child, ray, leaf_test);
            ahead.hits = core::mem::take(&mut ray.hits);
        } else {
            ray.steps.nodes += 1;
            let node = &tree.nodes[child.first as usize];
            let (entry, met) = enter_children(node, &slabs, ray.ray.t_max);
            for side in [0, 1] {
                if met[side] {
                    ahead.add(node.children[side], entry[side]);
                }
            }
        }
    }
}

/// Returns where the ray enters the children's boxes, and which of them it meets.
///
/// Entries are at t_min or later. Only boxes that the ray meets up to `limit` count as met.
#[inline(always)]
pub(super) fn enter_children<S: Scalar>(node: &Node<S>, slabs: &Slabs<S>, limit: S) -> ([S; 2], [bool; 2]) {
    if slabs.t_min < S::ZERO {
        // A copy: a reference would keep the slabs out of registers on all other paths.
        let copy = *slabs;
        return enter_children_behind(node, &copy, limit);
    }
    // One maximum serves both ends: the far ends are computed with the opposite sign.
    let mut bounds = S::Lanes4::of_halves(slabs.t_min, -limit);
    for axis in 0..3 {
        let negative = usize::from(slabs.negative[axis]);
        let planes = S::Lanes4::of_pairs(&node.planes[axis][negative], &node.planes[axis][1 - negative]);
        let inv = S::Lanes4::of_halves(slabs.inv_near[axis], -slabs.inv_far[axis]);
        bounds = planes.sub(S::Lanes4::splat(slabs.origin[axis])).mul(inv).max(bounds);
    }
    let [near, far] = bounds.to_pairs_negating_second();
    (near, [near[0] <= far[0], near[1] <= far[1]])
}

/// The same for a ray that also looks behind its origin.
///
/// There the padding has the other sign.
#[cold]
#[inline(never)]
fn enter_children_behind<S: Scalar>(node: &Node<S>, slabs: &Slabs<S>, limit: S) -> ([S; 2], [bool; 2]) {
    let (mut near, mut far) = ([slabs.t_min; 2], [limit; 2]);
    for axis in 0..3 {
        let [minima, maxima] = node.planes[axis];
        for side in [0, 1] {
            let [enters, leaves] = slabs.slab(axis, [minima[side], maxima[side]]);
            near[side] = max(enters, near[side]);
            far[side] = min(leaves, far[side]);
        }
    }
    (near, [near[0] <= far[0], near[1] <= far[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};

    #[test]
    fn one_box_and_two_boxes_round_alike() {
        // Distances on both sides of the origin: some underflow when multiplied,
        // others are ordinary.
        let values = [-1.0f32, -1e-45, -0.0, 0.0, 1e-45, 2e-45, 1e-38, 0.625, 1.0];
        let directions = [-2.0f32, -1.0, -0.0, 0.0, 0.5, 2.0];
        for t_min in [-3.0, 0.0, 1e-45] {
            for &origin in &values {
                for &direction in &directions {
                    let ray = Ray::new([origin, 0.0, 0.0], [direction, 1.0, 0.0]).with_interval(t_min, 9.0);
                    let slabs = Slabs::new(&ray);
                    for (i, &low) in values.iter().enumerate() {
                        for &high in &values[i..] {
                            let aabb = Aabb::new([low, -0.5, 0.0], [high, 0.5, 0.0]);
                            let single = slabs.entry(&aabb).map(|t| max(t, t_min));
                            let (entries, met) = enter_children(&Node::new([aabb; 2]), &slabs, 9.0);
                            let pair = met[0].then_some(entries[0]);
                            assert_eq!(single, pair, "{ray:?} {aabb:?}");
                            assert_eq!((entries[0], met[0]), (entries[1], met[1]));
                        }
                    }
                }
            }
        }
    }
}
