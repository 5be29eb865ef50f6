//! The extremes of coordinates, directions and intervals: documented answers, equal to the naive loop's.

mod common {
    pub mod agreement;
    pub mod aimed;
    pub mod answers;
    pub mod heuristics;
    pub mod hostile;
}

use bvhkit::{Aabb, Bvh, Counters, Hit, Ray, RayError, Scalar, Sphere, Triangle};
use common::agreement::assert_agreement;
use common::aimed::{aimed, soup, triangles};

/// The soup with its coordinates changed agrees with the naive loop; returns the number of hits.
fn agree<S: Scalar>(change: impl Fn(usize, f64) -> f64) -> usize {
    let triangles = triangles::<S>(&soup(60), change);
    assert_agreement(&triangles, &aimed(&triangles))
}

#[test]
fn coordinates_from_the_smallest_to_the_largest_number() {
    for exponent in (-45..=38).step_by(3) {
        let hits = agree::<f32>(|_, x| x * 10f64.powi(exponent));
        assert!(hits > 100 || exponent.abs() > 9, "{hits} hits at 1e{exponent}");
    }
    for exponent in (-324..=307).step_by(40) {
        let hits = agree::<f64>(|_, x| x * 10f64.powi(exponent));
        assert!(hits > 100 || exponent.abs() > 90, "{hits} hits at 1e{exponent}");
    }
}

#[test]
fn all_sizes_in_one_scene() {
    let size = |i: usize| 10f64.powi(i as i32 % 13 - 6);
    assert!(agree::<f32>(|i, x| x * size(i)) > 100);
    assert!(agree::<f64>(|i, x| x * size(i)) > 100);
}

#[test]
fn a_mesh_far_from_the_origin() {
    for shift in [1e7, -1e7] {
        assert!(agree::<f32>(|_, x| x * 100.0 + shift) > 100);
        assert!(agree::<f64>(|_, x| x + shift) > 100);
    }
}

#[test]
fn a_teapot_in_a_stadium() {
    // The last ten are the stadium.
    assert!(agree::<f32>(|i, x| if i < 50 { x * 0.01 } else { x * 1e4 }) > 100);
    assert!(agree::<f64>(|i, x| if i < 50 { x * 0.01 } else { x * 1e4 }) > 100);
}

#[test]
fn slivers_a_million_times_as_long_as_wide() {
    let sliver = |[a, b, c]: [[f64; 3]; 3]| [a, b, [0, 1, 2].map(|k| b[k] + (c[k] - b[k]) * 1e-6)];
    let slivers: Vec<_> = soup(60).into_iter().map(sliver).collect();
    let narrow = triangles::<f32>(&slivers, |_, x| x);
    assert!(assert_agreement(&narrow, &aimed(&narrow)) > 100);
    let narrow = triangles::<f64>(&slivers, |_, x| x);
    assert!(assert_agreement(&narrow, &aimed(&narrow)) > 100);
}

#[test]
fn plus_zero_and_minus_zero_are_the_same_direction() {
    let triangles = triangles::<f32>(&soup(60), |_, x| (x * 4.0).round());
    let bvh = Bvh::build(&triangles).unwrap();
    let mut hits = 0;
    for (i, triangle) in triangles.iter().enumerate() {
        let signs = [[0.0, 0.0], [0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0]];
        let rays = signs.map(|[x, y]| {
            let mut direction = [x, y, 1.0];
            direction.rotate_right(i % 3);
            Ray::new(triangle.a, direction)
        });
        let answers = rays.map(|ray| bvh.hits(&ray).collect::<Vec<_>>());
        hits += answers[0].len();
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        assert_agreement(&triangles, &rays);
    }
    assert!(hits > 60);
}

#[test]
fn a_ray_in_the_plane_of_a_face_meets_the_boxes_on_both_sides() {
    // Four by four by four unit boxes that touch.
    let corner = |i: u8| [i % 4, i / 4 % 4, i / 16].map(f32::from);
    let boxes: Vec<_> = (0..64).map(|i| Aabb::new(corner(i), corner(i).map(|x| x + 1.0))).collect();
    let bvh = Bvh::build(&boxes).unwrap();
    for zero in [0.0, -0.0] {
        for (y, z, rows) in [(1.0, 0.5, 2), (4.0, 0.5, 1), (0.0, 0.5, 1), (2.0, 3.0, 4), (0.0, 4.0, 1)] {
            for (x, length) in [(-1.0, 1.0), (5.0, -2.0)] {
                let ray = Ray::new([x, y, z], [length, zero, zero]);
                assert_eq!(bvh.hits(&ray).count(), 4 * rows, "{ray:?}");
                assert_agreement(&boxes, &[ray]);
            }
        }
        assert!(!bvh.any_hit(&Ray::new([-1.0, 4.0f32.next_up(), 0.5], [1.0, zero, zero])));
    }
}

