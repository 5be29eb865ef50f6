//! The build of clusters: splits above, Morton's curve below.
//!
//! ```text
//! references -> curve -> clusters: at most so many neighbours, alike in size, cut into a row of leaves
//!                                  or, where the layout cannot divide leaves, with a tree each, in one pass
//!            -> splits of clusters -> joined
//! ```
//!
//! Most of a build's time goes into its many small nodes, most of a tree's quality into its few large ones. So the curve
//! settles the small ones, and the heuristic the others.
//!
//! The boxes of large primitives among small ones would hide what is small from the heuristic: so the primitives of a
//! cluster are about as large as one another, if it is not small itself. A bound on its box alone made single ones of the
//! primitives of a volume (737 ns a triangle of a soup instead of 150).
//!
//! Refused, in steps of rays over those with `Quality::Balanced` (six scenes; clusters of 128 take 1.17):
//! - clusters of 4 or 8: 0.97 to 1.05, and no quicker to build than none: some 280 ns go into each node, of which there are as many;
//! - rows cut along the whole curve, and splits of their leaves, 6 primitives each, down to sets of 16, what a node holds: 1.14, for a
//!   seventh more time; down to single ones, with reinsertion, large primitives apart: 1.04, for three quarters of the time of
//!   `Balanced`;
//! - splits of clusters of 4 to 32 above sets of 1,024, of primitives below: 0.9 to 1.2 by luck, and no quicker than `Balanced` (sponza's
//!   tree 38 ms): 8 ms for the clusters, 4 for their splits, and the 25 that splits of up to 1,024 take in any case;
//! - Hilbert's curve: as good as Morton's;
//! - codes with bits of size among those of place (Vinkler, Bittner and Havran, Extended Morton Codes, HPG 2017): no better in six
//!   ways of mixing them.

use super::buffers::Buffers;
use super::heuristic::codes;
use super::lbvh::{Order, Root};
use super::leaf_partition::Cutter;
use super::morton_order::{Curve, border};
use super::partition::Rules;
use super::progress::{BuildControl, Progress};
use super::reference::{PrimRef, bounds};
use super::subtree::{Piece, Subtree, TASK_SIZE, join, task_child};
use crate::geometry::{Aabb, Scalar};
use crate::leaf::LEAF_WIDTH;
use crate::memory::with_numbers;
use crate::parallel;
use crate::tree::{Child, MAX_DEPTH};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// Up to this many times its primitives' share of the scene's area a cluster's box may have, whatever is in it.
const LARGEST: f64 = 16.0;

/// How evenly the boxes in a larger one have to be large: the square of their areas' sum over the sum of their squares, which
/// is their number if all are equal and 1 if one outweighs the others, in parts of their number.
const EVEN: f64 = 0.5;

/// No cluster's subtree is deeper: what is left of [`MAX_DEPTH`] is the splits'.
const DEPTH: usize = 16;

/// How deep the splits may go.
pub(super) const SPLIT_DEPTH: usize = MAX_DEPTH - DEPTH;

const _: () = assert!(TASK_SIZE < 1 << DEPTH, "what lies in a task halves to one in fewer steps");

/// The tree over references, at least one, in clusters of up to `size`, which `split` makes a tree of: one whose leaves
/// are single clusters.
pub(super) fn build<S: Scalar>(
    references: &mut Vec<PrimRef<S>>,
    scene: &Aabb<S>,
    size: usize,
    rules: &Rules<'_, S>,
    progress: &Progress<'_>,
    buffers: &mut Buffers<S>,
    split: &dyn Fn(&mut Vec<PrimRef<S>>) -> Subtree<S>,
) -> Subtree<S> {
    // Of a cluster that is cut, no more than the layout can divide; of one with a tree, no more than lie in one task.
    let is_cut = rules.max_leaf_ranges > 1;
    let size =
        if is_cut { size.min(rules.max_leaf_size * rules.max_leaf_ranges) } else { size.min(TASK_SIZE) };
    let (references, numbers) = with_numbers(references, 2);
    let (keys, spare) = numbers.split_at_mut(references.len());
    codes(references, scene, keys);
    let curve = Curve::new(keys, spare, MAX_DEPTH);
    let (_, tasks) = curve.divide::<S>();
    let order = Order { references, curve: &curve, max_leaf_size: rules.max_leaf_size };
    let scale = scene.area_scale();
    let share = scene.scaled_half_area(scale).to_f64() / references.len() as f64;
    let finder = Finder { size, scale, share };
    let cutter = is_cut.then(|| Cutter::new(rules.max_leaf_ranges, rules.block_size, scale));
    let tasks = parallel::map(tasks, |task: Range<usize>| {
        if progress.poll() == BuildControl::Stop {
            return Built::with_capacity(0, 0);
        }
        let keys = &curve.keys[task];
        let sorted = order.sorted(keys);
        let found = finder.find(keys, &sorted);
        match &cutter {
            Some(cutter) => cut(cutter, &sorted, &found),
            None => grow(&order, keys, &found),
        }
    });
    let clusters = tasks.iter().flat_map(|Built { subtree, clusters }| {
        clusters.iter().map(|(begin, end, root)| {
            let piece = Piece {
                nodes: &subtree.nodes[begin.nodes..end.nodes],
                root: root.child,
                indices: &subtree.indices[begin.indices..end.indices],
                leaf_ranges: &subtree.leaf_ranges[begin.leaf_ranges..end.leaf_ranges],
            };
            (piece, root.aabb)
        })
    });
    let (subtrees, boxes): (Vec<_>, Vec<_>) = clusters.unzip();
    if boxes.is_empty() {
        // It was stopped.
        return Subtree::with_capacity(0, 0);
    }
    let mut clusters: Vec<_> = (0..).zip(boxes).map(|(number, aabb)| PrimRef::new(aabb, number)).collect();
    let Subtree { mut nodes, root, indices, .. } = split(&mut clusters);
    if progress.poll() == BuildControl::Stop {
        // Some of its leaves may be empty.
        return Subtree::with_capacity(0, 0);
    }
    let moved = |child: Child| match indices.get(child.slots()) {
        Some(&[cluster]) if child.is_leaf() => task_child(cluster as usize),
        _ => child,
    };
    for node in &mut nodes {
        node.children = node.children.map(moved);
    }
    let top = Subtree { nodes, root: moved(root), ..Subtree::with_capacity(0, 0) };
    join(top, &subtrees, buffers)
}

