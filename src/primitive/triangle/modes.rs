//! The modes of the ray-triangle test: a type chooses how exact the test is.

use super::sheared::sheared;
use super::watertight::{bounds, exact_bounds, watertight, watertight_widest};
use super::{Barycentrics, Corners};
use crate::geometry::{Aabb, Ray, RayFrame, Scalar, ScalarParts};
use crate::leaf::{FastLeaf, PreciseLeaf, WatertightLeaf};
use crate::primitive::{Intersect, Primitive};

/// A triangle tested with the least arithmetic.
///
/// A ray aimed at a corner, or at an edge of a sliver, may pass between the triangles that meet
/// there. It may also be reported to hit a triangle that it passes beside: by a rounding, or, if
/// the triangle is degenerate, by much more.
///
/// The test computes products of three lengths. Coordinates and distances are good from about 1e-12
/// to 1e12 in `f32`, and 1e-100 to 1e100 in `f64`; beyond, hits are lost. `docs/accuracy.md` has
/// the error rates and the gain in speed.
///
/// ```
/// use bvhkit::{Bvh, Fast, Triangle};
/// let triangles = [Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
/// let bvh: Bvh<Fast<&Triangle>> = Bvh::build(triangles.iter().map(Fast))?;
/// # Ok::<(), bvhkit::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fast<P>(pub P);

/// A triangle tested so that no ray passes between it and its neighbours.
///
/// By themselves, [`Triangle`](crate::Triangle) and [`MeshTriangle`](crate::MeshTriangle) are
/// tested in this mode.
///
/// A ray from inside a closed mesh hits the mesh, at edges and corners too. The triangles must
/// share the very bits of their corners. Sometimes the hit is on the neighbour of the triangle that
/// exact arithmetic would name. The origin must be inside by more than the rounding of the
/// coordinates, since each ray sees the corners moved by as much. Of rays that start within 1e-6 of
/// an edge of the unit cube, 0 of 20,000 leave it; of rays that start closer, some do (measured:
/// docs/decisions.md, 36).
///
/// The ray of a hit passes the triangle within a few roundings of the distances to its corners. The
/// point of the hit is as close, unless the ray is in the triangle's plane up to rounding. Then t
/// is only known to be between those of the nearest and the farthest corner, and the point may be
/// off by the triangle's size ([`Precise`] has no such hits). The triangle's box is a few roundings
/// larger than the box of its corners. The proof needs this margin; it is in the source
/// (`primitive/triangle/watertight.rs`).
///
/// Coordinates and distances are good from about 1e-30 to 1e37 in `f32`, and 1e-100 to 1e100 in
/// `f64`. So are directions of a length in that range, as long as t is in the scalar's range, too.
/// A triangle with two equal corners is never hit. A triangle whose corners are on a line is hit
/// only by rays that pass within the same few roundings of that line.
///
/// Wraps any triangle of your own that implements [`Corners`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Watertight<P>(pub P);

/// A triangle with `f32` corners, tested in `f64`.
///
/// It is watertight, and an origin may be a billion times closer to an edge than in [`Watertight`]
/// mode. t, the weights and the decision between neighbours are those of exact arithmetic, except
/// for rare roundings of `f64`.
///
/// All coordinates from about 1e-30 to 1e37 are good. The boxes are in `f32`, as
/// for [`Watertight`].
///
/// ```
/// use bvhkit::{Bvh, Precise, Ray, TriangleMesh};
/// let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriangleMesh::new(&vertices, &[[0, 1, 2], [0, 2, 3]])?;
/// let bvh = Bvh::build(mesh.iter().map(Precise))?;
/// assert!(bvh.any_hit(&Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Precise<P>(pub P);

/// Returns the watertight box of `corners`, or their own box if it is invalid.
#[inline(always)]
fn padded<S: Scalar>(corners: [[S; 3]; 3]) -> Aabb<S> {
    let own = around(corners);
    if own.is_valid() { bounds(corners) } else { own }
}

/// Returns the box of any corners.
///
/// It is faster than [`Aabb::of_points`] if all coordinates are finite, as most are.
#[inline(always)]
fn around<S: Scalar>(corners: [[S; 3]; 3]) -> Aabb<S> {
    let [a, b, c] = corners;
    // NaN or infinite if a coordinate is. Finite coordinates may overflow the sum, which
    // costs only time.
    let sum = |axis: usize| a[axis] + b[axis] + c[axis];
    if (sum(0) + sum(1) + sum(2)).is_finite() { exact_bounds(corners) } else { Aabb::of_points(corners) }
}

