//! A user's own primitive, which is a box and a ray test.
//!
//! `cargo run --release --example own_primitive`

use bvhkit::{Aabb, Bvh, Intersect, OneByOne, Primitive, Ray, reference};

/// A horizontal disc.
struct Disc {
    center: [f32; 3],
    radius: f32,
}

impl Primitive for Disc {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        let ([x, y, z], r) = (self.center, self.radius);
        Aabb::new([x - r, y, z - r], [x + r, y, z + r])
    }
}

impl Intersect for Disc {
    type Payload = f32; // the distance from the center
    type Leaf = OneByOne; // how leaves store discs
    fn intersect(&self, ray: &Ray) -> Option<(f32, f32)> {
        let t = (self.center[1] - ray.origin[1]) / ray.direction[1];
        let [x, _, z] = ray.at(t);
        let distance = (x - self.center[0]).hypot(z - self.center[2]);
        (distance <= self.radius).then_some((t, distance))
    }
}

fn main() -> Result<(), bvhkit::BuildError> {
    let disc = |i: u8| Disc { center: [0.0, f32::from(i), 0.1 * f32::from(i)], radius: 2.0 };
    let stair: Vec<Disc> = (0..=255).map(disc).collect();
    let bvh = Bvh::build(&stair)?;
    let ray = Ray::new([0.5, -1.0, 0.25], [0.0, 1.0, 0.1]);
    for hit in bvh.hits(&ray).take(5) {
        println!("disc {} at t = {}, {:.3} from its center", hit.index, hit.t, hit.payload);
    }
    assert_eq!(bvh.closest_hit(&ray), reference::closest_hit(&stair, &ray));
    Ok(())
}