/// Finds clusters among neighbours.
struct Finder<S> {
    /// The most primitives in one.
    size: usize,
    /// As for [`Aabb::scaled_half_area`].
    scale: S,
    /// A primitive's of the scene's area, if all had the same.
    share: f64,
}

impl<S: Scalar> Finder<S> {
    /// The clusters of sorted keys and their references, in order, and their boxes.
    fn find(&self, keys: &[u64], sorted: &[PrimRef<S>]) -> Vec<(Range<usize>, Aabb<S>)> {
        let all = 0..keys.len();
        let (mut found, mut open) = (Vec::new(), vec![all]);
        while let Some(range) = open.pop() {
            match self.cluster(&sorted[range.clone()]) {
                Some(aabb) => found.push((range, aabb)),
                None => {
                    let border = range.start + border(&keys[range.clone()]);
                    open.extend([border..range.end, range.start..border]);
                }
            }
        }
        found
    }

    /// The box of a row, if it is to be a cluster.
    fn cluster(&self, row: &[PrimRef<S>]) -> Option<Aabb<S>> {
        if row.len() > self.size {
            return None;
        }
        let area = |aabb: &Aabb<S>| aabb.scaled_half_area(self.scale).to_f64();
        let (count, aabb) = (row.len() as f64, bounds(row));
        if count < 2.0 || area(&aabb) <= LARGEST * self.share * count {
            return Some(aabb);
        }
        let areas = row.iter().map(|reference| area(&reference.aabb));
        let (sum, squares) =
            areas.fold((0.0, 0.0), |(sum, squares), area| (sum + area, squares + area * area));
        (sum * sum >= EVEN * count * squares).then_some(aabb)
    }
}

/// The clusters of a task, one after another, with their first and last places and their roots, whose numbers are counted from the
/// first.
struct Built<S> {
    subtree: Subtree<S>,
    clusters: Vec<(Place, Place, Root<S>)>,
}

/// Among nodes, indices and runs.
struct Place {
    nodes: usize,
    indices: usize,
    leaf_ranges: usize,
}

impl<S: Scalar> Built<S> {
    fn with_capacity(nodes: usize, indices: usize) -> Self {
        Self { subtree: Subtree::with_capacity(nodes, indices), clusters: Vec::new() }
    }

    fn end(&self) -> Place {
        let Subtree { nodes, indices, leaf_ranges, .. } = &self.subtree;
        Place { nodes: nodes.len(), indices: indices.len(), leaf_ranges: leaf_ranges.len() }
    }
}

/// A row of leaves of each cluster.
fn cut<S: Scalar>(cutter: &Cutter<S>, sorted: &[PrimRef<S>], found: &[(Range<usize>, Aabb<S>)]) -> Built<S> {
    let mut built = Built::with_capacity(0, sorted.len());
    let mut last = [Vec::new(), Vec::new()];
    for pair in found.chunks(2) {
        // What fits a leaf is one.
        let rows = [pair.first(), pair.get(1)].map(|row| match row {
            Some((range, aabb)) if range.len() > LEAF_WIDTH => (&sorted[range.clone()], aabb),
            _ => (&[][..], &pair[0].1),
        });
        cutter.cut(rows, &mut last);
        for ((range, aabb), last) in pair.iter().zip(&last) {
            let (begin, row) = (built.end(), &sorted[range.clone()]);
            Cutter::append(row, last, &mut built.subtree.leaf_ranges);
            built.subtree.indices.extend(row.iter().map(|reference| reference.index));
            let root = Root { child: Child::leaf(0..row.len()), aabb: *aabb, height: 0 };
            built.clusters.push((begin, built.end(), root));
        }
    }
    built
}

/// A tree over each cluster.
fn grow<S: Scalar>(order: &Order<'_, S>, keys: &[u64], found: &[(Range<usize>, Aabb<S>)]) -> Built<S> {
    let mut built = Built::with_capacity(keys.len() / 4, keys.len());
    let mut parts = Vec::with_capacity(MAX_DEPTH + 1);
    for (range, _) in found {
        let (begin, keys) = (built.end(), &keys[range.clone()]);
        let mut root = order.build(keys, &mut built.subtree, &mut parts);
        if root.height > DEPTH {
            built.subtree.nodes.truncate(begin.nodes);
            built.subtree.indices.truncate(begin.indices);
            root = order.build(&order.curve.in_a_row(keys), &mut built.subtree, &mut parts);
        }
        built.clusters.push((begin, built.end(), root));
    }
    built
}
