//! Bins that count references, and the cheapest plane between two bins.

use super::Split;
use super::bin_grid::Grid;
use super::proposal::{Proposal, Sides};
use crate::builders::reference::{PrimRef, three};
use crate::geometry::{Aabb, Axis, Scalar};
use crate::simd::{Halves, Kernel, Lanes, prefetch_ahead};
use crate::simd::{Isa, KernelLanes};

/// The search for the cheapest plane between bins.
///
/// There are `N` bins on each axis, of which `count` are in use.
#[derive(Clone, Copy)]
pub(super) struct Bins<'r, S, const N: usize> {
    pub references: &'r [PrimRef<S>],
    /// The box that the bins divide.
    pub span: &'r Aabb<S>,
    pub count: usize,
    /// The scale for [`Aabb::scaled_half_area`].
    pub area_scale: S,
}

/// A plane, and the sum over both sides of area times count.
pub(super) struct Plane<S> {
    pub weighted_area: S,
    pub proposal: Proposal<S>,
    /// The area that the sides have in common.
    pub overlap: S,
}

/// Number of bins that are computed at once.
const LANES: usize = 8;

/// Boxes and counts of references, by axis and bin.
///
/// A box is one vector with its minimum negated, so that one maximum joins two boxes.
struct Filled<S: Scalar, I: Isa, const N: usize> {
    boxes: [[S::Times8<I>; N]; 3],
    counts: [[i32; N]; 3],
}

impl<S: Scalar, const N: usize> Kernel for Bins<'_, S, N> {
    /// More than 16 bins are rare, so they get no wide kernel.
    const IS_WIDE: bool = N <= 16;
    const USES_AVX512: bool = false;
    /// `None` if all centroids are in one bin.
    type Output = Option<Plane<S>>;

    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Option<Plane<S>> {
        const { assert!(N.is_multiple_of(LANES)) }
        let scale = self.span.per_unit(self.count);
        let filled = self.fill(isa, scale);
        let costs = [self.costs(isa, &filled, 0), self.costs(isa, &filled, 1), self.costs(isa, &filled, 2)];
        let (axis, bin, weighted_area) = least(isa, &costs)?;
        let (origin, scale, first) = (self.span.min[axis], scale[axis], S::from_count(bin as i32));
        let [left, right] = filled.sides(isa, axis, bin);
        let overlap = to_box(isa, left.min(right)).scaled_half_area(self.area_scale);
        let (axis, boxes) = (Axis::ALL[axis], [to_box(isa, left), to_box(isa, right)]);
        let split = Split::Plane { axis, position: origin + first / scale };
        let sides = Some(Sides { axis, origin, scale, bin: first, boxes });
        Some(Plane { weighted_area, proposal: Proposal { split, sides }, overlap })
    }
}

impl<S: Scalar, const N: usize> Bins<'_, S, N> {
    #[inline(always)]
    fn fill<I: Isa>(&self, isa: I, scale: [S; 3]) -> Filled<S, I, N> {
        let grid = Grid::new(isa, self.span.min, scale, self.count);
        let mut filled = Filled::empty(isa);
        // Two sets of more than 16 bins could overflow a worker's stack, and few references do not
        // pay for a second set.
        if N > 16 || self.references.len() < 8 * N {
            for reference in self.references {
                filled.count(isa, &grid, reference);
            }
            return filled;
        }
        // The bin of a reference is often that of the reference before, whose store is still on its
        // way to memory. Two sets of bins, used in turn, save a twentieth of the build.
        let mut others = Filled::<S, I, N>::empty(isa);
        let (pairs, rest) = self.references.as_chunks::<2>();
        for [first, second] in pairs {
            // Two references of `f32` are as long as a cache line.
            prefetch_ahead(first);
            filled.count(isa, &grid, first);
            others.count(isa, &grid, second);
        }
        for reference in rest {
            filled.count(isa, &grid, reference);
        }
        for axis in 0..3 {
            for bin in 0..N {
                filled.add(axis, bin, others.boxes[axis][bin], others.counts[axis][bin]);
            }
        }
        filled
    }

    /// Returns the cost of a plane before each bin, NaN where a side is empty; infinity before the
    /// first.
    #[inline(always)]
    fn costs<I: Isa>(&self, isa: I, filled: &Filled<S, I, N>, axis: usize) -> [S; N] {
        let (boxes, counts) = (&filled.boxes[axis], &filled.counts[axis]);
        let nothing = (S::Times8::splat(isa, S::NEG_INFINITY), 0);
        let mut sides = [Side::<S, N>::EMPTY, Side::EMPTY];
        let (mut aabb, mut count) = nothing;
        for bin in 1..N {
            (aabb, count) = (aabb.max(boxes[bin - 1]), count + counts[bin - 1]);
            sides[0].put(bin, aabb, count);
        }
        (aabb, count) = nothing;
        for bin in (1..N).rev() {
            (aabb, count) = (aabb.max(boxes[bin]), count + counts[bin]);
            sides[1].put(bin, aabb, count);
        }
        let scale = S::Times8::splat(isa, self.area_scale);
        let mut costs = [S::ZERO; N];
        for first in (0..N).step_by(LANES) {
            let cost = sides[0].costs(isa, first, scale) + sides[1].costs(isa, first, scale);
            cost.store(&mut costs[first..]);
        }
        // There is no plane before the first bin.
        costs[0] = S::INFINITY;
        costs
    }
}

