//! The kinds of leaves of the wide layouts, and the tests that lanes compute.
//!
//! ```text
//! leaf kind       the lanes compute                              left to the scalar test
//! FastLeaf        the whole test                                 hits that may be outside the box
//! WatertightLeaf  the whole test where rounding leaves no doubt  the same, and the cases of doubt
//! PreciseLeaf     the triangles that are out of the question     the test in f64 of the others
//! SphereLeaf      the whole test                                 hits that may be outside the box
//! OneByOne        nothing                                        `intersect` of each primitive
//! Sieved          the sieve of the primitive's author            `intersect` of the others
//! ```
//!
//! The operands of the first four kinds are the whole primitive. So the scalar test needs the
//! operands alone, and kernels for these kinds are compiled in this crate, for each scalar and
//! instruction set, whatever type the operands come from.

mod late_bound;
mod own;
mod precise;
mod rows;
mod spheres;
mod triangles;

pub(crate) use late_bound::{StoredHits, TestLanes};
pub use own::{OneByOne, Sieve, Sieved};
pub use precise::PreciseLeaf;
pub use rows::Operands;
pub use spheres::SphereLeaf;
pub use triangles::{FastLeaf, WatertightLeaf};

use crate::geometry::{Ray, Scalar, Slabs, max};
use crate::simd::{Backend, Lanes};
use alloc::vec::Vec;

/// The number of primitives side by side in a leaf of the wide layouts.
pub const LEAF_WIDTH: usize = 8;

/// The maximum number of operands that are gathered where no leaf stores them.
pub(crate) const GATHERED: usize = 16;

/// A kind of leaf of the wide layouts: its content and its test.
///
/// The trait is sealed. [`Intersect::Leaf`](crate::Intersect::Leaf) chooses the kind. [`OneByOne`]
/// tests each primitive by itself. [`Sieved`] tests the primitives that a [`Sieve`] in lanes lets
/// through. The leaves of triangles and spheres are this crate's.
pub trait Leaf<S: Scalar, T>: sealed::LeafKind<S, T> {}

impl<S: Scalar, T, K: sealed::LeafKind<S, T>> Leaf<S, T> for K {}

pub(crate) mod sealed {
    use super::*;

    /// The private part of a kind of leaf.
    pub trait LeafKind<S: Scalar, T>: 'static {
        /// The number of scalars of each primitive in the leaf.
        const OPERANDS: usize;
        /// Whether the operands are the whole primitive.
        ///
        /// If they are, `intersect` is never called.
        const IS_SETTLED_IN_LANES: bool;
        /// The kernel, for kinds that are settled in lanes.
        const KERNEL: Kernel = Kernel::Fast;

        /// Returns the payload of a hit with these details.
        ///
        /// Returns `None` for kinds whose primitives are tested by `intersect`.
        #[inline(always)]
        fn payload(_details: [S; 3]) -> Option<T> {
            None
        }

        /// Returns a bit for each lane whose primitive the ray may hit.
        ///
        /// The bits of lanes without a primitive do not count.
        #[inline(always)]
        fn candidates(_backend: Backend, _rows: &[[S; LEAF_WIDTH]], _ray: &Ray<S>) -> u32 {
            u32::MAX
        }
    }

    /// The kernels of leaves whose operands are the whole primitives.
    ///
    /// The order is that of the kernels' tables.
    #[derive(Clone, Copy)]
    pub enum Kernel {
        Fast,
        Watertight,
        Precise,
        Spheres,
    }
}

