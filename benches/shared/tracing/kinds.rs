//! Rays by kind, in two orders, each with the query that renderers make.

use super::tracer::Query;
use crate::support::rays::{Rays, Surface, seen, sphere};
use crate::support::scenes::NamedScene;
use bvhkit::{Aabb, Bvh, Ray};
use glam::Vec3;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use std::f32::consts::TAU;

/// A kind of ray, with the same rays in two orders.
pub struct Kind {
    pub name: &'static str,
    pub query: Query,
    /// In the order of a renderer: neighbours in its picture one after another.
    pub natural: Vec<Ray>,
    pub shuffled: Vec<Ray>,
    /// The places of the shuffled rays in the natural order.
    pub order: Vec<usize>,
}

impl Kind {
    fn new(name: &'static str, query: Query, natural: Vec<Ray>) -> Self {
        let mut order: Vec<usize> = (0..natural.len()).collect();
        order.shuffle(&mut Pcg32::seed_from_u64(5));
        let shuffled = order.iter().map(|&place| natural[place]).collect();
        Self { name, query, natural, shuffled, order }
    }
}

/// Returns about `n` rays of each kind, always the same kinds in the same order.
///
/// There are more rays of quick kinds and fewer of slow kinds. If the camera sees nothing, there
/// are none of the kinds that start on visible surfaces.
pub fn all<P: Surface>(primitives: &[P], scene: &NamedScene, n: usize) -> Vec<Kind> {
    let bvh = Bvh::build(primitives.iter().copied()).expect("the scene's coordinates are finite");
    let Rays { primary, diffuse, shadow, random } = Rays::new(primitives, scene, n);
    let mut rng = Pcg32::seed_from_u64(6);
    let Aabb { min, max } = bvh.aabb();
    let (center, diagonal) = (Vec3::from(bvh.aabb().center()), Vec3::from(min).distance(max.into()));

    let near = |(point, normal): (Vec3, Vec3)| {
        let direction = normal + sphere(&mut rng);
        Ray::new(point, direction.normalize_or(normal)).with_interval(0.0, 0.1 * diagonal)
    };
    let surface = seen(primitives, scene, &primary);
    let ambient_occlusion = surface.into_iter().cycle().take(n).map(near).collect();

    let short = |ray: &Ray| bvh.closest_hit(ray).map_or(*ray, |hit| ray.with_interval(0.0, 0.999 * hit.t));
    let miss = random.iter().map(short).collect();

    let tangent = |_| {
        let away = sphere(&mut rng);
        let (right, up) = away.any_orthonormal_pair();
        let (sin, cos) = (TAU * rng.random::<f32>()).sin_cos();
        Ray::new(center + diagonal * away, cos * right + sin * up)
    };
    // These are answered at once. There are so many that the time does not go into waking threads.
    let beside = (0..8 * n).map(tangent).collect();

    // Each of these rays meets many primitives, so an eighth of the rays takes as long.
    let few = random.iter().step_by(8).copied().collect();
    vec![
        Kind::new("primary", Query::Closest, primary),
        Kind::new("shadow", Query::Any, shadow),
        Kind::new("ambient-occlusion", Query::Any, ambient_occlusion),
        Kind::new("diffuse", Query::Closest, diffuse),
        Kind::new("random", Query::Closest, random),
        Kind::new("miss", Query::Closest, miss),
        Kind::new("beside", Query::Closest, beside),
        Kind::new("random-all-hits", Query::All, few),
    ]
}
