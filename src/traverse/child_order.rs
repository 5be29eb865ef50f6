//! The order of a node's children: which one is next, and how the others wait.

use super::traversal_stack::TraversalStack;
use crate::geometry::Scalar;
use crate::layout::{Reference, WideNode};
use crate::simd::Lanes;

/// A number of children that are sorted, or written, without a branch.
///
/// In most nodes no more are met.
const FEW: usize = 4;

/// Pushes the met children but the nearest, farthest first; returns the nearest.
///
/// There are at least two, which the ray enters at `near` in the lanes `met`. Distances within 16
/// ulps of one another may change places.
///
/// They are sorted in registers where the lanes can sort so many, unless the ray looks behind its
/// origin: its entry distances do not suit that. Otherwise a few are sorted as integers, and
/// more than a few one by one.
#[inline(always)]
pub(super) fn nearest<S: Scalar, L: Lanes<S>, const N: usize>(
    node: &impl WideNode<S, N>,
    near: L,
    met: u32,
    is_ahead: bool,
    stack: &mut TraversalStack<'_, S>,
) -> Reference {
    let count = met.count_ones() as usize;
    if is_ahead {
        let (references, entries) = stack.windows();
        let references = Reference::window(references);
        if let Some(lane) = near.sort(met, Reference::bits(node.children()), references, entries) {
            stack.grow(count - 1);
            return node.children()[lane as usize % N];
        }
    }
    let mut distances = Distances([S::ZERO; 16]);
    near.store(&mut distances.0);
    if count <= FEW {
        nearest_of_few(node, &distances, met, stack)
    } else {
        nearest_of_many(node, &distances, met, stack)
    }
}

/// Does the same as [`nearest`] for a few children, by a sorting network.
///
/// One branch after another on which child is nearer would be mispredicted half of the time (with
/// AVX2 closest hits are 1 to 7 % faster).
#[inline(always)]
fn nearest_of_few<S: Scalar, const N: usize>(
    node: &impl WideNode<S, N>,
    distances: &Distances<S>,
    mut met: u32,
    stack: &mut TraversalStack<'_, S>,
) -> Reference {
    let count = met.count_ones() as usize;
    // A key is a distance whose last bits are replaced by its lane. Unused keys are zero.
    let mut key = || {
        let is_there = met != 0;
        let lane = next_lane(&mut met) % 16;
        let key = distances.of(lane).to_ordered_bits() & !15 | lane as u64;
        if is_there { key } else { 0 }
    };
    let order = |one: u64, other: u64| (one.max(other), one.min(other));
    let [a, b, c, d] = [key(), key(), key(), key()];
    let ((a, b), (c, d)) = (order(a, b), order(c, d));
    let ((a, c), (b, d)) = (order(a, c), order(b, d));
    let (b, c) = order(b, c);
    let (references, entries) = stack.windows();
    for (place, key) in [a, b, c].into_iter().enumerate() {
        let lane = (key & 15) as usize;
        references[place].write(node.children()[lane % N]);
        entries[place].write(distances.of(lane));
    }
    stack.grow(count - 1);
    let of_three_or_four = if count == 3 { c } else { d };
    let nearest = if count == 2 { b } else { of_three_or_four };
    node.children()[(nearest & 15) as usize % N]
}

#[inline(always)]
fn nearest_of_many<S: Scalar, const N: usize>(
    node: &impl WideNode<S, N>,
    distances: &Distances<S>,
    mut met: u32,
    stack: &mut TraversalStack<'_, S>,
) -> Reference {
    let [first, second] = [next_lane(&mut met), next_lane(&mut met)];
    let (mut nearest, farthest) =
        if distances.of(second) < distances.of(first) { (second, first) } else { (first, second) };
    let base = stack.len();
    stack.push(node.children()[farthest % N], distances.of(farthest));
    while met != 0 {
        let mut lane = next_lane(&mut met);
        if distances.of(lane) < distances.of(nearest) {
            core::mem::swap(&mut lane, &mut nearest);
        }
        stack.push(node.children()[lane % N], distances.of(lane));
        stack.sink(base);
    }
    node.children()[nearest % N]
}

