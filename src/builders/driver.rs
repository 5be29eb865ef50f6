//! The order of a build: large nodes level by level, small nodes as tasks.
//!
//! 1. **Top.** All open nodes of a level are split at once, on all threads. A node with at most
//!    [`TASK_SIZE`] references becomes a task. When the build has to hurry or stop, every open
//!    node becomes a task.
//! 2. **Tasks.** Each task builds its subtree into lists of its own, depth first.
//! 3. **Join.** The top and the subtrees are laid out depth first.
//!
//! The place of each result follows from the data alone, never from the threads: the tree is the
//! same on any number of threads. Nothing recurses: neither stack depth nor build time depends on a
//! well-behaved heuristic.

use super::buffers::Buffers;
use super::clusters::{self, SPLIT_DEPTH};
use super::heuristic::new_codes;
use super::lbvh;
use super::partition::{Rules, Set};
use super::progress::{BuildControl, Progress};
use super::reference::{PrimRef, bounds};
use super::subtree::{Parent, Subtree, TASK_SIZE, join, task_child};
use crate::geometry::{Aabb, Scalar};
use crate::parallel;
use crate::simd::prefetch_ahead;
use crate::tree::Tree;
use alloc::vec;
use alloc::vec::Vec;
use core::mem::take;

/// A set of references that becomes a subtree, and the parent of the subtree.
struct OpenNode<'r, S> {
    set: Set<'r, S>,
    parent: Parent,
}

/// Appends the inner node above two sets, and returns the sets as open nodes.
fn push<'r, S: Scalar>(
    subtree: &mut Subtree<S>,
    parent: Parent,
    sides: [Set<'r, S>; 2],
) -> [OpenNode<'r, S>; 2] {
    let index = subtree.push(parent, [sides[0].aabb, sides[1].aabb]);
    let [left, right] = sides;
    [OpenNode { set: left, parent: Some((index, 0)) }, OpenNode { set: right, parent: Some((index, 1)) }]
}

/// The data that all nodes of a build share.
struct Build<'h, S: Scalar> {
    rules: &'h Rules<'h, S>,
    progress: &'h Progress<'h>,
    scene: Aabb<S>,
}

/// Builds the tree over the references of `buffers`; `None` if it was stopped.
///
/// The references must be valid.
pub(crate) fn build_tree<S: Scalar>(
    buffers: &mut Buffers<S>,
    rules: &Rules<'_, S>,
    progress: &Progress<'_>,
) -> Option<Tree<S>> {
    let mut references = take(&mut buffers.references);
    let parts = references.chunks(TASK_SIZE).collect();
    let boxes = parallel::map(parts, |part: &[PrimRef<S>]| {
        bounds(part.iter().inspect(|reference| prefetch_ahead(*reference)))
    });
    let aabb = boxes.into_iter().fold(Aabb::EMPTY, Aabb::union);
    let primitives = references.len();
    let whole = build_whole(&mut references, aabb, rules, progress, buffers);
    buffers.references = references;
    if progress.poll() == BuildControl::Stop {
        return None;
    }
    let Subtree { nodes, root, indices, leaf_ranges } = whole;
    Some(Tree { nodes, root, aabb, indices, leaf_ranges, primitives })
}

/// Builds as the heuristic asks: by codes, by splits of clusters, or by splits.
fn build_whole<S: Scalar>(
    references: &mut Vec<PrimRef<S>>,
    aabb: Aabb<S>,
    rules: &Rules<'_, S>,
    progress: &Progress<'_>,
    buffers: &mut Buffers<S>,
) -> Subtree<S> {
    if references.is_empty() {
        return Subtree::with_capacity(0, 0);
    }
    progress.begin(references.len());
    let codes = rules.heuristic.codes(references, &aabb);
    if let Some(codes) = codes.filter(|codes| codes.len() == references.len()) {
        return lbvh::build(references, codes, rules.max_depth, rules.max_leaf_size, progress, buffers);
    }
    let size = rules.heuristic.cluster_size();
    if size < 2 {
        return build_by_splits(references, aabb, rules, progress, buffers);
    }
    let above = Rules { max_leaf_size: 1, block_size: 1, max_depth: SPLIT_DEPTH, ..*rules };
    clusters::build(references, &aabb, size, rules, progress, buffers, &|clusters| {
        progress.begin(clusters.len());
        build_by_splits(clusters, aabb, &above, progress, &mut Buffers::default())
    })
}

