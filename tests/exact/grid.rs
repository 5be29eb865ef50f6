//! Every triangle on a small grid, against exact arithmetic in integers.
//!
//! Rays go from grid points along {-1, -0, +0, 1}^3, in every mode. They meet edges, corners,
//! coplanar faces and triangles without area by the thousand.

use crate::common::integers::{self, Point, assert_exact, exact_t};
use crate::common::modes::Mode;
use bvhkit::{Bvh, Fast, Precise, Ray, Scalar, Triangle, Watertight};

fn grid(range: std::ops::Range<i32>) -> Vec<Point> {
    let all = || range.clone();
    all().flat_map(|x| all().flat_map(move |y| all().map(move |z| [x, y, z]))).collect()
}

/// Returns every choice of three corners, equal ones included.
///
/// The triangles take turns through the six orders of their corners.
fn triangles(corners: &[Point]) -> Vec<[Point; 3]> {
    let mut triangles = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i) {
            for &c in &corners[j..] {
                let mut triangle = [a, b, c];
                triangle.rotate_left(triangles.len() % 3);
                if triangles.len() % 2 == 1 {
                    triangle.swap(0, 1);
                }
                triangles.push(triangle);
            }
        }
    }
    triangles
}

/// Returns {-1, -0, +0, 1}^3 without its zero vectors.
fn directions() -> Vec<[f64; 3]> {
    let components = grid(0..4).into_iter().map(|point| point.map(|i| [-1.0, -0.0, 0.0, 1.0][i as usize]));
    components.filter(|&direction| direction != [0.0; 3]).collect()
}

/// A tree over the scene in one mode.
struct Tree<M: Mode>(Bvh<M>);

/// A tree in any mode, with the query hidden behind the type of its scalar.
trait Asked {
    fn check(&self, origin: Point, direction: [f64; 3], t_min: f64, expected: &[(usize, f64)]);
}

impl<M: Mode> Asked for Tree<M> {
    fn check(&self, origin: Point, direction: [f64; 3], t_min: f64, expected: &[(usize, f64)]) {
        let s = M::Number::from_f64;
        let ray = Ray::new(integers::point::<M::Number>(origin), direction.map(s))
            .with_interval(s(t_min), M::Number::INFINITY);
        let found: Vec<_> = self.0.hits(&ray).map(|hit| (hit.index, hit.t)).collect();
        assert_exact(&found, expected, &(std::any::type_name::<M>(), ray));
        let closest = self.0.closest_hit(&ray).map(|hit| (hit.index, hit.t));
        assert_eq!((closest, self.0.any_hit(&ray)), (found.first().copied(), !found.is_empty()), "{ray:?}");
    }
}

/// Checks every `step`th ray from `origins`; returns the number of hits.
fn check(corners: std::ops::Range<i32>, origins: std::ops::Range<i32>, step: usize, t_min: f64) -> usize {
    let scene = triangles(&grid(corners));
    fn tree<M: Mode + 'static>(scene: &[[Point; 3]]) -> Box<dyn Asked> {
        let triangles = scene.iter().map(|&corners| M::of(integers::triangle(corners)));
        let bvh = Bvh::build(triangles).unwrap();
        // Triangles without area are counted too.
        assert_eq!(bvh.len(), scene.len());
        Box::new(Tree(bvh))
    }
    let modes = [
        tree::<Fast<Triangle>>(&scene),
        tree::<Watertight<Triangle>>(&scene),
        tree::<Precise<Triangle>>(&scene),
        tree::<Fast<Triangle<f64>>>(&scene),
        tree::<Watertight<Triangle<f64>>>(&scene),
    ];
    let directions = directions();
    assert_eq!(directions.len(), 56);
    let rays = grid(origins).into_iter().flat_map(|origin| directions.iter().map(move |&d| (origin, d)));
    let mut hits = 0;
    for (origin, direction) in rays.step_by(step) {
        let whole = direction.map(|x| x as i32);
        let expected: Vec<_> = (scene.iter().enumerate())
            .filter_map(|(index, &corners)| Some((index, exact_t(corners, origin, whole)?)))
            .filter(|&(_, t)| t >= t_min)
            .collect();
        hits += expected.len();
        modes.iter().for_each(|mode| mode.check(origin, direction, t_min, &expected));
    }
    hits
}

#[test]
fn all_triangles_of_two_by_two_by_two_corners() {
    let hits = check(0..2, -2..4, 1, 0.0);
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn all_of_these_behind_the_origin_too() {
    let hits = check(0..2, -1..3, 1, f64::NEG_INFINITY);
    assert!(hits > 20_000, "{hits}");
}

#[test]
fn all_triangles_of_three_by_three_by_three_corners() {
    let hits = check(-1..2, -2..3, 3, 0.0);
    assert!(hits > 100_000, "{hits}");
}
