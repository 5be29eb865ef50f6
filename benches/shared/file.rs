//! A scene from a file, read by the path tracer's loader.

use crate::support::scenes::NamedScene;
use anyhow::{Context, Result};
use bvhkit::Bvh;
use std::path::Path;

#[path = "../../examples/path_tracer/scene/mod.rs"]
#[expect(dead_code, reason = "the path tracer needs more of a scene than its triangles")]
mod scene;

/// Loads a scene, with the camera of the file or one that sees everything.
pub fn scene(path: &Path) -> Result<NamedScene> {
    let mut scene = scene::load(path)?;
    let bvh = Bvh::build(scene.shapes.iter().copied())?;
    scene::view::complete(&mut scene, |ray| bvh.closest_hit(ray).map(|hit| (hit.t, hit.index)));
    let camera = scene.camera.context("a scene has a camera once it is complete")?;

    let center = glam::Vec3::from(bvh.aabb().center());
    let distance = camera.forward.dot(center - camera.position).max(1e-3 * center.distance(camera.position));
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    Ok(NamedScene {
        name,
        triangles: scene.triangles(),
        eye: camera.position,
        target: camera.position + distance * camera.forward,
    })
}
