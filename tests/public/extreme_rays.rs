//! Extreme rays: origins, directions and intervals, in every triangle mode.

use crate::common::agreement::assert_agreement;
use crate::common::aimed::{aimed, soup, triangles};
use crate::common::answers::key;
use crate::common::in_every_mode::in_every_mode;
use crate::common::modes::Mode;
use bvhkit::{Aabb, Bvh, Counters, Ray, RayError, Scalar, Sphere, Triangle};

fn point<S: Scalar>(point: [f64; 3]) -> [S; 3] {
    point.map(S::from_f64)
}

fn triangle<M: Mode>([a, b, c]: [[f64; 3]; 3]) -> M {
    M::of(Triangle::new(point::<M::Number>(a), point::<M::Number>(b), point::<M::Number>(c)))
}

fn ray<S: Scalar>(origin: [f64; 3], direction: [f64; 3]) -> Ray<S> {
    Ray::new(point::<S>(origin), point::<S>(direction))
}

fn plus_zero_and_minus_zero_are_the_same_direction<M: Mode>() {
    let triangles = triangles::<M::Number>(&soup(60), |_, x| (x * 4.0).round());
    let scene: Vec<_> = triangles.iter().copied().map(M::of).collect();
    let bvh = Bvh::build(&scene).unwrap();
    let mut hits = 0;
    for (i, triangle) in triangles.iter().enumerate() {
        let signs = [[0.0, 0.0], [0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0]];
        let rays = signs.map(|[x, y]| {
            let mut direction = [x, y, 1.0];
            direction.rotate_right(i % 3);
            Ray::new(triangle.a, point::<M::Number>(direction))
        });
        // Compared with `==`, not by bits: barycentrics may differ in the sign of a zero.
        let answers = rays.map(|ray| bvh.hits(&ray).collect::<Vec<_>>());
        hits += answers[0].len();
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        assert_agreement(&scene, &rays);
    }
    assert!(hits > 60);
}

fn a_coplanar_triangle_misses_and_its_neighbour_across_the_edge_hits<M: Mode>() {
    let scene = [
        triangle::<M>([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]),
        triangle([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]]),
    ];
    for zero in [0.0, -0.0] {
        let ray = ray([-1.0, 0.25, 0.0], [1.0, zero, zero]);
        let hits =
            Bvh::build(scene).unwrap().hits(&ray).map(|hit| (hit.index, hit.t.to_f64())).collect::<Vec<_>>();
        assert_eq!(hits, [(1, 2.0)]);
        assert_agreement(&scene, &[ray]);
    }
}

fn the_interval_is_closed_at_a_surface<M: Mode>() {
    let s = M::Number::from_f64;
    let scene = [triangle::<M>([[-1.0, -1.0, 3.0], [1.0, -1.0, 3.0], [0.0, 1.0, 3.0]])];
    let bvh = Bvh::build(&scene).unwrap();
    let up = ray([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]);
    let down = ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]);
    for ray in [up, down, up.with_interval(s(0.0), s(0.0)), up.with_interval(s(-0.0), s(1.0))] {
        let t = bvh.closest_hit(&ray).map(|hit| key(hit).0);
        assert_eq!(t, Some(0), "plus zero, {ray:?}");
        assert_agreement(&scene, &[ray]);
    }
    let least = s(0.0).next_up();
    let below = ray([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    for ray in [below.with_interval(s(2.0), s(2.0)), below.with_interval(s(0.0), s(2.0))] {
        assert!(bvh.any_hit(&ray), "{ray:?}");
        assert_eq!(assert_agreement(&scene, &[ray]), 1);
    }
    for ray in [
        up.with_interval(least, s(1.0)),
        below.with_interval(s(2.0).next_up(), s(9.0)),
        below.with_interval(s(0.0), s(2.0).next_down()),
    ] {
        assert!(!bvh.any_hit(&ray), "{ray:?}");
        assert_agreement(&scene, &[ray]);
    }
}

/// Traces a ray again with the interval [t, t] of each hit, and finds a hit at that t.
fn a_hit_is_found_again_at_its_own_t<M: Mode>() {
    let scene: Vec<_> =
        triangles::<M::Number>(&soup(60), |_, x| (x * 4.0).round()).into_iter().map(M::of).collect();
    let bvh = Bvh::build(&scene).unwrap();
    // Vertices are whole numbers and the direction is a power of two, so only the division rounds.
    let ray = ray([0.25, 0.125, -8.0], [0.0, 0.0, 0.5]);
    let hits: Vec<_> = bvh.hits(&ray).collect();
    assert!(hits.len() > 3);
    for hit in hits {
        let again = bvh.closest_hit(&ray.with_interval(hit.t, hit.t));
        assert!(again.is_some_and(|again| again.t == hit.t && again.index <= hit.index), "{hit:?} {again:?}");
    }
}

fn an_axis_aligned_triangle_behind_the_origin_is_hit_at_a_negative_t<M: Mode>() {
    let s = M::Number::from_f64;
    let floor = [triangle::<M>([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]])];
    let ray = ray([0.0, 0.0, 5.0], [0.0, 0.0, 1.0]).with_interval(s(-10.0), s(10.0));
    let t = Bvh::build(&floor).unwrap().closest_hit(&ray).map(|hit| hit.t.to_f64());
    assert!(t.is_some_and(|t| (t + 5.0).abs() < 1e-5), "{t:?}");
}