/// Builds by splits: the heuristic is asked to split every node.
fn build_by_splits<S: Scalar>(
    references: &mut Vec<PrimRef<S>>,
    aabb: Aabb<S>,
    rules: &Rules<'_, S>,
    progress: &Progress<'_>,
    buffers: &mut Buffers<S>,
) -> Subtree<S> {
    let len = references.len();
    // Slots are numbered with 32 bits.
    let most = len.saturating_add(rules.heuristic.extra_references(len)).min(u32::MAX as usize);
    parallel::extend_to(references, most, PrimRef::new(Aabb::EMPTY, u32::MAX));
    let build = Build { rules, progress, scene: aabb };
    let root = Set { memory: references, len, aabb, depth: 0 };
    let (top, tasks) = build_top(OpenNode { set: root, parent: None }, &build);
    let subtrees = parallel::map(tasks, |task| build_subtree(task, &build));
    join(top, &subtrees.iter().map(Subtree::all).collect::<Vec<_>>(), buffers)
}

/// Splits all large sets, and returns the other sets as tasks.
///
/// A set is large if it has more than [`TASK_SIZE`] references. Once the build is not steady any
/// more, every set that is left becomes a task.
fn build_top<'r, S: Scalar>(root: OpenNode<'r, S>, build: &Build<'_, S>) -> (Subtree<S>, Vec<Set<'r, S>>) {
    let mut top = Subtree::with_capacity(0, 0);
    let mut tasks = Vec::new();
    let mut level = vec![root];
    while !level.is_empty() {
        let divided = parallel::map(level, |OpenNode { set, parent }| {
            let is_task = set.len <= TASK_SIZE || build.progress.poll() != BuildControl::Steady;
            (parent, if is_task { Err(set) } else { set.divide(build.rules, &build.scene) })
        });
        level = Vec::new();
        for (parent, divided) in divided {
            match divided {
                Ok(sides) => level.extend(push(&mut top, parent, sides)),
                // A leaf becomes a task too.
                Err(set) => {
                    top.refer(parent, task_child(tasks.len()));
                    tasks.push(set);
                }
            }
        }
    }
    (top, tasks)
}

/// Builds everything below one set, depth first.
///
/// A left child is the node after its parent.
fn build_subtree<S: Scalar>(root: Set<'_, S>, build: &Build<'_, S>) -> Subtree<S> {
    let Build { rules, progress, scene } = build;
    let len = root.len;
    match progress.poll() {
        BuildControl::Steady => {}
        BuildControl::Hurry => {
            let codes = new_codes(root.references(), scene);
            let depth = rules.max_depth - root.depth;
            let buffers = &mut Buffers::default();
            return lbvh::build(root.references(), codes, depth, rules.max_leaf_size, progress, buffers);
        }
        BuildControl::Stop => return Subtree::with_capacity(0, 0),
    }
    let mut subtree = Subtree::with_capacity(len / 4, len);
    let mut open = vec![OpenNode { set: root, parent: None }];
    while let Some(OpenNode { set, parent }) = open.pop() {
        match set.divide(rules, scene) {
            Ok(sides) => {
                let [left, right] = push(&mut subtree, parent, sides);
                open.push(right);
                open.push(left);
            }
            Err(set) => subtree.push_leaf(parent, set.references().iter().map(|reference| reference.index)),
        }
    }
    progress.place(len);
    subtree
}