/// Pushes all met children but the last, in the order of lanes; returns the last.
///
/// There are at least two.
#[inline(always)]
pub(super) fn last<S: Scalar, L: Lanes<S>, const N: usize>(
    isa: L::Isa,
    node: &impl WideNode<S, N>,
    mut met: u32,
    stack: &mut TraversalStack<'_, S>,
) -> Reference {
    let last = met.ilog2();
    met ^= 1 << last;
    let count = met.count_ones() as usize;
    let (references, _) = stack.windows();
    if L::compress(isa, met, Reference::bits(node.children()), Reference::window(references)) {
        stack.grow(count);
    } else if count <= FEW {
        for reference in &mut references[..FEW] {
            reference.write(node.children()[next_lane(&mut met) % N]);
        }
        stack.grow(count);
    } else {
        while met != 0 {
            stack.push(node.children()[next_lane(&mut met) % N], S::ZERO);
        }
    }
    node.children()[last as usize % N]
}

/// Takes out the lowest lane; returns 32 if there is none.
#[inline(always)]
pub(super) fn next_lane(met: &mut u32) -> usize {
    let lane = met.trailing_zeros() as usize;
    *met &= met.wrapping_sub(1);
    lane
}

/// The distances of a node's children, in one cache line if they are `f32`.
///
/// A store across two lines takes a fifth more time.
#[repr(align(64))]
pub(super) struct Distances<S>(pub [S; 16]);

impl<S: Copy> Distances<S> {
    #[inline(always)]
    fn of(&self, lane: usize) -> S {
        self.0[lane % 16]
    }
}

#[cfg(test)]
mod tests {
    use super::super::traversal_stack::Memory;
    use super::*;
    use crate::geometry::Aabb;
    use crate::layout::{Encoding, Packed};
    use alloc::vec;

    type Node = <Packed as Encoding<f32, 16>>::Node;

    /// Distances with ties and zeros, and all sets of two or more children.
    ///
    /// The stack holds one entry before.
    #[test]
    fn children_are_pushed_farthest_first_and_none_is_lost() {
        let distances = Distances(core::array::from_fn(|lane| ((lane * 7 + 3) % 11) as f32 * 0.75));
        let child = |lane: usize| Reference::node(64 * (lane + 1));
        let boxes: [_; 16] = core::array::from_fn(|lane| (Aabb::new([0.0; 3], [1.0; 3]), child(lane)));
        let node = Node::new(&boxes);
        let lane_of = |place: Reference| (0..16).find(|&lane| child(lane) == place).unwrap();
        for met in (3..=u32::from(u16::MAX)).filter(|met| met.count_ones() > 1) {
            for is_few in [true, false] {
                if is_few && met.count_ones() as usize > FEW {
                    continue;
                }
                let mut memory = Memory::new();
                let mut stack = TraversalStack::new(&mut memory);
                stack.push(Reference::node(0), 9.0);
                let of = if is_few { nearest_of_few } else { nearest_of_many };
                let mut lanes = vec![lane_of(of(&node, &distances, met, &mut stack))];
                while stack.len() > 1 {
                    // Its entry is the child's own distance.
                    let before = stack.len();
                    let lane = lane_of(stack.pop().unwrap());
                    stack.grow(1);
                    assert_eq!(stack.pop_before(distances.of(lane)), Some(child(lane)), "{met:b}");
                    assert_eq!(stack.len(), before - 1);
                    lanes.push(lane);
                }
                assert!(
                    lanes.is_sorted_by(|&a, &b| distances.of(a) <= distances.of(b)),
                    "{met:b}: {lanes:?}"
                );
                assert_eq!(lanes.iter().fold(0, |set, lane| set | 1 << lane), met);
                assert_eq!(lanes.len(), met.count_ones() as usize);
            }
        }
    }
}
