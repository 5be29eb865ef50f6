//! The viewpoint: inside a room, or in front of an object.

use std::collections::HashSet;
use std::f32::consts::TAU;

use bvhkit::{Primitive, Ray};
use glam::{Vec2, Vec3};

use super::super::Camera;
use super::{Survey, directions, raster};

/// Width over height of the pictures by which viewpoints are judged.
const ASPECT: f32 = 4.0 / 3.0;
/// The vertical field of view in a room, in radians.
const ROOM_FOV: f32 = 1.1;
/// The vertical field of view of an object, in radians.
const OBJECT_FOV: f32 = 0.7;

/// Chooses a camera that sees the scene well.
pub fn choose(survey: &Survey<'_>) -> Camera {
    in_a_room(survey).unwrap_or_else(|| before_an_object(survey))
}

/// Chooses a viewpoint in a room, with a long free view.
///
/// `None` if no point of the scene is in a room.
fn in_a_room(survey: &Survey<'_>) -> Option<Camera> {
    if survey.region.is_part {
        return None;
    }
    let mut best = (0.0, None);
    for point in grid(survey) {
        let Some(space) = space_around(survey, point) else { continue };
        for direction in around(survey.up, 0.0, 16) {
            let target = point + direction - 0.1 * survey.up;
            let camera = Camera::look_at(point, target, survey.up, ROOM_FOV);
            let score = space.sqrt() * view_quality(survey, &camera);
            if score > best.0 {
                best = (score, Some(camera));
            }
        }
    }
    best.1
}

/// Returns points spread over the region, at about the height of eyes.
fn grid(survey: &Survey<'_>) -> impl Iterator<Item = Vec3> {
    const STEPS: usize = 7;
    let up = survey.up.abs();
    let (x, y) = survey.up.any_orthonormal_pair();
    let (x, y) = (x.abs(), y.abs());
    [0.25, 0.5].into_iter().flat_map(move |height| {
        raster(STEPS, STEPS).map(move |at| survey.region.at(height * up + at.x * x + at.y * y))
    })
}

/// Returns the space around a point of a room; `None` if it is not in a room.
///
/// A point in a room is surrounded by surfaces that face it at some distance. Inside a solid
/// object, rays meet back faces; beside an object, they leave the region.
fn space_around(survey: &Survey<'_>, point: Vec3) -> Option<f32> {
    let rays = 48;
    let mut facing = 0;
    let mut space = 0.0;
    for direction in directions(rays) {
        let sight = survey.look(&Ray::new(point, direction));
        if let Some(sight) = sight.filter(|it| it.front && survey.region.contains_nearly(it.point)) {
            facing += 1;
            space += sight.t / survey.region.diagonal() / rays as f32;
        }
    }
    (facing * 10 >= rays * 7 && space > 0.07).then_some(space)
}

/// Returns a score of the view, which is higher the more there is to see.
///
/// Long views count, those in the middle of the picture twice. The number of shapes counts too,
/// since bare walls have few. Surfaces near the lens, and back faces, are in the way.
fn view_quality(survey: &Survey<'_>, camera: &Camera) -> f32 {
    let diagonal = survey.region.diagonal();
    let mut depth = 0.0;
    let mut shapes = HashSet::new();
    for image in raster(8, 6) {
        let in_the_middle = (image - 0.5).abs().max_element() < 0.3;
        let (weight, near) = if in_the_middle { (2.0, 0.16) } else { (1.0, 0.08) };
        depth += match survey.look(&camera.ray(image, ASPECT)) {
            Some(sight) if !sight.front || sight.t < near * diagonal => -0.5 * weight,
            Some(sight) => {
                shapes.insert(sight.shape);
                weight * (sight.t / diagonal).min(0.5).sqrt()
            }
            None => 0.1 * weight,
        };
    }
    depth * (10 + shapes.len()) as f32
}

/// Chooses a viewpoint from which the region fills the picture.
///
/// It is on the side where the object covers most of the picture. If the sides differ little, it is
/// the front (+z, or -y if z is up).
fn before_an_object(survey: &Survey<'_>) -> Camera {
    let mut best = (f32::NEG_INFINITY, None);
    for (i, direction) in around(survey.up, 0.4, 8).enumerate() {
        let camera = framing(survey, direction + 0.3 * survey.up);
        let in_region = |image: &Vec2| {
            let sight = survey.look(&camera.ray(*image, ASPECT));
            sight.is_some_and(|sight| survey.region.contains_nearly(sight.point))
        };
        let covered = raster(16, 12).filter(in_region).count() as f32 / (16.0 * 12.0);
        let score = if i < 2 { covered + 0.05 } else { covered };
        if score > best.0 {
            best = (score, Some(camera));
        }
    }
    best.1.unwrap_or_else(|| framing(survey, Vec3::Z))
}

/// Returns the camera that looks against `backward` and has the object in view.
///
/// It is as close as it can be.
fn framing(survey: &Survey<'_>, backward: Vec3) -> Camera {
    let backward = backward.normalize_or(Vec3::Z);
    let center = survey.region.center();
    let turned = Camera::look_at(center + backward, center, survey.up, OBJECT_FOV);
    let (right, above) = (turned.right(), turned.right().cross(turned.forward));
    let boxes = survey.scene.shapes.iter().map(|shape| shape.aabb());
    let ends = boxes.flat_map(|aabb| [aabb.min, aabb.max].map(Vec3::from));
    let points: Vec<Vec3> = ends
        .filter(|&point| survey.region.contains_nearly(point))
        .map(|point| point - center)
        .map(|point| Vec3::new(point.dot(right), point.dot(above), point.dot(backward)))
        .collect();

    // Aims at the middle of the visible points, then steps back until all are in the picture.
    let low = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let middle = if low.cmple(high).all() { 0.5 * (low + high) } else { Vec3::ZERO };
    let half_height = (0.5 * OBJECT_FOV).tan();
    let distance = points.iter().map(|point| {
        let offset = (*point - middle).abs();
        point.z + 1.12 * (offset.x / (half_height * ASPECT)).max(offset.y / half_height)
    });
    let distance = distance.fold(1e-3 * survey.region.diagonal(), f32::max);
    let target = center + middle.x * right + middle.y * above;
    Camera::look_at(target + distance * backward, target, survey.up, OBJECT_FOV)
}

/// Returns `count` horizontal directions all around.
///
/// The first one is `turn` radians off the front.
fn around(up: Vec3, turn: f32, count: usize) -> impl Iterator<Item = Vec3> {
    let front = if up == Vec3::Z { Vec3::NEG_Y } else { Vec3::Z };
    let right = front.cross(up);
    (0..count).map(move |i| {
        let (sin, cos) = (turn - i as f32 / count as f32 * TAU).sin_cos();
        cos * front - sin * right
    })
}
