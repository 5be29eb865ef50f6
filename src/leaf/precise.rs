//! Leaves of triangles that are tested in `f64`, after a sieve in lanes of `f32`.

use super::sealed::{Kernel, LeafKind};
use super::triangles::{EdgeTests, TriangleFrame, barycentrics, details, largest, triangle};
use super::{LaneHits, LaneTest, Operands, is_ahead_and_in_range};
use crate::geometry::{Ray, Slabs};
use crate::primitive::{Barycentrics, Precise, accept};
use crate::simd::Lanes;

/// The leaf of [`Precise`] triangles: nine coordinates each.
///
/// Lanes of `f32` leave out the triangles that the ray misses: the signs of two of their
/// weights differ beyond doubt.
#[derive(Clone, Copy, Debug)]
pub struct PreciseLeaf;

impl LeafKind<f32, Barycentrics> for PreciseLeaf {
    const OPERANDS: usize = 9;
    const IS_SETTLED_IN_LANES: bool = true;
    const KERNEL: Kernel = Kernel::Precise;

    #[inline(always)]
    fn payload(details: [f32; 3]) -> Option<Barycentrics> {
        Some(barycentrics(details))
    }
}

impl LaneTest<f32> for PreciseLeaf {
    const OPERANDS: usize = 9;
    type Frame = TriangleFrame<f32>;

    #[inline(always)]
    fn frame(ray: &Ray, slabs: &Slabs<f32>) -> TriangleFrame<f32> {
        TriangleFrame::of(ray, slabs)
    }

    #[inline(always)]
    fn suits(ray: &Ray) -> bool {
        is_ahead_and_in_range(ray)
    }

    /// Leaves out the lanes that the ray misses beyond doubt.
    ///
    /// A weight is a difference of two products of coordinates in the ray's frame. The error of
    /// each coordinate is less than 2 epsilon of the value that the coordinate would have if
    /// all signs were plus. So the error of the weight is less than 16 epsilon of the largest
    /// such product. A slope, a coordinate or a product that underflows has an error of more
    /// than its epsilons, but of less than the smallest normal number. The test adds this
    /// number to each of them.
    #[inline(always)]
    fn test<L: Lanes<f32>>(
        operands: &Operands<'_, f32, L>,
        _: &Ray,
        frame: &TriangleFrame<f32>,
        _: f32,
    ) -> LaneHits<L> {
        let EdgeTests { x, y, z, weights: [a, b, c], .. } = EdgeTests::new(operands, &frame.shear);
        let [dx, dy, dz] = frame.shear.direction;
        let (x, y, z) = (largest(x), largest(y), largest(z));
        let splat = |x: f32| operands.splat(x.abs());
        let tiny = operands.splat(f32::MIN_POSITIVE);
        let (x, y) =
            (x * splat(dz) + z * (splat(dx) + tiny) + tiny, y * splat(dz) + z * (splat(dy) + tiny) + tiny);
        let doubt = x * y * operands.splat(16.0 * f32::EPSILON) + tiny;
        let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
        let zero = operands.splat(0.0);
        LaneHits::undecided(L::bits((zero - doubt).le(lowest) | highest.le(doubt)), operands)
    }

    fn one(operands: &[f32], ray: &Ray, slabs: &Slabs<f32>) -> Option<(f32, [f32; 3])> {
        accept(&Precise(triangle(operands)), ray, slabs).map(details)
    }
}