/// The test of a leaf whose operands are the whole primitives.
pub(crate) trait LaneTest<S: Scalar>: 'static {
    /// The number of scalars of each primitive.
    const OPERANDS: usize;
    /// The values that are computed once per ray, at the first leaf that it meets.
    type Frame: Copy;

    fn frame(ray: &Ray<S>, slabs: &Slabs<S>) -> Self::Frame;

    /// Returns whether lanes may be tested with this ray.
    ///
    /// The answer is for trees whose coordinates are below `Scalar::LARGE_AREA`.
    fn suits(ray: &Ray<S>) -> bool;

    /// Tests all lanes, for hits up to `limit`.
    fn test<L: Lanes<S>>(
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &Self::Frame,
        limit: S,
    ) -> LaneHits<L>;

    /// Tests one lane by itself: returns t, as `primitive::accept` does, and details.
    fn one(operands: &[S], ray: &Ray<S>, slabs: &Slabs<S>) -> Option<(S, [S; 3])>;
}

/// Returns the operands of one lane, and zeros behind them.
pub(crate) fn operands_of<S: Scalar>(rows: &[[S; LEAF_WIDTH]], lane: usize) -> [S; GATHERED] {
    let mut operands = [S::ZERO; GATHERED];
    for (operand, row) in operands.iter_mut().zip(rows) {
        *operand = row[lane];
    }
    operands
}

/// The hits in the lanes of a leaf.
#[derive(Clone, Copy)]
pub(crate) struct LaneHits<L> {
    /// A bit for each lane that is hit at its `t`, by the rule of `primitive::accept`.
    pub settled: u32,
    /// A bit for each lane that the scalar test has to decide.
    pub undecided: u32,
    pub t: L,
    /// The values from which the payload is computed.
    pub details: [L; 3],
}

impl<L> LaneHits<L> {
    /// Returns hits of which none is settled.
    #[inline(always)]
    fn undecided<S: Scalar>(undecided: u32, operands: &Operands<'_, S, L>) -> Self
    where
        L: Lanes<S>,
    {
        let nothing = operands.splat(S::ZERO);
        Self { settled: 0, undecided, t: nothing, details: [nothing; 3] }
    }
}

/// Returns whether lanes of triangles may be tested with this ray.
///
/// The ray does not look behind its origin, where the padding of boxes has the other sign. And no
/// sum or product of two coordinates in its frame overflows, so only lanes without a primitive are
/// NaN. (In `f64`, products overflow sooner. Then t is NaN in the lanes, as it is for a single
/// triangle, and nothing is hit.)
#[inline(always)]
fn is_ahead_and_in_range<S: Scalar>(ray: &Ray<S>) -> bool {
    let [x, y, z] = ray.origin;
    ray.t_min >= S::ZERO && max(max(x.abs(), y.abs()), z.abs()) < S::LARGE_AREA
}

/// A list of primitives that writes their operands, by their indices in the input.
///
/// The call is late-bound, because kernels know no primitive's type.
pub trait PutOperands<S> {
    /// Writes a row for each operand, with a lane for each primitive.
    ///
    /// The lanes behind the last primitive become NaN.
    fn put_rows(&self, indices: &[u32], rows: &mut [[S; LEAF_WIDTH]]);
}

/// A list of primitives, as kernels see it.
pub(crate) struct Primitives<'a, P>(pub &'a [P]);

impl<P: crate::Intersect> PutOperands<P::Scalar> for Primitives<'_, P> {
    fn put_rows(&self, indices: &[u32], rows: &mut [[P::Scalar; LEAF_WIDTH]]) {
        // The size of this array is known to the compiler, so few operands stay in registers.
        // Through memory, operands are written in parts of one size and read in parts of another: a
        // quick build takes a fifteenth longer.
        let (mut few, mut many) = ([P::Scalar::ZERO; 16], Vec::new());
        let operands = <P::Leaf as sealed::LeafKind<_, P::Payload>>::OPERANDS;
        let values = few.get_mut(..operands).unwrap_or_else(|| {
            many.resize(operands, P::Scalar::ZERO);
            &mut many
        });
        for (lane, &index) in indices.iter().enumerate() {
            self.0[index as usize].put_operands(values);
            for (row, &value) in rows.iter_mut().zip(&*values) {
                row[lane] = value;
            }
        }
        for row in rows {
            row[indices.len()..].fill(P::Scalar::from_f64(f64::NAN));
        }
    }
}
