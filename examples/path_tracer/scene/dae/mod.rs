//! COLLADA: the nodes of a scene with their polygons, spheres, cameras and lights.

mod mesh;
mod profile;

use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};
use bvhkit::{Aabb, Primitive};
use dae_parser::{
    Document, Effect, Element, Error, Geometry, Instance, LightKind, LocalMap, Node, ProjectionType, Source,
    Transform, UpAxis, Vertices,
};
use glam::{Mat4, Vec3};

use super::{Camera, Light, Material, Scene, Shape};

/// Maximum depth of nested nodes, since an instance of a node may contain itself.
const MAX_DEPTH: usize = 64;

pub fn load(path: &Path) -> Result<Scene> {
    let document = parse(&std::fs::read_to_string(path)?)?;
    let mut loader = Loader {
        scene: Scene::default(),
        geometries: document.local_map().map_err(message)?,
        sources: document.local_map().map_err(message)?,
        vertices: document.local_map().map_err(message)?,
        effects: document.local_map().map_err(message)?,
        materials: document.local_map().map_err(message)?,
        nodes: document.local_map().map_err(message)?,
        cameras: document.local_map().map_err(message)?,
        lights: document.local_map().map_err(message)?,
    };
    loader.scene.up = Some(match document.asset.up_axis {
        UpAxis::XUp => Vec3::X,
        UpAxis::YUp => Vec3::Y,
        UpAxis::ZUp => Vec3::Z,
    });
    let root = document.get_visual_scene().context("the file has no visual scene")?;
    for node in &root.nodes {
        loader.add_node(node, &Mat4::IDENTITY, 0)?;
    }

    // A lamp of emitting shapes also has a light, for renderers that cannot use the shapes.
    let mut scene = loader.scene;
    if scene.surfaces.iter().any(|surface| scene.materials[surface.material].is_emitter()) {
        scene.lights.retain(|light| matches!(light, Light::Directional { .. }));
    }
    if profile::is_used(&document) {
        step_back(&mut scene);
    }
    Ok(scene)
}

/// Moves the camera back until all of the scene is in view.
///
/// The profile's own renderer does the same: from a camera it takes only the lens
/// and the direction, and it steps back from the middle of the scene. The profile's
/// scene files are made for that.
fn step_back(scene: &mut Scene) {
    let boxes = scene.shapes.iter().map(Shape::aabb);
    let Some(all) = boxes.reduce(Aabb::union) else { return };
    if let Some(camera) = &mut scene.camera {
        let diagonal = Vec3::from(all.extent()).length();
        camera.position = Vec3::from(all.center()) - 1.5 * diagonal * camera.forward;
    }
}

/// Parses the text.
///
/// The schema and the parser want a shape in every `<geometry>`, but an analytic sphere is an
/// `<extra>` alone. Such a geometry gets an empty shape first.
fn parse(text: &str) -> Result<Document> {
    let mut root: Element = text.parse().map_err(|error| anyhow!("{error}"))?;
    let namespace = root.ns();
    let mut mended = false;
    let libraries = root.children_mut().filter(|child| child.name() == "library_geometries");
    for geometry in libraries.flat_map(|library| library.children_mut()) {
        if geometry.children().all(|child| child.name() == "extra") {
            let shape = Element::builder("convex_mesh", &namespace).attr("convex_hull_of", "#none");
            *geometry = Element::builder("geometry", &namespace)
                .attr("id", geometry.attr("id"))
                .append(shape)
                .append_all(geometry.children().cloned())
                .build();
            mended = true;
        }
    }
    if !mended {
        return text.parse().map_err(message);
    }
    let mut bytes = Vec::new();
    root.write_to(&mut bytes).map_err(|error| anyhow!("{error}"))?;
    Document::try_from(bytes.as_slice()).map_err(message)
}

/// Converts the parser's error, which cannot be displayed by itself.
fn message(error: Error) -> anyhow::Error {
    match error {
        Error::Minidom(error) => anyhow!("{error}"),
        Error::Other(text) => anyhow!("{text}"),
        Error::Str(text) => anyhow!("{text}"),
    }
}

