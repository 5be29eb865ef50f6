//! A scene as the renderer sees it: shapes, materials, lights and camera.
//!
//! It does not depend on the format of the file.

mod camera;
mod cornell;
mod dae;
mod gltf;
mod light;
mod material;
mod obj;
mod shape;
mod teapot;
pub mod view;

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use bvhkit::{Sphere, Triangle};
use glam::{Mat4, Vec3};

pub use camera::Camera;
pub use light::{Light, Sky};
pub use material::Material;
pub use shape::Shape;

/// A scene to render.
///
/// If a file leaves out the [`camera`](Self::camera) or every light, [`view::complete`] chooses
/// them later, because it needs to cast rays.
#[derive(Default)]
pub struct Scene {
    pub shapes: Vec<Shape>,
    /// The surface of each shape; as long as `shapes` and in the same order.
    pub surfaces: Vec<Surface>,
    pub materials: Vec<Material>,
    /// The lights that are not shapes.
    ///
    /// Shapes of an emitting material are lights as well.
    pub lights: Vec<Light>,
    /// The sky that rays see when they leave the scene; black if there is none.
    pub sky: Option<Sky>,
    pub camera: Option<Camera>,
    /// The direction that the file calls up, if it calls any so.
    pub up: Option<Vec3>,
}

/// The shading of a shape.
#[derive(Clone, Copy)]
pub struct Surface {
    /// An index into [`Scene::materials`].
    pub material: usize,
    /// The normals at a triangle's vertices, if the file has them.
    pub normals: Option<[Vec3; 3]>,
}

/// Loads a COLLADA, OBJ or glTF file, chosen by its extension.
pub fn load(path: &Path) -> Result<Scene> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let loader = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("dae") => dae::load,
        Some("obj") => obj::load,
        Some("glb" | "gltf") => gltf::load,
        _ => bail!("{}: not a scene file; known extensions are .dae, .obj, .glb and .gltf", path.display()),
    };
    // Loaders have different words for a file that cannot be opened. These checks come first.
    let kind = std::fs::metadata(path).with_context(|| path.display().to_string())?;
    ensure!(kind.is_file(), "{}: not a file", path.display());

    let scene = loader(path).with_context(|| path.display().to_string())?;
    ensure!(!scene.shapes.is_empty(), "{}: the scene has no triangles", path.display());
    let invalid = scene.shapes.iter().position(|shape| !shape.is_finite());
    if let Some(index) = invalid {
        bail!("{}: a coordinate of shape {index} is NaN or infinite", path.display());
    }
    Ok(scene)
}

/// Returns the scene that needs no file, a Cornell box.
///
/// The box holds the Utah teapot and two spheres.
pub fn cornell_box() -> Scene {
    cornell::scene()
}

impl Scene {
    /// Returns the scene's triangles, without its other shapes.
    pub fn triangles(&self) -> Vec<Triangle> {
        let triangle = |shape: &Shape| match shape {
            Shape::Triangle(triangle) => Some(*triangle),
            Shape::Sphere(_) => None,
        };
        self.shapes.iter().filter_map(triangle).collect()
    }

    /// Returns the material of the shape at `index`.
    pub fn material(&self, index: usize) -> &Material {
        &self.materials[self.surfaces[index].material]
    }

    /// Returns whether anything at all emits light.
    fn is_lit(&self) -> bool {
        let emits = |surface: &Surface| self.materials[surface.material].is_emitter();
        self.sky.is_some() || !self.lights.is_empty() || self.surfaces.iter().any(emits)
    }

    fn add_material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a triangle placed by `transform`.
    ///
    /// A mirroring transform turns a triangle inside out. Then its vertices change their order, so
    /// that the front stays in front.
    fn add_triangle(
        &mut self,
        transform: &Mat4,
        mut points: [Vec3; 3],
        mut normals: Option<[Vec3; 3]>,
        material: usize,
    ) {
        if transform.determinant() < 0.0 {
            points.swap(1, 2);
            if let Some(normals) = &mut normals {
                normals.swap(1, 2);
            }
        }
        let [a, b, c] = points.map(|point| transform.transform_point3(point));
        // The inverse transpose carries normals, so that they stay perpendicular to the surface.
        let normals = normals.map(|normals| {
            let carry = transform.inverse().transpose();
            normals.map(|normal| carry.transform_vector3(normal).normalize_or_zero())
        });
        self.shapes.push(Shape::Triangle(Triangle::new(a, b, c)));
        self.surfaces.push(Surface { material, normals });
    }

    /// Adds a sphere about the origin of `transform`.
    ///
    /// The scale of `transform` is taken to be uniform.
    fn add_sphere(&mut self, transform: &Mat4, radius: f32, material: usize) {
        let center = transform.transform_point3(Vec3::ZERO);
        let scale = transform.determinant().abs().cbrt();
        self.shapes.push(Shape::Sphere(Sphere::new(center, radius * scale)));
        self.surfaces.push(Surface { material, normals: None });
    }
}
