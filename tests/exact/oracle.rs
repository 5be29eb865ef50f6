//! The exact oracle against a second method with other big numbers.

use crate::common::aimed::{aimed, soup, triangles};
use crate::common::rational::{self, Meeting, is_nearest, spacing};
use bvhkit::reference::exact::{self, ExactHit, Fraction};
use bvhkit::{Ray, Scalar, Triangle};
use num_rational::BigRational;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn value(t: &Fraction) -> BigRational {
    t.to_string().parse().unwrap()
}

/// Compares all answers of the oracle for a ray; returns the number of hits.
fn assert_agrees<S: Scalar>(scene: &[Triangle<S>], ray: &Ray<S>) -> usize {
    let meetings: Vec<_> = scene.iter().map(|triangle| rational::meeting(triangle, ray)).collect();
    for (triangle, meeting) in scene.iter().zip(&meetings) {
        match (exact::edge_slack(triangle, ray), meeting) {
            (None, None) => {}
            (Some(slack), Some(meeting)) => {
                assert!(is_nearest(slack, &meeting.slack), "{ray:?} {triangle:?}")
            }
            (slack, meeting) => panic!("{slack:?}, {:?}", meeting.is_some()),
        }
    }
    let hit = |meeting: &Option<Meeting>| {
        let meeting = meeting.as_ref().filter(|meeting| meeting.is_hit(ray))?;
        Some(meeting.t.clone())
    };
    let mut expected: Vec<_> =
        meetings.iter().enumerate().filter_map(|(index, meeting)| Some((hit(meeting)?, index))).collect();
    expected.sort();
    let ties = expected.iter().take_while(|hit| hit.0 == expected[0].0).count();
    let plain = |hits: &[ExactHit]| hits.iter().map(|hit| (value(&hit.t), hit.index)).collect::<Vec<_>>();

    let found = exact::hits(scene, ray);
    assert_eq!(plain(&found), expected, "{ray:?} {scene:?}");
    assert_eq!(plain(&exact::closest_hits(scene, ray)), expected[..ties], "{ray:?} {scene:?}");
    assert_eq!(exact::any_hit(scene, ray), !expected.is_empty());
    for (hit, (t, index)) in found.iter().zip(&expected) {
        assert_rounds::<f32>(&hit.t, t);
        assert_rounds::<f64>(&hit.t, t);
        assert_ends_agree(&scene[*index], ray, meetings[*index].as_ref().unwrap());
    }
    found.len()
}

/// Checks the rounding of t, and its error.
fn assert_rounds<S: Scalar>(t: &Fraction, exact_t: &BigRational) {
    let rounded = t.to_scalar::<S>();
    assert!(is_nearest(rounded, exact_t), "{t} to {rounded:?}");
    if !rounded.is_finite() {
        return;
    }
    assert!(t.ulps_from(rounded).abs() <= 0.5);
    let spacing = spacing(rounded, exact_t);
    for x in [rounded, rounded.next_up(), S::ONE] {
        let Some(exact_x) = rational::exact(x) else { continue };
        assert_eq!(t.cmp_scalar(x), exact_t.cmp(&exact_x));
        assert!(is_nearest(t.ulps_from(x), &((exact_x - exact_t) / &spacing)), "{t} from {x:?}");
    }
}

/// Checks intervals that begin or end at the number nearest to t, or next to it.
fn assert_ends_agree<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>, meeting: &Meeting) {
    let t = exact::intersect(triangle, ray).unwrap().to_scalar::<S>();
    for end in [t.next_down(), t, t.next_up()] {
        for (t_min, t_max) in [(S::NEG_INFINITY, end), (end, S::INFINITY), (end, end)] {
            let ray = ray.with_interval(t_min, t_max);
            let found = exact::intersect(triangle, &ray).is_some();
            assert_eq!(found, meeting.is_hit(&ray), "{ray:?} {triangle:?}");
        }
    }
}

