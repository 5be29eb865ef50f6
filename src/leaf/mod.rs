//! How primitives lie side by side in a leaf of the wide layouts, and what its lanes compute.
//!
//! ```text
//! leaf kind            the lanes compute                              left to a primitive
//! FastLeaf             the whole test                                 -
//! WatertightLeaf       the whole test where rounding leaves no doubt  a second look, from the operands
//! PreciseLeaf          which triangles are out of the question        the test in f64, from the operands
//! SphereLeaf           the whole test                                 -
//! OneByOne             nothing                                        its `intersect`
//! Sieved               what its author's sieve says                   its `intersect`
//! ```
//!
//! The first four know all of a primitive by its operands: kernels for them are compiled in this crate, for each scalar and
//! instruction set, whatever type the operands came from.

mod own;
mod precise;
mod rows;
mod spheres;
mod stored;
mod triangles;

pub use own::{OneByOne, Sieve, Sieved};
pub use precise::PreciseLeaf;
pub use rows::Operands;
pub use spheres::SphereLeaf;
pub(crate) use stored::{StoredHits, TestLanes};
pub use triangles::{FastLeaf, WatertightLeaf};

use crate::geometry::{Ray, Scalar, Slabs, max};
use crate::simd::{Backend, Lanes};
use alloc::vec::Vec;

/// Number of primitives side by side in a leaf of the wide layouts.
pub const LEAF_WIDTH: usize = 8;

/// Operands up to which they are gathered where they do not lie in the leaf.
pub(crate) const GATHERED: usize = 16;

/// How primitives lie in a leaf of the wide layouts, and how a ray meets them there: chosen by
/// [`Intersect::Leaf`](crate::Intersect::Leaf). Sealed.
///
/// [`OneByOne`] asks each primitive by itself; [`Sieved`] asks those that a [`Sieve`] in lanes lets through. The leaves of
/// triangles and spheres are this crate's.
pub trait Leaf<S: Scalar, T>: sealed::LeafKind<S, T> {}

impl<S: Scalar, T, K: sealed::LeafKind<S, T>> Leaf<S, T> for K {}

pub(crate) mod sealed {
    use super::*;

    /// What this crate knows of a kind of leaf.
    pub trait LeafKind<S: Scalar, T>: 'static {
        /// Scalars of each primitive that lie in the leaf.
        const OPERANDS: usize;
        /// Whether operands say all of a primitive: then it is never asked.
        const IS_SETTLED_IN_LANES: bool;
        /// Which of the kernels that are settled in lanes.
        const KERNEL: Kernel = Kernel::Fast;

        /// The payload of a hit with these details; none where primitives are asked.
        #[inline(always)]
        fn payload(_details: [S; 3]) -> Option<T> {
            None
        }

        /// Bits of the lanes whose primitives a ray may hit, of those that there are.
        #[inline(always)]
        fn candidates(_backend: Backend, _rows: &[[S; LEAF_WIDTH]], _ray: &Ray<S>) -> u32 {
            u32::MAX
        }
    }

    /// Kernels that know all of a primitive by its operands, in the order of their tables.
    #[derive(Clone, Copy)]
    pub enum Kernel {
        Fast,
        Watertight,
        Precise,
        Spheres,
    }
}

/// The test of a leaf whose operands say all of its primitives.
pub(crate) trait LaneTest<S: Scalar>: 'static {
    /// Scalars of each primitive.
    const OPERANDS: usize;
    /// What is computed of a ray once, at the first leaf that it meets.
    type Frame: Copy;

    fn frame(ray: &Ray<S>, slabs: &Slabs<S>) -> Self::Frame;

    /// Whether lanes may be tested with this ray, in a tree whose coordinates are below `Scalar::LARGE_AREA`.
    fn suits(ray: &Ray<S>) -> bool;

    /// The test of all lanes, for hits up to `limit`.
    fn test<L: Lanes<S>>(
        operands: &Operands<'_, S, L>,
        ray: &Ray<S>,
        frame: &Self::Frame,
        limit: S,
    ) -> LaneHits<L>;

    /// The test of one lane by itself: t, as `primitive::accept` says, and details.
    fn one(operands: &[S], ray: &Ray<S>, slabs: &Slabs<S>) -> Option<(S, [S; 3])>;
}

/// The operands of one lane, and zeros behind them.
pub(crate) fn operands_of<S: Scalar>(rows: &[[S; LEAF_WIDTH]], lane: usize) -> [S; GATHERED] {
    let mut operands = [S::ZERO; GATHERED];
    for (operand, row) in operands.iter_mut().zip(rows) {
        *operand = row[lane];
    }
    operands
}

/// What was found in a leaf's lanes.
#[derive(Clone, Copy)]
pub(crate) struct LaneHits<L> {
    /// A bit for each lane that is hit at its `t`, as `primitive::accept` would say.
    pub settled: u32,
    /// A bit for each lane that has to be tested by itself.
    pub undecided: u32,
    pub t: L,
    /// What the payload is made of.
    pub details: [L; 3],
}

impl<L> LaneHits<L> {
    /// Nothing is hit for sure.
    #[inline(always)]
    fn undecided<S: Scalar>(undecided: u32, operands: &Operands<'_, S, L>) -> Self
    where
        L: Lanes<S>,
    {
        let nothing = operands.splat(S::ZERO);
        Self { settled: 0, undecided, t: nothing, details: [nothing; 3] }
    }
}

/// Whether the ray does not look behind its origin, where the padding of boxes has the other sign, and no sum or product of
/// two coordinates in its frame overflows: only lanes without a primitive are NaN. (In `f64` products overflow sooner, but
/// then t is NaN in lanes as it is for a single triangle, and nothing is hit.)
#[inline(always)]
fn is_ahead_and_in_range<S: Scalar>(ray: &Ray<S>) -> bool {
    let [x, y, z] = ray.origin;
    ray.t_min >= S::ZERO && max(max(x.abs(), y.abs()), z.abs()) < S::LARGE_AREA
}

/// What writes the operands of primitives, by their indices in the input: late-bound, for kernels know no primitive's type.
pub trait PutOperands<S> {
    /// A row for each operand, a lane for each primitive, NaN in the lanes behind.
    fn put_rows(&self, indices: &[u32], rows: &mut [[S; LEAF_WIDTH]]);
}

/// A list of primitives, as kernels see it.
pub(crate) struct Primitives<'a, P>(pub &'a [P]);

impl<P: crate::Intersect> PutOperands<P::Scalar> for Primitives<'_, P> {
    fn put_rows(&self, indices: &[u32], rows: &mut [[P::Scalar; LEAF_WIDTH]]) {
        // Of a size that the compiler knows, so that few operands stay in registers on their way: through memory, where they are
        // written in parts of one size and read in parts of another, a quick build took a fifteenth longer.
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
