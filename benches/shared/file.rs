//! A scene from a file, read by the path tracer's loader.

use crate::support::scenes::NamedScene;
use anyhow::{Context, Result};
use bvhkit::Bvh;
use std::path::PathBuf;

#[path = "../../examples/path_tracer/scene/mod.rs"]
#[expect(
    dead_code,
    unused_imports,
    reason = "the path tracer needs more of a scene than its triangles; its unit tests are left out here"
)]
mod scene;

/// The scene in the file that the environment variable `BVHKIT_SCENE` names, if it is set.
pub fn scene() -> Result<Option<NamedScene>> {
    let Some(path) = std::env::var_os("BVHKIT_SCENE").map(PathBuf::from) else { return Ok(None) };
    let mut scene = scene::load(&path)?;
    let bvh = Bvh::build(scene.shapes.iter().copied())?;
    scene::view::complete(&mut scene, |ray| bvh.closest_hit(ray).map(|hit| (hit.t, hit.index)));
    let camera = scene.camera.context("a scene has a camera once it is complete")?;

    let center = glam::Vec3::from(bvh.aabb().center());
    let distance = camera.forward.dot(center - camera.position).max(1e-3 * center.distance(camera.position));
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    Ok(Some(NamedScene {
        name,
        triangles: scene.triangles(),
        eye: camera.position,
        target: camera.position + distance * camera.forward,
    }))
}
