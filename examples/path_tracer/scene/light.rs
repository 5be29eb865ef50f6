//! Lights that are not shapes: distant, point and rectangular ones, and the sky.

use glam::Vec3;

/// A light that no ray hits; only direct sampling finds it.
#[derive(Clone, Copy, Debug)]
pub enum Light {
    /// Parallel light, such as the sun's; `irradiance` is that of a surface facing it.
    Directional { direction: Vec3, irradiance: Vec3 },
    /// Light from a point, with the given power per solid angle.
    Point { position: Vec3, intensity: Vec3 },
    /// Light from the front of the parallelogram `corner + s * u + t * v`.
    ///
    /// The front is the side that `u x v` points to.
    Rectangle { corner: Vec3, u: Vec3, v: Vec3, radiance: Vec3 },
}

/// A sky that brightens from zenith to horizon, over a plain ground.
#[derive(Clone, Copy, Debug)]
pub struct Sky {
    pub up: Vec3,
    pub zenith: Vec3,
    pub horizon: Vec3,
    pub ground: Vec3,
}

impl Sky {
    /// Returns the sky of a clear day, whose mean radiance is about 1.
    pub fn day(up: Vec3) -> Self {
        Self {
            up,
            zenith: Vec3::new(0.45, 0.68, 1.05),
            horizon: Vec3::new(1.05, 1.10, 1.15),
            ground: Vec3::new(0.27, 0.26, 0.25),
        }
    }

    /// Returns the same sky, `factor` times as bright.
    pub fn scaled(self, factor: f32) -> Self {
        Self {
            up: self.up,
            zenith: self.zenith * factor,
            horizon: self.horizon * factor,
            ground: self.ground * factor,
        }
    }

    /// Returns the radiance that arrives along a ray of this direction, a unit vector.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let height = direction.dot(self.up);
        if height >= 0.0 {
            self.horizon.lerp(self.zenith, height.sqrt())
        } else {
            // A short haze hides the line between ground and sky.
            self.horizon.lerp(self.ground, (-8.0 * height).min(1.0))
        }
    }
}
