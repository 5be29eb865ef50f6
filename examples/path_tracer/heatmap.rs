//! Work per pixel as colours, with a legend.

use glam::Vec3;
use image::{Rgb, RgbImage};

use crate::film::Film;

/// Colours from no work to the most: dark blue, purple, red, orange, pale yellow.
const RAMP: [Vec3; 6] = [
    Vec3::new(0.00, 0.00, 0.05),
    Vec3::new(0.22, 0.04, 0.42),
    Vec3::new(0.58, 0.15, 0.40),
    Vec3::new(0.87, 0.32, 0.22),
    Vec3::new(0.98, 0.65, 0.10),
    Vec3::new(0.99, 1.00, 0.72),
];

/// The digits, 3 pixels wide and 5 high: a row is three bits, the left one highest.
const DIGITS: [[u8; 5]; 10] = [
    [0b111, 0b101, 0b101, 0b101, 0b111],
    [0b010, 0b110, 0b010, 0b010, 0b111],
    [0b111, 0b001, 0b111, 0b100, 0b111],
    [0b111, 0b001, 0b111, 0b001, 0b111],
    [0b101, 0b101, 0b111, 0b001, 0b001],
    [0b111, 0b100, 0b111, 0b001, 0b111],
    [0b111, 0b100, 0b111, 0b101, 0b111],
    [0b111, 0b001, 0b010, 0b010, 0b010],
    [0b111, 0b101, 0b111, 0b101, 0b111],
    [0b111, 0b101, 0b111, 0b001, 0b111],
];

/// Returns a picture of the work per pixel, and the work of its brightest colour.
///
/// The work is the x of each pixel. A legend is added below the picture.
pub fn image(film: &Film) -> (RgbImage, u32) {
    let scale = scale(film);
    let picture = film.to_image(|work| ramp(work.x / scale as f32));
    (with_legend(&picture, scale), scale)
}

/// Returns a round number above the work of all but a few pixels.
///
/// With a scale up to the largest work, a handful of outliers would leave the rest dark.
fn scale(film: &Film) -> u32 {
    let mut work: Vec<f32> = film.pixels.iter().map(|pixel| pixel.x).collect();
    let rank = work.len() * 995 / 1000;
    let (_, &mut most, _) = work.select_nth_unstable_by(rank, f32::total_cmp);
    round_up(most)
}

/// Returns the next of 4, 8, 12, 20, 40, 80, 120, 200, ...; quarters are whole.
fn round_up(work: f32) -> u32 {
    let mut decade = 1;
    loop {
        for step in [4, 8, 12, 20] {
            if work <= (decade * step) as f32 || decade >= 100_000_000 {
                return decade * step;
            }
        }
        decade *= 10;
    }
}

fn ramp(t: f32) -> Vec3 {
    let position = t.clamp(0.0, 1.0) * (RAMP.len() - 1) as f32;
    let below = (position as usize).min(RAMP.len() - 2);
    RAMP[below].lerp(RAMP[below + 1], position - below as f32)
}

/// Adds a bar of the colours below the picture, with numbers at its quarters.
fn with_legend(picture: &RgbImage, scale: u32) -> RgbImage {
    let (width, height) = picture.dimensions();
    // The size of a digit's pixel: about a 160th of the width, so that five numbers fit.
    let unit = (width / 160).max(1);
    let mut image = RgbImage::from_pixel(width, height + 17 * unit, Rgb([20, 20, 20]));
    image::imageops::replace(&mut image, picture, 0, 0);

    let (left, right) = (4 * unit, width.saturating_sub(4 * unit).max(4 * unit + 1));
    let bar_top = height + 2 * unit;
    for x in left..right.min(width) {
        let color = ramp((x - left) as f32 / (right - left) as f32);
        for y in bar_top..bar_top + 6 * unit {
            image.put_pixel(x, y, Rgb((color * 255.0).as_u8vec3().to_array()));
        }
    }
    for quarter in 0..=4 {
        let text = (scale / 4 * quarter).to_string();
        let text_width = (4 * text.len() as u32 - 1) * unit;
        let middle = left + (right - left) * quarter / 4;
        let start = middle.saturating_sub(text_width / 2);
        let start = start.min(width.saturating_sub(text_width + unit)).max(unit);
        write_number(&mut image, &text, start, bar_top + 8 * unit, unit);
    }
    image
}

fn write_number(image: &mut RgbImage, text: &str, left: u32, top: u32, unit: u32) {
    for (place, digit) in text.chars().filter_map(|digit| digit.to_digit(10)).enumerate() {
        let left = left + 4 * unit * place as u32;
        for (x, y) in (0..5 * unit).flat_map(|y| (0..3 * unit).map(move |x| (x, y))) {
            let on = DIGITS[digit as usize][(y / unit) as usize] >> (2 - x / unit) & 1 == 1;
            if let Some(pixel) = image.get_pixel_mut_checked(left + x, top + y).filter(|_| on) {
                *pixel = Rgb([235, 235, 235]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_and_above_the_work() {
        let scales = [0.0, 3.5, 4.1, 13.0, 121.0, 400.0, 279_164.0].map(round_up);
        assert_eq!(scales, [4, 4, 8, 20, 200, 400, 400_000]);
    }

    #[test]
    fn even_a_picture_too_small_for_numbers_gets_a_legend() {
        let film = Film::new(glam::UVec2::ONE);
        let (image, scale) = image(&film);
        assert_eq!((image.width(), scale), (1, 4));
    }
}
