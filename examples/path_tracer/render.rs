//! Rendering of the picture, tile by tile on all threads.

use bvhkit::{Counters, Ray};
use glam::{UVec2, Vec2, Vec3};
use indicatif::ProgressBar;
use rand_pcg::Pcg32;
use rayon::prelude::*;

use crate::film::Film;
use crate::sampling;
use crate::scene::Camera;
use crate::tracer::{Caster, Query, Tracer};

/// The side of a tile in pixels: enough work to hand out, little enough to share.
const TILE: u32 = 16;

/// The picture to render: its camera, size and samples.
#[derive(Clone, Copy)]
pub struct Shot {
    pub camera: Camera,
    pub size: UVec2,
    /// Camera rays per pixel.
    pub samples: u32,
}

/// A rendered picture, and the work that it took.
pub struct Rendered {
    pub film: Film,
    pub counters: Counters,
    /// The kept rays, if any were asked for.
    pub rays: Vec<Query>,
}

/// Renders a picture in which `shade` gives the value of a camera ray.
///
/// A pixel is the mean over its samples. Every `keep_every`th ray is kept, or none
/// if that is 0. The result does not depend on the number of threads, because each
/// pixel has its own random numbers.
pub fn render(
    shot: &Shot,
    tracer: &Tracer,
    keep_every: u64,
    progress: &ProgressBar,
    shade: impl Fn(&Ray, &mut Caster<'_>, &mut Pcg32) -> Vec3 + Sync,
) -> Rendered {
    let tiles = shot.size.map(|side| side.div_ceil(TILE));
    progress.set_length(u64::from(tiles.element_product()));
    let tiles: Vec<(Tile, Vec<Vec3>, Caster<'_>)> = (0..tiles.element_product())
        .into_par_iter()
        .map(|index| {
            let tile = Tile::new(UVec2::new(index % tiles.x, index / tiles.x), shot.size);
            let mut caster = Caster::new(tracer, keep_every);
            let colors = tile.pixels().map(|at| pixel(shot, at, &mut caster, &shade)).collect();
            progress.inc(1);
            (tile, colors, caster)
        })
        .collect();

    let mut film = Film::new(shot.size);
    let mut counters = Counters::default();
    let mut rays = Vec::new();
    for (tile, colors, caster) in tiles {
        for (at, color) in tile.pixels().zip(colors) {
            film.set(at, color);
        }
        counters += caster.counters;
        rays.extend(caster.kept);
    }
    Rendered { film, counters, rays }
}

fn pixel(
    shot: &Shot,
    at: UVec2,
    caster: &mut Caster<'_>,
    shade: &impl Fn(&Ray, &mut Caster<'_>, &mut Pcg32) -> Vec3,
) -> Vec3 {
    let mut rng = sampling::pixel_rng((at.y * shot.size.x + at.x) as usize);
    let size = shot.size.as_vec2();
    let mut sum = Vec3::ZERO;
    for _ in 0..shot.samples {
        let image: Vec2 = (at.as_vec2() + sampling::square(&mut rng)) / size;
        sum += shade(&shot.camera.ray(image, size.x / size.y), caster, &mut rng);
    }
    sum / shot.samples as f32
}

/// A rectangle of pixels.
struct Tile {
    min: UVec2,
    max: UVec2,
}

impl Tile {
    fn new(position: UVec2, size: UVec2) -> Self {
        let min = position * TILE;
        Self { min, max: (min + TILE).min(size) }
    }

    fn pixels(&self) -> impl Iterator<Item = UVec2> {
        let Self { min, max } = *self;
        (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| UVec2::new(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        let size = UVec2::new(37, 18);
        let mut seen = vec![0; 37 * 18];
        for index in 0..6 {
            for at in Tile::new(UVec2::new(index % 3, index / 3), size).pixels() {
                seen[(at.y * size.x + at.x) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }
}
