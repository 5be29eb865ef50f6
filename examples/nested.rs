//! A hierarchy as a primitive: many copies of one mesh, each in another place.

use bvhkit::{Aabb, Bvh, Intersect, OneByOne, Primitive, Ray, Triangle};
use std::f32::consts::{PI, TAU};
use std::time::Instant;

/// A copy of a hierarchy, moved to a place.
struct Copy<'a> {
    mesh: &'a Bvh<Triangle>,
    place: [f32; 3],
}

impl Primitive for Copy<'_> {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        let (Aabb { min, max }, [x, y, z]) = (self.mesh.aabb(), self.place);
        Aabb::new([min[0] + x, min[1] + y, min[2] + z], [max[0] + x, max[1] + y, max[2] + z])
    }
}

impl Intersect for Copy<'_> {
    type Payload = usize; // index of the mesh's triangle
    type Leaf = OneByOne;
    /// The ray ends at the closest hit so far, so the mesh's query leaves out what is farther.
    fn intersect(&self, ray: &Ray) -> Option<(f32, usize)> {
        let ([ox, oy, oz], [x, y, z]) = (ray.origin, self.place);
        let hit = self.mesh.closest_hit(&Ray { origin: [ox - x, oy - y, oz - z], ..*ray })?;
        Some((hit.t, hit.index))
    }
}

fn main() -> Result<(), bvhkit::BuildError> {
    // Numbers from 0 to 1.
    let part = |i: u32| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
    let point = |i: u32| [part(3 * i), part(3 * i + 1), part(3 * i + 2)];
    // A bumpy sphere of 20,000 triangles.
    const RINGS: u32 = 100;
    let at = |ring: u32, sector: u32| {
        let (u, v) = (ring as f32 / RINGS as f32 * PI, (sector % RINGS) as f32 / RINGS as f32 * TAU);
        let radius = 0.4 + 0.05 * (7.0 * u).sin() * (5.0 * v).cos();
        [radius * u.sin() * v.cos(), radius * u.sin() * v.sin(), radius * u.cos()]
    };
    let quads = (0..RINGS).flat_map(|ring| (0..RINGS).map(move |sector| (ring, sector)));
    let mesh = Bvh::build(quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [Triangle::new(a, b, c), Triangle::new(a, c, d)]
    }))?;
    // The copies overlap, so each ray meets the boxes of many.
    let copies = Bvh::build((0..500).map(|i| Copy { mesh: &mesh, place: point(100_000 + i) }))?;
    let rays: Vec<Ray> = (0..20_000)
        .map(|i| {
            let ([x, y, z], [tx, ty, tz]) = (point(200_000 + i), point(300_000 + i));
            Ray::new([2.0 * x, 2.0 * y, -1.0], [2.0 * (tx - x), 2.0 * (ty - y), 1.0 + tz + z])
        })
        .collect();
    let clock = Instant::now();
    let hits = rays.iter().filter(|ray| copies.closest_hit(ray).is_some()).count();
    println!(
        "{hits} of {} rays hit, {:.1} us a ray",
        rays.len(),
        clock.elapsed().as_secs_f64() * 1e6 / rays.len() as f64
    );
    Ok(())
}