/// The scene so far, and the file's elements by their ids.
struct Loader<'a> {
    scene: Scene,
    geometries: LocalMap<'a, Geometry>,
    sources: LocalMap<'a, Source>,
    vertices: LocalMap<'a, Vertices>,
    effects: LocalMap<'a, Effect>,
    materials: LocalMap<'a, dae_parser::Material>,
    nodes: LocalMap<'a, Node>,
    cameras: LocalMap<'a, dae_parser::Camera>,
    lights: LocalMap<'a, dae_parser::Light>,
}

impl Loader<'_> {
    fn add_node(&mut self, node: &Node, parent: &Mat4, depth: usize) -> Result<()> {
        ensure!(depth < MAX_DEPTH, "more than {MAX_DEPTH} nodes inside each other");
        let transform = node.transforms.iter().fold(*parent, |matrix, step| matrix * local(step));

        for instance in &node.instance_geometry {
            self.add_geometry(instance, &transform)?;
        }
        for instance in &node.instance_camera {
            if let Some(camera) = self.cameras.get(&instance.url) {
                self.add_camera(camera, &transform);
            }
        }
        for instance in &node.instance_light {
            if let Some(light) = self.lights.get(&instance.url) {
                self.add_light(light, &transform);
            }
        }
        for instance in &node.instance_node {
            if let Some(child) = self.nodes.get(&instance.url) {
                self.add_node(child, &transform, depth + 1)?;
            }
        }
        node.children.iter().try_for_each(|child| self.add_node(child, &transform, depth + 1))
    }

    fn add_geometry(&mut self, instance: &Instance<Geometry>, transform: &Mat4) -> Result<()> {
        let geometry = self
            .geometries
            .get(&instance.url)
            .with_context(|| format!("a node names the geometry {}, which is not there", instance.url))?;
        if let Some(radius) = profile::sphere_radius(geometry) {
            let bound = instance.instance_materials().first();
            let material = self.bound_material(bound);
            self.scene.add_sphere(transform, radius, material);
        }
        if let Some(mesh) = geometry.element.as_mesh() {
            for part in &mesh.elements {
                let Some(polygons) = mesh::Polygons::new(part) else { continue };
                let bound = polygons.material.and_then(|name| instance.get_instance_material(name));
                let material = self.bound_material(bound);
                for triangle in polygons.triangles(&self.vertices, &self.sources)? {
                    let (points, normals) = triangle?;
                    self.scene.add_triangle(transform, points, normals, material);
                }
            }
        }
        Ok(())
    }

    fn bound_material(&mut self, bound: Option<&dae_parser::InstanceMaterial>) -> usize {
        let material = bound.and_then(|bound| self.materials.get(&bound.target));
        let effect = material.and_then(|it| self.effects.get(&it.instance_effect.url));
        self.scene.add_material(effect.map_or(Material::GREY, profile::material))
    }

    /// Adds a camera, unless there is one already.
    ///
    /// A field of view in both directions determines the aspect.
    fn add_camera(&mut self, camera: &dae_parser::Camera, transform: &Mat4) {
        let ProjectionType::Perspective(lens) = &camera.optics.ty else { return };
        if self.scene.camera.is_some() {
            return;
        }
        let half_tangent = |degrees: f32| (0.5 * degrees.to_radians()).tan();
        let (half_height, aspect) = match (lens.xfov, lens.yfov, lens.aspect_ratio) {
            (Some(x), Some(y), _) => (half_tangent(y), Some(half_tangent(x) / half_tangent(y))),
            (None, Some(y), aspect) => (half_tangent(y), aspect),
            (Some(x), None, aspect) => (half_tangent(x) / aspect.unwrap_or(1.0), Some(aspect.unwrap_or(1.0))),
            (None, None, _) => return,
        };
        self.scene.camera = Some(Camera::from_node(transform, 2.0 * half_height.atan(), aspect));
    }

    /// Adds a light. A spot light becomes a point light: its cone is not modelled.
    fn add_light(&mut self, light: &dae_parser::Light, transform: &Mat4) {
        let position = transform.transform_point3(Vec3::ZERO);
        self.scene.lights.push(match &light.kind {
            _ if let Some(radiance) = profile::area_radiance(light) => Light::Rectangle {
                corner: transform.transform_point3(Vec3::new(-0.5, -0.5, 0.0)),
                // In this order, the front is the node's -z.
                u: transform.transform_vector3(Vec3::Y),
                v: transform.transform_vector3(Vec3::X),
                radiance,
            },
            LightKind::Directional(light) => Light::Directional {
                direction: transform.transform_vector3(Vec3::NEG_Z).normalize_or(Vec3::NEG_Y),
                // In this format, a white surface appears as bright as the colour of the light.
                irradiance: std::f32::consts::PI * Vec3::from(*light.color),
            },
            LightKind::Point(light) => Light::Point { position, intensity: Vec3::from(*light.color) },
            LightKind::Spot(light) => Light::Point { position, intensity: Vec3::from(*light.color) },
            LightKind::Ambient(_) => return,
        });
    }
}

