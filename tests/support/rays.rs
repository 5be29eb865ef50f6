//! Rays as renderers trace them, by kind: how well neighbours agree is what makes them quick or slow.

use super::scenes::NamedScene;
use bvhkit::{Aabb, Bvh, Intersect, Ray, Triangle};
use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::f32::consts::TAU;

/// What rays set out from.
pub trait Surface: Intersect<Scalar = f32> + Copy + Sync {
    /// The normal where it was hit, on either side; none where there is none.
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
    /// From a pinhole camera, by rows of its picture: coherent.
    pub primary: Vec<Ray>,
    /// From where primary rays hit, cosine-distributed about the normal: one diffuse bounce.
    pub diffuse: Vec<Ray>,
    /// From there to a lamp beside the camera, at which they end.
    pub shadow: Vec<Ray>,
    /// From anywhere in the scene's box to anywhere: incoherent.
    pub random: Vec<Ray>,
}

impl Rays {
    /// `n` primary and random rays; as many diffuse and shadow rays if the camera sees anything. Among the scene's
    /// triangles, or whatever is in their place.
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
            // Ends short of the lamp, which would be hit itself if it had a shape.
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

/// A square picture of `n` rays or, if `n` is no square, its first `n`; 60 degrees wide.
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

/// The points where rays first hit, each with the normal on the ray's side; lifted off the surface
/// by a little, so that what sets out there does not hit where it came from.
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

/// A direction, evenly distributed over the unit sphere.
pub fn sphere(rng: &mut Pcg32) -> Vec3 {
    let z = 1.0 - 2.0 * rng.random::<f32>();
    let (sin, cos) = (TAU * rng.random::<f32>()).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, r * sin, z)
}
