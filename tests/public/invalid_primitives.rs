//! Primitives with invalid boxes, and triangles without area.

use crate::common::agreement::assert_agreement;
use crate::common::aimed::{aimed, soup, triangles};
use crate::common::answers::{Answers, Payload};
use crate::common::in_every_mode::in_every_mode;
use crate::common::modes::Mode;
use bvhkit::{
    Aabb, BuildError, Bvh, Intersect, InvalidBox, OnInvalid, Primitive, Ray, Scalar, Sphere, Triangle,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Inserts `bad` at several indices and checks how builds treat it.
///
/// A default build fails and names the index. A build that skips invalid primitives answers as if
/// `bad` were absent, apart from the shifted indices.
fn assert_rejected_or_skipped<P: Intersect<Payload: Payload> + Clone>(
    good: &[P],
    bad: &P,
    reason: InvalidBox,
    rays: &[Ray<P::Scalar>],
) {
    for index in [0, good.len() / 2, good.len()] {
        let mut primitives = good.to_vec();
        primitives.insert(index, bad.clone());
        let rejected = Bvh::build(&primitives).map(|bvh| bvh.len());
        assert_eq!(rejected, Err(BuildError::InvalidPrimitive { index, reason }));
        let bvh = Bvh::builder().on_invalid(OnInvalid::Skip).build(&primitives).unwrap();
        assert_eq!((bvh.len(), bvh.skipped()), (good.len(), &[index as u32][..]));
        for ray in rays {
            let mut answers = Answers::naive(good, ray);
            for (_, hit, _) in answers.hits.iter_mut().chain(&mut answers.closest) {
                *hit += usize::from(*hit >= index);
            }
            assert_eq!(Answers::of(&bvh, ray), answers, "{ray:?}");
        }
        assert_agreement(&primitives, &rays[..8]);
    }
}

fn a_nan_or_an_infinity_in_any_corner_of_a_triangle<M: Mode>() {
    let triangles = triangles::<M::Number>(&soup(20), |_, x| x);
    let good: Vec<_> = triangles.iter().copied().map(M::of).collect();
    let rays = aimed(&triangles);
    let flaws = [
        (f64::NAN, InvalidBox::NanBox),
        (-f64::NAN, InvalidBox::NanBox),
        (f64::INFINITY, InvalidBox::InfiniteBox),
        (f64::NEG_INFINITY, InvalidBox::InfiniteBox),
    ];
    for (bad, reason) in flaws {
        for place in 0..9 {
            let mut triangle = triangles[7];
            let corner = [&mut triangle.a, &mut triangle.b, &mut triangle.c].into_iter().nth(place / 3);
            corner.unwrap()[place % 3] = M::Number::from_f64(bad);
            assert_rejected_or_skipped(&good, &M::of(triangle), reason, &rays);
        }
    }
}

in_every_mode! {
    a_nan_or_an_infinity_in_any_corner_of_a_triangle
    a_triangle_without_area_is_counted_but_never_hit
}

#[test]
fn spheres_and_boxes() {
    let rays = aimed(&triangles::<f32>(&soup(20), |_, x| x));
    let spheres: Vec<_> = soup(20).iter().map(|[a, ..]| Sphere::new(a.map(|x| x as f32), 0.25)).collect();
    let boxes: Vec<_> = spheres.iter().map(Primitive::aabb).collect();
    // A minimum above its maximum is reported first, infinite or not.
    let (nan, infinite, inverted) = (InvalidBox::NanBox, InvalidBox::InfiniteBox, InvalidBox::InvertedBox);
    for (bad, reason, as_min, as_max, as_radius) in [
        (f32::NAN, nan, nan, nan, nan),
        (f32::INFINITY, infinite, inverted, infinite, infinite),
        (f32::NEG_INFINITY, infinite, infinite, inverted, inverted),
    ] {
        for axis in 0..3 {
            let (mut sphere, mut lower, mut upper) = (spheres[3], boxes[3], boxes[3]);
            (sphere.center[axis], lower.min[axis], upper.max[axis]) = (bad, bad, bad);
            assert_rejected_or_skipped(&spheres, &sphere, reason, &rays);
            assert_rejected_or_skipped(&boxes, &lower, as_min, &rays);
            assert_rejected_or_skipped(&boxes, &upper, as_max, &rays);
        }
        assert_rejected_or_skipped(&spheres, &Sphere::new([0.0; 3], bad), as_radius, &rays);
    }
    assert_rejected_or_skipped(&spheres, &Sphere::new([0.0; 3], -1.0), InvalidBox::InvertedBox, &rays);
    assert_rejected_or_skipped(
        &boxes,
        &Aabb::new([0.0, 1.0, 0.0], [1.0, 0.5, 1.0]),
        InvalidBox::InvertedBox,
        &rays,
    );
}

#[test]
fn all_invalid_is_as_empty() {
    let spheres = [Sphere::new([f32::NAN; 3], 1.0); 5];
    let bvh = Bvh::builder().on_invalid(OnInvalid::Skip).build(&spheres).unwrap();
    assert_eq!((bvh.len(), bvh.skipped()), (0, &[0, 1, 2, 3, 4][..]));
    assert_eq!(assert_agreement(&spheres, &[Ray::new([0.0; 3], [1.0, 0.0, 0.0])]), 0);
}

fn a_triangle_without_area_is_counted_but_never_hit<M: Mode>() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut point = || [0.0; 3].map(|_: f64| M::Number::from_f64(rng.random_range(-1.0..1.0)));
    for _ in 0..1000 {
        let (a, b, origin) = (point(), point(), point());
        // Three segments and a point.
        let flat =
            [[a, a, b], [a, b, a], [a, b, b], [a, a, a]].map(|[a, b, c]| M::of(Triangle::new(a, b, c)));
        let bvh = Bvh::build(flat).unwrap();
        assert_eq!(bvh.len(), 4);
        for target in [a, b, [0, 1, 2].map(|k| (a[k] + b[k]) * M::Number::HALF)] {
            let ray = Ray::new(origin, [0, 1, 2].map(|k| target[k] - origin[k]));
            assert!(bvh.closest_hit(&ray).is_none(), "{flat:?} {ray:?}");
        }
    }
}
