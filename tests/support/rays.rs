//! Rays of the kinds that renderers trace.
//!
//! The coherence of neighbouring rays makes a kind fast or slow.

use super::scenes::NamedScene;
use bvhkit::{Aabb, Bvh, Intersect, Ray, Triangle};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::f32::consts::TAU;

/// A primitive from which rays can start.
pub trait Surface: Intersect<Scalar = f32> + Copy + Sync {
    /// Returns the normal at a hit point, on either side; `None` if there is none.
    fn normal(&self, at: Vec3) -> Option<Vec3>;
}

impl Surface for Triangle {
    fn normal(&self, _: Vec3) -> Option<Vec3> {
        let [a, b, c] = [self.a, self.b, self.c].map(Vec3::from);
        (b - a).cross(c - a).try_normalize()
    }
}

/// Rays of each kind.
pub struct Rays {
    /// Coherent rays from a pinhole camera, by rows of its picture.
    pub primary: Vec<Ray>,
    /// One diffuse bounce: from primary hits, cosine-distributed about the normal.
    pub diffuse: Vec<Ray>,
    /// From primary hits to a lamp beside the camera, where the rays end.
    pub shadow: Vec<Ray>,
    /// Incoherent rays: from anywhere in the scene's box in any direction.
    pub random: Vec<Ray>,
}

impl Rays {
    /// Generates `n` rays of each kind, among the scene's triangles or their stand-ins.
    ///
    /// There are no diffuse and shadow rays if the camera sees nothing.
    pub fn new<P: Surface>(primitives: &[P], scene: &NamedScene, n: usize) -> Self {
        let mut rng = Pcg32::seed_from_u64(4);
        let primary = camera(scene, n);
        let surface = seen(primitives, scene, &primary);
        let aabb = primitives.iter().fold(Aabb::EMPTY, |aabb, primitive| aabb.union(primitive.aabb()));
        let (min, max) = (Vec3::from(aabb.min), Vec3::from(aabb.max));

        let diffuse = |&(point, normal): &(Vec3, Vec3)| {
            let direction = normal + sphere(&mut rng);
            Ray::new(point, direction.normalize_or(normal))
        };
        let diffuse = surface.iter().cycle().take(n).map(diffuse).collect();

        let forward = scene.target - scene.eye;
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X) * forward.length();
        let lamp = scene.eye + 0.2 * right + 0.2 * forward.length() * Vec3::Y;
        let shadow = |&(point, _): &(Vec3, Vec3)| {
            let way = lamp + 0.05 * forward.length() * sphere(&mut rng) - point;
            // The ray ends short of the lamp, which it would hit if the lamp had a shape.
            Ray::new(point, way.normalize()).with_interval(0.0, 0.999 * way.length())
        };
        let shadow = surface.iter().cycle().take(n).map(shadow).collect();

        let random = (0..n)
            .map(|_| {
                let origin = min + (max - min) * Vec3::from_array(rng.random());
                Ray::new(origin, sphere(&mut rng))
            })
            .collect();
        Self { primary, diffuse, shadow, random }
    }
}

/// Returns the rays of a square picture, 60 degrees wide.
///
/// If `n` is not a square number, they are the first `n` rays of the picture.
fn camera(scene: &NamedScene, n: usize) -> Vec<Ray> {
    let side = (n as f32).sqrt().ceil() as usize;
    let forward = (scene.target - scene.eye).normalize();
    let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(forward);
    let half_width = 30.0_f32.to_radians().tan();
    (0..n)
        .map(|i| {
            let [x, y] = [i % side, i / side].map(|k| 2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
            Ray::new(scene.eye, (forward + half_width * (x * right - y * up)).normalize())
        })
        .collect()
}

/// Returns the points where rays first hit, with the normal on the ray's side.
///
/// The points are lifted slightly off the surface, so that a ray that starts there
/// does not hit the surface again.
pub fn seen<P: Surface>(primitives: &[P], scene: &NamedScene, rays: &[Ray]) -> Vec<(Vec3, Vec3)> {
    let bvh = Bvh::build(primitives.iter().copied()).expect("the scene's coordinates are finite");
    let lift = 1e-5 * scene.eye.distance(scene.target);
    let look = |ray: &Ray| {
        let hit = bvh.closest_hit(ray)?;
        let at = Vec3::from(ray.at(hit.t));
        let normal = primitives[hit.index].normal(at)?;
        let normal = if normal.dot(ray.direction.into()) > 0.0 { -normal } else { normal };
        Some((at + lift * normal, normal))
    };
    rays.iter().filter_map(look).collect()
}

/// Returns a direction, uniformly distributed over the unit sphere.
pub fn sphere(rng: &mut Pcg32) -> Vec3 {
    let z = 1.0 - 2.0 * rng.random::<f32>();
    let (sin, cos) = (TAU * rng.random::<f32>()).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, r * sin, z)
}