/// Returns one step of a node's transformation as a matrix.
fn local(step: &Transform) -> Mat4 {
    match step {
        // The file writes rows, glam takes columns.
        Transform::Matrix(matrix) => Mat4::from_cols_array(&matrix.0).transpose(),
        Transform::Translate(by) => Mat4::from_translation(Vec3::from(*by.0)),
        Transform::Scale(by) => Mat4::from_scale(Vec3::from(*by.0)),
        Transform::Rotate(by) => {
            let axis = Vec3::from(*by.axis()).normalize_or(Vec3::Z);
            Mat4::from_axis_angle(axis, by.angle().to_radians())
        }
        Transform::LookAt(view) => {
            let [eye, target, up] = [*view.eye(), *view.target(), *view.up()].map(Vec3::from);
            glam::camera::rh::view::look_at_mat4(eye, target, up).inverse()
        }
        // Hardly any file has a shear, so it is left out.
        Transform::Skew(_) => Mat4::IDENTITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>
    <up_axis>Z_UP</up_axis></asset>
  <library_effects><effect id="glass-effect"><profile_COMMON><technique sid="common"><phong>
      <diffuse><color>0.5 0.5 0.5 1</color></diffuse></phong></technique></profile_COMMON>
    <extra><technique profile="CMU462"><glass><transmittance>1 1 1</transmittance><ior>1.45</ior>
    </glass></technique></extra></effect></library_effects>
  <library_materials><material id="glass"><instance_effect url="#glass-effect"/></material>
  </library_materials>
  <library_geometries>
    <geometry id="ball"><extra><technique profile="CMU462"><sphere><radius>0.5</radius></sphere>
      </technique></extra></geometry>
    <geometry id="quad"><mesh>
      <source id="points"><float_array id="array" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
        <technique_common><accessor source="#array" count="4" stride="3">
          <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
        </accessor></technique_common></source>
      <vertices id="corners"><input semantic="POSITION" source="#points"/></vertices>
      <polylist count="1"><input semantic="VERTEX" source="#corners" offset="0"/>
        <vcount>4</vcount><p>0 1 2 INDEX</p></polylist></mesh></geometry>
  </library_geometries>
  <library_visual_scenes><visual_scene id="scene">
    <node><translate>0 0 3</translate><scale>2 2 2</scale><instance_geometry url="#ball">
      <bind_material><technique_common><instance_material symbol="m" target="#glass"/>
      </technique_common></bind_material></instance_geometry></node>
    <node><matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#quad"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"##;

    fn load_with_index(index: &str, name: &str) -> Result<Scene> {
        let file = format!("path_tracer_{name}_{}.dae", std::process::id());
        let path = std::env::temp_dir().join(file);
        std::fs::write(&path, FILE.replace("INDEX", index))?;
        let scene = load(&path);
        std::fs::remove_file(&path)?;
        scene
    }

    #[test]
    fn spheres_polygons_materials_and_transforms_arrive() {
        let scene = load_with_index("3", "good").unwrap();
        assert_eq!(scene.up, Some(Vec3::Z));
        assert_eq!(scene.shapes.len(), 3);
        let Shape::Sphere(ball) = scene.shapes[0] else { panic!("no sphere") };
        assert_eq!((ball.center, ball.radius), ([0.0, 0.0, 3.0], 1.0));
        assert_eq!(*scene.material(0), Material::Glass { transmittance: Vec3::ONE, ior: 1.45 });
        assert_eq!(scene.triangles()[1].c, [5.0, 1.0, 0.0]);
        assert_eq!(*scene.material(1), Material::GREY);
    }

    #[test]
    fn an_index_out_of_range_is_an_error() {
        let error = load_with_index("4", "bad").err().unwrap();
        assert!(error.to_string().contains("not there"), "{error}");
    }
}
