//! How fast each is, on one thread.

use crate::support::rays::Rays;
use crate::support::scenes::NamedScene;
use crate::timing;
use crate::tracer::Contestant;
use std::hint::black_box;

/// Millions of closest hits a second for each contestant: primary, diffuse, shadow and random rays, `rays`
/// of each.
pub fn mega_rays(
    scene: &NamedScene,
    contestants: &[Contestant],
    rays: usize,
    repetitions: usize,
) -> Vec<f64> {
    let Rays { primary, diffuse, shadow, random } = Rays::new(&scene.triangles, scene, rays);
    let rays = [primary, diffuse, shadow, random].concat();
    let tracers: Vec<_> = contestants.iter().map(|contestant| (contestant.build)(&scene.triangles)).collect();
    let times =
        timing::interleaved(tracers.len(), repetitions, |_| (), |i| black_box(tracers[i].count_hits(&rays)));
    times.into_iter().map(|time| timing::mega_rays(rays.len(), time)).collect()
}