impl<S: Scalar, I: Isa, const N: usize> Filled<S, I, N> {
    #[inline(always)]
    fn empty(isa: I) -> Self {
        Self { boxes: [[S::Times8::splat(isa, S::NEG_INFINITY); N]; 3], counts: [[0; N]; 3] }
    }

    /// Returns the box around the bins before `border`, and the box around the rest.
    #[inline(always)]
    fn sides(&self, isa: I, axis: usize, border: usize) -> [S::Times8<I>; 2] {
        let nothing = S::Times8::splat(isa, S::NEG_INFINITY);
        let (mut left, mut right) = (nothing, nothing);
        for bin in 0..N {
            let side = if bin < border { &mut left } else { &mut right };
            *side = side.max(self.boxes[axis][bin]);
        }
        [left, right]
    }

    #[inline(always)]
    fn add(&mut self, axis: usize, bin: usize, aabb: S::Times8<I>, count: i32) {
        self.counts[axis][bin] += count;
        let joined = &mut self.boxes[axis][bin];
        *joined = joined.max(aabb);
    }

    #[inline(always)]
    fn count(&mut self, isa: I, grid: &Grid<S, I>, reference: &PrimRef<S>) {
        let [min, max] = reference.corners::<I>(isa);
        let aabb = S::Times8::of_halves([S::Times4::splat(isa, S::ZERO) - min, max]);
        let [x, y, z] = grid.cells(min, max);
        self.add(0, x as usize % N, aabb, 1);
        self.add(1, y as usize % N, aabb, 1);
        self.add(2, z as usize % N, aabb, 1);
    }
}

/// Converts a vector whose minimum is negated to a box.
#[inline(always)]
fn to_box<S: Scalar, I: Isa>(isa: I, aabb: S::Times8<I>) -> Aabb<S> {
    let [negated_min, max] = aabb.to_halves();
    Aabb { min: three(S::Times4::splat(isa, S::ZERO) - negated_min), max: three(max) }
}

/// One side of each plane: the extents of its box, and its number of references.
struct Side<S, const N: usize> {
    extents: [[S; N]; 3],
    counts: [S; N],
}

impl<S: Scalar, const N: usize> Side<S, N> {
    const EMPTY: Self = Self { extents: [[S::ZERO; N]; 3], counts: [S::ZERO; N] };

    #[inline(always)]
    fn put<I: Isa>(&mut self, bin: usize, aabb: S::Times8<I>, count: i32) {
        let [negated_min, max] = aabb.to_halves();
        let [x, y, z] = three(max + negated_min);
        self.extents[0][bin] = x;
        self.extents[1][bin] = y;
        self.extents[2][bin] = z;
        self.counts[bin] = S::from_count(count);
    }

    /// Returns the areas times counts of this side, for eight planes.
    ///
    /// An empty side has NaN: infinity times zero.
    #[inline(always)]
    fn costs<I: Isa>(&self, isa: I, first: usize, scale: S::Times8<I>) -> S::Times8<I> {
        let [x, y, z] = &self.extents;
        let x = eight(isa, x, first) * scale;
        let y = eight(isa, y, first) * scale;
        let z = eight(isa, z, first) * scale;
        (x * y + y * z + z * x) * eight(isa, &self.counts, first)
    }
}

/// Loads eight values of a row.
#[inline(always)]
fn eight<S: Scalar, I: Isa, const N: usize>(isa: I, row: &[S; N], first: usize) -> S::Times8<I> {
    S::Times8::from_slice(isa, &row[first..first + LANES])
}

/// Returns the axis, the bin and the value of the least cost, if there is one.
///
/// Of equal costs, the first is taken.
#[inline(always)]
fn least<S: Scalar, I: Isa, const N: usize>(isa: I, costs: &[[S; N]; 3]) -> Option<(usize, usize, S)> {
    let mut smallest = S::Times8::splat(isa, S::INFINITY);
    for row in costs {
        for first in (0..N).step_by(LANES) {
            smallest = eight(isa, row, first).min(smallest);
        }
    }
    let smallest =
        (0..LANES).fold(S::INFINITY, |least, lane| crate::geometry::min(smallest.lane(lane), least));
    // The least cost is no NaN: the minimum leaves NaN out.
    if smallest == S::INFINITY {
        return None;
    }
    for (axis, row) in costs.iter().enumerate() {
        for first in (0..N).step_by(LANES) {
            let is_least = S::Times8::<I>::bits(eight(isa, row, first).le(S::Times8::splat(isa, smallest)));
            if is_least != 0 {
                return Some((axis, first + is_least.trailing_zeros() as usize, smallest));
            }
        }
    }
    None
}
