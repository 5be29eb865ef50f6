//! The lighting of the camera's view: a sun if its light gets there, else lamps.

use std::f32::consts::PI;

use bvhkit::Ray;
use glam::Vec3;

use super::super::{Camera, Light, Scene, Sky};
use super::{Sight, Survey, directions, raster};

/// The share of visible points that the sun has to reach.
const ENOUGH_SUN: f32 = 0.25;
const MAX_LAMPS: usize = 6;
/// The distance up to which a lamp's light is of use, in heights of the room.
const REACH: f32 = 2.5;

/// Returns whether all light comes from distant lights.
pub fn is_sunlight_only(scene: &Scene) -> bool {
    let distant = |light: &Light| matches!(light, Light::Directional { .. });
    let emits = scene.surfaces.iter().any(|it| scene.materials[it.material].is_emitter());
    !emits && !scene.lights.is_empty() && scene.lights.iter().all(distant)
}

/// Chooses lights and a sky for the camera's picture.
pub fn choose(survey: &Survey<'_>, camera: &Camera) -> (Vec<Light>, Sky) {
    let rays = raster(12, 9).map(|image| camera.ray(image, 4.0 / 3.0));
    let seen: Vec<Sight> = rays.filter_map(|ray| survey.look(&ray)).collect();
    let sky = Sky::day(survey.up);
    match sun(survey, camera, &seen) {
        Some(direction) => {
            let irradiance = PI * Vec3::new(1.75, 1.6, 1.35);
            (vec![Light::Directional { direction: -direction, irradiance }], sky)
        }
        // Little light of a bright sky would get in by the windows: more noise than light.
        None => (lamps(survey, camera, &seen), sky.scaled(0.08)),
    }
}

/// Returns the direction towards the sun, if one lights enough of the picture.
///
/// The first choice is over the camera's left shoulder. The second is the high direction that
/// lights most of the picture: light comes into a court from above, whereas a low sun through a
/// window only makes a spot on the floor.
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
    let high = directions(48).filter(|direction| direction.dot(survey.up) > 0.7);
    let best = high.map(|direction| (lit(direction), direction)).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|best| best.0 > ENOUGH_SUN).map(|best| best.1)
}

/// Returns square lamps that shine down from below the ceiling.
///
/// Each lamp is put where it reaches most of the points that the lamps before it leave dark, as
/// long as these are enough to be worth a lamp. Candidates hang above the points in the picture and
/// above the camera. Those below furniture are left out, because the ceiling is low there.
fn lamps(survey: &Survey<'_>, camera: &Camera, seen: &[Sight]) -> Vec<Light> {
    let up = survey.up;
    let floor = seen.iter().filter(|sight| sight.normal.dot(up) > 0.7).map(|sight| sight.point);
    let mut candidates: Vec<Lamp> = floor
        .chain([camera.position])
        .filter_map(|below| {
            let start = below + 1e-4 * survey.region.diagonal() * up;
            let height = survey.look(&Ray::new(start, up))?.t;
            Some(Lamp { position: below + 0.9 * height * up, height })
        })
        .collect();
    let highest = candidates.iter().map(|lamp| lamp.position.dot(up)).fold(f32::MIN, f32::max);
    let lowest = survey.region.min.dot(up.abs());
    candidates.retain(|lamp| lamp.position.dot(up) - lowest > 0.6 * (highest - lowest));

    let mut dark: Vec<&Sight> = seen.iter().collect();
    let mut lights = Vec::new();
    while lights.len() < MAX_LAMPS {
        let reached = |lamp: &Lamp| dark.iter().filter(|sight| lamp.reaches(survey, sight)).count();
        let best = candidates.iter().map(|lamp| (reached(lamp), lamp)).max_by_key(|it| it.0);
        let Some((count, lamp)) = best else { break };
        if count * 10 < seen.len() {
            break;
        }
        dark.retain(|sight| !lamp.reaches(survey, sight));
        lights.push(lamp.light(up));
    }
    lights
}

/// A place for a lamp, and its height above the point below it.
struct Lamp {
    position: Vec3,
    height: f32,
}

impl Lamp {
    /// Returns whether the light reaches a visible point and is not too faint there.
    fn reaches(&self, survey: &Survey<'_>, sight: &Sight) -> bool {
        let way = self.position - sight.point;
        let near = way.length() < REACH * self.height;
        near && way.dot(survey.up) > 0.0 && survey.is_clear(sight, way, 0.99)
    }

    fn light(&self, up: Vec3) -> Light {
        let side = 0.35 * self.height;
        let (u, v) = up.any_orthonormal_pair();
        // `u` and `v` are in the order in which the front faces down.
        let (u, v) = if u.cross(v).dot(up) < 0.0 { (u, v) } else { (v, u) };
        let corner = self.position - 0.5 * side * (u + v);
        Light::Rectangle { corner, u: side * u, v: side * v, radiance: Vec3::new(11.0, 10.0, 8.5) }
    }
}
