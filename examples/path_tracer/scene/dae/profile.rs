//! Materials of COLLADA, and the additions of its profile CMU462.
//!
//! The profile adds mirror, glass, emission, area lights and spheres, in `<extra>` elements. The
//! scene files of the course 15-462 use it.

use dae_parser::{Document, Effect, Element, Extra, Geometry, Light, Shader};
use glam::Vec3;

use super::Material;

/// Returns the material of an effect.
///
/// The material of the profile comes first, then the emission or the
/// diffuse colour of the common shader.
pub fn material(effect: &Effect) -> Material {
    let common = effect.get_common_profile();
    let nested = common.into_iter().flat_map(|it| it.extra.iter().chain(&it.technique.extra));
    if let Some(material) = effect.extra.iter().chain(nested).flat_map(elements).find_map(special_material) {
        return material;
    }
    let Some(shader) = common.and_then(|it| it.technique.data.shaders.first()) else {
        return Material::GREY;
    };
    let (emission, diffuse) = match shader {
        Shader::Blinn(shader) => (&shader.emission, &shader.diffuse),
        Shader::Lambert(shader) => (&shader.emission, &shader.diffuse),
        Shader::Phong(shader) => (&shader.emission, &shader.diffuse),
        Shader::Constant(shader) => (&shader.emission, &None),
    };
    let [emission, diffuse] = [emission, diffuse].map(|param| {
        let [r, g, b, _] = *param.as_ref()?.as_color()?;
        Some(Vec3::new(r, g, b))
    });
    match (emission, diffuse) {
        (Some(radiance), _) if radiance.max_element() > 0.0 => Material::Emitter { radiance },
        (_, Some(albedo)) => Material::Diffuse { albedo },
        _ => Material::GREY,
    }
}

fn special_material(element: &Element) -> Option<Material> {
    let color = |name| numbers(element, name).and_then(|numbers| numbers.first_chunk().copied());
    match element.name() {
        "emission" => Some(Material::Emitter { radiance: Vec3::from(color("radiance")?) }),
        "mirror" => Some(Material::Mirror { reflectance: Vec3::from(color("reflectance")?) }),
        "glass" => Some(Material::Glass {
            transmittance: color("transmittance").map_or(Vec3::ONE, Vec3::from),
            ior: numbers(element, "ior").and_then(|ior| ior.first().copied()).unwrap_or(1.5),
        }),
        _ => None,
    }
}

/// Returns the radius of a geometry that is an analytic sphere.
pub fn sphere_radius(geometry: &Geometry) -> Option<f32> {
    let sphere = find(&geometry.extra, "sphere")?;
    numbers(sphere, "radius")?.first().copied()
}

/// Returns the radiance of an area light.
pub fn area_radiance(light: &Light) -> Option<Vec3> {
    let color = numbers(find(&light.extra, "area")?, "color")?;
    color.first_chunk::<3>().copied().map(Vec3::from)
}

/// Returns whether the file uses the profile for materials or spheres.
pub fn is_used(document: &Document) -> bool {
    let effects = document.iter().flat_map(|effect: &Effect| &effect.extra);
    let geometries = document.iter().flat_map(|geometry: &Geometry| &geometry.extra);
    effects.chain(geometries).flat_map(elements).next().is_some()
}

fn find<'a>(extras: &'a [Extra], name: &str) -> Option<&'a Element> {
    extras.iter().flat_map(elements).find(|element| element.name() == name)
}

/// Returns the elements that an `<extra>` holds for the profile.
fn elements(extra: &Extra) -> impl Iterator<Item = &Element> {
    let techniques = extra.technique.iter().map(|technique| &technique.element);
    techniques.filter(|it| it.attr("profile") == Some("CMU462")).flat_map(Element::children)
}

/// Returns the numbers in the text of a child element.
fn numbers(element: &Element, name: &str) -> Option<Vec<f32>> {
    let child = element.children().find(|child| child.name() == name)?;
    child.text().split_whitespace().map(|number| number.parse().ok()).collect()
}
