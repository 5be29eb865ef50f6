//! A user's own primitive in packed leaves.
//!
//! A sieve tests eight discs at once; then `intersect` tests the discs that the sieve lets through.

use bvhkit::{Aabb, Bvh, Intersect, Lanes, Operands, Primitive, Ray, Sieve, Sieved};

/// A horizontal disc: x, y and z of its center, its radius.
struct Disc([f32; 4]);
struct DiscSieve;

impl Primitive for Disc {
    type Scalar = f32;
    fn aabb(&self) -> Aabb {
        let Disc([x, y, z, r]) = *self;
        Aabb::new([x - r, y, z - r], [x + r, y, z + r])
    }
}

impl Intersect for Disc {
    type Payload = ();
    type Leaf = Sieved<DiscSieve>;
    fn intersect(&self, ray: &Ray) -> Option<(f32, ())> {
        let Disc([cx, cy, cz, r]) = *self;
        let t = (cy - ray.origin[1]) / ray.direction[1];
        let [x, _, z] = ray.at(t);
        let (x, z) = (x - cx, z - cz);
        (x * x + z * z <= r * r).then_some((t, ()))
    }
    fn put_operands(&self, operands: &mut [f32]) {
        operands.copy_from_slice(&self.0);
    }
}

impl Sieve<f32> for DiscSieve {
    const OPERANDS: usize = 4;
    /// Repeats `intersect` operation by operation, so that no hit is left out.
    fn candidates<L: Lanes<f32>>(discs: &Operands<'_, f32, L>, ray: &Ray) -> L::Mask {
        let ([ox, oy, oz], [dx, dy, dz]) =
            (ray.origin.map(|x| discs.splat(x)), ray.direction.map(|x| discs.splat(x)));
        let t = (discs.get(1) - oy) / dy;
        let (x, z, r) = (ox + dx * t - discs.get(0), oz + dz * t - discs.get(2), discs.get(3));
        t.le(discs.splat(ray.t_max)) & (x * x + z * z).le(r * r)
    }
}

fn main() -> Result<(), bvhkit::BuildError> {
    let discs: Vec<Disc> = (0..1000).map(|i| Disc([(i % 32) as f32, (i / 32) as f32, 0.0, 0.4])).collect();
    let bvh = Bvh::build(discs)?;
    let ray = Ray::new([7.25, 40.0, 0.0], [0.0, -1.0, 0.0]);
    println!("disc {:?}", bvh.closest_hit(&ray).map(|hit| hit.index));
    assert_eq!(bvh.closest_hit(&ray), bvhkit::reference::closest_hit(bvh.primitives(), &ray));
    Ok(())
}
