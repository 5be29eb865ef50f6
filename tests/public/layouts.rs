//! Every layout, on every instruction set, answers as the naive loop, bit for bit.
//!
//! Soups, rays, heuristics and leaf sizes are of every kind that is hard. Primitives are triangles
//! in every mode, solids, a user's own primitive, and pointers to primitives of different types.

use crate::common::alone::Alone;
use crate::common::answers::{Key, Payload, key};
use crate::common::at_hits::at_hits;
use crate::common::heuristics;
use crate::common::modes::Mode;
use crate::common::naive::Naive;
use crate::common::soups::{self, KINDS};
use crate::generate::primitives::{Corners, boxes, discs, spheres, triangles};
use bvhkit::heuristic::Heuristic;
use bvhkit::{
    Aabb, Barycentrics, Builder, Bvh, CompactTree, Fast, InstructionSet, Intersect, Lanes, OnInvalid,
    OneByOne, Operands, Precise, Primitive, Quality, Ray, Scalar, Sieve, Sieved, Sphere, Traverse, Tree,
    Triangle, Watertight, WatertightLeaf, reference,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::fmt;

/// Maximum leaf sizes: up to the 8 slots of a packed leaf, one more, and far more.
const LEAF_SIZES: [usize; 6] = [1, 4, 8, 9, 100, usize::MAX];

/// Factors by which coordinates are multiplied.
const SCALES: [f64; 5] = [1.0, 1e-30, 1e-15, 1e15, 1e30];

/// Maximum numbers of triangles; scenes take them in turn.
const SIZES: [usize; 4] = [8, 24, 100, 400];

/// The number of scenes of each kind: one for each pair of scale and leaf size.
const SCENES: usize = SCALES.len() * LEAF_SIZES.len();

/// A function that builds in some layouts, compares, and returns their number.
type Compare<P> = for<'a> fn(
    &Naive<'a, P>,
    Builder<&'a P, &dyn Heuristic<<P as Primitive>::Scalar>>,
    fmt::Arguments<'_>,
) -> usize;

/// Compares all three layouts and returns their number.
///
/// A few kinds of primitives are enough to find the faults of a layout; the
/// others use [`in_wide_trees`].
fn in_every_layout<'a, P: Intersect<Payload: Payload>>(
    naive: &Naive<'a, P>,
    builder: Builder<&'a P, &dyn Heuristic<P::Scalar>>,
    options: fmt::Arguments<'_>,
) -> usize {
    naive.assert_same(builder.clone().layout::<Tree<P::Scalar>>(), options);
    naive.assert_same(builder.clone().layout::<CompactTree<P::Scalar>>(), options);
    naive.assert_same(builder, options);
    3
}

/// Compares the wide layout, which is the default, and returns 1.
fn in_wide_trees<'a, P: Intersect<Payload: Payload>>(
    naive: &Naive<'a, P>,
    builder: Builder<&'a P, &dyn Heuristic<P::Scalar>>,
    options: fmt::Arguments<'_>,
) -> usize {
    naive.assert_same(builder, options);
    1
}

/// A comparison function, and counts that show that something was tested.
struct Compared<P: Intersect> {
    compare: Compare<P>,
    answers: usize,
    hits: usize,
}

impl<P: Intersect<Payload: Payload>> Compared<P> {
    fn by(compare: Compare<P>) -> Self {
        Self { compare, answers: 0, hits: 0 }
    }

    /// Compares one scene on every instruction set.
    ///
    /// Half of the heuristics build trees. `turn` chooses that half and the leaf sizes.
    fn add(&mut self, primitives: &[P], rays: &[Ray<P::Scalar>], turn: usize) {
        let naive = Naive::new(primitives, rays);
        self.hits += naive.hits();
        for (i, (name, heuristic)) in heuristics::all().iter().enumerate().skip(turn % 2).step_by(2) {
            let max_leaf_size = LEAF_SIZES[(turn / 2 + i) % LEAF_SIZES.len()];
            for set in InstructionSet::available() {
                let builder = Bvh::builder().heuristic(&**heuristic as &dyn Heuristic<P::Scalar>);
                let builder = builder.max_leaf_size(max_leaf_size).instruction_set(set);
                let options = format_args!("{name}, leaves of {max_leaf_size}");
                // The closest hit, any hit and all hits of each ray.
                self.answers += 3 * rays.len() * (self.compare)(&naive, builder, options);
            }
        }
    }

    fn tell(&self) {
        let Self { answers, hits, .. } = self;
        eprintln!("{}: {answers} answers compared", std::any::type_name::<P>());
        assert!(*hits > 1000, "{hits} hits");
    }
}

/// Returns `ray` and four variants of it.
///
/// They are the whole line, an interval from t = -0.5 on, the direction with the other sign for its
/// zeros, and the direction with a zero in a random component.
fn variants<S: Scalar>(ray: Ray<S>, rng: &mut Pcg64Mcg) -> [Ray<S>; 5] {
    let flipped = ray.direction.map(|x| if x == S::ZERO { -x } else { x });
    let mut flat = ray.direction;
    flat[rng.random_range(0..3)] = if rng.random() { S::ZERO } else { -S::ZERO };
    [
        ray,
        ray.with_interval(S::NEG_INFINITY, S::INFINITY),
        ray.with_interval(-S::HALF, ray.t_max),
        Ray { direction: flipped, ..ray },
        Ray { direction: flat, ..ray },
    ]
}

