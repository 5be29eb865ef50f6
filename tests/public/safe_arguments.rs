//! Safe code around kernels: unknown primitives, foreign places, lengths of lists.
//!
//! Kernels call primitives whose type they do not know. Safe code can open places of one tree in
//! another, and pass lists of different lengths.
#![forbid(unsafe_code)]

use bvhkit::{
    Aabb, Barycentrics, Bvh, CompactTree, Intersect, Layout, OneByOne, Primitive, Ray, Sphere, Traverse,
    Tree, Triangle, WideTree, reference,
};
use std::sync::Mutex;

/// A sphere that records the end of each ray that it is tested with.
struct Watched<'a>(Sphere, &'a Mutex<Vec<f32>>);

impl Primitive for Watched<'_> {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

impl Intersect for Watched<'_> {
    type Payload = ();
    type Leaf = OneByOne;
    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        self.1.lock().unwrap().push(ray.t_max);
        self.0.intersect(ray)
    }
}

/// Returns the ends of the rays that primitives in a row are tested with.
fn ends<L: for<'a> Traverse<Watched<'a>>>(any: bool) -> Vec<f32> {
    let ends = Mutex::new(Vec::new());
    let row: Vec<_> =
        (0..20u8).map(|i| Watched(Sphere::new([0.0, 0.0, f32::from(20 - i)], 3.0), &ends)).collect();
    let ray = Ray::new([0.0, 0.0, -10.0], [0.0, 0.0, 1.0]).with_interval(0.0, 100.0);
    let bvh = Bvh::builder().layout::<L>().build(row).unwrap();
    if any {
        assert!(bvh.any_hit(&ray));
    } else {
        assert_eq!(bvh.closest_hit(&ray).map(|hit| (hit.index, hit.t)), Some((19, 8.0)));
    }
    drop(bvh);
    ends.into_inner().unwrap()
}

#[test]
fn primitives_see_the_ray_end_at_the_closest_hit_so_far() {
    for ends in [ends::<WideTree>(false), ends::<CompactTree>(false), ends::<Tree>(false)] {
        assert_eq!(ends[0], 100.0);
        assert!(ends.is_sorted_by(|a, b| a >= b), "{ends:?}");
        assert!(ends.iter().any(|&end| end < 100.0), "{ends:?}");
    }
    for ends in [ends::<WideTree>(true), ends::<Tree>(true)] {
        assert_eq!(ends, [100.0]);
    }
}

/// A hierarchy as a primitive.
struct Nested<'a>(&'a Bvh<Triangle>, [f32; 3]);

impl Primitive for Nested<'_> {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        let Aabb { min, max } = self.0.aabb();
        let moved = |corner: [f32; 3]| [0, 1, 2].map(|axis| corner[axis] + self.1[axis]);
        Aabb::new(moved(min), moved(max))
    }
}

impl Intersect for Nested<'_> {
    type Payload = (usize, Barycentrics);
    type Leaf = OneByOne;
    fn intersect(&self, ray: &Ray) -> Option<(f32, Self::Payload)> {
        let origin = [0, 1, 2].map(|axis| ray.origin[axis] - self.1[axis]);
        let hit = self.0.closest_hit(&Ray { origin, ..*ray })?;
        Some((hit.t, (hit.index, hit.payload)))
    }
}

