//! Which of a node's children is next, and in what order the others wait.

use super::pending::Pending;
use crate::geometry::Scalar;
use crate::layout::{Reference, WideNode};
use crate::simd::Lanes;

/// The nearest of two children or more, which are entered at `near` in the lanes `met`; the others are pushed, the
/// farthest first.
///
/// In registers where the lanes can sort, which the entry distances of a ray that looks behind its origin do not suit; else
/// one by one.
#[inline(always)]
pub(super) fn nearest<S: Scalar, L: Lanes<S>, const N: usize>(
    node: &impl WideNode<S, N>,
    near: L,
    mut met: u32,
    t_min: S,
    pending: &mut Pending<'_, S>,
) -> Reference {
    if t_min >= S::ZERO {
        let (references, entries) = pending.windows();
        let references = Reference::window(references);
        if let Some(lane) = near.sort(met, Reference::bits(node.children()), references, entries) {
            pending.grow(met.count_ones() as usize - 1);
            return node.children()[lane as usize % N];
        }
    }
    let mut distances = Distances([S::ZERO; 16]);
    near.store(&mut distances.0);
    let distance = |lane: usize| distances.0[lane % 16];
    let [first, second] = [next_lane(&mut met), next_lane(&mut met)];
    let (mut nearest, farthest) =
        if distance(second) < distance(first) { (second, first) } else { (first, second) };
    let base = pending.len();
    pending.push(node.children()[farthest % N], distance(farthest));
    while met != 0 {
        let mut lane = next_lane(&mut met);
        if distance(lane) < distance(nearest) {
            core::mem::swap(&mut lane, &mut nearest);
        }
        pending.push(node.children()[lane % N], distance(lane));
        pending.sink(base);
    }
    node.children()[nearest % N]
}

/// The last of two children or more; the others are pushed as they lie in the node.
#[inline(always)]
pub(super) fn last<S: Scalar, L: Lanes<S>, const N: usize>(
    isa: L::Isa,
    node: &impl WideNode<S, N>,
    mut met: u32,
    pending: &mut Pending<'_, S>,
) -> Reference {
    let last = met.ilog2();
    met ^= 1 << last;
    let (references, _) = pending.windows();
    if L::compress(isa, met, Reference::bits(node.children()), Reference::window(references)) {
        pending.grow(met.count_ones() as usize);
    } else {
        while met != 0 {
            pending.push(node.children()[next_lane(&mut met) % N], S::ZERO);
        }
    }
    node.children()[last as usize % N]
}

#[inline(always)]
pub(super) fn next_lane(met: &mut u32) -> usize {
    let lane = met.trailing_zeros() as usize;
    *met &= *met - 1;
    lane
}

/// Stored a line at a time: across two lines it takes a fifth more.
#[repr(align(64))]
pub(super) struct Distances<S>(pub [S; 16]);
