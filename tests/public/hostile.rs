//! Builds that would break a careless driver.
//!
//! The inputs are hostile heuristics, equal primitives, and more primitives than indices.

use crate::common::heuristics;
use crate::common::in_every_mode::in_every_mode;
use crate::common::modes::Mode;
use bvhkit::heuristic::{BinnedSah, BuildNode, Heuristic, Median, Midpoint, Split, SweepSah};
use bvhkit::{
    Aabb, Axis, BuildError, Bvh, Intersect, MAX_DEPTH, OneByOne, Primitive, Quality, Ray, Scalar, Sphere,
    Traverse, Tree, Triangle, reference,
};
use std::sync::atomic::{AtomicU64, Ordering};

/// Returns `n` concentric spheres; they are identical if all radii are equal.
fn concentric(n: usize, radius: impl Fn(usize) -> f32) -> Vec<Sphere> {
    (0..n).map(|i| Sphere::new([1.0, 2.0, 3.0], radius(i))).collect()
}

/// A heuristic that counts the references it is shown.
///
/// The count measures the work of a build on any machine.
struct Counted<'a, H> {
    heuristic: H,
    references: &'a AtomicU64,
}

impl<H: Heuristic<f32>> Heuristic<f32> for Counted<'_, H> {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        self.references.fetch_add(node.references.len() as u64, Ordering::Relaxed);
        self.heuristic.split(node)
    }
}

/// A sphere that counts the calls of its `aabb`.
struct Asked<'a>(Sphere, &'a AtomicU64);

impl Primitive for Asked<'_> {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.aabb()
    }
}

impl Intersect for Asked<'_> {
    type Payload = ();
    type Leaf = OneByOne;
    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        self.0.intersect(ray)
    }
}

/// Builds over `n` spheres with one centroid and returns the work.
///
/// Also checks the tree and its closest hit.
fn work(n: usize, heuristic: impl Heuristic<f32>, radius: impl Fn(usize) -> f32) -> u64 {
    let spheres = concentric(n, &radius);
    let (references, boxes) = (AtomicU64::new(0), AtomicU64::new(0));
    let counted = Counted { heuristic, references: &references };
    let bvh =
        Bvh::builder().heuristic(counted).build(spheres.iter().map(|&sphere| Asked(sphere, &boxes))).unwrap();
    assert!(boxes.load(Ordering::Relaxed) <= 2 * n as u64, "a box is asked for once or twice");
    bvh.check().unwrap();
    assert!(bvh.report().max_depth <= MAX_DEPTH);
    // From outside, a ray first hits the largest sphere; of equal ones, the first.
    let first = (1..n).fold(0, |first, i| if radius(i) > radius(first) { i } else { first });
    let ray = Ray::new([1.0, 2.0, -20.0], [0.0, 0.0, 1.0]);
    let hit = bvh.closest_hit(&ray);
    assert_eq!(hit.map(|hit| hit.index), Some(first));
    assert_eq!(hit, reference::closest_hit(&spheres, &ray));
    drop(bvh);
    references.into_inner()
}

/// Asserts that four times as many primitives take at most 4.8 times the work.
///
/// For n log n the factor is 4.5.
fn assert_n_log_n(n: usize, heuristic: impl Heuristic<f32> + Copy) {
    let radii: [fn(usize) -> f32; 2] = [|_| 1.0, |i| 1.0 + (i % 1000) as f32 * 0.001];
    for radius in radii {
        let [small, large] = [n / 4, n].map(|n| work(n, heuristic, radius));
        assert!(large * 10 <= small * 48, "{small} references for {}, {large} for {n}", n / 4);
    }
}

#[test]
fn a_million_equal_primitives_or_centroids() {
    assert_n_log_n(1_000_000, Median);
    assert_n_log_n(1_000_000, Midpoint);
    assert_n_log_n(1_000_000, BinnedSah::default());
    assert_n_log_n(100_000, SweepSah::default());
}