/// Box tests treat the least subnormal component as zero, since its inverse is infinite.
///
/// The hits have to be the same as with a component of zero.
fn subnormal_components_beside_ordinary_ones<M: Mode>() {
    let least = M::Number::ZERO.next_up();
    let triangles = triangles::<M::Number>(&soup(60), |_, x| x * 4.0);
    let scene: Vec<_> = triangles.iter().copied().map(M::of).collect();
    let zeros: Vec<_> = aimed(&triangles).into_iter().skip(3).step_by(4).collect();
    let subnormal = |x: M::Number| if x == M::Number::ZERO { least.xor_sign(x) } else { x };
    let rays: Vec<_> =
        zeros.iter().map(|ray| Ray { direction: ray.direction.map(subnormal), ..*ray }).collect();
    // These rays aim at corners, where the smallest change of direction may decide.
    assert!(assert_agreement(&scene, &rays) > 20);
    for (i, (triangle, &zero)) in triangles.iter().zip(&zeros).enumerate() {
        let (Triangle { a, b, c }, half) = (*triangle, M::Number::HALF);
        let mut middle = [0, 1, 2].map(|k| (a[k] * half + b[k] * half) * half + c[k] * half);
        middle[i % 3] = zero.origin[i % 3];
        let zero = Ray { origin: middle, ..zero };
        let hits = assert_agreement(&scene, &[zero]);
        let beside = Ray { direction: zero.direction.map(subnormal), ..zero };
        assert!(hits > 0 && hits == assert_agreement(&scene, &[beside]), "{hits}, {zero:?}");
    }
}

fn a_subnormal_direction_is_valid<M: Mode>() {
    let tiny = M::Number::ZERO.next_up();
    let wall = triangle::<M>([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]]);
    for direction in [[tiny; 3], [M::Number::ZERO, M::Number::ZERO, tiny]] {
        let ray = Ray::new([M::Number::ZERO; 3], direction);
        assert_eq!(ray.validate(), Ok(()));
        // The wall is at a t beyond the largest number, which is a miss.
        assert_eq!(assert_agreement(&[wall], &[ray]), 0);
    }
}

/// Asserts that an invalid ray gives `error`, hits nothing and visits no node.
fn assert_unanswered<M: Mode>(ray: &Ray<M::Number>, error: RayError) {
    let scene: Vec<_> = triangles::<M::Number>(&soup(9), |_, x| x).into_iter().map(M::of).collect();
    let bvh = Bvh::builder().max_leaf_size(1).build(&scene).unwrap();
    let mut counters = Counters::default();
    assert_eq!(ray.validate(), Err(error), "{ray:?}");
    assert!(bvh.closest_hit_with(ray, &mut counters).is_none());
    assert!(!bvh.any_hit_with(ray, &mut counters));
    assert_eq!(bvh.hits_with(ray, &mut counters).count(), 0);
    assert_eq!(counters, Counters::default(), "{ray:?}");
    assert_agreement(&scene, &[*ray]);
}

fn invalid_rays_hit_and_visit_nothing<M: Mode>() {
    let s = M::Number::from_f64;
    let good = ray([0.0; 3], [1.0, 0.0, 0.0]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(s) {
        for axis in 0..3 {
            let (mut origin, mut direction) = (good, good);
            origin.origin[axis] = bad;
            direction.direction[axis] = bad;
            assert_unanswered::<M>(&origin, RayError::Origin);
            assert_unanswered::<M>(&direction, RayError::Direction);
        }
    }
    for zero in [[0.0; 3], [-0.0; 3], [0.0, -0.0, 0.0]] {
        assert_unanswered::<M>(&ray([0.0; 3], zero), RayError::ZeroDirection);
    }
    let (nan, infinity) = (f64::NAN, f64::INFINITY);
    for (t_min, t_max) in [(1.0, 0.5), (nan, 1.0), (0.0, nan), (nan, nan), (infinity, -infinity)] {
        assert_unanswered::<M>(&good.with_interval(s(t_min), s(t_max)), RayError::Interval);
    }
    assert_unanswered::<M>(&good.with_interval(s(0.0), -s(0.0).next_up()), RayError::Interval);
}

in_every_mode! {
    plus_zero_and_minus_zero_are_the_same_direction
    a_coplanar_triangle_misses_and_its_neighbour_across_the_edge_hits
    the_interval_is_closed_at_a_surface
    a_hit_is_found_again_at_its_own_t
    an_axis_aligned_triangle_behind_the_origin_is_hit_at_a_negative_t
    subnormal_components_beside_ordinary_ones
    a_subnormal_direction_is_valid
    invalid_rays_hit_and_visit_nothing
}

#[test]
fn a_ray_in_the_plane_of_a_face_meets_the_boxes_on_both_sides() {
    // A grid of 4 x 4 x 4 unit boxes that touch.
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
fn an_origin_inside_a_solid_hits_its_far_side() {
    let inside = ray([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(Bvh::build([Sphere::new([0.0f32; 3], 1.0)]).unwrap().closest_hit(&inside).unwrap().t, 0.5);
    let unit = Bvh::build([Aabb::new([-1.0f32; 3], [1.0; 3])]).unwrap();
    assert_eq!(unit.closest_hit(&inside).unwrap().t, 0.5);
    // The origin is on the surface and the interval is closed at t_min: the
    // ray enters at 0 and leaves at 2.
    let on = ray([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(unit.closest_hit(&on).unwrap().t, 0.0);
    assert_eq!(unit.closest_hit(&on.with_interval(0.0f32.next_up(), 9.0)).unwrap().t, 2.0);
}
