//! Direct light: samples points of the scene's lights for shadow rays.

use std::f32::consts::TAU;

use bvhkit::Ray;
use glam::Vec3;
use rand::RngExt;
use rand_pcg::Pcg32;

use crate::sampling;
use crate::scene::{Light, Material, Scene};

/// The share of the way that shadow rays go, so that they do not hit the light.
const SHADOW_LENGTH: f32 = 0.9999;

/// The lights of a scene.
///
/// Lights without shape are sampled one by one, and all emitting shapes as one light.
pub struct Lights<'a> {
    scene: &'a Scene,
    emitters: Vec<usize>,
    /// The sum of the emitters' power up to and including each; the last is the total.
    cumulative_power: Vec<f32>,
}

/// Light that reaches a point if the shadow ray is clear.
///
/// Its strength is `irradiance` times the cosine at the receiver.
pub struct LightSample {
    pub shadow_ray: Ray,
    pub direction: Vec3,
    pub irradiance: Vec3,
}

impl<'a> Lights<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let mut emitters = Vec::new();
        let mut cumulative_power = Vec::new();
        let mut total = 0.0;
        for (index, shape) in scene.shapes.iter().enumerate() {
            if let Material::Emitter { radiance } = scene.material(index) {
                let power = shape.area() * radiance.element_sum();
                if power > 0.0 {
                    total += power;
                    emitters.push(index);
                    cumulative_power.push(total);
                }
            }
        }
        Self { scene, emitters, cumulative_power }
    }

    /// Returns a sample of each light without shape, and one of all emitting shapes.
    pub fn samples(&self, point: Vec3, rng: &mut Pcg32) -> impl Iterator<Item = LightSample> {
        let emitter = self.sample_emitters(point, rng);
        let lights = self.scene.lights.iter();
        emitter.into_iter().chain(lights.filter_map(move |light| sample(light, point, rng)))
    }

    /// Samples a point of an emitting shape, which is chosen in proportion to power.
    fn sample_emitters(&self, point: Vec3, rng: &mut Pcg32) -> Option<LightSample> {
        let total = *self.cumulative_power.last()?;
        let chosen = rng.random::<f32>() * total;
        let chosen = self.cumulative_power.partition_point(|&power| power <= chosen);
        let index = *self.emitters.get(chosen).or(self.emitters.last())?;
        let Material::Emitter { radiance } = *self.scene.material(index) else { return None };

        let shape = &self.scene.shapes[index];
        let target = sampling::surface_point(shape, rng);
        let probability = shape.area() * radiance.element_sum() / total;
        let radiance = radiance / probability;
        from_area(point, target, shape.normal(target), radiance, shape.area())
    }
}

fn sample(light: &Light, point: Vec3, rng: &mut Pcg32) -> Option<LightSample> {
    match *light {
        Light::Directional { direction, irradiance } => {
            Some(LightSample { shadow_ray: Ray::new(point, -direction), direction: -direction, irradiance })
        }
        Light::Point { position, intensity } => {
            let way = position - point;
            let direction = way.try_normalize()?;
            let irradiance = intensity / way.length_squared();
            let shadow_ray = Ray::new(point, way).with_interval(0.0, SHADOW_LENGTH);
            Some(LightSample { shadow_ray, direction, irradiance })
        }
        Light::Rectangle { corner, u, v, radiance } => {
            let at = sampling::square(rng);
            let across = u.cross(v);
            let target = corner + at.x * u + at.y * v;
            from_area(point, target, across.try_normalize()?, radiance, across.length())
        }
    }
}

/// Returns the sample of an emitting area at `target`, which is chosen uniformly.
fn from_area(point: Vec3, target: Vec3, normal: Vec3, radiance: Vec3, area: f32) -> Option<LightSample> {
    let way = target - point;
    let direction = way.try_normalize()?;
    // No light covers more than a hemisphere, but a sample close to the light may give more.
    // Without this bound, such samples are white specks in the picture.
    let solid_angle = (-direction.dot(normal) * area / way.length_squared()).min(TAU);
    (solid_angle > 0.0).then(|| LightSample {
        shadow_ray: Ray::new(point, way).with_interval(0.0, SHADOW_LENGTH),
        direction,
        irradiance: radiance * solid_angle,
    })
}
