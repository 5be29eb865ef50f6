//! The driver's contract with heuristics: nodes shown, proposals carried out.

use crate::common::hostile::Hostile;
use bvhkit::heuristic::{BuildNode, Heuristic, Split};
use bvhkit::{Aabb, Axis, Bvh, Sphere};
use std::sync::Mutex;

/// Returns spheres at these x coordinates.
fn at(xs: &[f32]) -> Vec<Sphere> {
    xs.iter().map(|&x| Sphere::new([x, 0.0, 0.0], 0.5)).collect()
}

/// A heuristic that splits only the root, and records the references below it.
struct Spy {
    split: Split,
    below: Mutex<Vec<Vec<u32>>>,
}

impl Heuristic<f32> for Spy {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        if node.depth == 0 {
            return self.split;
        }
        let mut indices: Vec<_> = node.references.iter().map(|reference| reference.index).collect();
        indices.sort_unstable();
        self.below.lock().unwrap().push(indices);
        Split::Leaf
    }
}

/// Returns the indices on both sides of a split at the root.
///
/// The side with the lowest index comes first.
fn sides(xs: &[f32], split: Split) -> [Vec<u32>; 2] {
    let spy = Spy { split, below: Mutex::default() };
    Bvh::builder().heuristic(&spy).max_leaf_size(xs.len()).build(at(xs)).unwrap();
    let mut below = spy.below.into_inner().unwrap();
    below.sort();
    below.try_into().unwrap()
}

#[test]
fn a_plane_has_what_is_below_it_on_its_left_and_what_is_on_it_on_its_right() {
    let split = Split::Plane { axis: Axis::X, position: 1.0 };
    assert_eq!(sides(&[0.0, 1.0, 2.0, 1.0, 0.5, 0.9], split), [vec![0, 4, 5], vec![1, 2, 3]]);
}

#[test]
fn a_count_takes_the_smallest_and_of_equal_ones_the_lowest_index() {
    let split = |left| Split::Count { axis: Axis::X, left };
    let xs = [1.0, 0.0, 1.0, 1.0, 2.0, 1.0, 0.0, 1.0];
    assert_eq!(sides(&xs, split(4)), [vec![0, 1, 2, 6], vec![3, 4, 5, 7]]);
    for left in (2..998).step_by(if cfg!(miri) { 199 } else { 1 }) {
        let [front, back] = sides(&[7.0; 1000], split(left));
        assert!(front.into_iter().eq(0..left as u32) && back.into_iter().eq(left as u32..1000));
    }
}

/// A heuristic that checks each node it is shown.
struct Checked;

impl Heuristic<f32> for Checked {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        let references = node.references;
        let all = references.iter().fold(Aabb::EMPTY, |all, reference| all.union(reference.aabb));
        assert!(references.len() >= 2);
        assert_eq!((node.aabb, node.max_leaf_size), (all, 3));
        assert_eq!(node.centroids(), Aabb::of_points(references.iter().map(|r| r.aabb.center())));
        Hostile.split(node)
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many primitives for an interpreter")]
fn nodes_are_shown_as_they_are() {
    let xs: Vec<_> = (0..10_000).map(|i| (i * 7 % 1009) as f32).collect();
    Bvh::builder().heuristic(Checked).max_leaf_size(3).build(at(&xs)).unwrap().check().unwrap();
}
