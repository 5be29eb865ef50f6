//! Partition of neighbours along a curve into a row of small leaves.
//!
//! Dynamic programming finds the least cost of the first k references, in leaves of up to 8:
//!
//! ```text
//! least(0) = 0
//! least(k) = min over n = 1..=8 of
//!            least(k - n) + area(references k - n to k) * blocks(n) + PRICE * area(all)
//! ```
//!
//! A wide node above such leaves is nearly as good as the collapse of the curve's binary tree
//! over the same neighbours: rays take 3 % more steps, in the mean over six scenes. There is no
//! such tree to build, to plan or to arrange, so the build is quicker (measured:
//! docs/decisions.md, 15).

use super::reference::{PrimRef, bounds};
use crate::geometry::{Aabb, Scalar, min};
use crate::leaf::LEAF_WIDTH;
use crate::simd::{Backend, Halves, Kernel, Lanes};
use crate::simd::{Isa, KernelLanes};
use crate::tree::{Child, LeafRange};
use alloc::vec::Vec;

/// Cost of a leaf beside its visits, for its memory.
///
/// In units of the cost of a visit with the box of the whole row.
const PRICE: f64 = 0.06;

/// Partitions rows of references into leaves.
pub(super) struct Cutter<S> {
    /// The scale for [`Aabb::scaled_half_area`].
    scale: S,
    /// Maximum number of leaves in a row.
    max_leaf_ranges: usize,
    /// The cost of a visit to a leaf, by its last and first places modulo 8.
    costs: [[S; LEAF_WIDTH]; LEAF_WIDTH],
}

impl<S: Scalar> Cutter<S> {
    /// Makes a cutter for rows of at most `max_leaf_ranges` leaves.
    ///
    /// A leaf tests `block_size` references at once.
    pub fn new(max_leaf_ranges: usize, block_size: usize, scale: S) -> Self {
        let cost = |count: usize| S::from_count(count.div_ceil(block_size) as i32);
        let costs = core::array::from_fn(|end| core::array::from_fn(|start| cost(count(start, end))));
        Self { scale, max_leaf_ranges, costs }
    }

    /// Partitions two rows into leaves at the least cost.
    ///
    /// For each prefix of a row, `last` is the size of the last leaf in the prefix's cheapest
    /// partition. A row has at most as many references as `max_leaf_ranges` leaves have room for,
    /// and all are in the row's box.
    pub fn cut(&self, rows: [(&[PrimRef<S>], &Aabb<S>); 2], last: &mut [Vec<u8>; 2]) {
        debug_assert!(rows.iter().all(|(row, _)| row.len() <= self.max_leaf_ranges * LEAF_WIDTH));
        // Above zero, so that few leaves are cheaper than many even where all
        // references are points.
        let price = |aabb: &Aabb<S>| {
            PRICE * aabb.scaled_half_area(self.scale).to_f64() + f64::from(f32::MIN_POSITIVE)
        };
        let prices = rows.map(|(_, aabb)| price(aabb));
        let run = |rows, prices: [f64; 2], last: &mut _| {
            Backend::best().run(Cut { cutter: self, rows, prices: prices.map(S::from_f64), last });
        };
        run(rows.map(|(row, _)| row), prices, last);
        for ((row, _), (mut price, last)) in rows.into_iter().zip(prices.into_iter().zip(last)) {
            while ends(last).count() > self.max_leaf_ranges {
                // A higher price makes fewer leaves. Where areas overflow, no price is high enough:
                // the leaves are full then.
                price *= 4.0;
                if S::from_f64(price) >= S::MAX {
                    last.clear();
                    last.extend((0..row.len()).map(|place| count(0, place % LEAF_WIDTH) as u8));
                    break;
                }
                let mut anew = [core::mem::take(last), Vec::new()];
                run([row, &[]], [price; 2], &mut anew);
                [*last, _] = anew;
            }
        }
    }

    /// Appends the leaves of a row that was partitioned.
    ///
    /// Their slots are counted from the start of the row.
    pub fn append(row: &[PrimRef<S>], last: &[u8], leaf_ranges: &mut Vec<LeafRange<S>>) {
        let start = leaf_ranges.len();
        for end in ends(last) {
            let slots = end - usize::from(last[end - 1])..end;
            leaf_ranges.push(LeafRange { aabb: bounds(&row[slots.clone()]), leaf: Child::leaf(slots) });
        }
        leaf_ranges[start..].reverse();
    }
}

