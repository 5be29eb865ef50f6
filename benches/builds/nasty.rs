//! Triangles that are hard to build over, or would be for a careless builder.

use crate::scenes::soup::{self, cube, triangle};
use bvhkit::Triangle;
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

/// Returns one list of `n` triangles of each kind. The first is well-behaved.
pub fn all(n: usize) -> Vec<(&'static str, Vec<Triangle>)> {
    let soup = soup::scattered(n);
    let mut sorted = soup.clone();
    sorted.sort_by(|one, other| one.a[0].total_cmp(&other.a[0]));
    let reversed = sorted.iter().rev().copied().collect();
    let side = (n as f32).sqrt().ceil() as usize;
    let part = |i: usize| (i + 1) as f32 / n as f32;
    vec![
        ("soup", soup),
        ("identical", vec![Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]); n]),
        ("one centroid, all sizes", list(n, |i, _| around_zero(part(i)))),
        ("slivers", list(n, |_, rng| sliver(rng))),
        (
            "huge and tiny",
            list(n, |_, rng| triangle(cube(rng), 10_f32.powf(11.0 * rng.random::<f32>() - 6.0), rng)),
        ),
        ("sorted", sorted),
        ("reversed", reversed),
        ("giant over dust", list(n, |i, rng| triangle(cube(rng), if i == n / 2 { 1e3 } else { 1e-4 }, rng))),
        ("shells", list(n, |i, rng| on_sphere((i % 50 + 1) as f32, rng))),
        ("large, overlapping", list(n, |_, rng| triangle(cube(rng), 2.0, rng))),
        ("flat grid", list(n, |i, _| level(Vec3::new((i % side) as f32, 0.0, (i / side) as f32), 1.0))),
        ("growing gaps", list(n, |i, _| growing(10_f32.powf(24.0 * part(i) - 12.0)))),
    ]
}

fn list(n: usize, mut triangle: impl FnMut(usize, &mut Pcg32) -> Triangle) -> Vec<Triangle> {
    let mut rng = Pcg32::seed_from_u64(8);
    (0..n).map(|i| triangle(i, &mut rng)).collect()
}

/// Returns a triangle whose box has its center exactly at the origin.
fn around_zero(size: f32) -> Triangle {
    let corners = [Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, -0.3, 0.2), Vec3::new(0.1, 1.0, 1.0)];
    let [a, b, c] = corners.map(|corner| size * corner);
    Triangle::new(a, b, c)
}

/// Returns a triangle half as long as the cube and a millionth wide.
///
/// It has any direction.
fn sliver(rng: &mut Pcg32) -> Triangle {
    let (start, along, across) = (cube(rng), cube(rng) - 0.5, cube(rng) - 0.5);
    Triangle::new(start, start + along, start + 0.5 * along + 1e-6 * across)
}

/// Returns a triangle on a sphere around the origin.
///
/// Many such triangles cover the sphere.
fn on_sphere(radius: f32, rng: &mut Pcg32) -> Triangle {
    let away = (cube(rng) - 0.5).normalize_or(Vec3::X);
    let (right, up) = away.any_orthonormal_pair();
    let (center, size) = (radius * away, 0.1 * radius);
    Triangle::new(center, center + size * right, center + size * up)
}

/// Returns a horizontal triangle with a corner at `at`.
fn level(at: Vec3, size: f32) -> Triangle {
    Triangle::new(at, at + size * Vec3::X, at + size * Vec3::Z)
}

/// Returns a triangle that is far smaller than the gap to the next.
fn growing(x: f32) -> Triangle {
    let (at, size) = (x * Vec3::X, 1e-6 * x);
    Triangle::new(at, at + size * Vec3::Y, at + size * Vec3::ONE)
}
