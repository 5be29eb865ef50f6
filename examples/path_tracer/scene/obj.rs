//! Wavefront OBJ, with its .mtl if there is one.

use std::path::Path;

use anyhow::{Context, Result};
use glam::{Mat4, Vec3};

use super::{Material, Scene};

pub fn load(path: &Path) -> Result<Scene> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let (models, materials) = tobj::load_obj(path, &options)?;
    let mut scene = Scene { up: Some(Vec3::Y), ..Default::default() };

    // The file names a .mtl, which is often missing. Then the shapes are grey.
    for material in materials.unwrap_or_default() {
        scene.add_material(convert(&material));
    }
    let grey = scene.add_material(Material::GREY);

    for tobj::Model { mesh, .. } in &models {
        let material = mesh.material_id.filter(|&id| id < grey).unwrap_or(grey);
        for corner in (0..mesh.indices.len() / 3 * 3).step_by(3) {
            let points = triple(&mesh.positions, &mesh.indices[corner..corner + 3])
                .context("a face names a vertex that is not there")?;
            let normals = mesh.normal_indices.get(corner..corner + 3);
            let normals = normals.and_then(|indices| triple(&mesh.normals, indices));
            scene.add_triangle(&Mat4::IDENTITY, points, normals, material);
        }
    }
    Ok(scene)
}

/// Returns the vectors that `indices` name in an array of x, y, z, x, y, z, ...
fn triple(values: &[f32], indices: &[u32]) -> Option<[Vec3; 3]> {
    let vector = |index: u32| Some(Vec3::from_slice(values.get(3 * index as usize..)?.get(..3)?));
    Some([vector(indices[0])?, vector(indices[1])?, vector(indices[2])?])
}

/// Returns the nearest of our materials.
///
/// Emission decides first, then the illumination model `illum`: 3 and 5 are
/// mirrors; 4, 6, 7 and 9 are glass.
fn convert(material: &tobj::Material) -> Material {
    let emission = material.emissive.map(Vec3::from);
    if let Some(radiance) = emission.filter(|radiance| radiance.max_element() > 0.0) {
        return Material::Emitter { radiance };
    }
    match material.illumination_model {
        Some(3 | 5) => {
            Material::Mirror { reflectance: material.specular.map_or(Vec3::splat(0.9), Vec3::from) }
        }
        Some(4 | 6 | 7 | 9) => Material::Glass {
            transmittance: Vec3::ONE,
            ior: material.optical_density.filter(|&ior| ior > 1.0).unwrap_or(1.5),
        },
        _ => material.diffuse.map_or(Material::GREY, |albedo| Material::Diffuse { albedo: albedo.into() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_becomes_two_triangles_with_the_materials_of_the_mtl() {
        let folder = std::env::temp_dir().join(format!("path_tracer_obj_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mtl = "newmtl lamp\nKd 0 0 0\nKe 5 5 4\nnewmtl chrome\nKs 0.8 0.8 0.8\nillum 3\n";
        std::fs::write(folder.join("quad.mtl"), mtl).unwrap();
        let obj = "mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
                   usemtl lamp\nf 1 2 3 4\nusemtl chrome\nf 1 2 3\n";
        let path = folder.join("quad.obj");
        std::fs::write(&path, obj).unwrap();

        let scene = load(&path).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();

        assert_eq!(scene.shapes.len(), 3);
        assert_eq!(*scene.material(0), Material::Emitter { radiance: Vec3::new(5.0, 5.0, 4.0) });
        assert_eq!(*scene.material(2), Material::Mirror { reflectance: Vec3::splat(0.8) });
    }
}
