//! Reinsertion: subtrees of a tree move to places where they cost less.
//!
//! ```text
//! tree -> linked tree -> largest nodes -> rounds -> tree
//!                                         each: the best places, all at once
//!                                               -> the moves, best first
//! ```

mod parent_links;
mod search;

use crate::geometry::Scalar;
use crate::memory::Word;
use crate::parallel;
use crate::tree::Tree;
use alloc::vec::Vec;
use core::cmp::{Ordering, Reverse};
use parent_links::Linked;
use search::Move;

/// Reinsertion of the largest nodes of a tree, to lower its cost.
///
/// A node is taken out of the tree with its subtree, and inserted again where the sum of the inner
/// nodes' surface areas becomes least (Bittner, Hapala and Havran, Fast Insertion-Based
/// Optimization of Bounding Volume Hierarchies, 2013). All places of a round are sought at once
/// (Meister and Bittner, Parallel Reinsertion for Bounding Volume Hierarchy Optimization, 2018).
///
/// Reinsertion takes the tree of any heuristic. It is a part of a build, see
/// [`Builder::optimise`](crate::Builder::optimise), or a step of its own, see
/// [`Tree::optimise`](crate::Tree::optimise). The result is the same on any number of threads, and
/// no deeper than [`MAX_DEPTH`](crate::MAX_DEPTH).
///
/// A node without a better place is left alone in the next round. The second time in a row, it is
/// left alone for two rounds, and after that for three each time. Most nodes have no better place,
/// and the search for one takes most of the time.
///
/// Reinsertion ends if the last four rounds gain less than a thousandth of the initial sum
/// of areas. In four rounds every node is tried at least once. Smaller gains are within
/// the noise of ties.
///
/// The places of one round are sought without regard to the other moves of the round. A move that
/// turns out to gain nothing is undone. So no tree becomes worse, and any number of rounds ends.
///
/// The default, a hundredth of the nodes in 8 rounds, gets most of the gain: see the table
/// in `docs/building.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimise {
    /// The fraction of all nodes that may be taken out, from 0 to 1.
    ///
    /// The nodes with the largest areas are chosen.
    pub share: f64,
    /// Maximum number of rounds.
    pub rounds: usize,
}

impl Optimise {
    /// No reinsertion: the tree as it was built.
    pub const NONE: Self = Self { share: 0.0, rounds: 0 };
}

impl Default for Optimise {
    fn default() -> Self {
        Self { share: 0.01, rounds: 8 }
    }
}

/// The result of a reinsertion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OptimiseStats {
    /// The sum of the inner nodes' surface areas before the reinsertion.
    ///
    /// In units of the root's surface area.
    pub before: f64,
    /// The same sum after the reinsertion.
    pub after: f64,
    /// The number of subtrees that were moved.
    pub moves: usize,
}

/// Least gain of the last rounds for another round.
///
/// In units of the initial sum of areas. Without this end, a build with
/// [`Quality::High`](crate::Quality) takes 4 to 8 % longer where there is little to gain (measured:
/// docs/decisions.md, 10).
const LEAST_GAIN: f64 = 1e-3;

