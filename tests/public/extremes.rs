//! Extreme coordinates: documented answers, equal to those of the naive loop.
//!
//! They are tested in every triangle mode. The tests of each kind of extreme input:
//!
//! - Coordinates from subnormal to the largest:
//!   `coordinates_from_the_smallest_to_the_largest_number` and `an_overflow_is_no_hit_at_infinity`
//!   in this file; `*_at_all_sizes` in `../exact/closed_meshes.rs`. Any exponent and any bits:
//!   `properties.rs` and `random_bits.rs`.
//! - Direction components that are +-0 or subnormal, and directions that are all zero:
//!   `plus_zero_and_minus_zero_are_the_same_direction`, `*subnormal*` and
//!   `invalid_rays_hit_and_visit_nothing` in `extreme_rays.rs`; `../exact/grid.rs`.
//! - A ray in the plane of a box's face: `a_ray_in_the_plane_of_a_face_*` and
//!   `a_coplanar_triangle_misses_*` in `extreme_rays.rs`; `../exact/grid.rs`.
//! - An origin on or inside a surface: `the_interval_is_closed_at_a_surface` and
//!   `an_origin_inside_*` in `extreme_rays.rs`; `../exact/grid.rs`.
//! - t_min > t_max, and NaN or infinity in a ray:
//!   `invalid_rays_hit_and_visit_nothing` in `extreme_rays.rs`.
//! - NaN or infinity in a primitive: `invalid_primitives.rs`.
//! - Triangles without area: `a_triangle_without_area_*` in `invalid_primitives.rs`;
//!   `../exact/grid.rs`. Slivers: `slivers_a_million_times_as_long_as_wide` in this file.
//! - A million equal primitives or centroids: `a_million_*` and
//!   `of_equal_primitives_the_first_is_hit` in `hostile.rs`.
//! - 0 or 1 primitive: `none_or_one_triangle` and `none_or_one_primitive` in this file.
//! - Hostile heuristics: `hostile_heuristics_*` and `a_bad_split_*` in `hostile.rs`;
//!   also every test of agreement.
//! - A teapot in a stadium, meshes far from the origin, all sizes: the tests of these names in this
//!   file. Without a leak: `../exact/closed_meshes.rs`.
//! - More primitives than indices: `more_primitives_than_indices*` in `hostile.rs`.
//! - `max_leaf_size` of 0 or huge: `a_leaf_size_of_zero_*` in `hostile.rs`.

use crate::common::agreement::assert_agreement;
use crate::common::aimed::{aimed, soup, triangles};
use crate::common::in_every_mode::in_every_mode;
use crate::common::modes::Mode;
use crate::common::range::Range;
use bvhkit::{Aabb, Bvh, Ray, Scalar, Sphere, Triangle};

/// Compares triangles in mode `M` with the naive loop; returns the number of hits.
fn agreement<M: Mode>(triangles: &[Triangle<M::Number>]) -> usize {
    let in_mode: Vec<_> = triangles.iter().copied().map(M::of).collect();
    assert_agreement(&in_mode, &aimed(triangles))
}

/// Calls [`agreement`] for a soup with changed coordinates.
fn agree<M: Mode>(change: impl Fn(usize, f64) -> f64) -> usize {
    agreement::<M>(&triangles(&soup(60), change))
}

fn coordinates_from_the_smallest_to_the_largest_number<M: Range>() {
    let (smallest, largest, step) = if size_of::<M::Number>() == 4 { (-45, 38, 3) } else { (-324, 307, 40) };
    // Exponents at which products overflow in f64, although the
    // coordinates are far inside the range.
    let products_overflow = if size_of::<M::Number>() == 4 { 0..0 } else { 152..184 };
    for exponent in (smallest..=largest).step_by(step).chain(products_overflow.step_by(4)) {
        let scale = 10f64.powi(exponent);
        let hits = agree::<M>(|_, x| x * scale);
        let is_in_range = M::RANGE[0] * 10.0 <= scale && scale * 10.0 <= M::RANGE[1];
        assert!(hits > 100 || !is_in_range, "{hits} hits at 1e{exponent}");
    }
}

