//! A scene and the rays to trace in it.

use crate::support::rays::Rays;
use crate::support::scenes::NamedScene;
use bvhkit::{Ray, Triangle};

pub struct Workload {
    pub name: String,
    pub triangles: Vec<Triangle>,
    /// Primary, diffuse and random rays, in this order.
    pub closest: Vec<Ray>,
    /// Shadow rays.
    pub any: Vec<Ray>,
}

impl Workload {
    /// Returns a workload with `rays` rays of each kind.
    pub fn new(scene: &NamedScene, rays: usize) -> Self {
        let Rays { primary, diffuse, shadow, random } = Rays::new(&scene.triangles, scene, rays);
        Self {
            name: scene.name.clone(),
            triangles: scene.triangles.clone(),
            closest: [primary, diffuse, random].concat(),
            any: shadow,
        }
    }

    pub fn all_rays(&self) -> Vec<Ray> {
        [&self.closest[..], &self.any].concat()
    }
}
