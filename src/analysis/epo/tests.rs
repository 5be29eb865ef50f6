use crate::geometry::Aabb;
use crate::heuristic::{BuildNode, Heuristic, Median, SpatialSah, Split, SweepSah};
use crate::layout::{Outline, Part};
use crate::parallel::in_pool;
use crate::{
    Axis, Builder, Bvh, CompactTree, Corners, Fast, Intersect, OnInvalid, Precise, Primitive, Traverse, Tree,
    Triangle, Watertight, WideTree,
};
use alloc::vec::Vec;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A triangle whose box contains its whole area, without a mode's padding.
type Plain = Fast<Triangle>;

/// Returns a source of numbers in [0, 1), the same each time.
fn random() -> impl FnMut() -> f32 {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    move || rng.random()
}

/// Returns triangles in the unit cube, a tenth of them large.
fn soup(n: usize) -> Vec<Plain> {
    let mut random = random();
    let mut point = move || [0.0; 3].map(|_: f32| random());
    let triangle = |i: usize| {
        let size = if i.is_multiple_of(10) { 0.8 } else { 0.1 };
        let center = point();
        let mut corner = || {
            let away = point();
            [0, 1, 2].map(|axis| center[axis] + size * (away[axis] - 0.5))
        };
        Fast(Triangle::new(corner(), corner(), corner()))
    };
    (0..n).map(triangle).collect()
}

/// Returns triangles in a row, with gaps in between.
fn row(n: usize) -> Vec<Plain> {
    let triangle = |i: usize| {
        let x = i as f32;
        Fast(Triangle::new([x, 0.0, 0.0], [x + 0.5, 0.0, 1.0], [x, 1.0, 0.0]))
    };
    (0..n).map(triangle).collect()
}

fn area([a, b, c]: [[f32; 3]; 3]) -> f64 {
    let from_a = |point: [f32; 3]| [0, 1, 2].map(|axis| f64::from(point[axis]) - f64::from(a[axis]));
    let ([ux, uy, uz], [vx, vy, vz]) = (from_a(b), from_a(c));
    let normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    0.5 * normal.map(|x| x * x).iter().sum::<f64>().sqrt()
}

/// Returns the share of a triangle's area that is inside a box.
///
/// It is estimated by points all over the triangle: the centers of equal parts.
fn share([a, b, c]: [[f32; 3]; 3], within: &Aabb) -> f64 {
    const ROWS: usize = 120;
    let is_inside = |&(i, j): &(usize, usize)| {
        let [u, v] = [i, j].map(|row| (row as f32 + 1.0 / 3.0) / ROWS as f32);
        // The points form a parallelogram: those in its other half are turned into the triangle.
        let (u, v) = if i + j < ROWS { (u, v) } else { (1.0 - u, 1.0 - v) };
        let point = [0, 1, 2].map(|k| a[k] * (1.0 - u - v) + b[k] * u + c[k] * v);
        within.contains(&Aabb::of_points([point]))
    };
    let points = (0..ROWS).flat_map(|i| (0..ROWS).map(move |j| (i, j)));
    points.filter(is_inside).count() as f64 / (ROWS * ROWS) as f64
}

/// Returns the sum over a node and all below it, and the primitives below it.
///
/// The area of each triangle that is not below a node is estimated by itself.
fn by_points<H: Outline<f32>>(
    hierarchy: &H,
    place: H::Place,
    aabb: Aabb,
    soup: &[Plain],
) -> (f64, Vec<usize>) {
    let (mut sum, mut below, mut children) = (0.0, Vec::new(), Vec::new());
    hierarchy.open(place, |part| match part {
        Part::Child(child, place) => children.push((child.intersection(aabb), place)),
        Part::Primitive(index) => below.push(index as usize),
    });
    let cost = if children.is_empty() { below.len() as f64 } else { 1.0 };
    for (aabb, place) in children {
        let (child, more) = by_points(hierarchy, place, aabb, soup);
        sum += child;
        below.extend(more);
    }
    let others = (0..soup.len()).filter(|index| !below.contains(index));
    let meets = |index: &usize| !soup[*index].aabb().intersection(aabb).is_empty();
    let foreign = |index: usize| share(soup[index].corners(), &aabb) * area(soup[index].corners());
    (sum + cost * others.filter(meets).map(foreign).sum::<f64>(), below)
}

fn agrees<L: Traverse<Plain>>(builder: Builder<Plain, impl Heuristic<f32>, L>) {
    let soup = soup(60);
    let bvh = builder.build(soup.clone()).unwrap();
    let (sum, _) = by_points(bvh.layout(), bvh.layout().root().unwrap(), bvh.aabb(), &soup);
    let expected = sum / soup.iter().map(|triangle| area(triangle.corners())).sum::<f64>();
    let found = bvh.epo();
    assert!(expected > 0.1 && (found / expected - 1.0).abs() < 0.001, "{found}, by points {expected}");
}

#[test]
fn points_on_triangles_tell_the_same_in_any_layout() {
    agrees(Bvh::builder().heuristic(Median).max_leaf_size(2).layout::<Tree>());
    agrees(Bvh::builder().heuristic(SpatialSah::default()).max_leaf_size(1).layout::<Tree>());
    agrees(Bvh::builder().heuristic(Median).max_leaf_size(2).layout::<WideTree>());
    agrees(Bvh::builder().heuristic(SpatialSah::default()).layout::<WideTree>());
    agrees(Bvh::builder().heuristic(Median).layout::<CompactTree>());
}

