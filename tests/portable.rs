//! Compares the path without vector instructions with the naive loop, bit for bit.
//!
//! The test is a program of its own, behind the feature `portable`: portable code for
//! sixteen lanes takes long to compile.
#![cfg(feature = "portable")]

mod common {
    pub mod answers;
    pub mod naive;
    pub mod soups;
}

use bvhkit::{Bvh, InstructionSet, Intersect, Ray, Scalar, Sphere, Triangle};
use common::answers::Payload;
use common::naive::Naive;
use common::soups::{self, KINDS};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn compare<S: Scalar, P: Intersect<Scalar = S, Payload: Payload>>(of: impl Fn(&Triangle<S>) -> P) {
    let (mut hits, mut rng) = (0, Pcg64Mcg::seed_from_u64(16));
    for turn in 0..20 * KINDS {
        let size = rng.random_range(1..=200);
        let soup = soups::soup::<S>(turn % KINDS, size, &mut rng);
        let primitives: Vec<P> = soup.iter().map(&of).collect();
        let rays: Vec<Ray<S>> = (0..20).map(|_| soups::ray(&soup, &mut rng)).collect();
        let naive = Naive::new(&primitives, &rays);
        hits += naive.hits();
        let builder = Bvh::builder().instruction_set(InstructionSet::Portable);
        naive.assert_same(builder, format_args!("turn {turn}"));
    }
    assert!(hits > 1000, "{hits} hits");
}

#[test]
fn triangles() {
    compare::<f32, _>(|triangle| *triangle);
    compare::<f64, _>(|triangle| *triangle);
}

#[test]
fn spheres() {
    compare::<f32, _>(|triangle| {
        let extent = triangle.b[0] - triangle.a[0];
        Sphere::new(triangle.a, extent.abs())
    });
}
