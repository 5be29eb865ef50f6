//! The speed of each contestant, on one thread.

use crate::support::rays::Rays;
use crate::support::scenes::NamedScene;
use crate::timing;
use crate::tracer::Contestant;
use std::hint::black_box;

/// Returns millions of rays per second for each contestant, traced for the closest hit.
///
/// The rays are primary, diffuse, shadow and random, `rays` of each kind.
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