fn of_equal_primitives_the_first_is_hit<M: Mode>() {
    let point = |x: [f64; 3]| x.map(M::Number::from_f64);
    let (a, b, c) = (point([0.0, 0.0, 3.0]), point([1.0, 0.0, 3.0]), point([0.0, 1.0, 3.5]));
    let triangles = [M::of(Triangle::new(a, b, c)); 1000];
    // Targets inside, on an edge and at a corner.
    for target in [[0.25, 0.25, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]] {
        let ray = Ray::new(point(target), point([0.0, 0.0, 1.0]));
        for (name, heuristic) in heuristics::all() {
            let bvh = Bvh::builder().heuristic(&*heuristic).build(&triangles).unwrap();
            assert_eq!(bvh.closest_hit(&ray).unwrap().index, 0, "{name}");
            assert!(bvh.hits(&ray).map(|hit| hit.index).eq(0..1000), "{name}");
        }
    }
}

in_every_mode!(of_equal_primitives_the_first_is_hit);

/// A heuristic that derives its split only from the number of references.
#[derive(Clone, Copy)]
struct Stubborn(fn(usize) -> Split);

impl Heuristic<f32> for Stubborn {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        (self.0)(node.references.len())
    }
}

const AXIS: Axis = Axis::X;

const STUBBORN: [(&str, Stubborn); 9] = [
    ("0 of n", Stubborn(|_| Split::Count { axis: AXIS, left: 0 })),
    ("n of n", Stubborn(|n| Split::Count { axis: AXIS, left: n })),
    ("too many of n", Stubborn(|_| Split::Count { axis: AXIS, left: usize::MAX })),
    ("1 of n", Stubborn(|_| Split::Count { axis: AXIS, left: 1 })),
    ("n - 1 of n", Stubborn(|n| Split::Count { axis: AXIS, left: n - 1 })),
    ("NaN", Stubborn(|_| Split::Plane { axis: AXIS, position: f32::NAN })),
    ("infinity", Stubborn(|_| Split::Plane { axis: AXIS, position: f32::INFINITY })),
    ("-infinity", Stubborn(|_| Split::Plane { axis: AXIS, position: f32::NEG_INFINITY })),
    ("always a leaf", Stubborn(|_| Split::Leaf)),
];

/// Runs `f` on a thread with a small stack, and all tasks that `f` starts too.
///
/// A recursion as deep as a bad tree would overflow this stack.
fn on_a_small_stack(f: impl FnOnce() + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).stack_size(64 * 1024).build().unwrap();
    pool.install(f);
}

/// Returns `n` spheres in a row and a ray that hits them all.
fn row<S: Scalar>(n: usize) -> (Vec<Sphere<S>>, Ray<S>) {
    let x = |i: usize| S::from_f64((i * 7 % n) as f64);
    let spheres = (0..n).map(|i| Sphere::new([x(i), S::ZERO, S::ZERO], S::HALF)).collect();
    (spheres, Ray::new([-S::ONE, S::ZERO, S::ZERO], [S::ONE, S::ZERO, S::ZERO]))
}

fn build_and_ask<S: Scalar>(n: usize, name: &str, heuristic: &dyn Heuristic<S>) {
    fn ask<'a, S: Scalar, L: Traverse<&'a Sphere<S>>>(bvh: &Bvh<&'a Sphere<S>, L>, ray: &Ray<S>, name: &str) {
        bvh.check().unwrap();
        assert!(bvh.report().max_depth <= MAX_DEPTH, "{name}");
        assert_eq!(bvh.closest_hit(ray).unwrap().index, 0, "{name}");
        assert!(bvh.any_hit(ray), "{name}");
        assert_eq!(bvh.hits(ray).count(), bvh.len(), "{name}");
    }
    let (spheres, ray) = row::<S>(n);
    let builder = Bvh::builder().heuristic(heuristic).max_leaf_size(1);
    ask(&builder.clone().build(&spheres).unwrap(), &ray, name);
    ask(&builder.layout::<Tree<S>>().build(&spheres).unwrap(), &ray, name);
}

#[test]
fn hostile_heuristics_keep_the_depth_bound_on_a_small_stack() {
    on_a_small_stack(|| STUBBORN.iter().for_each(|(name, stubborn)| build_and_ask(100_003, name, stubborn)));
    on_a_small_stack(|| {
        heuristics::all().iter().for_each(|(name, h)| build_and_ask::<f32>(100_003, name, &**h))
    });
    on_a_small_stack(|| {
        heuristics::all().iter().for_each(|(name, h)| build_and_ask::<f64>(100_003, name, &**h))
    });
}