impl<P: Corners> Corners for Fast<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn corners(&self) -> [[P::Scalar; 3]; 3] {
        self.0.corners()
    }
}

impl<P: Corners> Primitive for Fast<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn aabb(&self) -> Aabb<P::Scalar> {
        around(self.0.corners())
    }

    #[inline(always)]
    fn aabb_of_valid(&self) -> Aabb<P::Scalar> {
        exact_bounds(self.0.corners())
    }
}

impl<P: Corners> Intersect for Fast<P> {
    type Payload = Barycentrics<P::Scalar>;
    type Leaf = FastLeaf;

    #[inline(always)]
    fn intersect(&self, ray: &Ray<P::Scalar>) -> Option<(P::Scalar, Barycentrics<P::Scalar>)> {
        sheared(self.0.corners(), &RayFrame::of(ray)).filter(|&(t, _)| ray.includes(t))
    }

    #[inline(always)]
    fn put_operands(&self, operands: &mut [P::Scalar]) {
        operands.copy_from_slice(self.0.corners().as_flattened());
    }
}

impl<P: Corners> Corners for Watertight<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn corners(&self) -> [[P::Scalar; 3]; 3] {
        self.0.corners()
    }
}

impl<P: Corners> Primitive for Watertight<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn aabb(&self) -> Aabb<P::Scalar> {
        padded(self.0.corners())
    }

    #[inline(always)]
    fn aabb_of_valid(&self) -> Aabb<P::Scalar> {
        bounds(self.0.corners())
    }
}

impl<P: Corners> Intersect for Watertight<P> {
    type Payload = Barycentrics<P::Scalar>;
    type Leaf = WatertightLeaf;

    #[inline(always)]
    fn intersect(&self, ray: &Ray<P::Scalar>) -> Option<(P::Scalar, Barycentrics<P::Scalar>)> {
        watertight(self.0.corners(), ray).filter(|&(t, _)| ray.includes(t))
    }

    #[inline(always)]
    fn put_operands(&self, operands: &mut [P::Scalar]) {
        operands.copy_from_slice(self.0.corners().as_flattened());
    }
}

impl<P: Corners> Corners for Precise<P> {
    type Scalar = P::Scalar;

    #[inline(always)]
    fn corners(&self) -> [[P::Scalar; 3]; 3] {
        self.0.corners()
    }
}

impl<P: Corners<Scalar = f32>> Primitive for Precise<P> {
    type Scalar = f32;

    #[inline(always)]
    fn aabb(&self) -> Aabb {
        padded(self.0.corners())
    }

    #[inline(always)]
    fn aabb_of_valid(&self) -> Aabb {
        bounds(self.0.corners())
    }
}

impl<P: Corners<Scalar = f32>> Intersect for Precise<P> {
    type Payload = Barycentrics;
    type Leaf = PreciseLeaf;

    #[inline(always)]
    fn intersect(&self, ray: &Ray) -> Option<(f32, Barycentrics)> {
        let [a, b, c] = self.0.corners();
        let widen = |[x, y, z]: [f32; 3]| [x.widen(), y.widen(), z.widen()];
        let corners = [widen(a), widen(b), widen(c)];
        let (t, Barycentrics { u, v }) = watertight_widest(corners, &RayFrame::widened(ray))?;
        let (t, u, v) = (t as f32, u as f32, v as f32);
        ray.includes(t).then_some((t, Barycentrics { u, v }))
    }

