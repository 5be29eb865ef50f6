//! glTF, binary (.glb) and text (.gltf).
//!
//! It has triangles, materials, cameras and punctual lights.

use std::path::Path;

use ::gltf::camera::Projection;
use ::gltf::khr_lights_punctual::Kind;
use ::gltf::mesh::Mode;
use anyhow::{Context, Result, ensure};
use glam::{Mat4, Vec3};

use super::{Camera, Light, Material, Scene};

/// Maximum depth of nested nodes: in a malformed file, a node may contain itself.
const MAX_DEPTH: usize = 64;

pub fn load(path: &Path) -> Result<Scene> {
    let file = ::gltf::Gltf::open(path)?;
    // Only the buffers are imported: no texture is used, so images would be decoded in vain.
    let buffers = ::gltf::import_buffers(&file.document, path.parent(), file.blob)?;
    let document = file.document;

    let mut loader = Loader { scene: Scene::default(), buffers };
    loader.scene.materials = document.materials().map(|material| convert(&material)).collect();
    loader.scene.add_material(Material::GREY);

    let scene = document.default_scene().or_else(|| document.scenes().next());
    for node in scene.context("the file has no scene")?.nodes() {
        loader.add_node(&node, &Mat4::IDENTITY, 0)?;
    }
    Ok(loader.scene)
}

struct Loader {
    scene: Scene,
    buffers: Vec<::gltf::buffer::Data>,
}

impl Loader {
    fn add_node(&mut self, node: &::gltf::Node<'_>, parent: &Mat4, depth: usize) -> Result<()> {
        ensure!(depth < MAX_DEPTH, "more than {MAX_DEPTH} nodes inside each other");
        let transform = *parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.add_primitive(&primitive, &transform)?;
            }
        }
        if let Some(camera) = node.camera()
            && let Projection::Perspective(lens) = camera.projection()
            && self.scene.camera.is_none()
        {
            self.scene.camera = Some(Camera::from_node(&transform, lens.yfov(), lens.aspect_ratio()));
        }
        if let Some(light) = node.light() {
            self.add_light(&light, &transform);
        }
        node.children().try_for_each(|child| self.add_node(&child, &transform, depth + 1))
    }

    fn add_primitive(&mut self, primitive: &::gltf::Primitive<'_>, transform: &Mat4) -> Result<()> {
        let strip = match primitive.mode() {
            Mode::Triangles => false,
            Mode::TriangleStrip => true,
            _ => return Ok(()),
        };
        let reader = primitive.reader(|buffer| self.buffers.get(buffer.index()).map(|data| &data[..]));
        let positions: Vec<Vec3> =
            reader.read_positions().context("a mesh has no positions")?.map(Vec3::from).collect();
        let normals: Option<Vec<Vec3>> =
            reader.read_normals().map(|normals| normals.map(Vec3::from).collect());
        let indices: Vec<usize> = match reader.read_indices() {
            Some(indices) => indices.into_u32().map(|index| index as usize).collect(),
            None => (0..positions.len()).collect(),
        };
        ensure!(
            indices.iter().all(|&index| index < positions.len()),
            "a mesh names a vertex that is not there"
        );
        let normals = normals.filter(|normals| normals.len() == positions.len());

        let grey = self.scene.materials.len() - 1;
        let material = primitive.material().index().unwrap_or(grey);
        let mut add = |corners: [usize; 3]| {
            let normals = normals.as_ref().map(|normals| corners.map(|corner| normals[corner]));
            let points = corners.map(|corner| positions[corner]);
            self.scene.add_triangle(transform, points, normals, material);
        };
        if strip {
            // Every second triangle of a strip runs the other way around.
            for (i, corners) in indices.windows(3).enumerate() {
                let (second, third) = if i % 2 == 0 { (1, 2) } else { (2, 1) };
                add([corners[0], corners[second], corners[third]]);
            }
        } else {
            for corners in indices.chunks_exact(3) {
                add([corners[0], corners[1], corners[2]]);
            }
        }
        Ok(())
    }

    /// Adds a light. A spot light becomes a point light: its cone is not modelled.
    fn add_light(&mut self, light: &::gltf::khr_lights_punctual::Light<'_>, transform: &Mat4) {
        let power = Vec3::from(light.color()) * light.intensity();
        self.scene.lights.push(match light.kind() {
            Kind::Directional => Light::Directional {
                direction: transform.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Y),
                irradiance: power,
            },
            Kind::Point | Kind::Spot { .. } => {
                Light::Point { position: transform.transform_point3(Vec3::ZERO), intensity: power }
            }
        });
    }
}

/// Returns the nearest of our materials.
///
/// Emission decides first, then transmission, then metalness.
fn convert(material: &::gltf::Material<'_>) -> Material {
    let emission = Vec3::from(material.emissive_factor());
    if emission.max_element() > 0.0 && material.emissive_texture().is_none() {
        return Material::Emitter { radiance: emission * material.emissive_strength().unwrap_or(1.0) };
    }
    let surface = material.pbr_metallic_roughness();
    let [r, g, b, _] = surface.base_color_factor();
    let color = Vec3::new(r, g, b);
    let transmission = material.transmission().map_or(0.0, |it| it.transmission_factor());
    if transmission > 0.5 {
        Material::Glass { transmittance: color, ior: material.ior().unwrap_or(1.5) }
    } else if surface.metallic_factor() > 0.5 && surface.roughness_factor() < 0.3 {
        Material::Mirror { reflectance: color }
    } else {
        Material::Diffuse { albedo: color }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle, moved by its node, with its three vertices in a base64 buffer.
    const TRIANGLE: &str = r#"{
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "translation": [0, 0, -3]},
            {"camera": 0, "translation": [0, 0, 5]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]
    }"#;

    #[test]
    fn nodes_place_triangles_and_cameras() {
        let path = std::env::temp_dir().join(format!("path_tracer_{}.gltf", std::process::id()));
        std::fs::write(&path, TRIANGLE).unwrap();
        let scene = load(&path).unwrap();
        std::fs::remove_file(&path).unwrap();

        assert_eq!(scene.triangles().len(), 1);
        assert_eq!(scene.triangles()[0].b, [1.0, 0.0, -3.0]);
        assert_eq!(scene.camera.unwrap().position, Vec3::new(0.0, 0.0, 5.0));
        assert_eq!(*scene.material(0), Material::GREY);
    }
}