fn all_sizes_in_one_scene<M: Mode>() {
    assert!(agree::<M>(|i, x| x * 10f64.powi(i as i32 % 13 - 6)) > 100);
}

fn a_mesh_far_from_the_origin<M: Mode>() {
    for shift in [1e7, -1e7] {
        assert!(agree::<M>(|_, x| x * 100.0 + shift) > 100);
    }
}

fn a_teapot_in_a_stadium<M: Mode>() {
    // The last ten triangles are the stadium.
    for size in [1e4, 1e6] {
        assert!(agree::<M>(|i, x| if i < 50 { x } else { x * size }) > 100);
    }
}

fn slivers_a_million_times_as_long_as_wide<M: Mode>() {
    let sliver = |[a, b, c]: [[f64; 3]; 3]| [a, b, [0, 1, 2].map(|k| b[k] + (c[k] - b[k]) * 1e-6)];
    let slivers: Vec<_> = soup(60).into_iter().map(sliver).collect();
    assert!(agreement::<M>(&triangles(&slivers, |_, x| x)) > 100);
}

fn an_overflow_is_no_hit_at_infinity<M: Mode>() {
    // The product of the sides is near the smallest number, and its reciprocal is infinite.
    let side = M::Number::from_f64(if size_of::<M::Number>() == 4 { 1e-20 } else { 1e-160 });
    let (zero, one, inside) = (M::Number::ZERO, M::Number::ONE, side * M::Number::from_f64(0.2));
    let speck = [M::of(Triangle::new([zero; 3], [side, zero, zero], [zero, side, zero]))];
    let ray = Ray::new([inside, inside, one], [zero, zero, -one]);
    let hit = Bvh::build(&speck).unwrap().closest_hit(&ray);
    assert!(hit.is_none_or(|hit| hit.t.is_finite()), "{hit:?}");
    assert_agreement(&speck, &[ray]);
    // A huge triangle far away: t itself is beyond the largest number.
    let is_single = size_of::<M::Number>() == 4;
    let [huge, tiny] = if is_single { [1e30, 1e-30] } else { [1e250, 1e-250] }.map(M::Number::from_f64);
    let wall = [M::of(Triangle::new([-huge, -huge, huge], [huge, -huge, huge], [zero, huge, huge]))];
    assert_eq!(assert_agreement(&wall, &[Ray::new([zero; 3], [zero, zero, tiny])]), 0);
}

in_every_mode! {
    coordinates_from_the_smallest_to_the_largest_number
    all_sizes_in_one_scene
    a_mesh_far_from_the_origin
    a_teapot_in_a_stadium
    slivers_a_million_times_as_long_as_wide
    an_overflow_is_no_hit_at_infinity
    none_or_one_triangle
}

fn none_or_one_triangle<M: Mode>() {
    let one = triangles::<M::Number>(&soup(1), |_, x| x);
    let rays = aimed(&one);
    assert_eq!(assert_agreement::<M>(&[], &rays), 0);
    assert!(agreement::<M>(&one) > 0);
}

#[test]
fn none_or_one_primitive() {
    let ray = Ray::new([0.0f32, 0.0, -2.0], [0.0, 0.0, 1.0]);
    assert_eq!(assert_agreement::<Sphere>(&[], &[ray]), 0);
    assert_eq!(assert_agreement(&[Sphere::new([0.0; 3], 1.0)], &[ray]), 1);
    let empty = Bvh::<Sphere>::build([]).unwrap();
    assert_eq!((empty.len(), empty.aabb(), empty.report().leaves), (0, Aabb::EMPTY, 0));
    let one = Bvh::build([Sphere::new([0.0f32; 3], 1.0)]).unwrap().report();
    assert_eq!((one.leaves, one.inner_nodes, one.max_depth), (1, 0, 0));
}
