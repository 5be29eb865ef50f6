//! Where labels of marks go, so that none covers another.

use std::ops::Range;

/// A pixel, from the top left.
type Pixel = (i32, i32);

const HEIGHT: i32 = 18;
/// Of a character, on average and a little more.
const WIDTH: i32 = 8;
/// More than there are rows of labels.
const TRIES: i32 = 100;

/// What has been drawn: center, and half the extent.
#[derive(Default)]
pub struct Labels(Vec<(Pixel, Pixel)>);

impl Labels {
    /// A mark, or an upright bar of them, that no label may cover.
    pub fn bar(&mut self, from: Pixel, to: Pixel) {
        let center = ((from.0 + to.0) / 2, (from.1 + to.1) / 2);
        self.0.push((center, (8, 8 + (from.1 - to.1).abs() / 2)));
    }

    /// The center of `text`: the place nearest above or below the mark that is free, and within `rows`.
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
