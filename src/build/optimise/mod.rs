//! A better tree from any tree: subtrees are taken out and put in where they cost less.
//!
//! ```text
//! tree -> linked tree -> largest nodes -> rounds of (best places, all at once -> moves, best first) -> tree
//! ```

mod linked;
mod search;

use crate::geometry::Scalar;
use crate::memory::Word;
use crate::parallel;
use crate::tree::Tree;
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
/// A node without a better place is left alone in the next round, in the next two the time after, then in three each
/// time: most have none, and looking for one is what takes the time. It is over where four rounds, in which every node was
/// asked, gain less than a thousandth: what there is beyond that is within the luck of ties.
///
/// The default, a hundredth of the nodes in 8 rounds, gets most of what there is: see the README's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimise {
    /// Which part of all nodes may be taken out, from 0 to 1: the largest.
    pub share: f64,
    /// How many rounds there are at the most.
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

/// Which part of the sum of areas the last rounds have to gain for another one. Without such an end the same trees cost 4 to 8 %
/// more of a build with [`Quality::High`](crate::Quality) where there is little to gain (dragon, hairball, spaceship), for areas
/// smaller by less than a thousandth; and a few nodes may go to and fro for ever, since moves of one round are sought without
/// those of the others.
const LEAST_GAIN: f64 = 1e-3;

impl Optimise {
    /// The tree, made better for as long as `goes_on` says so, in memory in which nothing lies.
    pub(crate) fn run<S: Scalar>(
        &self,
        tree: &mut Tree<S>,
        memory: &mut Vec<Word>,
        goes_on: impl Fn() -> bool + Sync,
    ) -> Gain {
        let Some(mut linked) = Linked::new(tree, memory) else { return Gain::default() };
        let before = linked.cost();
        let count = (linked.len() as f64 * self.share.clamp(0.0, 1.0)) as usize;
        let mut candidates = largest(&linked, count);
        let least = LEAST_GAIN * before * linked.area(Linked::<S>::ROOT).to_f64();
        let mut moves = 0;
        let mut last_gains = [f64::INFINITY; Candidate::LONGEST_PAUSE as usize + 1];
        for number in 0..self.rounds {
            let is_over = last_gains.iter().sum::<f64>() <= least;
            if is_over || !goes_on() {
                break;
            }
            let (done, gain) = round(&mut linked, &mut candidates, &goes_on);
            moves += done;
            last_gains[number % last_gains.len()] = gain;
        }
        if moves > 0 {
            linked.write(tree);
        }
        Gain { before, after: linked.cost(), moves }
    }
}

/// Takes candidates out and puts them where they cost least. Tells how many were moved, and what each of them alone gains, summed.
fn round<S: Scalar>(
    linked: &mut Linked<'_, S>,
    candidates: &mut [Candidate],
    goes_on: &(impl Fn() -> bool + Sync),
) -> (usize, f64) {
    let mut found: Vec<Move<S>> = parallel::map(candidates.chunks_mut(64).collect(), |chunk| {
        if !goes_on() {
            return Vec::new();
        }
        let mut open = Vec::new();
        chunk.iter_mut().filter_map(|candidate| candidate.best_move(linked, &mut open)).collect::<Vec<_>>()
    })
    .into_iter()
    .flatten()
    .collect();
    // The best first; of equals, that of the first node.
    found.sort_unstable_by(|a, b| {
        b.gain.partial_cmp(&a.gain).unwrap_or(Ordering::Equal).then(a.node.cmp(&b.node))
    });
    let mut touched = alloc::vec![false; linked.len()];
    let applied = found.iter().filter(|found| linked.apply(found, &mut touched));
    applied.fold((0, 0.0), |(moves, gain), applied| (moves + 1, gain + applied.gain.to_f64()))
}

/// A node that may be taken out.
struct Candidate {
    node: u32,
    /// Rounds that it is left alone for.
    rest: u8,
    /// How many those were at first.
    pause: u8,
}

impl Candidate {
    /// After many failures every fourth round is enough: with it trees are as good, to the luck of a few parts in a thousand, and
    /// on sponza 16 rounds of a tenth of the nodes take 19 ms, not 52; on dragon 7, not 25.
    const LONGEST_PAUSE: u8 = 3;

    fn new(node: u32) -> Self {
        Self { node, rest: 0, pause: 0 }
    }

    fn best_move<S: Scalar>(&mut self, linked: &Linked<'_, S>, open: &mut Vec<(S, u32)>) -> Option<Move<S>> {
        if self.rest > 0 {
            self.rest -= 1;
            return None;
        }
        let found = search::best_move(linked, self.node, open);
        self.pause = if found.is_some() { 0 } else { Self::LONGEST_PAUSE.min(self.pause + 1) };
        self.rest = self.pause;
        found
    }
}