/// Compares primitives made from soups of all kinds and scales.
fn over_the_soups<S: Scalar, P: Intersect<Scalar = S, Payload: Payload>>(
    primitives_of: impl Fn(&[Corners<S>]) -> Vec<P>,
    ray: impl Fn(&[Triangle<S>], &[P], &mut Pcg64Mcg) -> Ray<S>,
    compare: Compare<P>,
) {
    let scaled = |point: [S; 3], scale: f64| point.map(|x| x * S::from_f64(scale));
    let mut compared = Compared::by(compare);
    for (kind, turn) in (0..KINDS).flat_map(|kind| (0..SCENES).map(move |turn| (kind, turn))) {
        let mut rng = Pcg64Mcg::seed_from_u64((kind * SCENES + turn) as u64);
        let (scale, size) = (SCALES[turn % SCALES.len()], SIZES[turn % SIZES.len()]);
        let size = rng.random_range(1..=size);
        let soup = soups::soup::<S>(kind, size, &mut rng);
        let soup: Vec<Corners<S>> = soup.iter().map(|t| [t.a, t.b, t.c].map(|p| scaled(p, scale))).collect();
        let (bare, primitives) = (triangles(&soup), primitives_of(&soup));
        let rays = (0..2).flat_map(|_| {
            let ray = ray(&bare, &primitives, &mut rng);
            variants(ray, &mut rng)
        });
        let rays = at_hits(&primitives, rays.collect());
        compared.add(&primitives, &rays, turn);
        if kind == 0 {
            compared.add(&[], &rays, turn);
        }
    }
    compared.tell();
}

fn all_answers<M: Mode>(compare: Compare<M>) {
    over_the_soups(
        |soup| triangles(soup).into_iter().map(M::of).collect(),
        |soup, _, rng| soups::ray(soup, rng),
        compare,
    );
}

