//! Neighbours along Morton's curve, split as one: a build of clusters has a third or a sixth of the references.
//!
//! ```text
//! references -> curve -> largest subtrees of so many keys -> those with small boxes whole, others parted
//! ```
//!
//! The boxes of large primitives among small ones would hide what is small from the heuristic: with clusters of up to 4,
//! however large, rays in a hotel room are 11 % slower than in a tree of single primitives, with this bound 2 %. Codes with
//! bits of size among those of place (Vinkler, Bittner and Havran, Extended Morton Codes, HPG 2017) were no better in
//! six ways of mixing them.

use super::curve::{Curve, border, difference};
use super::heuristic::codes;
use super::reference::{PrimRef, bounds};
use super::subtree::Subtree;
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::simd::prefetch;
use crate::tree::{Child, MAX_DEPTH, Node};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// A cluster's box has at most this many times a primitive's share of the scene's area.
const LARGEST: f64 = 64.0;

/// How many clusters before one's turn its references are asked for: they lie in the input's order.
const AHEAD: usize = 8;

/// Clusters, and what is in them.
pub(super) struct Clusters {
    /// Where each ends among the indices.
    ends: Vec<u32>,
    /// Of primitives, cluster by cluster.
    indices: Vec<u32>,
}

impl Clusters {
    /// Clusters of up to `size` of the references, at least one, and references to them, whose indices are the clusters' numbers.
    pub fn of<S: Scalar>(references: &[PrimRef<S>], scene: &Aabb<S>, size: usize) -> (Self, Vec<PrimRef<S>>) {
        let curve = Curve::new(&codes(references, scene), MAX_DEPTH);
        let (_, tasks) = curve.divide::<S>();
        let scale = scene.area_scale();
        let largest = scene.scaled_half_area(scale).to_f64() * LARGEST / references.len() as f64;
        let is_small = |aabb: &Aabb<S>| aabb.scaled_half_area(scale).to_f64() <= largest;
        let parts = parallel::map(tasks, |task: Range<usize>| {
            let keys = &curve.keys[task.clone()];
            let at = |key: &u64| &references[curve.place(*key)];
            let subtrees = subtrees(keys, size);
            let mut clusters = Vec::with_capacity(2 * subtrees.len());
            let mut open = Vec::with_capacity(size);
            for (number, subtree) in subtrees.iter().enumerate() {
                for key in subtrees.get(number + AHEAD).map_or(&[][..], |ahead| &keys[ahead.clone()]) {
                    prefetch(core::ptr::from_ref(at(key)).cast(), size_of::<PrimRef<S>>());
                }
                open.push(subtree.clone());
                while let Some(range) = open.pop() {
                    let aabb = bounds(keys[range.clone()].iter().map(at));
                    if range.len() == 1 || is_small(&aabb) {
                        clusters.push((aabb, (task.start + range.end) as u32));
                    } else {
                        let border = range.start + border(&keys[range.clone()]);
                        open.extend([border..range.end, range.start..border]);
                    }
                }
            }
            clusters
        });
        let all = parallel::concat(parts.iter().map(|part| part.iter().copied()).collect());
        let ends = parallel::collect(&all, |_, &(_, end)| end);
        let indices = parallel::collect(&curve.keys, |_, &key| references[curve.place(key)].index);
        (
            Self { ends, indices },
            parallel::collect(&all, |number, &(aabb, _)| PrimRef::new(aabb, number as u32)),
        )
    }

