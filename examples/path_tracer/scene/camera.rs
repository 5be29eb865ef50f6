//! The pinhole camera.

use bvhkit::Ray;
use glam::{Mat4, Vec2, Vec3};

/// A pinhole camera: its position, orientation and field of view.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub position: Vec3,
    right: Vec3,
    up: Vec3,
    pub forward: Vec3,
    /// Half the image's height at distance 1.
    ///
    /// This is the tangent of half the vertical field of view.
    half_height: f32,
    /// Width over height, if the file gives it.
    pub aspect: Option<f32>,
}

impl Camera {
    /// Returns the camera of a scene graph's node.
    ///
    /// It looks along the node's -z with +y up, the convention that COLLADA and glTF share. The
    /// vertical field of view `yfov` is in radians.
    pub fn from_node(node: &Mat4, yfov: f32, aspect: Option<f32>) -> Self {
        Self {
            position: node.transform_point3(Vec3::ZERO),
            right: node.transform_vector3(Vec3::X).normalize_or(Vec3::X),
            up: node.transform_vector3(Vec3::Y).normalize_or(Vec3::Y),
            forward: node.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Z),
            half_height: (0.5 * yfov).tan(),
            aspect,
        }
    }

    /// Returns the camera at `position` with `target` in the middle of its picture.
    pub fn look_at(position: Vec3, target: Vec3, up: Vec3, yfov: f32) -> Self {
        let forward = (target - position).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(up).try_normalize();
        let right = right.unwrap_or_else(|| forward.any_orthonormal_vector());
        Self {
            position,
            right,
            up: right.cross(forward),
            forward,
            half_height: (0.5 * yfov).tan(),
            aspect: None,
        }
    }

    /// Returns the ray through a point of the image.
    ///
    /// The point is given as fractions of the width and height, from the upper left corner.
    /// `aspect` is that of the image. If the image is narrower than the file's, more is seen above
    /// and below, and nothing is lost to the left and right.
    pub fn ray(&self, image: Vec2, aspect: f32) -> Ray {
        let widen = self.aspect.map_or(1.0, |own| (own / aspect).max(1.0));
        let half_height = self.half_height * widen;
        let x = (2.0 * image.x - 1.0) * half_height * aspect;
        let y = (1.0 - 2.0 * image.y) * half_height;
        let direction = self.forward + x * self.right + y * self.up;
        Ray::new(self.position, direction.normalize())
    }

    /// Returns the direction to the right of the picture.
    pub fn right(&self) -> Vec3 {
        self.right
    }
}
