//! Exact ray-triangle tests in whole numbers.

use bvhkit::{Scalar, Triangle};

pub type Point = [i32; 3];

pub fn sub(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> i32 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the t at which a line meets the triangle, rounded to the nearest `f64`.
///
/// Edges and corners are inside. A line in the triangle's plane misses it.
pub fn exact_t([a, b, c]: [Point; 3], origin: Point, direction: Point) -> Option<f64> {
    let [a, b, c] = [a, b, c].map(|corner| sub(corner, origin));
    let normal = cross(sub(b, a), sub(c, a));
    let det = dot(normal, direction);
    // The signs tell on which side of each edge the line passes.
    let sides = [cross(c, b), cross(a, c), cross(b, a)].map(|plane| dot(plane, direction));
    let inside = sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0);
    (det != 0 && inside).then(|| f64::from(dot(normal, a)) / f64::from(det))
}

/// Converts a point to a scalar in which it is exact.
pub fn point<S: Scalar>(point: Point) -> [S; 3] {
    point.map(|x| S::from_f64(f64::from(x)))
}

pub fn triangle<S: Scalar>([a, b, c]: [Point; 3]) -> Triangle<S> {
    Triangle::new(point::<S>(a), point::<S>(b), point::<S>(c))
}

/// Asserts that the hits found, by index and t, are those expected.
///
/// There must be no more and no fewer, each t within 8 epsilon of the expected one, sorted, and
/// none before one that exactly comes first. `expected` is sorted by index.
pub fn assert_exact<S: Scalar>(
    found: &[(usize, S)],
    expected: &[(usize, f64)],
    context: &dyn std::fmt::Debug,
) {
    let near = |a: f64, b: f64| (a - b).abs() <= 8.0 * S::EPSILON.to_f64() * b.abs();
    let exact: Option<Vec<f64>> = found
        .iter()
        .map(|hit| expected.binary_search_by_key(&hit.0, |e| e.0).map(|i| expected[i].1).ok())
        .collect();
    let is_exact = found.len() == expected.len()
        && found.is_sorted_by(|a, b| (a.1, a.0) < (b.1, b.0))
        && exact.is_some_and(|exact| {
            exact.is_sorted_by(|&a, &b| a <= b || near(a, b))
                && found.iter().zip(&exact).all(|(hit, &exact)| near(hit.1.to_f64(), exact))
        });
    assert!(is_exact, "{context:?}: {found:?}, exactly {expected:?}");
}
