//! The picture as radiances, and its way to a PNG file.
//!
//! The steps are exposure, tone mapping and encoding.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Result};
use glam::{UVec2, Vec3};
use image::{ImageFormat, Rgb, RgbImage};

/// A picture of linear colours, whose meaning is up to the renderer.
pub struct Film {
    pub size: UVec2,
    pub pixels: Vec<Vec3>,
}

impl Film {
    pub fn new(size: UVec2) -> Self {
        Self { size, pixels: vec![Vec3::ZERO; size.x as usize * size.y as usize] }
    }

    pub fn set(&mut self, at: UVec2, color: Vec3) {
        self.pixels[at.y as usize * self.size.x as usize + at.x as usize] = color;
    }

    /// Returns the picture of radiances, exposed, tone mapped and in sRGB.
    pub fn tone_mapped(&self) -> RgbImage {
        let exposure = self.exposure();
        self.to_image(|color| srgb(tone_map(exposure * color)))
    }

    /// Returns the picture with each pixel turned into a colour from 0 to 1.
    pub fn to_image(&self, color: impl Fn(Vec3) -> Vec3) -> RgbImage {
        RgbImage::from_fn(self.size.x, self.size.y, |x, y| {
            let value = self.pixels[y as usize * self.size.x as usize + x as usize];
            let bytes = (color(value).clamp(Vec3::ZERO, Vec3::ONE) * 255.0 + 0.5).as_u8vec3();
            Rgb(bytes.to_array())
        })
    }

    /// Returns the factor that brings the bright parts of the picture just below white.
    ///
    /// The lights themselves may be brighter. The factor is needed because files give light in any
    /// unit. Black pixels are left out, since they may show no surface.
    fn exposure(&self) -> f32 {
        let mut lit: Vec<f32> = self.pixels.iter().map(|&color| luminance(color)).collect();
        lit.retain(|&luminance| luminance > 0.0 && luminance.is_finite());
        if lit.is_empty() {
            return 1.0;
        }
        let rank = lit.len() * 9 / 10;
        let (_, bright, _) = lit.select_nth_unstable_by(rank, f32::total_cmp);
        1.1 / *bright
    }
}

/// Writes the picture as PNG, whatever the file's extension.
pub fn save(image: &RgbImage, path: &Path) -> Result<()> {
    let write = || -> Result<()> {
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png)?;
        // One call writes the whole file: an encoder's own buffer
        // drops the error of its last write.
        Ok(fs::write(path, png.into_inner())?)
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// Compresses luminance so that `WHITE` becomes 1.
///
/// Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002, equation 4.
fn tone_map(color: Vec3) -> Vec3 {
    const WHITE: f32 = 4.0;
    let luminance = luminance(color);
    color * ((1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance))
}

/// Returns the relative luminance of linear sRGB (ITU-R BT.709).
fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Applies the transfer function of sRGB (IEC 61966-2-1).
fn srgb(color: Vec3) -> Vec3 {
    color.map(|x| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tone_curve_rises_from_black_to_white() {
        assert_eq!(tone_map(Vec3::ZERO), Vec3::ZERO);
        assert!((tone_map(Vec3::splat(4.0)) - Vec3::ONE).abs().max_element() < 1e-6);
        let steps: Vec<f32> = (0..400).map(|i| tone_map(Vec3::splat(i as f32 * 0.01)).x).collect();
        assert!(steps.is_sorted());
        assert_eq!(srgb(Vec3::ONE).map(|x| (x * 1e5).round()), Vec3::splat(1e5));
    }

    #[test]
    fn exposure_does_not_depend_on_the_unit_of_light() {
        let ramp = |unit: f32| {
            let mut film = Film::new(UVec2::new(16, 16));
            for (i, pixel) in film.pixels.iter_mut().enumerate() {
                *pixel = Vec3::splat(unit * i as f32);
            }
            film.tone_mapped()
        };
        assert_eq!(ramp(1.0), ramp(1024.0));
        // A picture without light stays black.
        assert!(ramp(0.0).iter().all(|&byte| byte == 0));
    }
}