impl Optimise {
    /// Improves the tree by reinsertion, as long as `goes_on` returns true.
    ///
    /// `memory` is scratch memory; its old content is lost.
    pub(crate) fn run<S: Scalar>(
        &self,
        tree: &mut Tree<S>,
        memory: &mut Vec<Word>,
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> OptimiseStats {
        let Some(mut linked) = Linked::new(tree, memory) else { return OptimiseStats::default() };
        let before = linked.cost();
        let count = (linked.len() as f64 * self.share.clamp(0.0, 1.0)) as usize;
        let mut candidates = largest(&linked, count);
        let least = LEAST_GAIN * before * linked.area(Linked::<S>::ROOT).to_f64();
        let mut moves = 0;
        let mut last_gains = [f64::INFINITY; Candidate::LONGEST_PAUSE as usize + 1];
        for number in 0..self.rounds {
            // With infinite areas, no gain can be computed.
            let may_gain = last_gains.iter().sum::<f64>() > least;
            if !may_gain || !goes_on() {
                break;
            }
            let (done, gain) = round(&mut linked, &mut candidates, goes_on);
            moves += done;
            last_gains[number % last_gains.len()] = gain;
        }
        if moves > 0 {
            linked.write(tree);
        }
        OptimiseStats { before, after: linked.cost(), moves }
    }
}

/// Moves candidates to the places where they cost least.
///
/// Returns the number of moves, and the decrease of the sum of areas.
fn round<S: Scalar>(
    linked: &mut Linked<'_, S>,
    candidates: &mut [Candidate],
    goes_on: &(dyn Fn() -> bool + Sync),
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
    // The largest gain comes first; of equal gains, that of the first node.
    found.sort_unstable_by(|a, b| {
        b.gain.partial_cmp(&a.gain).unwrap_or(Ordering::Equal).then(a.node.cmp(&b.node))
    });
    let mut touched = alloc::vec![false; linked.len()];
    let gains = found.iter().filter_map(|found| linked.improve(found, &mut touched));
    gains.fold((0, 0.0), |(moves, sum), gain| (moves + 1, sum + gain))
}

/// A node that may be taken out.
struct Candidate {
    node: u32,
    /// The remaining rounds in which the node is left alone.
    rest: u8,
    /// The length of its last pause, in rounds.
    pause: u8,
}

impl Candidate {
    /// Maximum pause: after many failures, every fourth round is enough.
    ///
    /// The trees are as good, up to noise, and a run takes less than half of the time (measured:
    /// docs/decisions.md, 11).
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

/// Returns the nodes with the largest areas, except the root, in no order.
///
/// Of equal areas, the first nodes are chosen. A child is never larger than its parent, so the
/// search goes from the root down. The first bits of the areas order the nodes; exact areas are
/// compared only to choose the last nodes. Refused: a heap of all nodes that may be next, which
/// took two to three times as long (measured: docs/decisions.md, 12).
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

impl<S: Scalar> Tree<S> {
    /// Improves the tree by reinsertion; queries keep their answers.
    ///
    /// ```
    /// use bvhkit::heuristic::Median;
    /// use bvhkit::{Bvh, Optimise, Sphere, Tree};
    ///
    /// let spheres =
    ///     (0..1000).map(|i| Sphere::new([(i * i % 97) as f32, (i % 31) as f32, 0.0], 1.0));
    /// let mut bvh = Bvh::builder().heuristic(Median).layout::<Tree>().build(spheres)?;
    /// let gain = bvh.optimise(&Optimise { share: 0.1, rounds: 4 });
    /// assert!(gain.moves > 0 && gain.after < gain.before);
    /// # Ok::<(), bvhkit::BuildError>(())
    /// ```
    pub fn optimise(&mut self, optimise: &Optimise) -> OptimiseStats {
        S::optimise(self, optimise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristic::BinnedSah;
    use crate::{Bvh, Sphere};
    use core::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    #[test]
    fn the_largest_are_taken_and_of_equal_ones_the_first() {
        // A few sizes, and many equal ones.
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

    /// Optimises with all nodes as candidates and no limit of rounds.
    ///
    /// Returns the result, and the number of calls to `goes_on`.
    fn without_bound(spheres: &[Sphere]) -> (OptimiseStats, usize) {
        let builder = Bvh::builder().heuristic(BinnedSah::default()).max_leaf_size(1).layout::<Tree>();
        let mut tree = builder.build(spheres).unwrap().layout().clone();
        let asked = AtomicUsize::new(0);
        let goes_on = || asked.fetch_add(1, Relaxed) < 1_000_000;
        let gain = Optimise { share: 1.0, rounds: usize::MAX }.run(&mut tree, &mut Vec::new(), &goes_on);
        assert!(gain.after <= gain.before, "{gain:?}");
        (gain, asked.into_inner())
    }

    #[test]
    fn rounds_without_bound_end() {
        // Two of these spheres promise a gain by trading places, again and again.
        let traders = [
            ([6.0, 4.0, 8.0], 0.25),
            ([4.0, 5.0, 7.0], 3.0),
            ([14.0, 13.0, 5.0], 1.75),
            ([8.0, 9.0, 10.0], 0.25),
            ([9.0, 6.0, 7.0], 2.75),
            ([4.0, 11.0, 11.0], 0.25),
            ([5.0, 2.0, 5.0], 3.0),
            ([11.0, 15.0, 11.0], 2.0),
        ]
        .map(|(center, radius)| Sphere::new(center, radius));
        let (_, asked) = without_bound(&traders);
        assert!(asked < 100, "{asked}");
        // Areas that overflow.
        let huge = [-1.0, 0.0, 0.3, 1.0].map(|x: f32| Sphere::new([x * 1.5e38; 3], 1e38));
        let (gain, asked) = without_bound(&huge);
        assert!(gain.moves == 0 && asked < 100, "{gain:?} {asked}");
        // A grid, where many places cost the same up to rounding.
        let grid: Vec<Sphere> = (0..4000_u16)
            .map(|i| {
                let center = [i % 16, i / 16 % 16, i / 256].map(|place| 0.1 * f32::from(place));
                Sphere::new(center, 0.01 * f32::from(i % 7))
            })
            .collect();
        let (gain, asked) = without_bound(&grid);
        assert!(gain.moves > 0 && asked < 100_000, "{gain:?} {asked}");
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
