//! Path tracing: the radiance that arrives along a ray.
//!
//! Paths are unidirectional, with direct light sampled at every diffuse vertex (Kajiya, "The
//! Rendering Equation", SIGGRAPH 1986). The sky is the exception: paths that escape find it.

use std::f32::consts::FRAC_1_PI;

use bvhkit::{Barycentrics, Ray, SurfacePoint, Triangle};
use glam::Vec3;
use rand::RngExt;
use rand_pcg::Pcg32;

use crate::lights::Lights;
use crate::sampling;
use crate::scene::{Material, Scene, Shape};
use crate::tracer::{Caster, Hit};

/// Number of bounces after which Russian roulette decides whether a path goes on.
const ROULETTE_START: u32 = 3;

pub struct Integrator<'a> {
    scene: &'a Scene,
    lights: Lights<'a>,
    max_bounces: u32,
}

impl<'a> Integrator<'a> {
    pub fn new(scene: &'a Scene, max_bounces: u32) -> Self {
        Self { scene, lights: Lights::new(scene), max_bounces }
    }

    /// Estimates the radiance that arrives at the origin of `ray`, by one path.
    pub fn radiance(&self, ray: &Ray, caster: &mut Caster<'_>, rng: &mut Pcg32) -> Vec3 {
        let mut ray = *ray;
        let mut radiance = Vec3::ZERO;
        let mut throughput = Vec3::ONE;
        // Whether the direct sampling could not reach the light that the ray may meet.
        let mut sees_emitters = true;

        for bounce in 0.. {
            let Some(hit) = caster.closest_hit(&ray) else {
                let direction = Vec3::from(ray.direction);
                let sky = self.scene.sky.map_or(Vec3::ZERO, |sky| sky.radiance(direction));
                return radiance + throughput * sky;
            };
            let vertex = self.vertex(&ray, &hit);
            let direction = match *self.scene.material(hit.index) {
                Material::Emitter { radiance: emitted } => {
                    let visible = sees_emitters && vertex.front;
                    return if visible { radiance + throughput * emitted } else { radiance };
                }
                Material::Diffuse { albedo } => {
                    throughput *= albedo;
                    radiance += throughput * self.direct(&vertex, caster, rng);
                    sees_emitters = false;
                    sampling::cosine_hemisphere(vertex.shading, rng)
                }
                Material::Mirror { reflectance } => {
                    throughput *= reflectance;
                    sees_emitters = true;
                    Vec3::from(ray.direction).reflect(vertex.shading)
                }
                Material::Glass { transmittance, ior } => {
                    sees_emitters = true;
                    let eta = if vertex.front { 1.0 / ior } else { ior };
                    let incoming = Vec3::from(ray.direction);
                    let (direction, refracted) = scatter_glass(incoming, vertex.shading, eta, rng);
                    if refracted {
                        throughput *= transmittance;
                    }
                    direction
                }
            };
            // A shading normal can send a ray to the wrong side of the
            // surface. The path ends there.
            let crosses = direction.dot(vertex.geometric) < 0.0;
            let transmits = matches!(self.scene.material(hit.index), Material::Glass { .. });
            if bounce == self.max_bounces || (crosses && !transmits) {
                return radiance;
            }
            if bounce >= ROULETTE_START {
                let survival = throughput.max_element().min(0.95);
                if rng.random::<f32>() >= survival {
                    return radiance;
                }
                throughput /= survival;
            }
            ray = vertex.surface.spawn(direction);
        }
        radiance
    }

    /// Returns the direct light at a diffuse vertex, as reflected by a white surface.
    fn direct(&self, vertex: &Vertex, caster: &mut Caster<'_>, rng: &mut Pcg32) -> Vec3 {
        let start = SurfacePoint { position: vertex.smooth_point.into(), ..vertex.surface };
        let start = Vec3::from(start.spawn(vertex.geometric).origin);
        let mut irradiance = Vec3::ZERO;
        for sample in self.lights.samples(start, rng) {
            let cos = sample.direction.dot(vertex.shading);
            if cos > 0.0 && !caster.any_hit(&sample.shadow_ray) {
                irradiance += cos * sample.irradiance;
            }
        }
        FRAC_1_PI * irradiance
    }

    /// Returns the shading normal of the camera ray's first surface, as a colour.
    pub fn normal_color(&self, ray: &Ray, caster: &mut Caster<'_>) -> Vec3 {
        let hit = caster.closest_hit(ray);
        hit.map_or(Vec3::ZERO, |hit| 0.5 * self.vertex(ray, &hit).shading + 0.5)
    }