    /// The tree over primitives from one over clusters.
    pub fn opened<S: Scalar>(&self, tree: Subtree<S>) -> Subtree<S> {
        let Subtree { nodes, root, indices } = tree;
        let members = |&cluster: &u32| {
            let start = cluster.checked_sub(1).map_or(0, |before| self.ends[before as usize]);
            &self.indices[start as usize..self.ends[cluster as usize] as usize]
        };
        // Where each slot's primitives begin.
        let mut sum = 0;
        let mut starts = Vec::with_capacity(indices.len() + 1);
        starts.push(sum);
        starts.extend(indices.iter().map(|cluster| {
            sum += members(cluster).len() as u32;
            sum
        }));
        let moved = |child: Child| {
            let Range { start, end } = child.slots();
            if child.is_leaf() { Child::leaf(starts[start] as usize..starts[end] as usize) } else { child }
        };
        let nodes = parallel::collect(&nodes, |_, node| Node { children: node.children.map(moved), ..*node });
        let members = |clusters: &[u32]| clusters.iter().flat_map(members).copied().collect();
        let parts: Vec<Vec<u32>> = parallel::map(indices.chunks(1 << 14).collect(), members);
        let indices = parallel::concat(parts.into_iter().map(Vec::into_iter).collect());
        Subtree { nodes, root: moved(root), indices }
    }
}

/// The largest subtrees of at most `size` sorted keys, in order.
///
/// As [`linear`](super::linear) finds nodes: keys come from the right, and what awaits its left neighbour lies on a stack.
fn subtrees(keys: &[u64], size: usize) -> Vec<Range<usize>> {
    let mut begins = vec![false; keys.len()];
    // Where each begins and ends, and whether it is small enough.
    let mut open: Vec<(usize, usize, bool)> = Vec::with_capacity(MAX_DEPTH + 1);
    for first in (0..keys.len()).rev() {
        let (mut end, mut fits) = (first + 1, true);
        let on_the_left = difference(keys, first);
        while difference(keys, end) < on_the_left
            && let Some((right, right_end, right_fits)) = open.pop()
        {
            let both_fit = right_end - first <= size;
            if !both_fit {
                begins[first] |= fits;
                begins[right] |= right_fits;
            }
            (end, fits) = (right_end, both_fit);
        }
        open.push((first, end, fits));
    }
    begins[0] = true;
    let starts = (0..keys.len()).filter(|&key| begins[key]);
    let ends = starts.clone().skip(1).chain([keys.len()]);
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(n: usize) -> impl Iterator<Item = u64> {
        (1..=n as u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    #[test]
    fn subtrees_are_the_largest_of_their_size() {
        for (n, bits) in [(1, 60), (2, 60), (500, 60), (500, 10), (3000, 14)] {
            let mut keys: Vec<u64> = scattered(n).map(|key| key >> (64 - bits)).collect();
            keys.sort_unstable();
            keys.dedup();
            for size in [1, 2, 3, 8, 5000] {
                let mut expected = Vec::new();
                let mut open = vec![0..keys.len()];
                while let Some(range) = open.pop() {
                    if range.len() <= size {
                        expected.push(range);
                    } else {
                        let border = range.start + border(&keys[range.clone()]);
                        open.extend([border..range.end, range.start..border]);
                    }
                }
                assert_eq!(subtrees(&keys, size), expected, "{n} keys of {bits} bits, {size}");
            }
        }
    }

    /// Small boxes, and every hundredth one as large as the scene.
    #[test]
    fn clusters_hold_each_once_and_what_is_large_is_alone() {
        let references: Vec<PrimRef> = (0..)
            .zip(scattered(10_000))
            .map(|(index, bits)| {
                let center = [0, 20, 40].map(|shift| ((bits >> shift) & 0xfffff) as f32);
                let half = if index % 100 == 0 { 1e5 } else { 1.0 };
                PrimRef::new(Aabb::new(center.map(|x| x - half), center.map(|x| x + half)), index)
            })
            .collect();
        let scene = bounds(&references);
        let (clusters, all) = Clusters::of(&references, &scene, 4);
        let mut seen = clusters.indices.clone();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..10_000));
        assert!(all.len() < 8_000 && clusters.ends.len() == all.len());
        let mut start = 0;
        for (cluster, &end) in all.iter().zip(&clusters.ends) {
            let members =
                clusters.indices[start as usize..end as usize].iter().map(|&i| &references[i as usize]);
            assert!((1..=4).contains(&(end - start)));
            assert_eq!(cluster.aabb, bounds(members.clone()));
            assert!(
                members.clone().count() == 1 || members.into_iter().all(|member| member.index % 100 != 0)
            );
            start = end;
        }
    }
}