/// Compares equal triangles, which give ties in every box and every leaf.
fn equal_triangles<M: Mode>(compare: Compare<M>) {
    let point = |x: [f64; 3]| x.map(M::Number::from_f64);
    let (a, b, c) = (point([0.0, 0.0, 3.0]), point([1.0, 0.0, 3.0]), point([0.0, 1.0, 3.5]));
    let triangles = [M::of(Triangle::new(a, b, c)); 3000];
    // Targets inside, at a corner and outside.
    let targets = [[0.25, 0.25, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let rays = targets.map(|target| Ray::new(point(target), point([0.0, -0.0, 1.0])));
    let rays = at_hits(&triangles, rays.into());
    let mut compared = Compared::by(compare);
    (0..2 * LEAF_SIZES.len()).for_each(|turn| compared.add(&triangles, &rays, turn));
    compared.tell();
}

/// Compares lists of rays, some of them invalid, with the naive loop.
fn lists_of_rays<M: Mode>() {
    fn assert_same<'a, M: Mode, L: Traverse<&'a M>>(
        builder: Builder<&'a M, Quality, L>,
        triangles: &'a [M],
        rays: &[Ray<M::Number>],
        expected: &[Option<Key>],
    ) {
        let bvh = builder.on_invalid(OnInvalid::Skip).build(triangles).unwrap();
        let (mut closest, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
        bvh.closest_hits(rays, &mut closest);
        bvh.any_hits(rays, &mut any);
        for (i, ray) in rays.iter().enumerate() {
            let (layout, set) = (std::any::type_name::<L>(), bvh.instruction_set());
            let answers = (closest[i].map(key), any[i]);
            assert_eq!(answers, (expected[i], expected[i].is_some()), "{layout}, {set}, {ray:?}");
        }
    }
    for kind in 0..KINDS {
        let mut rng = Pcg64Mcg::seed_from_u64(kind as u64);
        let soup = soups::soup::<M::Number>(kind, 300, &mut rng);
        let triangles: Vec<_> = soup.iter().copied().map(M::of).collect();
        let mut rays = vec![Ray::new(soup[0].a, [M::Number::ZERO; 3])];
        while rays.len() < 3000 {
            let ray = soups::ray(&soup, &mut rng);
            rays.extend(variants(ray, &mut rng));
        }
        let expected: Vec<_> =
            rays.iter().map(|ray| reference::closest_hit(&triangles, ray).map(key)).collect();
        for set in InstructionSet::available() {
            let builder = Bvh::builder().instruction_set(set);
            assert_same(builder.clone(), &triangles, &rays, &expected);
            assert_same(builder.layout::<Tree<M::Number>>(), &triangles, &rays, &expected);
        }
    }
}

/// A list of 60,000 rays gives the hits of single queries.
#[test]
fn a_long_list_of_rays() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let soup = soups::soup::<f32>(0, 100, &mut rng);
    let rays: Vec<_> = (0..60_000).map(|_| soups::ray(&soup, &mut rng)).collect();
    let bvh = Bvh::build(&soup).unwrap();
    let (mut closest, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    bvh.closest_hits(&rays, &mut closest);
    bvh.any_hits(&rays, &mut any);
    for (ray, (closest, any)) in rays.iter().zip(closest.into_iter().zip(any)) {
        let expected = bvh.closest_hit(ray).map(key);
        assert_eq!((closest.map(key), any), (expected, expected.is_some()), "{ray:?}");
    }
}

#[test]
fn watertight_triangles() {
    all_answers::<Watertight<Triangle>>(in_every_layout);
    equal_triangles::<Watertight<Triangle>>(in_every_layout);
    lists_of_rays::<Watertight<Triangle>>();
}

#[test]
fn watertight_triangles_in_f64() {
    all_answers::<Watertight<Triangle<f64>>>(in_every_layout);
    equal_triangles::<Watertight<Triangle<f64>>>(in_every_layout);
    lists_of_rays::<Watertight<Triangle<f64>>>();
}

#[test]
fn fast_and_precise_triangles() {
    all_answers::<Fast<Triangle>>(in_wide_trees);
    all_answers::<Precise<Triangle>>(in_wide_trees);
}

#[test]
fn solids() {
    over_the_soups(spheres::<f32>, |soup, _, rng| soups::ray(soup, rng), in_every_layout);
    over_the_soups(spheres::<f64>, |soup, _, rng| soups::ray(soup, rng), in_wide_trees);
    over_the_soups(boxes::<f64>, |soup, _, rng| soups::ray(soup, rng), in_wide_trees);
}

/// Compares boxes with rays that start at their corners, in 26 directions.
///
/// A corner of one box may be on a face or an edge of the whole block. Where a ray leaves a box at
/// its start, t is a zero of either sign.
#[test]
fn rays_from_the_faces_of_boxes() {
    let corner = |i: u8| [i % 4, i / 4 % 4, i / 16].map(f32::from);
    let boxes: Vec<_> = (0..64).map(|i| Aabb::new(corner(i), corner(i).map(|x| x + 1.0))).collect();
    let signs = |i: u8| [i % 3, i / 3 % 3, i / 9].map(|x| f32::from(x) - 1.0);
    let directions = (0..27).map(signs).filter(|direction| *direction != [0.0; 3]);
    let origins = (0..125).map(|i: u8| [i % 5, i / 5 % 5, i / 25].map(f32::from));
    let rays: Vec<_> = origins
        .flat_map(|origin| directions.clone().map(move |direction| Ray::new(origin, direction)))
        .flat_map(|ray| [ray, ray.with_interval(0.0, 0.0), ray.with_interval(-0.0, -0.0)])
        .collect();
    let mut compared = Compared::by(in_every_layout);
    compared.add(&boxes, &rays, 0);
    compared.tell();
}

/// A user's primitive that keeps no rule except that it is a pure function.
#[test]
fn sloppy_discs() {
    over_the_soups(discs::<f32>, |soup, _, rng| soups::ray(soup, rng), in_every_layout);
}

/// A sphere whose sieve lets every lane through, even lanes without a primitive.
struct Suspected(Sphere);
struct AllLanes;

impl Primitive for Suspected {
    type Scalar = f32;

    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

impl Intersect for Suspected {
    type Payload = ();
    type Leaf = Sieved<AllLanes>;

    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        self.0.intersect(ray)
    }

    fn put_operands(&self, operands: &mut [f32]) {
        operands.fill(1.0);
    }
}

impl Sieve<f32> for AllLanes {
    const OPERANDS: usize = 1;

    fn candidates<L: Lanes<f32>>(operands: &Operands<'_, f32, L>, _: &Ray) -> L::Mask {
        let (zero, some) = (operands.splat(0.0), operands.get(0));
        zero.le(zero) | some.le(some)
    }
}

#[test]
fn a_leaf_that_leaves_no_lane_out() {
    let suspected = |soup: &[Corners<f32>]| spheres(soup).into_iter().map(Suspected).collect();
    over_the_soups(suspected, |soup, _, rng| soups::ray(soup, rng), in_every_layout);
}

/// Compares pointers to primitives, both in packed leaves and tested one by one.
#[test]
fn pointers() {
    type Alike = dyn Intersect<Scalar = f32, Payload = Barycentrics, Leaf = WatertightLeaf>;
    type Unlike = dyn Intersect<Scalar = f32, Payload = (), Leaf = OneByOne>;
    over_the_soups(
        |soup| triangles(soup).into_iter().map(|triangle| Box::new(triangle) as Box<Alike>).collect(),
        |soup, _, rng| soups::ray(soup, rng),
        in_wide_trees,
    );
    over_the_soups(
        |soup| {
            let by_turns = |(i, (sphere, cuboid))| match i % 2 {
                0 => Box::new(Alone(sphere)) as Box<Unlike>,
                _ => Box::new(cuboid),
            };
            spheres(soup).into_iter().zip(boxes(soup)).enumerate().map(by_turns).collect()
        },
        |soup, _, rng| soups::ray(soup, rng),
        in_wide_trees,
    );
}