/// Returns the ends of the leaves, the last one first.
fn ends(last: &[u8]) -> impl Iterator<Item = usize> {
    let before = |&end: &usize| end.checked_sub(usize::from(last[end - 1])).filter(|&end| end > 0);
    core::iter::successors(Some(last.len()).filter(|&end| end > 0), before)
}

/// Returns the size of a leaf, from its first and last places modulo 8.
fn count(first: usize, last: usize) -> usize {
    (last + LEAF_WIDTH - first) % LEAF_WIDTH + 1
}

/// A kernel that partitions two rows at a time.
///
/// Each place of a row waits for the place before, and a second row fills the wait: a quick build
/// of sponza takes 16.7 ms instead of 17.1 ms.
struct Cut<'r, S> {
    cutter: &'r Cutter<S>,
    rows: [&'r [PrimRef<S>]; 2],
    prices: [S; 2],
    last: &'r mut [Vec<u8>; 2],
}

/// The candidates for the leaf that ends at a place of a row.
///
/// A candidate's lane is the place where it begins, modulo 8. `mins` and `maxs` are its box.
struct Ends<S: Scalar, I: Isa> {
    mins: [S::Times8<I>; 3],
    maxs: [S::Times8<I>; 3],
    /// The least cost of all references before the leaf.
    before: S::Times8<I>,
    /// The least cost of all references so far.
    least: S,
}

