//! Builds of clusters: splits above, the Morton curve below.
//!
//! ```text
//! references -> sorted along the curve -> clusters: neighbours of similar areas, up to `size`
//!    each: partitioned into a row of leaves,
//!          or, if the layout cannot divide leaves, a tree of its own, in one pass
//! clusters -> split by the heuristic -> joined
//! ```
//!
//! Most of the time of a build goes into its many small nodes, and most of the quality of a
//! tree into its few large ones. So the curve settles the small nodes, and the heuristic
//! settles the large ones.
//!
//! The boxes of large primitives among small ones would hide the small ones from the heuristic. So
//! the primitives of a cluster have similar areas, unless the cluster itself is small.
//!
//! Refused (clusters of 128 take 1.17 times the ray steps of `Quality::Balanced`; measured:
//! docs/decisions.md, 14):
//! - a bound on the box of a cluster alone: each primitive of a volume became a cluster of its own;
//! - clusters of 4 or 8: no quicker to build than no clusters, since each node takes its time, and
//!   there are as many nodes;
//! - rows partitioned along the whole curve, and splits of their leaves, 6 primitives each, down to
//!   sets of 16, the content of a node: hardly fewer steps, for more time;
//! - the same down to single leaves, with reinsertion, and large primitives apart: more steps than
//!   `Quality::Balanced`, for most of its time;
//! - splits of clusters of 4 to 32 above sets of 1,024, and of primitives below: steps that depend
//!   on luck, and no quicker than `Quality::Balanced`;
//! - Hilbert's curve: as good as Morton's;
//! - codes with bits of size among those of position (Vinkler, Bittner and Havran, Extended Morton
//!   Codes, HPG 2017): no better in six ways of mixing them.

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

/// Maximum area of a small cluster's box, in units of its primitives' shares.
///
/// A primitive's share is the scene's area divided by the number of primitives. A small cluster may
/// hold primitives of any areas.
const LARGEST: f64 = 16.0;

/// Least evenness of the areas in a cluster that is not small.
///
/// The evenness is (sum of areas)^2 / (n * sum of squared areas): 1 if all areas are equal, 1/n
/// if one dominates.
const EVEN: f64 = 0.5;

/// Maximum depth of a cluster's subtree.
///
/// The splits have the rest of [`MAX_DEPTH`].
const DEPTH: usize = 16;

/// Maximum depth of the splits above clusters.
pub(super) const SPLIT_DEPTH: usize = MAX_DEPTH - DEPTH;

const _: () = assert!(TASK_SIZE < 1 << DEPTH, "what lies in a task halves to one in fewer steps");

/// Builds the tree over references, in clusters of up to `size`.
///
/// Requires at least one reference. `split` makes a tree of the clusters, whose leaves are
/// single clusters.
pub(super) fn build<S: Scalar>(
    references: &mut Vec<PrimRef<S>>,
    scene: &Aabb<S>,
    size: usize,
    rules: &Rules<'_, S>,
    progress: &Progress<'_>,
    buffers: &mut Buffers<S>,
    split: &dyn Fn(&mut Vec<PrimRef<S>>) -> Subtree<S>,
) -> Subtree<S> {
    // A partitioned cluster has at most as many primitives as the layout can divide; a cluster with
    // a tree of its own fits one task.
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
        // The build was stopped.
        return Subtree::with_capacity(0, 0);
    }
    let mut clusters: Vec<_> = (0..).zip(boxes).map(|(number, aabb)| PrimRef::new(aabb, number)).collect();
    let Subtree { mut nodes, root, indices, .. } = split(&mut clusters);
    if progress.poll() == BuildControl::Stop {
        // The build was stopped: some leaves may be empty.
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

/// The search for clusters among neighbours.
struct Finder<S> {
    /// Maximum number of primitives in a cluster.
    size: usize,
    /// The scale for [`Aabb::scaled_half_area`].
    scale: S,
    /// A primitive's share of the scene's area, if all primitives have the same.
    share: f64,
}

impl<S: Scalar> Finder<S> {
    /// Returns the clusters of sorted keys, in order, and their boxes.
    ///
    /// `sorted` holds the references of the keys.
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

    /// Returns the box of a row of neighbours, if it becomes a cluster.
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

/// The clusters of a task, one after another.
///
/// Each has the place where it begins, the place where it ends, and its root. The root's numbers
/// are counted from the begin.
struct Built<S> {
    subtree: Subtree<S>,
    clusters: Vec<(Place, Place, Root<S>)>,
}

/// A place in the lists of nodes, indices and leaf ranges.
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

/// Partitions each cluster into a row of leaves.
fn cut<S: Scalar>(cutter: &Cutter<S>, sorted: &[PrimRef<S>], found: &[(Range<usize>, Aabb<S>)]) -> Built<S> {
    let mut built = Built::with_capacity(0, sorted.len());
    let mut last = [Vec::new(), Vec::new()];
    for pair in found.chunks(2) {
        // A cluster that fits one leaf has no leaf ranges.
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

/// Builds a tree over each cluster.
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
