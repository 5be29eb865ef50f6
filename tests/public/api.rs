//! Tests of the public API: accepted inputs, lazy queries, the meaning of counters.

use crate::common::alone::Alone;
use bvhkit::heuristic::{BinnedSah, Heuristic, Median, SweepSah};
use bvhkit::{
    Aabb, Barycentrics, BuildError, Builder, Bvh, Counters, Hits, InstructionSet, Intersect, OneByOne,
    Primitive, Quality, Ray, Recorder, Sphere, Traverse, Tree, Triangle, TriangleMesh, WideTree,
};
use glam::{DVec3, Vec3};

/// Returns spheres of radius 0.4 at x = 0, 1, 2, ...
fn row(n: usize) -> Vec<Sphere> {
    (0..n).map(|i| Sphere::new([i as f32, 0.0, 0.0], 0.4)).collect()
}

fn along_the_row() -> Ray {
    Ray::new([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0])
}

#[test]
fn points_are_arrays_or_the_users_own_vectors() {
    let arrays = Triangle::new([0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert_eq!(Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y), arrays);
    assert_eq!(Ray::new(Vec3::X, Vec3::Y), Ray::new([1.0f32, 0.0, 0.0], [0.0, 1.0, 0.0]));
    assert_eq!(Ray::new(DVec3::X, DVec3::Y).origin, [1.0f64, 0.0, 0.0]);
    assert_eq!(Sphere::new(Vec3::Z, 1.0).center, [0.0, 0.0, 1.0]);
    assert_eq!(Aabb::new(Vec3::ZERO, Vec3::ONE), Aabb::new([0.0f32; 3], [1.0; 3]));
    assert_eq!(Vec3::from(Ray::new(Vec3::X, Vec3::Y).at(2.0)), Vec3::new(1.0, 2.0, 0.0));
}

#[test]
fn input_is_anything_that_iterates() {
    let list = row(10);
    let ray = along_the_row();
    let expected = Some((0, 4.6));
    let answer =
        |hit: Option<bvhkit::Hit<f32, ()>>| hit.map(|hit| (hit.index, (hit.t * 10.0).round() / 10.0));
    assert_eq!(answer(Bvh::build(&list).unwrap().closest_hit(&ray)), expected);
    assert_eq!(answer(Bvh::build(list.iter().copied()).unwrap().closest_hit(&ray)), expected);
    assert_eq!(
        answer(Bvh::build(list.iter().copied().filter(|_| true)).unwrap().closest_hit(&ray)),
        expected
    );
    assert_eq!(answer(Bvh::build([list[0], list[5]]).unwrap().closest_hit(&ray)), expected);
    assert_eq!(answer(Bvh::build(list).unwrap().closest_hit(&ray)), expected);

    let vertices = [[0.0f32, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]];
    let mesh = TriangleMesh::new(&vertices, &[[0, 1, 2]]).unwrap();
    assert_eq!(Bvh::build(&mesh).unwrap().closest_hit(&ray).unwrap().t, 5.0);
}

#[test]
fn unlike_primitives_behind_one_pointer() {
    type Surface = dyn Intersect<Scalar = f32, Payload = (), Leaf = OneByOne> + Send + Sync;
    let scene: Vec<Box<Surface>> =
        vec![Box::new(Aabb::new([1.0f32, -1.0, -1.0], [2.0, 1.0, 1.0])), Box::new(Alone(row(1)[0]))];
    let bvh = Bvh::build(scene).unwrap();
    assert!(bvh.hits(&along_the_row()).map(|hit| hit.index).eq([1, 0]));
    let borrowed = Bvh::build(bvh.primitives().iter().map(|primitive| &**primitive)).unwrap();
    assert!(borrowed.hits(&along_the_row()).map(|hit| hit.index).eq([1, 0]));
}

#[test]
fn a_heuristic_chosen_at_run_time() {
    let trees = [&Median as &dyn Heuristic<f32>, &BinnedSah::default(), &SweepSah::default(), &Quality::High]
        .map(|heuristic| Bvh::builder().layout::<Tree>().heuristic(heuristic).build(row(100)).unwrap());
    assert!(trees.iter().all(|bvh| bvh.any_hit(&along_the_row())));
    assert!(trees[0].layout() != trees[2].layout(), "the choice makes a difference");
    let direct = Bvh::builder().heuristic(Median).layout::<Tree>().build(row(100)).unwrap();
    assert!(trees[0].layout() == direct.layout(), "and how it is passed does not");
}

#[test]
fn the_last_choice_of_a_heuristic_counts() {
    let builder = || Bvh::builder().layout::<Tree>();
    let high = builder().quality(Quality::High).build(row(100)).unwrap();
    let by_name = builder().heuristic(Median).heuristic(Quality::High).build(row(100)).unwrap();
    let median = builder().quality(Quality::High).heuristic(Median).build(row(100)).unwrap();
    assert!(high.layout() == by_name.layout() && high.layout() != median.layout());
}

#[test]
fn trees_and_what_comes_of_them_cross_threads() {
    fn crosses<T: Send + Sync>() {}
    crosses::<Bvh<Triangle>>();
    crosses::<Bvh<&Sphere<f64>>>();
    crosses::<Bvh<Triangle, Tree>>();
    crosses::<Builder<Triangle>>();
    crosses::<Hits<'_, Triangle, WideTree>>();
    crosses::<Hits<'_, Triangle, Tree>>();

    let bvh = Bvh::build(row(100)).unwrap();
    let answers = std::thread::scope(|scope| {
        let threads = [0; 4].map(|_| scope.spawn(|| bvh.closest_hit(&along_the_row())));
        threads.map(|thread| thread.join().unwrap())
    });
    assert!(answers.iter().all(|&answer| answer == bvh.closest_hit(&along_the_row())));
}

/// A primitive that owns heap data and implements neither `Clone` nor `Debug`.
struct Named {
    name: String,
    place: [f32; 3],
}

impl Primitive for Named {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        Aabb::new(self.place, self.place)
    }
}

