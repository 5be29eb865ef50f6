//! Positions of the labels of marks, so that none covers another.

use std::ops::Range;

/// The position of a pixel, from the top left.
type Pixel = (i32, i32);

const HEIGHT: i32 = 18;
/// The width of a character, on average and a little more.
const WIDTH: i32 = 8;
/// The number of positions to try, more than there are rows of labels.
const TRIES: i32 = 100;

/// The boxes that are drawn already: the center and half the extent of each.
#[derive(Default)]
pub struct Labels(Vec<(Pixel, Pixel)>);

impl Labels {
    /// Reserves the box of a mark, or of an upright bar, which no label may cover.
    pub fn bar(&mut self, from: Pixel, to: Pixel) {
        let center = ((from.0 + to.0) / 2, (from.1 + to.1) / 2);
        self.0.push((center, (8, 8 + (from.1 - to.1).abs() / 2)));
    }

    /// Returns the center for a label, the nearest free one above or below its mark.
    ///
    /// The center is within `rows`. If none is free, it is that of the mark.
    pub fn place(&mut self, text: &str, mark: Pixel, rows: &Range<i32>) -> Pixel {
        let half = (text.chars().count() as i32 * WIDTH / 2, HEIGHT / 2);
        let away = |i: i32| (i + 1) / 2 * HEIGHT * if i % 2 == 1 { -1 } else { 1 };
        let mut places = (1..TRIES).map(|i| (mark.0, mark.1 + away(i)));
        let place = places.find(|&place| rows.contains(&place.1) && self.is_free(place, half));
        let place = place.unwrap_or(mark);
        self.0.push((place, half));
        place
    }

    fn is_free(&self, place: Pixel, half: Pixel) -> bool {
        self.0.iter().all(|&(other, other_half)| {
            (place.0 - other.0).abs() >= half.0 + other_half.0
                || (place.1 - other.1).abs() >= half.1 + other_half.1
        })
    }
}
