//! Primitives that are no place in space, and primitives that are no surface.

mod common {
    pub mod agreement;
    pub mod aimed;
    pub mod answers;
    pub mod heuristics;
    pub mod hostile;
}

use bvhkit::{
    Aabb, BuildError, Bvh, Flaw, Intersect, OnInvalid, PreparedRay, Primitive, Ray, Scalar, Sphere, Triangle,
};
use common::agreement::assert_agreement;
use common::aimed::{aimed, soup, triangles};
use common::answers::{Answers, Payload};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// With the primitive at `index` made invalid, a build fails and names it; a build that skips answers
/// as if it were not there, indices apart.
fn assert_rejected_or_skipped<P: Intersect<Payload: Payload> + Clone>(
    good: &[P],
    bad: &P,
    rays: &[Ray<P::Scalar>],
) {
    for index in [0, good.len() / 2, good.len()] {
        let mut primitives = good.to_vec();
        primitives.insert(index, bad.clone());
        match Bvh::build(&primitives) {
            Err(BuildError::InvalidPrimitive { index: named, .. }) => assert_eq!(named, index),
            other => panic!("accepted at {index}: {:?}", other.map(|bvh| bvh.len())),
        }
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

fn assert_bad_corners<S: Scalar>(bad: S) {
    let good = triangles::<S>(&soup(20), |_, x| x);
    let rays = aimed(&good);
    for place in 0..9 {
        let mut triangle = good[7];
        let corner = [&mut triangle.a, &mut triangle.b, &mut triangle.c].into_iter().nth(place / 3);
        corner.unwrap()[place % 3] = bad;
        assert_rejected_or_skipped(&good, &triangle, &rays);
    }
}

#[test]
fn an_infinity_in_any_corner_of_a_triangle() {
    assert_bad_corners(f32::INFINITY);
    assert_bad_corners(f32::NEG_INFINITY);
    assert_bad_corners(f64::INFINITY);
}

#[test]
fn a_nan_in_any_corner_of_a_triangle() {
    assert_bad_corners(f32::NAN);
    assert_bad_corners(f64::NAN);
}

#[test]
fn spheres_and_boxes() {
    let rays = aimed(&triangles::<f32>(&soup(20), |_, x| x));
    let spheres: Vec<_> = soup(20).iter().map(|[a, ..]| Sphere::new(a.map(|x| x as f32), 0.25)).collect();
    let boxes: Vec<_> = spheres.iter().map(Primitive::aabb).collect();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut sphere, mut lower, mut upper) = (spheres[3], boxes[3], boxes[3]);
            (sphere.center[axis], lower.min[axis], upper.max[axis]) = (bad, bad, bad);
            assert_rejected_or_skipped(&spheres, &sphere, &rays);
            assert_rejected_or_skipped(&boxes, &lower, &rays);
            assert_rejected_or_skipped(&boxes, &upper, &rays);
        }
        assert_rejected_or_skipped(&spheres, &Sphere::new([0.0; 3], bad), &rays);
    }
    assert_rejected_or_skipped(&spheres, &Sphere::new([0.0; 3], -1.0), &rays);
    assert_rejected_or_skipped(&boxes, &Aabb::new([0.0, 1.0, 0.0], [1.0, 0.5, 1.0]), &rays);
}

/// A sphere that is sorted by a point of the test's choice.
#[derive(Clone, Debug)]
struct Sorted(Sphere, [f32; 3]);

impl Primitive for Sorted {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
    fn centroid(&self) -> [f32; 3] {
        self.1
    }
}

impl Intersect for Sorted {
    type Payload = ();
    fn intersect(&self, ray: &PreparedRay) -> Option<(f32, ())> {
        self.0.intersect(ray)
    }
}

#[test]
fn a_centroid_that_is_no_point() {
    let rays = aimed(&triangles::<f32>(&soup(20), |_, x| x));
    let sphere = |[a, ..]: &[[f64; 3]; 3]| Sphere::new(a.map(|x| x as f32), 0.25);
    // A centroid far from its box is odd, but no error.
    let good: Vec<_> = soup(20).iter().map(|corners| Sorted(sphere(corners), [9.0, 0.0, 0.0])).collect();
    assert!(assert_agreement(&good, &rays) > 100);
    for bad in [f32::NAN, f32::INFINITY] {
        let bad = Sorted(good[5].0, [0.0, bad, 0.0]);
        let error = Bvh::build([bad.clone()]).unwrap_err();
        assert_eq!(error, BuildError::InvalidPrimitive { index: 0, flaw: Flaw::Centroid });
        assert_rejected_or_skipped(&good, &bad, &rays);
    }
}

#[test]
fn all_invalid_is_as_empty() {
    let spheres = [Sphere::new([f32::NAN; 3], 1.0); 5];
    let bvh = Bvh::builder().on_invalid(OnInvalid::Skip).build(&spheres).unwrap();
    assert_eq!((bvh.len(), bvh.skipped()), (0, &[0, 1, 2, 3, 4][..]));
    assert_eq!(assert_agreement(&spheres, &[Ray::new([0.0; 3], [1.0, 0.0, 0.0])]), 0);
}

#[test]
fn a_triangle_without_area_is_counted_but_never_hit() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut point = || [0.0; 3].map(|_: f32| rng.random_range(-1.0..1.0f32));
    for _ in 0..1000 {
        let (a, b, origin) = (point(), point(), point());
        // Three segments and a point.
        let flat =
            [Triangle::new(a, a, b), Triangle::new(a, b, a), Triangle::new(a, b, b), Triangle::new(a, a, a)];
        let bvh = Bvh::build(flat).unwrap();
        assert_eq!(bvh.len(), 4);
        for target in [a, b, [0, 1, 2].map(|k| (a[k] + b[k]) * 0.5)] {
            let ray = Ray::new(origin, [0, 1, 2].map(|k| target[k] - origin[k]));
            assert_eq!(bvh.closest_hit(&ray), None, "{flat:?} {ray:?}");
        }
    }
}