#[test]
fn hostile_heuristics_over_many_tasks() {
    for (name, stubborn) in &STUBBORN {
        build_and_ask(20_011, name, stubborn);
    }
}

#[test]
fn a_bad_split_is_replaced_by_halves_and_a_poor_one_is_taken() {
    for (name, stubborn) in STUBBORN {
        let builder = Bvh::builder().layout::<Tree>().heuristic(stubborn).max_leaf_size(1);
        let bvh = builder.build(row(1024).0).unwrap();
        let expected = if name.starts_with('1') || name.starts_with("n - 1") { MAX_DEPTH } else { 10 };
        assert_eq!(bvh.report().max_depth, expected, "{name}");
    }
}

#[test]
fn a_leaf_size_of_zero_is_an_error_and_a_huge_one_a_single_leaf() {
    let zero = Bvh::builder().max_leaf_size(0).build([Sphere::new([0.0f32; 3], 1.0)]);
    assert_eq!(zero.unwrap_err(), BuildError::ZeroLeafSize);
    for size in [10_000, usize::MAX] {
        let builder = Bvh::builder().layout::<Tree>().heuristic(Median).max_leaf_size(size);
        let bvh = builder.build(row(10_000).0).unwrap();
        assert_eq!((bvh.report().leaves, bvh.report().max_depth), (1, 0));
        assert_eq!(bvh.hits(&row(10_000).1).count(), 10_000);
    }
}

/// A primitive of size zero, so that four billion of them fit in memory.
#[derive(Clone, Copy, Debug)]
struct Nothing;

impl Primitive for Nothing {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        panic!("no box is asked for before the number is known")
    }
}

impl Intersect for Nothing {
    type Payload = ();
    type Leaf = OneByOne;
    fn intersect(&self, _: &Ray) -> Option<(f32, ())> {
        None
    }
}

#[test]
#[cfg(target_pointer_width = "64")]
fn more_primitives_than_indices() {
    let count = 1 << 32;
    for count in [count, count + 1, usize::MAX] {
        let error = Bvh::build(std::iter::repeat_n(Nothing, count)).unwrap_err();
        assert_eq!(error, BuildError::TooManyPrimitives { count });
        // If any memory were allocated for these spheres, there would not be enough.
        let big = std::iter::repeat_n(Sphere::new([0.0f32; 3], 1.0), count);
        let error = Bvh::builder().quality(Quality::High).build(big).unwrap_err();
        assert_eq!(error, BuildError::TooManyPrimitives { count });
    }
}

/// An iterator that tells its length and panics in `next`.
struct Untouchable(usize);

impl Iterator for Untouchable {
    type Item = Sphere;
    fn next(&mut self) -> Option<Sphere> {
        panic!("nothing is taken before the number is known")
    }
    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.0, None)
    }
}

#[test]
#[cfg(target_pointer_width = "64")]
fn more_primitives_than_indices_are_refused_before_the_first_is_taken() {
    for count in [1 << 32, usize::MAX] {
        let error = Bvh::build(Untouchable(count)).unwrap_err();
        assert_eq!(error, BuildError::TooManyPrimitives { count });
    }
}

#[test]
fn an_intersection_that_answers_nonsense_is_no_hit() {
    struct Liar(f32);
    impl Primitive for Liar {
        type Scalar = f32;
        fn aabb(&self) -> Aabb {
            Aabb::new([-1.0; 3], [1.0; 3])
        }
    }
    impl Intersect for Liar {
        type Payload = ();
        type Leaf = OneByOne;
        fn intersect(&self, _: &Ray) -> Option<(f32, ())> {
            Some((self.0, ()))
        }
    }
    let ray = Ray::new([0.0f32, 0.0, -3.0], [0.0, 0.0, 1.0]).with_interval(2.5, 9.0);
    // t = 1 is before the box, which the ray enters at t = 2: t is
    // raised to 2, and the hit is kept.
    let early = Bvh::build([Liar(1.0)]).unwrap().closest_hit(&ray.with_interval(0.0, 9.0));
    assert!(early.is_some_and(|hit| (hit.t - 2.0).abs() < 1e-5));
    for (t, hit) in [(f32::NAN, false), (9.5, false), (f32::INFINITY, false), (2.0, false), (8.0, true)] {
        assert_eq!(Bvh::build([Liar(t)]).unwrap().any_hit(&ray), hit, "{t}");
    }
}
