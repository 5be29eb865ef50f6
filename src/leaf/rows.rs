//! The operands of a leaf, row by row.

use super::LEAF_WIDTH;
use crate::geometry::Scalar;
use crate::simd::Lanes;

/// The operands of a leaf: a vector for each operand, a lane for each primitive.
#[derive(Clone, Copy)]
pub struct Operands<'a, S: Scalar, L: Lanes<S>> {
    isa: L::Isa,
    rows: &'a [[S; LEAF_WIDTH]],
}

impl<'a, S: Scalar, L: Lanes<S>> Operands<'a, S, L> {
    #[inline(always)]
    pub(crate) fn new(isa: L::Isa, rows: &'a [[S; LEAF_WIDTH]]) -> Self {
        const { assert!(L::COUNT == LEAF_WIDTH) }
        Self { isa, rows }
    }

    /// Returns one operand of all the leaf's primitives.
    ///
    /// # Panics
    ///
    /// If the leaf has fewer operands.
    #[inline(always)]
    pub fn get(&self, operand: usize) -> L {
        L::from_slice(self.isa, &self.rows[operand])
    }

    /// Returns a vector with a scalar in all lanes.
    #[inline(always)]
    pub fn splat(&self, scalar: S) -> L {
        L::splat(self.isa, scalar)
    }
}