/// Two triangles in a plane, whose boxes overlap by half.
#[test]
fn a_small_tree_has_the_value_computed_by_hand() {
    let low = |x: f32| Fast(Triangle::new([x, 0.0, 0.0], [x + 4.0, 0.0, 0.0], [x, 4.0, 0.0]));
    // The triangles have an area of 8 each, in boxes with x in [0, 4] and [2, 6]. The left one has
    // 2 in the right box, the right one 6 in the left box.
    let bvh = Bvh::builder()
        .heuristic(Median)
        .max_leaf_size(1)
        .layout::<Tree>()
        .build([low(0.0), low(2.0)])
        .unwrap();
    assert_eq!(bvh.report().leaves, 2);
    assert_eq!(bvh.epo(), (2.0 + 6.0) / 16.0);
    // In one leaf, both triangles are below the only box.
    let bvh = Bvh::builder()
        .heuristic(Median)
        .layout::<Tree>()
        .max_leaf_size(2)
        .build([low(0.0), low(2.0)])
        .unwrap();
    assert_eq!((bvh.report().leaves, bvh.epo()), (1, 0.0));
}

#[test]
fn a_tree_whose_boxes_do_not_overlap_has_none() {
    let builder = || Bvh::builder().heuristic(Median).max_leaf_size(1);
    assert_eq!(builder().layout::<Tree>().build(row(100)).unwrap().epo(), 0.0);
    assert_eq!(builder().build(row(100)).unwrap().epo(), 0.0);
}

/// Splits across one axis, until few triangles are left.
struct Slabs;

impl Heuristic<f32> for Slabs {
    fn split(&self, node: &BuildNode<'_>) -> Split {
        if node.references.len() <= node.max_leaf_size {
            return Split::Leaf;
        }
        Split::Plane { axis: Axis::X, position: node.centroids().center()[0] }
    }
}

#[test]
fn worse_trees_have_more() {
    fn epo(heuristic: impl Heuristic<f32>) -> f64 {
        Bvh::builder().heuristic(heuristic).max_leaf_size(2).layout::<Tree>().build(soup(2000)).unwrap().epo()
    }
    let [split, sweep, median, slabs] =
        [epo(SpatialSah::default()), epo(SweepSah::default()), epo(Median), epo(Slabs)];
    assert!(
        1.1 * split < sweep && 1.1 * sweep < median && 1.5 * median < slabs,
        "{split} {sweep} {median} {slabs}"
    );
}

fn scaled(scale: f64) -> Vec<Fast<Triangle<f64>>> {
    let scaled = |Fast(triangle): Plain| {
        let [a, b, c] = triangle.corners().map(|corner| corner.map(|x| f64::from(x) * scale));
        Fast(Triangle { a, b, c })
    };
    soup(1000).into_iter().map(scaled).collect()
}

#[test]
fn neither_the_number_of_threads_nor_the_unit_of_length_changes_a_bit() {
    let epo = |scale: i32, threads| {
        let soup = scaled(2f64.powi(scale));
        let build = || Bvh::builder().heuristic(Median).layout::<Tree<f64>>().build(&soup).unwrap();
        let mut found = f64::NAN;
        in_pool(Some(threads), soup.len(), &mut || found = build().epo()).unwrap();
        found
    };
    let expected = epo(0, 1);
    assert!(expected > 1.0);
    for (scale, threads) in [(0, 2), (0, 5), (1000, 2), (-1000, 2)] {
        assert_eq!(epo(scale, threads), expected, "2^{scale}, {threads} threads");
    }
}

#[test]
fn what_has_no_area_or_was_skipped_counts_for_nothing() {
    let build = |soup: &[Plain]| {
        Bvh::builder()
            .heuristic(Median)
            .layout::<Tree>()
            .on_invalid(OnInvalid::Skip)
            .build(soup.to_vec())
            .unwrap()
    };
    assert_eq!(build(&[]).epo(), 0.0);
    assert_eq!(build(&soup(1)).epo(), 0.0);
    let point = Fast(Triangle::new([0.5; 3], [0.5; 3], [0.5; 3]));
    let needle = Fast(Triangle::new([0.0; 3], [0.5; 3], [1.0; 3]));
    assert_eq!(build(&[point, needle, point]).epo(), 0.0);

    let mut with_invalid = soup(500);
    let expected = build(&with_invalid).epo();
    let bad = [f32::NAN, f32::INFINITY].map(|x| Fast(Triangle::new([x, 0.0, 0.0], [1.0; 3], [0.0; 3])));
    with_invalid.extend(bad);
    let bvh = build(&with_invalid);
    assert_eq!((bvh.skipped(), bvh.epo()), (&[500, 501][..], expected));
}

/// Every mode has corners, and the padding of a mode hardly counts.
#[test]
fn modes_differ_little() {
    fn epo<P: Intersect<Scalar = f32> + Corners<Scalar = f32>>(mode: fn(Triangle) -> P) -> f64 {
        let triangles = soup(500).into_iter().map(|Fast(triangle)| mode(triangle));
        Bvh::builder().heuristic(Median).layout::<Tree>().build(triangles).unwrap().epo()
    }
    let expected = epo(Fast);
    for found in [epo(Watertight), epo(Precise), epo(|triangle| triangle)] {
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    }
}
