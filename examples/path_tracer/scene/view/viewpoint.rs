//! Where to put the camera: inside of a room, or in front of an object.

use std::f32::consts::TAU;

use glam::Vec3;

use super::super::Camera;
use super::{Survey, directions, raster};

/// Width over height of the picture that viewpoints are judged by.
const ASPECT: f32 = 4.0 / 3.0;
const ROOM_FOV: f32 = 1.15;
const OBJECT_FOV: f32 = 0.7;

/// A camera that sees the scene well.
pub fn choose(survey: &Survey<'_>) -> Camera {
    in_a_room(survey).unwrap_or_else(|| before_an_object(survey))
}

/// A viewpoint inside, looking along the longest free view; `None` if no point of the scene is
/// surrounded by surfaces that face it at some distance. In the inside of a solid object rays meet
/// back faces; beside an object they leave the region.
fn in_a_room(survey: &Survey<'_>) -> Option<Camera> {
    let region = &survey.region;
    let room_like = |&point: &Vec3| {
        let mut facing = 0;
        let mut depth = 0.0;
        let rays = 48;
        for direction in directions(rays) {
            let sight = survey.look(&bvhkit::Ray::new(point, direction));
            if let Some(sight) = sight.filter(|it| it.front && region.contains_nearly(it.point)) {
                facing += 1;
                depth += sight.t;
            }
        }
        facing * 10 >= rays * 7 && depth / facing as f32 > 0.1 * region.diagonal()
    };
    let steps = [0.1, 0.3, 0.5, 0.7, 0.9];
    let heights = [0.3, 0.5];
    let across = survey.up.any_orthonormal_pair();
    let grid = heights.into_iter().flat_map(|height| {
        steps.into_iter().flat_map(move |x| steps.into_iter().map(move |y| (height, x, y)))
    });
    let points = grid.map(|(height, x, y)| {
        let fractions = height * survey.up.abs() + x * across.0.abs() + y * across.1.abs();
        region.at(fractions)
    });

    let mut best = (0.0, None);
    for point in points.filter(room_like) {
        for direction in around(survey.up, 12) {
            let level = direction - 0.12 * survey.up;
            let camera = Camera::look_at(point, point + level, survey.up, ROOM_FOV);
            let score = depth_of_view(survey, &camera);
            if score > best.0 {
                best = (score, Some(camera));
            }
        }
    }
    best.1
}

/// How far one can see: long views count, what is right before the lens or turns its back does not.
fn depth_of_view(survey: &Survey<'_>, camera: &Camera) -> f32 {
    let diagonal = survey.region.diagonal();
    raster(6, 4)
        .map(|image| match survey.look(&camera.ray(image, ASPECT)) {
            Some(sight) if !sight.front => -0.5,
            Some(sight) if sight.t < 0.05 * diagonal => -0.2,
            Some(sight) => (sight.t / diagonal).min(1.0).sqrt(),
            None => 0.1,
        })
        .sum()
}

/// A viewpoint from which the whole region is in the picture, on the side where the object covers
/// most of it; the front (+z, or -y if z is up) if there is little between them.
fn before_an_object(survey: &Survey<'_>) -> Camera {
    let center = survey.region.center();
    let cameras = around(survey.up, 8).map(|direction| {
        let backward = (direction + 0.3 * survey.up).normalize();
        let camera = Camera::look_at(center + backward, center, survey.up, OBJECT_FOV);
        let (half_height, back) = ((0.5 * OBJECT_FOV).tan(), -camera.forward);
        // The least distance at which every corner of the region is inside the picture.
        let distance = survey.region.corners().map(|corner| {
            let offset = corner - center;
            let x = offset.dot(camera.right()).abs() / (half_height * ASPECT);
            let y = offset.dot(camera.right().cross(camera.forward)).abs() / half_height;
            offset.dot(back) + 1.05 * x.max(y)
        });
        let distance = distance.fold(0.0, f32::max);
        Camera::look_at(center + distance * backward, center, survey.up, OBJECT_FOV)
    });
    let mut best = (f32::NEG_INFINITY, None);
    for (i, camera) in cameras.enumerate() {
        let in_region = |image| {
            let sight = survey.look(&camera.ray(image, ASPECT));
            sight.is_some_and(|sight| survey.region.contains_nearly(sight.point))
        };
        let covered = raster(16, 12).filter(|&image| in_region(image)).count() as f32 / 192.0;
        let score = covered + if i < 2 { 0.05 } else { 0.0 };
        if score > best.0 {
            best = (score, Some(camera));
        }
    }
    best.1.unwrap_or_else(|| Camera::look_at(center + Vec3::Z, center, survey.up, OBJECT_FOV))
}

/// Horizontal directions all around, from the front (turned a little) on.
fn around(up: Vec3, count: usize) -> impl Iterator<Item = Vec3> {
    let front = if up == Vec3::Z { Vec3::NEG_Y } else { Vec3::Z };
    let right = front.cross(up);
    (0..count).map(move |i| {
        let (sin, cos) = (0.4 - i as f32 / count as f32 * TAU).sin_cos();
        cos * front - sin * right
    })
}
