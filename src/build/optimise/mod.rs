//! A better tree from any tree: subtrees are taken out and put in where they cost less.
//!
//! ```text
//! tree -> linked tree -> rounds of (largest nodes -> best places, all at once -> moves, best first) -> tree
//! ```

mod linked;
mod search;

use crate::geometry::Scalar;
use crate::parallel;
use crate::tree::Tree;
use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::cmp::{Ordering, Reverse};
use linked::Linked;
use search::Move;

/// Reinsertion: the largest nodes are taken out of the tree, each with all below it, and put in again where the sum of
/// the inner nodes' surface areas becomes least (Bittner, Hapala and Havran, Fast Insertion-Based Optimization of
/// Bounding Volume Hierarchies, 2013; all places of a round sought at once as by Meister and Bittner, Parallel Reinsertion
/// for Bounding Volume Hierarchy Optimization, 2018).
///
/// Takes a tree of any heuristic: a part of [`Builder::optimise`](crate::Builder::optimise), or a step of its own,
/// [`Tree::optimise`](crate::Tree::optimise). The result is the same on any number of threads, and no deeper than
/// [`MAX_DEPTH`](crate::MAX_DEPTH).
///
/// The default, a hundredth of the nodes in each of 8 rounds, gets most of what there is: see the README's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimise {
    /// Which part of all nodes is taken out in each round, from 0 to 1; the largest.
    pub share: f64,
    /// How many rounds there are at the most; they end where nothing is gained any more.
    pub rounds: usize,
}

impl Optimise {
    /// Nothing at all: the tree as it was built.
    pub const NONE: Self = Self { share: 0.0, rounds: 0 };
}

impl Default for Optimise {
    fn default() -> Self {
        Self { share: 0.01, rounds: 8 }
    }
}

/// What an optimisation has done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gain {
    /// The sum of the inner nodes' surface areas before it, in units of the root's.
    pub before: f64,
    /// The same after it.
    pub after: f64,
    /// How many subtrees were moved.
    pub moves: usize,
}

impl Optimise {
    /// The tree, made better for as long as `goes_on` says so.
    pub(crate) fn run<S: Scalar>(&self, tree: &mut Tree<S>, goes_on: impl Fn() -> bool + Sync) -> Gain {
        let Some(mut linked) = Linked::new(tree) else { return Gain::default() };
        let before = linked.cost();
        let count = (linked.len() as f64 * self.share.clamp(0.0, 1.0)) as usize;
        let mut moves = 0;
        for _ in 0..self.rounds {
            let done = round(&mut linked, count, &goes_on);
            moves += done;
            if done == 0 {
                break;
            }
        }
        if moves > 0 {
            linked.write(tree);
        }
        Gain { before, after: linked.cost(), moves }
    }
}

/// Takes out the `count` largest nodes and puts them where they cost least. Tells how many were moved.
fn round<S: Scalar>(linked: &mut Linked<S>, count: usize, goes_on: &(impl Fn() -> bool + Sync)) -> usize {
    let candidates = largest(linked, count);
    let chunks = candidates.chunks(64).collect();
    let mut found: Vec<Move<S>> = parallel::map(chunks, |chunk: &[u32]| {
        if !goes_on() {
            return Vec::new();
        }
        let mut open = Vec::new();
        chunk.iter().filter_map(|&node| search::best_move(linked, node, &mut open)).collect::<Vec<_>>()
    })
    .into_iter()
    .flatten()
    .collect();
    // The best first; of equals, that of the first node.
    found.sort_unstable_by(|a, b| {
        b.gain.partial_cmp(&a.gain).unwrap_or(Ordering::Equal).then(a.node.cmp(&b.node))
    });
    let mut touched = alloc::vec![false; linked.len()];
    found.iter().filter(|found| linked.apply(found, &mut touched)).count()
}

/// A node with its area, ordered by it.
struct Sized<S>(S, u32);

impl<S: Scalar> Ord for Sized<S> {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |sized: &Self| (sized.0.to_ordered_bits(), Reverse(sized.1));
        key(self).cmp(&key(other))
    }
}

impl<S: Scalar> PartialOrd for Sized<S> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<S: Scalar> PartialEq for Sized<S> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<S: Scalar> Eq for Sized<S> {}

/// The nodes of the largest areas, from the root down: a child is never larger than its parent.
fn largest<S: Scalar>(linked: &Linked<S>, count: usize) -> Vec<u32> {
    let mut largest = Vec::with_capacity(count);
    let mut open = BinaryHeap::new();
    let show = |node: u32, open: &mut BinaryHeap<_>| {
        for child in linked.children(node).into_iter().flatten() {
            open.push(Sized(linked.area(child), child));
        }
    };
    show(Linked::<S>::ROOT, &mut open);
    while let Some(Sized(_, node)) = open.pop() {
        if largest.len() == count {
            break;
        }
        largest.push(node);
        show(node, &mut open);
    }
    largest
}