    #[inline(always)]
    fn put_operands(&self, operands: &mut [f32]) {
        operands.copy_from_slice(self.0.corners().as_flattened());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Triangle;
    use alloc::vec::Vec;

    const UNIT: Triangle = Triangle { a: [0.0, 0.0, 0.0], b: [1.0, 0.0, 0.0], c: [0.0, 1.0, 0.0] };

    /// Returns the answers of the modes, and those for `f64` data, as `f32`.
    fn answers(triangle: Triangle, ray: Ray) -> [Option<(f32, f32, f32)>; 4] {
        let prepared = ray;
        let flat = |(t, at): (f32, Barycentrics)| (t, at.u, at.v);
        let double = |point: [f32; 3]| point.map(f64::from);
        let wide = Triangle::new(double(triangle.a), double(triangle.b), double(triangle.c));
        let wide_ray = Ray::new(double(ray.origin), double(ray.direction))
            .with_interval(f64::from(ray.t_min), f64::from(ray.t_max));
        let wide_hit = wide.intersect(&wide_ray);
        [
            Fast(triangle).intersect(&prepared).map(flat),
            Watertight(triangle).intersect(&prepared).map(flat),
            Precise(triangle).intersect(&prepared).map(flat),
            wide_hit.map(|(t, at)| (t as f32, at.u as f32, at.v as f32)),
        ]
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 2.0], [0.0, 0.0, -1.0])
    }

    #[test]
    fn edges_and_corners_are_inside_and_both_sides_are_hit() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.25, 0.25)] {
            // At an edge, a hit of `Fast` has the same t here, since nothing is rounded.
            assert_eq!(answers(UNIT, down(x, y)), [Some((2.0, x, y)); 4]);
            let up = Ray::new([x, y, -3.0], [0.0, 0.0, 1.0]);
            assert_eq!(answers(UNIT, up), [Some((3.0, x, y)); 4]);
        }
        for (x, y) in [(-0.001, 0.5), (0.5, -0.001), (0.501, 0.5)] {
            assert_eq!(answers(UNIT, down(x, y)), [None; 4]);
        }
    }

    #[test]
    fn the_interval_is_closed() {
        let ray = down(0.25, 0.25);
        assert!(answers(UNIT, ray.with_interval(2.0, 2.0)).iter().all(Option::is_some));
        for ray in [ray.with_interval(2.0f32.next_up(), 9.0), ray.with_interval(0.0, 2.0f32.next_down())] {
            assert_eq!(answers(UNIT, ray), [None; 4]);
        }
    }

    #[test]
    fn a_coplanar_ray_and_a_triangle_without_area_miss() {
        assert_eq!(answers(UNIT, Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0])), [None; 4]);
        let needle = Triangle::new([0.0f32; 3], [1.0, 0.0, 1.0], [2.0, 0.0, 2.0]);
        assert_eq!(answers(needle, down(0.5, 0.0)), [None; 4]);
        // Equal corners are equal in the ray's frame too, however the ray is rounded.
        let (p, q) = ([0.1f32, 0.7, 0.3], [1.1, -0.2, 0.9]);
        for corners in [[p, p, q], [p, q, p], [q, p, p], [p, p, p]] {
            for along in [0.0f32, 0.3, 1.0] {
                let origin = [0.37, 0.11, -1.7];
                let direction = [0, 1, 2].map(|k| p[k] + along * (q[k] - p[k]) - origin[k]);
                let [a, b, c] = corners;
                assert_eq!(answers(Triangle::new(a, b, c), Ray::new(origin, direction)), [None; 4]);
            }
        }
    }

    /// Tests rays inside, at an edge, at a corner and outside, of many lengths.
    #[test]
    fn size_alone_changes_nothing_within_each_modes_range() {
        for exponent in -36..=36 {
            for length in [1e-30f32, 1e-3, 1.0, 1e30] {
                let scale = 10f32.powi(exponent);
                let scaled = |point: [f32; 3]| point.map(|x| x * scale);
                let triangle = Triangle::new(scaled(UNIT.a), scaled(UNIT.b), scaled(UNIT.c));
                for (x, y) in [(0.25, 0.25), (0.5, 0.0), (0.0, 0.0), (0.25, -0.25)] {
                    let ray = Ray::new(scaled([x, y, 2.0]), [0.0, 0.0, -length]);
                    let [fast, rest @ ..] = answers(triangle, ray);
                    let near = |hit: Option<(f32, f32, f32)>| match hit {
                        None => y < 0.0,
                        Some((t, u, v)) => {
                            let expected = 2.0 * scale / length;
                            y >= 0.0
                                && (t - expected).abs() <= 1e-6 * expected
                                && (u - x).abs().max((v - y).abs()) < 1e-6
                        }
                    };
                    let expected = 2.0 * scale / length;
                    if expected.is_normal() {
                        assert!(rest.into_iter().all(near), "{exponent} {length}: {rest:?}");
                        assert!(exponent.abs() > 11 || near(fast), "{exponent} {length}: {fast:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_distance_far_larger_or_smaller_than_the_triangle_is_no_matter() {
        for (size, distance) in [(1e6f32, 1e30f32), (1e3, 1e33), (1e8, 1e25), (3e-9, 1e-28), (1e-8, 1e-25)] {
            let corner = |x: f32, y: f32| [x * size, y * size, distance];
            let triangle = Triangle::new(corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0));
            let ray = Ray::new([0.0, 0.1 * size, 0.0], [0.0, 0.0, 1.0]);
            let t = [Watertight(triangle).intersect(&ray), Precise(triangle).intersect(&ray)];
            assert!(t.iter().all(|hit| hit.is_some_and(|(t, _)| t == distance)), "{size} {distance}: {t:?}");
        }
    }

    /// The slope along x is subnormal or zero in `f32`.
    #[test]
    fn a_leaf_of_precise_triangles_loses_no_hit_to_underflow() {
        for (width, distance) in [(1e-29f32, 1e12f32), (1e-29, 1e14), (1e-25, 1e18), (1e-25, 1e20)] {
            let mut hits = 0;
            for i in 0..2000u16 {
                let part = |factor: u16| f32::from(i.wrapping_mul(factor) % 1009) / 1009.0 - 0.5;
                let corner = |k: u16| [part(3 + k) * width, part(7 + 2 * k), part(31 + k)];
                let [a, b, c] = [corner(0), corner(41), corner(97)];
                let center: [f32; 3] = core::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
                let origin = [center[0] + part(11) * width, -distance, center[2] + part(13)];
                let ray = Ray::new(origin, core::array::from_fn(|k| center[k] - origin[k]));
                let triangle = [Precise(Triangle::new(a, b, c))];
                let expected = crate::reference::closest_hit(&triangle, &ray);
                hits += usize::from(expected.is_some());
                assert_eq!(crate::Bvh::build(triangle).unwrap().closest_hit(&ray), expected, "{ray:?}");
            }
            assert!(hits > 1000, "{width} {distance}: {hits}");
        }
    }

    /// All weights of the only face ahead of the origin round to zero in `f64`.
    ///
    /// The weights are differences of products.
    #[test]
    fn a_flat_tetrahedron_around_the_origin_does_not_leak_in_f64() {
        let [a, b] = [-1.667_231_511_108_307_4, -1.562_852_918_119_195_2];
        let corners = [
            [a, -1.667_231_511_108_307_6, 1.0],
            [b, -1.562_852_918_119_195, 1.0],
            [-1.804_301_382_870_361_3, -1.804_301_382_870_361_1, 1.0],
            [1.634_375_342_070_289_8, 1.634_375_342_070_289_8, -1.0],
        ];
        let faces = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].map(|face| face.map(|i| corners[i]));
        let ray = Ray::new([0.0f64; 3], [0.0, 0.0, 1.0]);
        let hits: Vec<_> =
            faces.iter().filter_map(|&[a, b, c]| Triangle::new(a, b, c).intersect(&ray)).collect();
        assert!(!hits.is_empty());
        assert!(
            hits.iter().all(|(t, _)| (t - 9_674_296_178_797.0 / 1_626_008_410_828_155.0).abs() < 1e-9),
            "{hits:?}"
        );
    }

    #[test]
    fn the_watertight_box_is_a_little_larger_and_valid_for_all_finite_corners() {
        let triangle = Triangle::new([1e6f32, 1.0, 0.5], [1e6, 2.0, 0.5], [1e6, 1.0, 0.5]);
        let (exact, padded) = (Fast(triangle).aabb(), triangle.aabb());
        for axis in 0..3 {
            assert!(padded.min[axis] < exact.min[axis] && exact.max[axis] < padded.max[axis]);
            assert!(padded.extent()[axis] - exact.extent()[axis] < 1e-6 * (exact.max[axis] + 1.0));
        }
        let largest = Triangle::new([f32::MAX; 3], [f32::MIN; 3], [0.0, 1.0, f32::MAX]);
        assert!(largest.aabb().is_valid());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!Triangle::new([1.0, bad, 0.0], [1.0f32; 3], [2.0; 3]).aabb().is_valid());
        }
    }
}
