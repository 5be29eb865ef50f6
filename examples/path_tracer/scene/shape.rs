//! The primitive of the path tracer: a triangle or an analytic sphere, in one tree.

use bvhkit::{
    Aabb, Barycentrics, Corners, Intersect, OneByOne, Primitive, Ray, Sphere, SurfacePoint, Triangle,
};
use glam::Vec3;

/// One primitive of the scene.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Triangle(Triangle),
    Sphere(Sphere),
}

impl Primitive for Shape {
    type Scalar = f32;

    fn aabb(&self) -> Aabb {
        match self {
            Self::Triangle(triangle) => triangle.aabb(),
            Self::Sphere(sphere) => sphere.aabb(),
        }
    }
}

impl Intersect for Shape {
    /// The position on a triangle. A sphere needs no more than t.
    type Payload = Option<Barycentrics>;
    /// Triangles and spheres have no operands in common.
    type Leaf = OneByOne;

    fn intersect(&self, ray: &Ray) -> Option<(f32, Self::Payload)> {
        match self {
            Self::Triangle(triangle) => {
                let (t, barycentrics) = triangle.intersect(ray)?;
                Some((t, Some(barycentrics)))
            }
            Self::Sphere(sphere) => {
                let (t, ()) = sphere.intersect(ray)?;
                Some((t, None))
            }
        }
    }
}

impl Shape {
    /// Returns the point where a ray hits, from which other rays may start.
    pub fn surface_point(&self, ray: &Ray, t: f32, at: Option<Barycentrics>) -> SurfacePoint {
        match self {
            Self::Triangle(triangle) => triangle.surface_point(at.unwrap_or_default()),
            Self::Sphere(sphere) => sphere.surface_point(ray.at(t)),
        }
    }

    /// Returns the geometric normal at `point` on the surface, a unit vector.
    ///
    /// It points outward from a sphere, and to the side of
    /// counterclockwise vertices from a triangle.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        match self {
            Self::Triangle(triangle) => edges_cross(triangle).normalize_or(Vec3::Y),
            Self::Sphere(sphere) => (point - Vec3::from(sphere.center)).normalize_or(Vec3::Y),
        }
    }

    /// Returns whether all numbers of the shape are finite.
    pub fn is_finite(&self) -> bool {
        let finite = |point: [f32; 3]| Vec3::from(point).is_finite();
        match self {
            Self::Triangle(Triangle { a, b, c }) => finite(*a) && finite(*b) && finite(*c),
            Self::Sphere(sphere) => finite(sphere.center) && sphere.radius.is_finite(),
        }
    }

    pub fn area(&self) -> f32 {
        match self {
            Self::Triangle(triangle) => 0.5 * edges_cross(triangle).length(),
            Self::Sphere(sphere) => 4.0 * std::f32::consts::PI * sphere.radius * sphere.radius,
        }
    }
}

fn edges_cross(triangle: &Triangle) -> Vec3 {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::from);
    (b - a).cross(c - a)
}