impl<S: Scalar> Kernel for Cut<'_, S> {
    const IS_WIDE: bool = true;
    const USES_AVX512: bool = false;
    type Output = ();

    /// Each of the last eight places where a leaf may begin has a lane, in rotation.
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let splat = |value: S| S::Times8::<I>::splat(isa, value);
        let load = |row: &[S; LEAF_WIDTH]| S::Times8::<I>::from_slice(isa, row);
        let numbers: [S; LEAF_WIDTH] = core::array::from_fn(|lane| S::from_count(lane as i32));
        let lanes = load(&numbers);
        let only = |lane: usize| lanes.le(splat(numbers[lane])) & splat(numbers[lane]).le(lanes);
        let turns: [_; LEAF_WIDTH] = core::array::from_fn(only);
        let scale = splat(self.cutter.scale);

        let none = || Ends::<S, I> {
            mins: [splat(S::INFINITY); 3],
            maxs: [splat(S::NEG_INFINITY); 3],
            before: splat(S::INFINITY),
            least: S::ZERO,
        };
        let mut ends = [none(), none()];
        self.last.iter_mut().for_each(Vec::clear);
        let [first, second] = self.rows;
        for place in 0..first.len().max(second.len()) {
            let end = place % LEAF_WIDTH;
            let begins = turns[end];
            let blocks = load(&self.cutter.costs[end]);
            for ((row, ends), (&price, last)) in
                self.rows.iter().zip(&mut ends).zip(self.prices.iter().zip(&mut *self.last))
            {
                let Some(reference) = row.get(place) else { continue };
                for axis in 0..3 {
                    let (low, high) = (splat(reference.aabb.min[axis]), splat(reference.aabb.max[axis]));
                    ends.mins[axis] = low.select(begins, low.min(ends.mins[axis]));
                    ends.maxs[axis] = high.select(begins, high.max(ends.maxs[axis]));
                }
                ends.before = splat(ends.least).select(begins, ends.before);
                let x = (ends.maxs[0] - ends.mins[0]) * scale;
                let y = (ends.maxs[1] - ends.mins[1]) * scale;
                let z = (ends.maxs[2] - ends.mins[2]) * scale;
                let costs = ends.before + (x * y + y * z + z * x) * blocks;
                let [low, high] = costs.to_halves();
                let four = low.min(high);
                let lowest = min(min(four.lane(0), four.lane(1)), min(four.lane(2), four.lane(3)));
                let lane = S::Times8::<I>::bits(costs.le(splat(lowest))).trailing_zeros() as usize;
                // At most all references so far, even where areas overflow.
                last.push(count(lane % LEAF_WIDTH, end).min(place + 1) as u8);
                ends.least = lowest + price;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn at(x: f32) -> PrimRef {
        PrimRef::new(Aabb::new([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]), 0)
    }

    fn lengths(row: &[PrimRef], leaves: usize, block_size: usize) -> Vec<usize> {
        let aabb = bounds(row);
        let mut leaf_ranges = Vec::new();
        // Beside another row, and alone.
        let mut last = [Vec::new(), Vec::new()];
        let cutter = Cutter::new(leaves, block_size, aabb.area_scale());
        cutter.cut([(&row[..row.len() / 2], &aabb), (row, &aabb)], &mut last);
        let beside = last[1].clone();
        cutter.cut([(row, &aabb), (&[], &aabb)], &mut last);
        assert!(last[0] == beside && last[1].is_empty());
        Cutter::append(row, &beside, &mut leaf_ranges);
        let mut next = 0;
        for run in &leaf_ranges {
            assert_eq!(run.leaf.slots().start, next);
            next = run.leaf.slots().end;
            assert_eq!(run.aabb, bounds(&row[run.leaf.slots()]));
        }
        assert_eq!(next, row.len());
        leaf_ranges.iter().map(|run| run.leaf.slots().len()).collect()
    }

    #[test]
    fn rows_are_cut_where_there_are_gaps() {
        let row: Vec<_> = [0.0, 1.0, 2.0, 40.0, 41.0, 80.0, 81.0, 82.0, 83.0, 84.0].map(at).into();
        assert_eq!(lengths(&row, 16, 8), [3, 2, 5]);
        assert_eq!(lengths(&row[..1], 16, 8), [1]);
    }

    /// Compares the cost with that of every possible partition.
    #[test]
    fn no_other_cut_is_cheaper() {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let mut random = || rng.random::<f32>();
        for block_size in [1, 8] {
            for _ in 0..50 {
                let row: Vec<_> = (0..10)
                    .map(|_| {
                        let min = [random(), random(), random()];
                        PrimRef::new(Aabb::new(min, min.map(|x| x + random() * random())), 0)
                    })
                    .collect();
                let aabb = bounds(&row);
                let scale = aabb.area_scale();
                let price = PRICE * f64::from(aabb.scaled_half_area(scale));
                let cost = |lengths: &[usize]| {
                    let mut start = 0;
                    lengths.iter().fold(0.0, |sum, &length| {
                        let leaf = &row[start..start + length];
                        start += length;
                        let blocks = length.div_ceil(block_size) as f64;
                        sum + f64::from(bounds(leaf).scaled_half_area(scale)) * blocks + price
                    })
                };
                let found = cost(&lengths(&row, 16, block_size));
                // One bit for each gap between two references.
                for cuts in 0..1u32 << 9 {
                    let mut all = vec![1];
                    for place in 0..9 {
                        if cuts >> place & 1 == 1 {
                            all.push(1);
                        } else if let Some(length) = all.last_mut() {
                            *length += 1;
                        }
                    }
                    if all.iter().all(|&length| length <= LEAF_WIDTH) {
                        assert!(found <= cost(&all) * (1.0 + 1e-5), "{block_size}: {all:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn there_are_no_more_leaves_than_asked_for_whatever_the_boxes() {
        let far: Vec<_> = (0..128).map(|k| at(((k * 37) % 128) as f32 * 100.0)).collect();
        assert_eq!(lengths(&far, 16, 1), [8; 16]);
        let points = vec![PrimRef::new(Aabb::new([3.0; 3], [3.0; 3]), 0); 100];
        assert_eq!(lengths(&points, 16, 8).len(), 13);
        let huge = PrimRef::new(Aabb::new([-f32::MAX; 3], [f32::MAX; 3]), 0);
        assert!(lengths(&vec![huge; 100], 16, 8).len() <= 16);
        // Areas that are NaN, in a row that fills all leaves.
        let point = |y: f32| PrimRef::new(Aabb::new([0.0, y, 0.0], [0.0, y, 0.0]), 0);
        let mut row = vec![huge; 120];
        row.extend((0..8).map(|k| point(if k == 0 { -f32::MAX } else { f32::MAX })));
        assert_eq!(lengths(&row, 16, 8), [8; 16]);
    }
}
