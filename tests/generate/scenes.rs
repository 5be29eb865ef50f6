//! Strategies for soups of corners, with ordinary and awkward coordinates.

use super::numbers::{exponent, log_uniform, scalar_from_bits};
use super::primitives::Corners;
use bvhkit::Scalar;
use proptest::prelude::*;

type Point = [f64; 3];

/// Fewer than 60 primitives whose coordinates are awkward in one way.
pub fn soup<S: Scalar>() -> impl Strategy<Value = Vec<Corners<S>>> {
    let plain = || around(point(10.0), 1.0);
    let kinds = prop_oneof![
        several(plain()),
        several(clustered()),
        several(without_area()),
        several(sliver()),
        several(on_grid(0..5)),
        // Only 8 different corners, so that many primitives are equal.
        several(on_grid(0..2)),
        several(plain().prop_map(|corners| scaled(corners, 1e30))),
        several(plain().prop_map(|corners| scaled(corners, 1e-30))),
        several((plain(), -6.0..6.0).prop_map(|(corners, exponent)| scaled(corners, 10f64.powf(exponent)))),
        several(plain().prop_map(|corners| corners.map(|point| point.map(|x| x + 1e7)))),
    ];
    let rounded = kinds.prop_map(|soup| soup.into_iter().map(|c| c.map(|p| p.map(S::from_f64))).collect());
    prop_oneof![
        10 => rounded,
        1 => prop::collection::vec(from_bits(), 0..60),
        // Any exponent: one for each coordinate, each primitive, or the whole scene.
        1 => prop::collection::vec([(); 3].map(|()| [(); 3].map(|()| log_uniform())), 0..60)
            .prop_map(|soup| soup.into_iter().map(|c| c.map(|p| p.map(|x| x.number()))).collect()),
        1 => prop::collection::vec((plain(), exponent()), 0..60)
            .prop_map(|soup| soup.into_iter().map(|(c, e)| c.map(|p| p.map(|x| e.scale(x / 16.0)))).collect()),
        1 => (several(plain()), exponent())
            .prop_map(|(soup, e)| soup.into_iter().map(|c| c.map(|p| p.map(|x| e.scale(x / 16.0)))).collect()),
    ]
}

fn from_bits<S: Scalar>() -> impl Strategy<Value = Corners<S>> {
    any::<[[u64; 3]; 3]>().prop_map(|corners| corners.map(|point| point.map(scalar_from_bits)))
}

fn several(corners: impl Strategy<Value = [Point; 3]> + 'static) -> BoxedStrategy<Vec<[Point; 3]>> {
    prop::collection::vec(corners, 0..60).boxed()
}

fn point(size: f64) -> impl Strategy<Value = Point> + Clone {
    [-size..size, -size..size, -size..size]
}

fn around(center: impl Strategy<Value = Point>, size: f64) -> impl Strategy<Value = [Point; 3]> {
    (center, point(size), point(size)).prop_map(|(a, b, c)| [a, add(a, b, 1.0), add(a, c, 1.0)])
}

fn clustered() -> impl Strategy<Value = [Point; 3]> {
    let centers = prop::sample::select(vec![[0.0; 3], [5.0, 0.0, 0.0], [5.0, 100.0, -3.0]]);
    let near = (centers, point(0.1)).prop_map(|(center, offset)| add(center, offset, 1.0));
    around(near, 0.05)
}

/// Returns a point, a segment with a doubled end, or three points on a line.
fn without_area() -> impl Strategy<Value = [Point; 3]> {
    (point(3.0), point(3.0), 0..4).prop_map(|(a, b, kind)| match kind {
        0 => [a; 3],
        1 => [a, a, b],
        2 => [a, b, b],
        _ => [a, b, add(a, add(b, a, -1.0), 2.0)],
    })
}

/// Returns a triangle about a million times as long as wide.
fn sliver() -> impl Strategy<Value = [Point; 3]> {
    (point(10.0), point(10.0), point(1e-5)).prop_map(|(a, along, aside)| {
        let b = add(a, along, 1.0);
        [a, b, add(b, aside, 1.0)]
    })
}

/// Returns corners with small whole coordinates.
///
/// They give plenty of shared edges, coplanar faces and equal t.
fn on_grid(range: std::ops::Range<i8>) -> impl Strategy<Value = [Point; 3]> {
    let coordinate = move || range.clone().prop_map(f64::from);
    let point = move || [coordinate(), coordinate(), coordinate()];
    [point(), point(), point()]
}

fn scaled(corners: [Point; 3], scale: f64) -> [Point; 3] {
    corners.map(|point| point.map(|x| x * scale))
}

fn add(a: Point, b: Point, scale: f64) -> Point {
    [0, 1, 2].map(|axis| a[axis] + b[axis] * scale)
}
