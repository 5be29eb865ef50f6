//! The default scene, after the Cornell box.
//!
//! It is a lit room with one red and one green wall. In it stand the Utah teapot (triangles), a
//! mirror ball and a glass ball (analytic spheres).
//!
//! The box is Goral et al., "Modeling the Interaction of Light Between Diffuse Surfaces", SIGGRAPH
//! 1984. This one is 2 wide, 2 high and 2 deep, y up, with its open side towards +z.

use glam::{Mat4, Vec3};

use super::{Camera, Material, Scene, teapot};

/// Quads per side of a patch: enough for a smooth outline at the default size.
const TEAPOT_DETAIL: usize = 12;

pub fn scene() -> Scene {
    let mut scene = Scene { up: Some(Vec3::Y), ..Default::default() };
    add_room(&mut scene);
    add_teapot(&mut scene);

    let mirror = scene.add_material(Material::Mirror { reflectance: Vec3::splat(0.92) });
    let glass = scene.add_material(Material::Glass { transmittance: Vec3::ONE, ior: 1.5 });
    scene.add_sphere(&Mat4::from_translation(Vec3::new(-0.58, 0.32, 0.05)), 0.32, mirror);
    scene.add_sphere(&Mat4::from_translation(Vec3::new(0.52, 0.27, 0.55)), 0.27, glass);

    let (eye, target) = (Vec3::new(0.0, 1.0, 4.3), Vec3::new(0.0, 0.96, 0.0));
    scene.camera = Some(Camera::look_at(eye, target, Vec3::Y, 38.0_f32.to_radians()));
    scene
}

fn add_room(scene: &mut Scene) {
    let white = scene.add_material(Material::Diffuse { albedo: Vec3::splat(0.74) });
    let red = scene.add_material(Material::Diffuse { albedo: Vec3::new(0.63, 0.06, 0.05) });
    let green = scene.add_material(Material::Diffuse { albedo: Vec3::new(0.14, 0.45, 0.09) });
    let lamp = scene.add_material(Material::Emitter { radiance: Vec3::new(5.2, 4.7, 3.9) });

    let (x, y, z) = (2.0 * Vec3::X, 2.0 * Vec3::Y, 2.0 * Vec3::Z);
    add_quad(scene, Vec3::new(-1.0, 0.0, -1.0), z, x, white); // floor
    add_quad(scene, Vec3::new(-1.0, 2.0, -1.0), x, z, white); // ceiling
    add_quad(scene, Vec3::new(-1.0, 0.0, -1.0), x, y, white); // back wall
    add_quad(scene, Vec3::new(-1.0, 0.0, -1.0), y, z, red); // left wall
    add_quad(scene, Vec3::new(1.0, 0.0, -1.0), z, y, green); // right wall
    add_quad(scene, Vec3::new(-0.5, 1.99, -0.45), Vec3::X, 0.9 * Vec3::Z, lamp);
}

/// Adds a parallelogram whose front is where `u x v` points.
fn add_quad(scene: &mut Scene, corner: Vec3, u: Vec3, v: Vec3, material: usize) {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    scene.add_triangle(&Mat4::IDENTITY, [a, b, c], None, material);
    scene.add_triangle(&Mat4::IDENTITY, [a, c, d], None, material);
}

fn add_teapot(scene: &mut Scene) {
    let china = scene.add_material(Material::Diffuse { albedo: Vec3::new(0.75, 0.62, 0.42) });
    // The published teapot has z up.
    let upright = Mat4::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let placed = Mat4::from_translation(Vec3::new(0.18, 0.0, -0.35))
        * Mat4::from_rotation_y(0.5)
        * Mat4::from_scale(Vec3::splat(0.24))
        * upright;
    for facet in teapot::tessellate(TEAPOT_DETAIL) {
        scene.add_triangle(&placed, facet.points, Some(facet.normals), china);
    }
}
