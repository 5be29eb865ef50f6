//! No leak: a ray from inside a closed mesh hits it, at every corner and edge.
//!
//! This holds for any size and place of the mesh, beside any other mesh, in the modes that promise
//! it. Fast triangles answer as their own naive loop.

use crate::common::answers::{Answers, key};
use crate::common::closed::{Closed, sphere, torus};
use crate::common::range::Range;
use bvhkit::{Bvh, Fast, Precise, Ray, Scalar, Triangle, Watertight};

/// Exponents of the powers of two that scale directions; they keep the aim.
const LENGTHS: [i32; 3] = [-40, 0, 12];

/// Returns the rays, their directions scaled by [`LENGTHS`] in turn.
///
/// Rays whose directions leave the mode's range are left out.
fn lengths<M: Range>(rays: &[Ray<M::Number>]) -> Vec<Ray<M::Number>> {
    let lengthened = |(i, ray): (usize, &Ray<M::Number>)| {
        // 7 is not a multiple of the period in which the kinds of rays repeat.
        let factor = M::Number::from_f64(2f64.powi(LENGTHS[i / 7 % 3]));
        Ray { direction: ray.direction.map(|x| x * factor), ..*ray }
    };
    let fits = |ray: &Ray<M::Number>| {
        let largest = ray.direction.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max);
        (M::RANGE[0]..M::RANGE[1]).contains(&largest)
    };
    rays.iter().enumerate().map(lengthened).filter(fits).collect()
}

/// Returns how many rays do not first hit one of the first `closed` triangles.
///
/// For every 40th ray, all answers are compared with the naive loop's.
fn leaks<M: Range>(scene: &[Triangle<M::Number>], closed: usize, rays: &[Ray<M::Number>]) -> usize {
    let scene: Vec<_> = scene.iter().copied().map(M::of).collect();
    let bvh = Bvh::build(&scene).unwrap();
    for ray in rays.iter().step_by(40) {
        assert_eq!(Answers::of(&bvh, ray), Answers::naive(&scene, ray), "{ray:?}");
    }
    let is_leak = |ray: &&Ray<M::Number>| {
        let hit = bvh.closest_hit(ray);
        assert_eq!(hit.is_some(), bvh.any_hit(ray));
        hit.is_none_or(|hit| hit.index >= closed)
    };
    let leaks: Vec<_> = rays.iter().filter(is_leak).collect();
    if let Some(ray) = leaks.first() {
        println!("{} of {} leak, first {ray:?} {:?}", leaks.len(), rays.len(), bvh.closest_hit(ray).map(key));
    }
    leaks.len()
}

fn alone<M: Range>(scale: f64, shift: [f64; 3]) -> usize {
    let leak = |mesh: Closed| {
        let mesh = mesh.moved(scale, shift);
        let triangles = mesh.triangles();
        let rays = lengths::<M>(&mesh.rays());
        assert!(rays.len() > 3000, "{} rays", rays.len());
        leaks::<M>(&triangles, triangles.len(), &rays)
    };
    leak(sphere()) + leak(torus())
}

fn at_all_sizes<M: Range>(exponents: impl Iterator<Item = i32>) {
    for exponent in exponents {
        assert_eq!(alone::<M>(10f64.powi(exponent), [0.0; 3]), 0, "at 1e{exponent}");
    }
}

#[test]
fn watertight_f32_at_all_sizes() {
    at_all_sizes::<Watertight<Triangle>>((-28..=35).step_by(7));
}

#[test]
fn precise_at_all_sizes() {
    at_all_sizes::<Precise<Triangle>>((-28..=35).step_by(7));
}

#[test]
fn watertight_f64_at_all_sizes() {
    at_all_sizes::<Watertight<Triangle<f64>>>((-98..=98).step_by(28));
}

#[test]
fn fast_answers_as_its_naive_loop_at_all_sizes_and_leaks_little() {
    for exponent in (-12..=12).step_by(6) {
        let fast = alone::<Fast<Triangle>>(10f64.powi(exponent), [0.0; 3]);
        let double = alone::<Fast<Triangle<f64>>>(10f64.powi(8 * exponent), [0.0; 3]);
        // Fewer than one in a hundred of some 20,000 rays at edges and corners.
        assert!(fast < 200 && double < 200, "{fast} and {double} at 1e{exponent}");
    }
}

#[test]
fn far_from_the_origin() {
    for (scale, shift) in [(1.0, 1e3), (100.0, 1e7), (100.0, -1e7), (1e5, 1e7), (1e-6, 0.1)] {
        for shift in [[shift; 3], [shift, 0.0, -shift], [0.0, shift, 0.0]] {
            let leaks = [
                alone::<Watertight<Triangle>>(scale, shift),
                alone::<Precise<Triangle>>(scale, shift),
                alone::<Watertight<Triangle<f64>>>(scale, shift),
            ];
            assert_eq!(leaks, [0; 3], "{scale} at {shift:?}");
        }
    }
}

/// Asserts that a teapot-sized sphere in a closed stadium has no leaks.
///
/// A ray from inside the sphere hits the sphere. A ray from between the two hits either.
fn in_a_stadium<M: Range>() {
    for size in [1e4, 1e5, 1e6] {
        let at = [0.3 * size, -0.2 * size, 0.1 * size];
        // So large that the sphere's rounded corners still surround its center.
        let (teapot, stadium) = (sphere().moved(4.0, at), torus().moved(size / 0.6, [0.65 * size, 0.0, 0.0]));
        let triangles = teapot.triangles();
        let count = triangles.len();
        let scene: Vec<_> = triangles.iter().copied().chain(stadium.triangles()).collect();
        assert_eq!(leaks::<M>(&scene, count, &lengths::<M>(&teapot.rays())), 0, "{size}");
        assert_eq!(leaks::<M>(&scene, scene.len(), &lengths::<M>(&stadium.rays())), 0, "{size}");
        let towards: Vec<_> = stadium
            .rays::<M::Number>()
            .iter()
            .zip(triangles.iter().cycle())
            .map(|(ray, triangle)| Ray::new(ray.origin, [0, 1, 2].map(|k| triangle.a[k] - ray.origin[k])))
            .collect();
        assert_eq!(leaks::<M>(&scene, scene.len(), &towards), 0, "{size}");
    }
}

#[test]
fn a_teapot_in_a_stadium() {
    in_a_stadium::<Watertight<Triangle>>();
    in_a_stadium::<Precise<Triangle>>();
    in_a_stadium::<Watertight<Triangle<f64>>>();
}

/// Asserts that spheres inside each other, of sizes 1e-6 to 1e6, have no leaks.
///
/// A ray from inside a sphere first hits that sphere or a smaller one.
fn nested<M: Range>() {
    let meshes: Vec<_> = (-6..=6).map(|exponent| sphere().moved(10f64.powi(exponent), [0.0; 3])).collect();
    let scene: Vec<_> = meshes.iter().flat_map(Closed::triangles).collect();
    let count = scene.len() / meshes.len();
    for (i, mesh) in meshes.iter().enumerate() {
        // From inside the mesh itself, but outside all smaller meshes.
        let rays: Vec<_> = mesh.rays().into_iter().filter(|ray| ray.origin[0] != M::Number::ZERO).collect();
        assert_eq!(leaks::<M>(&scene, count * (i + 1), &lengths::<M>(&rays)), 0, "{i}");
    }
}

#[test]
fn all_sizes_in_one_scene() {
    nested::<Watertight<Triangle>>();
    nested::<Precise<Triangle>>();
    nested::<Watertight<Triangle<f64>>>();
}
