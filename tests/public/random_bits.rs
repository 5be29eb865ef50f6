//! Arbitrary bytes as scene, rays and options: no panic, and the naive answer.

use crate::common::answers::{Answers, Payload};
use crate::common::heuristics;
use crate::common::modes::Mode;
use bvhkit::{
    Aabb, BuildError, Bvh, Fast, Intersect, OnInvalid, Precise, Ray, Scalar, Sphere, Triangle, Watertight,
};
use proptest::prelude::*;

/// A reader of numbers from bytes; after the last byte it reads zeros.
struct Bytes<'a>(std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> usize {
        usize::from(self.0.next().copied().unwrap_or(0))
    }

    /// Returns the next number.
    ///
    /// Half of the numbers are small and whole, so that rays meet primitives. A quarter are
    /// multiples of 1/16, a few are special values, and the rest have the bits of any `f32`.
    fn number<S: Scalar>(&mut self) -> S {
        let special =
            [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::from(f32::MAX), 1e-45, f64::MAX];
        let x = match self.byte() {
            byte @ 0..128 => byte as f64 % 8.0 - 3.0,
            byte @ 128..192 => byte as f64 / 16.0 - 10.0,
            // So rare that some scenes are all valid.
            byte @ 192..195 => special[(self.byte() + byte) % special.len()],
            _ => f64::from(f32::from_bits((0..4).fold(0, |bits, _| bits << 8 | self.byte() as u32))),
        };
        S::from_f64(x)
    }

    fn point<S: Scalar>(&mut self) -> [S; 3] {
        [0; 3].map(|_| self.number())
    }

    fn ray<S: Scalar>(&mut self) -> Ray<S> {
        let ray = Ray::new(self.point(), self.point());
        if self.byte() < 128 { ray } else { ray.with_interval(self.number(), self.number()) }
    }
}

/// Builds and queries a tree whose options, primitives and rays come from `bytes`.
fn check<P: Intersect<Payload: Payload>>(bytes: &[u8], primitive: fn(&mut Bytes<'_>) -> P) {
    let mut bytes = Bytes(bytes.iter());
    let (heuristic, leaf_size, skip) = (bytes.byte(), bytes.byte(), bytes.byte());
    let primitives: Vec<P> = (0..bytes.byte() % 64).map(|_| primitive(&mut bytes)).collect();
    let max_leaf_size = match leaf_size {
        255 => usize::MAX,
        size => size % 10,
    };
    let heuristics = heuristics::all();
    let (name, heuristic) = &heuristics[heuristic % heuristics.len()];
    let on_invalid = if skip < 192 { OnInvalid::Skip } else { OnInvalid::Reject };
    let builder = Bvh::builder().heuristic(&**heuristic).max_leaf_size(max_leaf_size).on_invalid(on_invalid);

    let invalid = primitives.iter().position(|primitive| !primitive.aabb().is_valid());
    match builder.build(&primitives) {
        Ok(bvh) => {
            assert!(max_leaf_size > 0 && (invalid.is_none() || on_invalid == OnInvalid::Skip));
            assert_eq!(bvh.skipped().first().map(|&index| index as usize), invalid);
            bvh.check().unwrap();
            for _ in 0..16 {
                let ray = bytes.ray();
                assert_eq!(Answers::of(&bvh, &ray), Answers::naive(&primitives, &ray), "{name} {ray:?}");
            }
        }
        Err(BuildError::ZeroLeafSize) => assert_eq!(max_leaf_size, 0),
        Err(BuildError::InvalidPrimitive { index, .. }) => {
            assert_eq!((on_invalid, Some(index)), (OnInvalid::Reject, invalid));
        }
        Err(other) => panic!("{other}"),
    }
}

fn triangle<M: Mode>(bytes: &mut Bytes<'_>) -> M {
    M::of(Triangle::new(bytes.point(), bytes.point(), bytes.point()))
}

fn sphere<S: Scalar>(bytes: &mut Bytes<'_>) -> Sphere<S> {
    Sphere::new(bytes.point(), bytes.number())
}

fn cuboid<S: Scalar>(bytes: &mut Bytes<'_>) -> Aabb<S> {
    // Most boxes are not inverted.
    match bytes.byte() {
        0 => Aabb::new(bytes.point(), bytes.point()),
        _ => Aabb::of_points([bytes.point(), bytes.point()]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn any_bytes_at_all(bytes in prop::collection::vec(any::<u8>(), 0..3000)) {
        check(&bytes, triangle::<Fast<Triangle>>);
        check(&bytes, triangle::<Fast<Triangle<f64>>>);
        check(&bytes, triangle::<Watertight<Triangle>>);
        check(&bytes, triangle::<Watertight<Triangle<f64>>>);
        check(&bytes, triangle::<Precise<Triangle>>);
        check(&bytes, sphere::<f32>);
        check(&bytes, sphere::<f64>);
        check(&bytes, cuboid::<f32>);
        check(&bytes, cuboid::<f64>);
    }
}