#[test]
fn nested_hierarchies_answer_as_the_naive_loop_does() {
    let part = |x: u32| (x.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
    let corner = |i: u32, k: u32| [part(9 * i + k), part(9 * i + k + 1), part(9 * i + k + 2)];
    let soup = (0..300).map(|i| Triangle::new(corner(i, 0), corner(i, 3), corner(i, 6)));
    let inner = Bvh::build(soup).unwrap();
    let copies: Vec<_> = (0..40).map(|i| Nested(&inner, corner(7000 + i, 0))).collect();
    let outer = Bvh::build(&copies).unwrap();
    let mut hits = 0;
    for i in 0..300 {
        let (origin, aim) = (corner(20_000 + i, 0).map(|x| 4.0 * x - 1.0), corner(30_000 + i, 3));
        let ray = Ray::new(origin, [0, 1, 2].map(|k| 2.0 * aim[k] - origin[k]));
        let found = outer.closest_hit(&ray);
        assert_eq!(found.map(|hit| (hit.t.to_bits(), hit.index, hit.payload.0)), {
            let hit = reference::closest_hit(&copies, &ray);
            hit.map(|hit| (hit.t.to_bits(), hit.index, hit.payload.0))
        });
        hits += usize::from(found.is_some());
        assert_eq!(outer.any_hit(&ray), found.is_some());
    }
    assert!(hits > 100, "{hits}");
}

/// The kernel is the same, whatever pointer holds the triangle.
#[test]
fn triangles_behind_pointers_have_the_hits_of_triangles() {
    let triangles: Vec<Triangle> = (0..50u8)
        .map(|i| {
            let z = f32::from(i);
            Triangle::new([0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z])
        })
        .collect();
    let ray = Ray::new([0.25, 0.25, 20.5], [0.0, 0.0, 1.0]);
    let expected = Bvh::build(triangles.iter().copied()).unwrap().closest_hit(&ray);
    assert_eq!(expected.map(|hit| (hit.index, hit.t)), Some((21, 0.5)));
    let boxed = Bvh::build(triangles.iter().map(|&t| Box::new(t))).unwrap();
    assert_eq!(boxed.closest_hit(&ray), expected);
    let shared = Bvh::build(triangles.iter().map(|&t| std::sync::Arc::new(t))).unwrap();
    assert_eq!(shared.closest_hit(&ray), expected);
    assert_eq!(Bvh::build(&triangles).unwrap().closest_hit(&ray), expected);
}

/// Opens every place of `large` in `small` too; returns how many exist there.
fn mix<P: Primitive, L: Layout<P>>(large: &L, small: &L) -> usize {
    let (mut open, mut opened) = (Vec::from_iter(large.root()), 0);
    while let Some(place) = open.pop() {
        let mut more = Vec::new();
        large.open(place, |part| more.extend(part.child()));
        open.extend(&more);
        opened += usize::from(small.open(place, |_| ()));
    }
    opened
}

#[test]
fn places_of_another_tree_are_no_way_out_of_a_trees_memory() {
    let spheres = |n: u16| (0..n).map(|i| Sphere::new([f32::from(i), f32::from(i % 7), 0.0], 0.3));
    fn both<L: Layout<Sphere> + Traverse<Sphere>>(spheres: impl Fn(u16) -> Vec<Sphere>) {
        let build = |n| Bvh::builder().layout::<L>().build(spheres(n)).unwrap();
        let (large, small) = (build(5000), build(20));
        // Nearly all places are beyond the memory of the small tree.
        let all = mix::<Sphere, L>(large.layout(), large.layout());
        assert!(mix::<Sphere, L>(large.layout(), small.layout()) < all / 4);
    }
    both::<WideTree>(|n| spheres(n).collect());
    both::<CompactTree>(|n| spheres(n).collect());
    both::<Tree>(|n| spheres(n).collect());
}

/// Checks lists with fewer rays than places for hits, and with more.
fn lists<P: Intersect<Scalar = f32, Payload: PartialEq + std::fmt::Debug>, L: Traverse<P>>(bvh: &Bvh<P, L>) {
    let rays: Vec<Ray> = (0..200u8).map(|i| Ray::new([f32::from(i), -9.0, 0.0], [0.0, 1.0, 0.0])).collect();
    for (count, places) in [(10, 20), (74, 128), (128, 74), (64, 65), (0, 3), (200, 200)] {
        let sentinel = bvh.closest_hit(&rays[7]);
        assert!(sentinel.is_some());
        let (mut closest, mut any) = (vec![sentinel; places], vec![true; places]);
        bvh.closest_hits(&rays[..count], &mut closest);
        bvh.any_hits(&rays[..count], &mut any);
        for place in 0..places {
            let expected = if place < count { bvh.closest_hit(&rays[place]) } else { sentinel };
            assert_eq!(closest[place], expected, "{count} {places} {place}");
            assert_eq!(any[place], expected.is_some());
        }
    }
}

#[test]
fn lists_of_other_lengths_leave_the_rest_alone() {
    // The spheres have gaps, so some rays miss.
    let spheres: Vec<Sphere> =
        (0..40u8).map(|i| Sphere::new([f32::from(5 * i + 2), 0.0, 0.0], 1.0)).collect();
    lists(&Bvh::build(&spheres).unwrap());
    lists(&Bvh::builder().layout::<CompactTree>().build(&spheres).unwrap());
    lists(&Bvh::builder().layout::<Tree>().build(&spheres).unwrap());
    let ends = Mutex::new(Vec::new());
    lists(&Bvh::build(spheres.iter().map(|&sphere| Watched(sphere, &ends))).unwrap());
}
