//! A camera and lights for a scene whose file has none, found by casting rays.

mod lighting;
mod viewpoint;

use bvhkit::{Aabb, Primitive, Ray};
use glam::Vec3;

use super::{Scene, Shape};

/// Gives the scene a camera if it has none, and light if nothing shines.
///
/// `closest_hit` returns the first hit of a ray: t and the index of the shape.
pub fn complete(scene: &mut Scene, closest_hit: impl Fn(&Ray) -> Option<(f32, usize)>) {
    let survey = Survey::new(scene, &closest_hit);
    let camera = scene.camera.unwrap_or_else(|| viewpoint::choose(&survey));
    let lighting = (!scene.is_lit()).then(|| lighting::choose(&survey, &camera));
    let up = survey.up;

    scene.camera = Some(camera);
    if let Some((lights, sky)) = lighting {
        scene.lights = lights;
        scene.sky = Some(sky);
    } else if scene.sky.is_none() && lighting::is_sunlight_only(scene) {
        // Where the sun shines, there is a sky, and shadows are not black.
        scene.sky = Some(super::Sky::day(up).scaled(0.25));
    }
}

/// The scene, its ray query, and the region to look at.
struct Survey<'a> {
    scene: &'a Scene,
    closest_hit: &'a dyn Fn(&Ray) -> Option<(f32, usize)>,
    /// The part of the scene worth looking at.
    region: Region,
    up: Vec3,
}

/// The first hit of a ray.
#[derive(Clone, Copy)]
struct Sight {
    shape: usize,
    t: f32,
    point: Vec3,
    /// The geometric normal, on the side that the ray came from.
    normal: Vec3,
    /// Whether the ray met the front, so that its origin is not inside a solid.
    front: bool,
}

impl<'a> Survey<'a> {
    fn new(scene: &'a Scene, closest_hit: &'a dyn Fn(&Ray) -> Option<(f32, usize)>) -> Self {
        let region = Region::of_interest(&scene.shapes);
        let up = scene.up.unwrap_or_else(|| Region::of_all(&scene.shapes).likely_up());
        Self { scene, closest_hit, region, up }
    }

    /// Returns the first hit of the ray.
    fn look(&self, ray: &Ray) -> Option<Sight> {
        let (t, index) = (self.closest_hit)(ray)?;
        let point = Vec3::from(ray.at(t));
        let normal = self.scene.shapes[index].normal(point);
        let front = normal.dot(Vec3::from(ray.direction)) < 0.0;
        Some(Sight { shape: index, t, point, normal: if front { normal } else { -normal }, front })
    }

    /// Returns whether nothing blocks the way from a visible point into `direction`.
    ///
    /// The way ends at t = `distance`.
    fn is_clear(&self, from: &Sight, direction: Vec3, distance: f32) -> bool {
        let start = from.point + 1e-4 * self.region.diagonal() * from.normal;
        let ray = Ray::new(start, direction).with_interval(0.0, distance);
        from.normal.dot(direction) > 0.0 && (self.closest_hit)(&ray).is_none()
    }
}

/// A box in the scene.
#[derive(Clone, Copy)]
struct Region {
    min: Vec3,
    max: Vec3,
    /// Whether there are shapes far outside the box.
    is_part: bool,
}

impl Region {
    fn of_all(shapes: &[Shape]) -> Self {
        let all = shapes.iter().map(Shape::aabb).fold(Aabb::EMPTY, Aabb::union);
        Self { min: all.min.into(), max: all.max.into(), is_part: false }
    }

    /// Returns the box of all shapes, or a small part of it that holds most shapes.
    ///
    /// For example, a ship in front of a backdrop is the subject of the
    /// picture, and the backdrop is not.
    fn of_interest(shapes: &[Shape]) -> Self {
        let all = Self::of_all(shapes);
        let mut low = Vec3::ZERO;
        let mut high = Vec3::ZERO;
        for axis in 0..3 {
            let mut centers: Vec<f32> = shapes.iter().map(|shape| shape.aabb().center()[axis]).collect();
            centers.sort_unstable_by(f32::total_cmp);
            low[axis] = centers[centers.len() / 50];
            high[axis] = centers[centers.len() - 1 - centers.len() / 50];
        }
        let margin = 0.1 * (high - low);
        let crowd = Self { min: low - margin, max: high + margin, is_part: true };
        if crowd.diagonal() < 0.65 * all.diagonal() { crowd } else { all }
    }

    /// Returns +y, or +z if the box is flat in z: a flat scene lies on the ground.
    fn likely_up(&self) -> Vec3 {
        let size = self.max - self.min;
        if size.z < 0.4 * size.x.min(size.y) { Vec3::Z } else { Vec3::Y }
    }

    fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    fn diagonal(&self) -> f32 {
        self.max.distance(self.min)
    }

    /// Returns the point at these fractions of the box's sides.
    fn at(&self, fractions: Vec3) -> Vec3 {
        self.min + fractions * (self.max - self.min)
    }

    /// Returns whether the point is in the box, or outside by no more than rounding.
    fn contains_nearly(&self, point: Vec3) -> bool {
        let slack = 1e-3 * (self.max - self.min);
        point.cmpge(self.min - slack).all() && point.cmple(self.max + slack).all()
    }
}

/// Returns `count` directions spread evenly over the sphere: a Fibonacci lattice.
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    let golden_angle = std::f32::consts::PI * (3.0 - 5.0_f32.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (2 * i + 1) as f32 / count as f32;
        let (sin, cos) = (i as f32 * golden_angle).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z)
    })
}

/// Returns the middles of the cells of a picture, as fractions of its sides.
///
/// There are `columns` by `rows` cells.
fn raster(columns: usize, rows: usize) -> impl Iterator<Item = glam::Vec2> {
    (0..columns * rows).map(move |i| {
        let (x, y) = (i % columns, i / columns);
        glam::Vec2::new((x as f32 + 0.5) / columns as f32, (y as f32 + 0.5) / rows as f32)
    })
}