/// The nodes of the largest areas but the root, of equal ones the first, in no order. A child is never larger than its parent.
///
/// From the root down, by the first bits of their areas, and exactly only where the last are to be told apart: by a heap of all
/// that may be next it took two to three times as long (5.3 ms instead of 1.7 of 290, a tenth of a million triangles' nodes).
fn largest<S: Scalar>(linked: &Linked<'_, S>, count: usize) -> Vec<Candidate> {
    if count == 0 {
        return Vec::new();
    }
    // Sign and exponent.
    const BITS: u32 = 9;
    let class = |node: u32| ((linked.area(node).to_f64() as f32).to_bits() >> (u32::BITS - BITS)) as usize;
    let mut largest = Vec::with_capacity(count);
    let mut waiting = alloc::vec![Vec::new(); 1 << BITS];
    waiting[(1 << BITS) - 1].push(Linked::<S>::ROOT);
    for now in (0..1 << BITS).rev() {
        let others = largest.len();
        while let Some(node) = waiting[now].pop() {
            if node != Linked::<S>::ROOT {
                largest.push(node);
            }
            for child in linked.children(node).into_iter().flatten() {
                waiting[class(child).min(now)].push(child);
            }
        }
        if largest.len() > count {
            let key = |&node: &u32| (Reverse(linked.area(node).to_ordered_bits()), node);
            largest[others..].select_nth_unstable_by_key(count - others, key);
            largest.truncate(count);
            break;
        }
    }
    largest.into_iter().map(Candidate::new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, Sphere};

    #[test]
    fn the_largest_are_taken_and_of_equal_ones_the_first() {
        // Of some sizes, many alike.
        let spheres =
            (0..200u8).map(|i| Sphere::new([f32::from(i), f32::from(i % 7), 0.0], f32::from(i % 3)));
        let builder = Bvh::builder().optimise(Optimise::NONE).max_leaf_size(1).layout::<Tree>();
        let (bvh, mut memory) = (builder.build(spheres).unwrap(), Vec::new());
        let linked = Linked::new(bvh.layout(), &mut memory).unwrap();
        let mut all: Vec<u32> = (1..linked.len() as u32).collect();
        all.sort_by(|&a, &b| linked.area(b).total_cmp(&linked.area(a)).then(a.cmp(&b)));
        for count in 0..=all.len() + 1 {
            let mut found: Vec<u32> =
                largest(&linked, count).iter().map(|candidate| candidate.node).collect();
            let mut expected = all[..count.min(all.len())].to_vec();
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected, "{count}");
        }
    }

    #[test]
    fn rounds_that_gain_next_to_nothing_are_the_last() {
        // On a grid, where many places cost the same and a little less for a rounding.
        let spheres = (0..4000_u16).map(|i| {
            let [x, y, z] = [i % 16, i / 16 % 16, i / 256].map(|place| 0.1 * f32::from(place));
            Sphere::new([x, y, z], 0.01 * f32::from(i % 7))
        });
        let builder = Bvh::builder().optimise(Optimise::NONE).max_leaf_size(1).layout::<Tree>();
        let mut tree = builder.heuristic(crate::heuristic::Median).build(spheres).unwrap().layout().clone();
        let asked = core::sync::atomic::AtomicUsize::new(0);
        let goes_on = || asked.fetch_add(1, core::sync::atomic::Ordering::Relaxed) < 1_000_000;
        let optimise = Optimise { share: 1.0, rounds: usize::MAX };
        let gain = optimise.run(&mut tree, &mut Vec::new(), goes_on);
        assert!(gain.moves > 0 && asked.into_inner() < 100_000);
    }

    #[test]
    fn a_node_in_its_best_place_is_asked_ever_more_rarely() {
        let spheres = (0..8u8).map(|i| Sphere::new([f32::from(i), 0.0, 0.0], 0.1));
        let builder = Bvh::builder().optimise(Optimise::NONE).max_leaf_size(1).layout::<Tree>();
        let (bvh, mut memory) = (builder.build(spheres).unwrap(), Vec::new());
        let linked = Linked::new(bvh.layout(), &mut memory).unwrap();
        let mut candidates = largest(&linked, linked.len());
        assert_eq!(candidates.len(), linked.len() - 1, "all but the root");
        let mut asked = Vec::new();
        for number in 0..16 {
            if candidates.iter().all(|candidate| candidate.rest == 0) {
                asked.push(number);
            }
            assert!(candidates.iter_mut().all(|c| c.best_move(&linked, &mut Vec::new()).is_none()));
        }
        assert_eq!(asked, [0, 2, 5, 9, 13]);
    }
}