impl Intersect for Named {
    type Payload = ();
    type Leaf = OneByOne;
    fn intersect(&self, _: &Ray) -> Option<(f32, ())> {
        None
    }
}

#[test]
fn primitives_come_back_in_the_order_of_the_input() {
    let named = |i: usize| Named { name: i.to_string(), place: [(i * 37 % 101) as f32, 0.0, 0.0] };
    let bvh = Bvh::builder().max_leaf_size(1).build((0..101).map(named)).unwrap();
    let names = bvh.primitives().iter().map(|primitive| primitive.name.clone());
    assert!(names.eq((0..101).map(|i| i.to_string())));
    assert_eq!(bvh.primitives().len(), 101);
    for i in 0..101 {
        assert_eq!(bvh.primitive(i).name, i.to_string());
        assert_eq!(bvh.get(i).map(|primitive| &primitive.name), Some(&i.to_string()));
    }
    assert!(bvh.get(101).is_none());
    assert!(bvh.check().is_ok());
}

#[test]
fn a_payload_tells_where_on_the_triangle() {
    let bvh = Bvh::build([Triangle::new([0.0f64; 3], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0])]).unwrap();
    let hit = bvh.closest_hit(&Ray::new([0.5, 1.0, -1.0], [0.0, 0.0, 1.0])).unwrap();
    assert_eq!(hit.payload, Barycentrics { u: 0.25, v: 0.25 });
}

fn finds_hits_as_they_are_asked_for<L: Traverse<Sphere>>(bvh: &Bvh<Sphere, L>) {
    let (mut first, mut all, mut closest) = (Counters::default(), Counters::default(), Counters::default());
    assert_eq!(bvh.hits_with(&along_the_row(), &mut first).next().unwrap().index, 0);
    assert_eq!(bvh.hits_with(&along_the_row(), &mut all).count(), 1000);
    bvh.closest_hit_with(&along_the_row(), &mut closest);
    let report = bvh.report();
    let [leaves, nodes] = [report.leaves, report.inner_nodes].map(|count| count as u64);
    assert_eq!((all.primitives, all.leaves, all.nodes), (1000, leaves, nodes));
    let few = 4 * report.leaf_sizes.max as u64;
    assert!(first.nodes < 20 && first.primitives < few, "{first:?}");
    assert!(closest.nodes < 20 && closest.primitives < few, "{closest:?}");

    let mut hits = bvh.hits(&along_the_row());
    assert_eq!(hits.by_ref().count(), 1000);
    assert!(hits.next().is_none(), "the end is the end");
}

#[test]
fn hits_are_found_as_they_are_asked_for() {
    let builder = || Bvh::builder().max_leaf_size(1);
    finds_hits_as_they_are_asked_for(&builder().build(row(1000)).unwrap());
    finds_hits_as_they_are_asked_for(&builder().layout::<Tree>().build(row(1000)).unwrap());
}

