//! How to light what the camera sees: by a sun if it gets there, else by lamps.

use std::f32::consts::PI;

use glam::Vec3;

use super::super::{Camera, Light, Scene, Sky};
use super::{Sight, Survey, directions, raster};

/// The sun is used if it reaches this share of what is in the picture.
const ENOUGH_SUN: f32 = 0.2;
const MAX_LAMPS: usize = 3;

/// Whether all light comes from distant lights.
pub fn is_sunlight_only(scene: &Scene) -> bool {
    let distant = |light: &Light| matches!(light, Light::Directional { .. });
    let emits = scene.surfaces.iter().any(|it| scene.materials[it.material].is_emitter());
    !emits && !scene.lights.is_empty() && scene.lights.iter().all(distant)
}

/// Lights and a sky for the camera's picture.
pub fn choose(survey: &Survey<'_>, camera: &Camera) -> (Vec<Light>, Sky) {
    let rays = raster(12, 9).map(|image| camera.ray(image, 4.0 / 3.0));
    let seen: Vec<Sight> = rays.filter_map(|ray| survey.look(&ray)).collect();
    let sky = Sky::day(survey.up);
    match sun(survey, camera, &seen) {
        Some(direction) => {
            let irradiance = PI * Vec3::new(1.75, 1.6, 1.35);
            (vec![Light::Directional { direction: -direction, irradiance }], sky)
        }
        None => (lamps(survey, camera, &seen), sky),
    }
}

/// The direction towards the sun: over the camera's left shoulder if what is in the picture can be
/// lit from there, else the direction of the upper hemisphere that lights most of it.
fn sun(survey: &Survey<'_>, camera: &Camera, seen: &[Sight]) -> Option<Vec3> {
    let lit = |direction: Vec3| {
        let lit = seen.iter().filter(|sight| survey.is_clear(sight, direction, f32::INFINITY));
        lit.count() as f32 / seen.len().max(1) as f32
    };
    let shoulder = survey.up - 0.5 * camera.right() - 0.8 * camera.forward;
    let shoulder = shoulder.normalize_or(survey.up);
    if lit(shoulder) > ENOUGH_SUN {
        return Some(shoulder);
    }
    let high = directions(48).filter(|direction| direction.dot(survey.up) > 0.4);
    let best = high.map(|direction| (lit(direction), direction)).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|best| best.0 > ENOUGH_SUN).map(|best| best.1)
}

/// Square lamps that shine down from below the ceiling. Each is put where it reaches most of what
/// the ones before it leave dark; candidates hang above the points in the picture, and the camera.
fn lamps(survey: &Survey<'_>, camera: &Camera, seen: &[Sight]) -> Vec<Light> {
    let up = survey.up;
    let from_camera = Sight { t: 0.0, point: camera.position, normal: up, front: true };
    let floor = seen.iter().filter(|sight| sight.normal.dot(up) > 0.7);
    let candidates: Vec<(Vec3, f32)> = floor
        .chain([&from_camera])
        .filter_map(|below| {
            let start = below.point + 1e-4 * survey.region.diagonal() * up;
            let height = survey.look(&bvhkit::Ray::new(start, up))?.t;
            Some((below.point + 0.9 * height * up, height))
        })
        .collect();

    let mut dark: Vec<&Sight> = seen.iter().collect();
    let mut lights = Vec::new();
    for _ in 0..MAX_LAMPS {
        let reaches = |lamp: Vec3, sight: &Sight| {
            let way = lamp - sight.point;
            way.dot(up) > 0.0 && survey.is_clear(sight, way, 0.99)
        };
        let count = |lamp: Vec3| dark.iter().filter(|sight| reaches(lamp, sight)).count();
        let best = candidates.iter().map(|it| (count(it.0), it)).max_by_key(|it| it.0);
        let Some((count, &(lamp, height))) = best else { break };
        if count == 0 {
            break;
        }
        dark.retain(|sight| !reaches(lamp, sight));
        let (u, v) = up.any_orthonormal_pair();
        let (u, v) = (0.25 * height * u, 0.25 * height * v);
        let down = if u.cross(v).dot(up) < 0.0 { (u, v) } else { (v, u) };
        lights.push(Light::Rectangle {
            corner: lamp - 0.5 * (u + v),
            u: down.0,
            v: down.1,
            radiance: Vec3::new(11.0, 10.0, 8.5),
        });
    }
    lights
}