const AHEAD: (f64, f64) = (0.0, f64::INFINITY);
const LINE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Checks small whole coordinates; each ray has a scene of its own.
///
/// Corners and origins are from {-1, 0, 1}^3. Directions are all of {-1, -0, 0, 1}^3.
fn grid<S: Scalar>(mut next: usize) -> usize {
    let point = |i: usize| [i % 3, i / 3 % 3, i / 9 % 3].map(|x| S::from_f64(x as f64 - 1.0));
    let mut hits = 0;
    for origin in 0..27 {
        for direction in 0..64 {
            let parts = [direction % 4, direction / 4 % 4, direction / 16];
            let direction = parts.map(|x| S::from_f64([-1.0, -0.0, 0.0, 1.0][x]));
            let triangle = |_| {
                // Multiplication by 5 modulo a prime near 27^3: a sequence with a period of 984.
                next = next * 5 % 19_681;
                Triangle::new(point(next), point(next / 27), point(next / 729))
            };
            let scene: Vec<_> = (0..6).map(triangle).collect();
            let (t_min, t_max) = if origin % 2 == 0 { LINE } else { AHEAD };
            let ray = Ray::new(point(origin), direction);
            hits += assert_agrees(&scene, &ray.with_interval(S::from_f64(t_min), S::from_f64(t_max)));
        }
    }
    hits
}

#[test]
fn grids() {
    assert!(grid::<f32>(1) > 1000);
    assert!(grid::<f64>(2) > 1000);
}

/// Checks ordinary triangles with rays at corners, edges and the inside.
///
/// One ray in four goes along an axis through a corner.
fn ordinary<S: Scalar>(change: impl Fn(usize, f64) -> f64) -> usize {
    let scene = triangles::<S>(&soup(24), change);
    aimed(&scene).iter().map(|ray| assert_agrees(&scene, ray)).sum()
}

#[test]
fn ordinary_triangles_with_aimed_rays() {
    assert!(ordinary::<f32>(|_, x| x) > 100);
    assert!(ordinary::<f64>(|_, x| x) > 100);
    // With multiples of 1/64 the directions and their targets are exact.
    assert!(ordinary::<f32>(|_, x| (x * 64.0).round() / 64.0) > 100);
    assert!(ordinary::<f64>(|_, x| (x * 64.0).round() / 64.0) > 100);
}

/// Checks scenes with coordinates of all magnitudes.
///
/// Rays aim at corners, edges and the inside.
fn magnitudes<S: Scalar>(log_range: std::ops::Range<f64>, rays: usize) -> usize {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut hits = 0;
    for i in 0..rays {
        let mut coordinate = || {
            let size = 10f64.powf(rng.random_range(log_range.clone()));
            S::from_f64(if rng.random() { size } else { -size })
        };
        let mut point = || [0; 3].map(|_| coordinate());
        let scene: Vec<_> = (0..3).map(|_| Triangle::new(point(), point(), point())).collect();
        let Triangle { a, b, c } = scene[i % 3];
        let origin = if i % 5 == 0 { scene[(i + 1) % 3].b } else { point() };
        let weights = [[0.0, 1.0, 0.0], [0.5, 0.0, 0.5], [0.25, 0.5, 0.25]][i / 3 % 3].map(S::from_f64);
        let direction =
            [0, 1, 2].map(|k| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2] - origin[k]);
        hits += assert_agrees(&scene, &Ray::new(origin, direction));
    }
    hits
}

#[test]
fn mixed_magnitudes() {
    assert!(magnitudes::<f32>(-45.0..38.0, 150) > 20);
    assert!(magnitudes::<f32>(-45.5..-43.0, 150) > 20);
    assert!(magnitudes::<f64>(-45.0..38.0, 100) > 10);
    assert!(magnitudes::<f64>(-320.0..308.0, 15) > 2);
}

/// Checks arbitrary bits; every other ray starts at a corner.
fn any_bits<S: Scalar>(bits: &[u64], number: impl Fn(u64) -> S) {
    let point = |i: usize| [0, 1, 2].map(|k| number(bits[3 * i + k]));
    let scene = [Triangle::new(point(0), point(1), point(2)), Triangle::new(point(2), point(3), point(4))];
    let (origin, target) = if bits[0] & 1 == 0 { (point(5), point(6)) } else { (point(3), point(0)) };
    let direction = match bits[1] & 3 {
        0 => target,
        _ => [0, 1, 2].map(|k| target[k] - origin[k]),
    };
    let ray = Ray::new(origin, direction);
    assert_agrees(&scene, &ray);
    assert_agrees(&scene, &ray.with_interval(number(bits[21]), number(bits[22])));
}

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn any_bits_of_f32(bits in prop::collection::vec(any::<u64>(), 23)) {
        any_bits(&bits, |bits| f32::from_bits(bits as u32));
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn any_bits_of_f64(bits in prop::collection::vec(any::<u64>(), 23)) {
        any_bits(&bits, f64::from_bits);
    }
}