    fn vertex(&self, ray: &Ray, hit: &Hit) -> Vertex {
        let shape = &self.scene.shapes[hit.index];
        let surface = shape.surface_point(ray, hit.t, hit.payload);
        let point = Vec3::from(surface.position);
        let outward = shape.normal(point);
        let front = Vec3::from(ray.direction).dot(outward) < 0.0;
        let geometric = if front { outward } else { -outward };
        let flat = Vertex { surface, smooth_point: point, geometric, shading: geometric, front };
        match (*shape, self.scene.surfaces[hit.index].normals, hit.payload) {
            (Shape::Triangle(triangle), Some(normals), Some(at)) => flat.smoothed(&triangle, normals, at),
            _ => flat,
        }
    }
}

/// A point of a path on a surface.
struct Vertex {
    surface: SurfacePoint,
    /// The point where shadow rays start.
    smooth_point: Vec3,
    /// The geometric normal, on the side that the ray came from.
    geometric: Vec3,
    /// The shading normal, on the same side.
    shading: Vec3,
    /// Whether the ray came to the front; for a glass body, from outside.
    front: bool,
}

impl Vertex {
    /// Returns the vertex on a triangle that stands for a curved surface.
    ///
    /// The surface has these normals at the triangle's corners.
    ///
    /// Shadow rays start from the curved surface. From the triangle, neighbouring triangles
    /// would block some of the rays that the shading normal calls lit. The edge of the
    /// shadow would show the triangles (Hanika, "Hacking the Shadow Terminator", Ray
    /// Tracing Gems II, 2021, chapter 4).
    fn smoothed(self, triangle: &Triangle, normals: [Vec3; 3], at: Barycentrics) -> Self {
        let weights = [1.0 - at.u - at.v, at.u, at.v];
        let corners = [triangle.a, triangle.b, triangle.c].map(Vec3::from);
        let mut shading = Vec3::ZERO;
        let mut lift = Vec3::ZERO;
        let point = Vec3::from(self.surface.position);
        for ((weight, corner), normal) in weights.into_iter().zip(corners).zip(normals) {
            // Near a silhouette and on the inside, normals face away from the ray.
            let normal = if normal.dot(self.geometric) < 0.0 { -normal } else { normal };
            shading += weight * normal;
            let below = (point - corner).dot(normal).min(0.0);
            lift -= weight * below * normal;
        }
        let shading = shading.normalize_or(self.geometric);
        Self { smooth_point: point + lift, shading, ..self }
    }
}

/// Reflects or refracts a ray at a smooth dielectric.
///
/// Each happens as often as Fresnel's equations give it light. `eta` is the ratio of the
/// refractive indices, from the incoming ray's side to the other. The second result tells
/// whether the ray was refracted.
fn scatter_glass(incoming: Vec3, normal: Vec3, eta: f32, rng: &mut Pcg32) -> (Vec3, bool) {
    let cos_in = (-incoming.dot(normal)).clamp(0.0, 1.0);
    let sin2_out = eta * eta * (1.0 - cos_in * cos_in);
    let reflected = incoming.reflect(normal);
    if sin2_out >= 1.0 {
        return (reflected, false);
    }
    let cos_out = (1.0 - sin2_out).sqrt();
    let parallel = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
    let perpendicular = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    let reflectance = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    if rng.random::<f32>() < reflectance {
        (reflected, false)
    } else {
        (eta * incoming + (eta * cos_in - cos_out) * normal, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_obeys_snell_and_reflects_four_percent_head_on() {
        let mut rng = sampling::pixel_rng(1);
        let incoming = Vec3::new(0.6, -0.8, 0.0);
        let refracted = std::iter::repeat_with(|| scatter_glass(incoming, Vec3::Y, 1.0 / 1.5, &mut rng))
            .find_map(|(direction, refracted)| refracted.then_some(direction))
            .unwrap();
        assert!((refracted.x - 0.6 / 1.5).abs() < 1e-6 && refracted.is_normalized());

        let count = 50_000;
        let reflections =
            (0..count).filter(|_| !scatter_glass(Vec3::NEG_Y, Vec3::Y, 1.0 / 1.5, &mut rng).1).count();
        assert!((reflections as f32 / count as f32 - 0.04).abs() < 0.005);
    }
}