#[test]
fn a_coplanar_triangle_misses_and_its_neighbour_across_the_edge_hits() {
    let floor = Triangle::new([0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]);
    let wall = Triangle::new([1.0f32, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]);
    let ray = Ray::new([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]);
    let found: Vec<_> = Bvh::build([floor, wall]).unwrap().hits(&ray).map(|hit| (hit.index, hit.t)).collect();
    assert_eq!(found, [(1, 2.0)]);
    assert_agreement(&[floor, wall], &[ray]);
}

#[test]
fn the_interval_is_closed_at_a_surface() {
    let floor = [Triangle::new([-1.0f32, -1.0, 3.0], [1.0, -1.0, 3.0], [0.0, 1.0, 3.0])];
    let bvh = Bvh::build(&floor).unwrap();
    let up = Ray::new([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]);
    for ray in [up, Ray { direction: [0.0, 0.0, -1.0], ..up }, up.with_interval(0.0, 0.0)] {
        let t = bvh.closest_hit(&ray).map(|hit| hit.t.to_bits());
        assert_eq!(t, Some(0.0f32.to_bits()), "plus zero, {ray:?}");
    }
    assert!(!bvh.any_hit(&up.with_interval(f32::from_bits(1), 1.0)));
    let below = Ray::new([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    assert!(bvh.any_hit(&below.with_interval(2.0, 2.0)));
    assert!(bvh.any_hit(&below.with_interval(0.0, 2.0)));
    assert!(!bvh.any_hit(&below.with_interval(2.0f32.next_up(), 9.0)));
    assert!(!bvh.any_hit(&below.with_interval(0.0, 2.0f32.next_down())));
}

#[test]
fn an_axis_aligned_triangle_behind_the_origin_is_hit_at_a_negative_t() {
    let floor = [Triangle::new([-1.0f32, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0])];
    let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, 1.0]).with_interval(-10.0, 10.0);
    let t = Bvh::build(&floor).unwrap().closest_hit(&ray).map(|hit| hit.t);
    assert!(t.is_some_and(|t| (t + 5.0).abs() < 1e-5), "{t:?}");
}

#[test]
fn an_overflow_is_no_hit_at_infinity() {
    // The determinant is the smallest number, and its reciprocal infinite.
    let speck = [Triangle::new([0.0f32; 3], [1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0])];
    let ray = Ray::new([2e-21, 2e-21, 1.0], [0.0, 0.0, -1.0]);
    let hit = Bvh::build(&speck).unwrap().closest_hit(&ray);
    assert!(hit.is_none_or(|hit| hit.t.is_finite()), "{hit:?}");
    assert_agreement(&speck, &[ray]);
}

/// Asks everything there is to ask of a ray that hits nothing, and that nothing is visited for it.
fn assert_unanswered(ray: &Ray, error: RayError) {
    let spheres = [Sphere::new([0.0f32; 3], 1.0), Sphere::new([3.0, 0.0, 0.0], 1e9)];
    let bvh = Bvh::builder().max_leaf_size(1).build(&spheres).unwrap();
    let mut counters = Counters::default();
    assert_eq!(ray.validate(), Err(error), "{ray:?}");
    assert_eq!(bvh.closest_hit_with(ray, &mut counters), None);
    assert!(!bvh.any_hit_with(ray, &mut counters));
    assert_eq!(bvh.hits_with(ray, &mut counters).collect::<Vec<Hit<_, _>>>(), []);
    assert_eq!(counters, Counters::default(), "{ray:?}");
    assert_agreement(&spheres, &[*ray]);
}

#[test]
fn invalid_rays_hit_and_visit_nothing() {
    let good = Ray::new([0.0f32; 3], [1.0, 0.0, 0.0]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut origin, mut direction) = (good, good);
            origin.origin[axis] = bad;
            direction.direction[axis] = bad;
            assert_unanswered(&origin, RayError::Origin);
            assert_unanswered(&direction, RayError::Direction);
        }
    }
    for zero in [[0.0; 3], [-0.0; 3], [0.0, -0.0, 0.0]] {
        assert_unanswered(&Ray::new([0.0; 3], zero), RayError::ZeroDirection);
    }
    for (t_min, t_max) in [(1.0, 0.5), (f32::NAN, 1.0), (0.0, f32::NAN), (f32::INFINITY, f32::NEG_INFINITY)] {
        assert_unanswered(&good.with_interval(t_min, t_max), RayError::Interval);
    }
}

#[test]
fn a_subnormal_direction_is_valid() {
    let wall = [Aabb::new([-1.0f32, -1.0, 1e-40], [1.0, 1.0, 1.0])];
    let ray = Ray::new([0.0; 3], [0.0, 0.0, 1e-40]);
    assert_eq!(ray.validate(), Ok(()));
    assert_agreement(&wall, &[ray]);
    let wall = [Aabb::new([-1.0f64, -1.0, 1e-300], [1.0, 1.0, 1.0])];
    assert_eq!(assert_agreement(&wall, &[Ray::new([0.0; 3], [0.0, 0.0, 1e-307])]), 1);
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
