//! The loop over primitives of a leaf that are tested one by one.

use crate::geometry::Scalar;
use crate::leaf::sealed::LeafKind;
use crate::leaf::{GATHERED, LEAF_WIDTH, Primitives, PutOperands};
use crate::primitive::Intersect;
use crate::traverse::{LeafView, RayState};
use core::ops::ControlFlow;

/// Calls `test` with primitives of a leaf and their indices, until it breaks.
///
/// These are all primitives of the leaf, or those that the sieve of their type lets through.
#[inline(always)]
pub(super) fn each<P: Intersect>(
    primitives: &[P],
    leaf: LeafView<'_, P::Scalar>,
    ray: &mut RayState<P::Scalar>,
    mut test: impl FnMut(&P, u32, &mut RayState<P::Scalar>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let operands = const { <P::Leaf as LeafKind<P::Scalar, P::Payload>>::OPERANDS };
    // Leaves of the binary tree are of any length, and have no lanes.
    let sieve = ray.sieve.filter(|_| operands > 0 && leaf.indices.len() <= LEAF_WIDTH);
    if let Some(backend) = sieve {
        let mut gathered = [[P::Scalar::ZERO; LEAF_WIDTH]; GATHERED];
        let rows = if leaf.rows.len() == operands {
            leaf.rows
        } else if let Some(rows) = gathered.get_mut(..operands) {
            Primitives(primitives).put_rows(leaf.indices, rows);
            rows
        } else {
            return all(primitives, leaf.indices, ray, test);
        };
        ray.steps.primitives += leaf.indices.len() as u64;
        let lanes = <P::Leaf as LeafKind<P::Scalar, P::Payload>>::candidates(backend, rows, &ray.ray);
        for (lane, &index) in leaf.indices.iter().enumerate() {
            if lanes >> lane & 1 != 0 {
                test(&primitives[index as usize], index, ray)?;
            }
        }
        return ControlFlow::Continue(());
    }
    all(primitives, leaf.indices, ray, test)
}

#[inline(always)]
fn all<P: Intersect>(
    primitives: &[P],
    indices: &[u32],
    ray: &mut RayState<P::Scalar>,
    mut test: impl FnMut(&P, u32, &mut RayState<P::Scalar>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for &index in indices {
        ray.steps.primitives += 1;
        test(&primitives[index as usize], index, ray)?;
    }
    ControlFlow::Continue(())
}
