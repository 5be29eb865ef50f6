//! The four materials: diffuse, mirror, glass, emitter.

use glam::Vec3;

/// The response of a surface to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Lambert's ideal diffuse reflection.
    Diffuse { albedo: Vec3 },
    /// Ideal specular reflection.
    Mirror { reflectance: Vec3 },
    /// A smooth dielectric: reflects and refracts by Fresnel's equations.
    Glass { transmittance: Vec3, ior: f32 },
    /// Emits from its front, reflects nothing.
    Emitter { radiance: Vec3 },
}

impl Material {
    /// The material of a surface for which the file names none.
    pub const GREY: Self = Self::Diffuse { albedo: Vec3::splat(0.6) };

    pub fn is_emitter(&self) -> bool {
        matches!(self, Self::Emitter { .. })
    }
}