#[test]
fn counters_count_rays_nodes_leaves_and_primitives() {
    let bvh = Bvh::builder().layout::<Tree>().heuristic(Median).max_leaf_size(2).build(row(4)).unwrap();
    let mut counters = Counters::default();
    // The ray enters the first of two leaves; the second begins behind the hit.
    bvh.closest_hit_with(&along_the_row(), &mut counters);
    assert_eq!(counters, Counters { rays: 1, nodes: 1, leaves: 1, primitives: 2 });
    // The ray misses everything: the box of the whole tree is tested, but no node is visited.
    bvh.closest_hit_with(&Ray::new([-5.0, 9.0, 0.0], [1.0, 0.0, 0.0]), &mut counters);
    assert_eq!(counters, Counters { rays: 2, nodes: 1, leaves: 1, primitives: 2 });
    // Any hit stops within the leaf.
    let mut any = Counters::default();
    assert!(bvh.any_hit_with(&along_the_row(), &mut any));
    assert_eq!(any, Counters { rays: 1, nodes: 1, leaves: 1, primitives: 1 });
    counters += any;
    assert_eq!(counters, Counters { rays: 3, nodes: 2, leaves: 2, primitives: 3 });
}

#[test]
fn steps_of_many_rays_are_the_sum_of_each_rays() {
    let bvh = Bvh::builder().layout::<Tree>().heuristic(Median).max_leaf_size(2).build(row(4)).unwrap();
    let nowhere = Ray::new([0.0; 3], [0.0; 3]);
    let rays = [along_the_row(), nowhere, Ray::new([-5.0, 9.0, 0.0], [1.0, 0.0, 0.0])];
    let [closest, any] = [bvh.closest_hit_steps(&rays), bvh.any_hit_steps(&rays)];
    // The invalid ray is not counted.
    assert_eq!(closest, Counters { rays: 2, nodes: 1, leaves: 1, primitives: 2 });
    assert_eq!(any, Counters { rays: 2, nodes: 1, leaves: 1, primitives: 1 });
    let means = |steps: Counters| [steps.nodes_per_ray(), steps.leaves_per_ray(), steps.primitives_per_ray()];
    assert_eq!(means(closest), [0.5, 0.5, 1.0]);
    assert_eq!(means(bvh.any_hit_steps(&[nowhere])), [0.0; 3]);
}

#[test]
fn what_lies_outside_the_interval_is_not_visited() {
    let bvh = Bvh::builder().layout::<Tree>().max_leaf_size(1).build(row(1000)).unwrap();
    // The ray starts and ends in a gap between two spheres: half of the row is
    // behind it, half is beyond its end.
    let ray = Ray::new([500.5, 0.0, 0.0], [1.0, 0.0, 0.0]).with_interval(0.0, 0.05);
    let mut counters = Counters::default();
    assert!(bvh.closest_hit_with(&ray, &mut counters).is_none());
    assert!(!bvh.any_hit_with(&ray, &mut counters));
    assert_eq!(bvh.hits_with(&ray, &mut counters).count(), 0);
    assert!(counters.primitives == 0 && counters.nodes <= 3 * 20, "{counters:?}");
}

#[test]
fn a_recorder_of_ones_own() {
    #[derive(Default)]
    struct Leaves(usize);
    impl Recorder for Leaves {
        fn leaf(&mut self) {
            self.0 += 1;
        }
    }
    let mut leaves = Leaves::default();
    let bvh = Bvh::builder().layout::<Tree>().max_leaf_size(1).build(row(8)).unwrap();
    bvh.hits_with(&along_the_row(), &mut leaves).for_each(drop);
    assert_eq!(leaves.0, 8);
}

#[test]
fn an_instruction_set_is_what_was_asked_for_or_an_error() {
    let available: Vec<_> = InstructionSet::available().collect();
    assert_eq!(available.last(), Some(&InstructionSet::best()));
    assert_eq!(Bvh::build(row(9)).unwrap().instruction_set(), InstructionSet::best());
    for &set in InstructionSet::ALL {
        let built = Bvh::builder().instruction_set(set).build(row(9)).map(|bvh| bvh.instruction_set());
        let expected =
            if available.contains(&set) { Ok(set) } else { Err(BuildError::NoInstructionSet(set)) };
        assert_eq!(built, expected);
    }
}
