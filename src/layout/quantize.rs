//! Bounds in 8 bits each: the places of a grid that covers a node, rounded outward.

use crate::geometry::{Aabb, Scalar};

/// The grids of a node on its three axes: place q of an axis lies at `origin + q * scale`.
///
/// # Why the boxes contain what they should
///
/// A bound is what [`at`](Self::at) computes of its place: nothing compares it with what exact arithmetic would
/// make of it. `q * scale` is rounded where it overflows or underflows alone, since the scale is a power of two, and the sum
/// may be rounded anywhere; both are monotone in q, and so is `at`. Each place is chosen by what `at` computes: for
/// a minimum the last that is not above it (place 0 is not: `origin` is the least of the minima, to the bit), for a maximum
/// the first that is not below it (place 255 is not: the scale is doubled until then). Lanes do the same two operations, nothing is
/// fused, and so they compute the same bits. Whatever the scene's size and place, the box that a ray meets contains the
/// child's; where it is far from the origin places fall together, and near the end of the range the last ones are infinite, which
/// makes boxes larger.
///
/// No place is NaN: origin and scale are finite.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Grid<S> {
    pub origin: [S; 3],
    pub scale: [S; 3],
}

impl<S: Scalar> Grid<S> {
    /// Over all of a valid box.
    pub fn over(aabb: &Aabb<S>) -> Self {
        let scale = |axis: usize| scale(aabb.min[axis], aabb.max[axis]);
        Self { origin: aabb.min, scale: [scale(0), scale(1), scale(2)] }
    }

    /// Where a place lies.
    #[inline(always)]
    pub fn at(&self, axis: usize, place: u8) -> S {
        at(self.origin[axis], self.scale[axis], place)
    }

    /// The places of the least box around one that lies inside of the grid: minimum and maximum on each axis.
    pub fn around(&self, aabb: &Aabb<S>) -> [[u8; 2]; 3] {
        [0, 1, 2].map(|axis| {
            let beyond = first(|place| self.at(axis, place) > aabb.min[axis]);
            let maximum = first(|place| self.at(axis, place) >= aabb.max[axis]);
            debug_assert!(beyond > 0 && maximum <= 255);
            [(beyond - 1) as u8, maximum as u8]
        })
    }
}

#[inline(always)]
fn at<S: Scalar>(origin: S, scale: S, place: u8) -> S {
    origin + S::from_count(i32::from(place)) * scale
}

/// The first place that is far enough, 256 if none is: all behind one are.
fn first(is_far_enough: impl Fn(u8) -> bool) -> u32 {
    let (mut low, mut high) = (0, 256);
    while low < high {
        let middle = (low + high) / 2;
        if is_far_enough(middle as u8) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// The least power of two with which the grid reaches from one bound to another, but that it may be larger where the extent
/// is subnormal; 0 if they are equal.
fn scale<S: Scalar>(min: S, max: S) -> S {
    if min == max {
        return S::ZERO;
    }
    // Of halves, which do not overflow: at most twice that power of two.
    let half = max * S::HALF - min * S::HALF;
    let power = S::ONE / half.inverse_power_of_two();
    // The extent is at most four times the power, which 255 steps of a 32nd part cover: two doublings at the most.
    let mut scale = power * S::from_f64(1.0 / 128.0);
    for _ in 0..2 {
        if at(min, scale, 255) < max {
            scale = scale + scale;
        }
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Bounds in and around a grid from `low` to `high`: its ends, what lies next to them, and between.
    fn bounds<S: Scalar>(low: S, high: S) -> Vec<S> {
        let mut bounds: Vec<S> = [0.0, 1e-9, 0.003, 0.1, 0.25, 1.0 / 3.0, 0.5, 0.7, 0.999, 1.0]
            .map(|at| low * S::from_f64(1.0 - at) + high * S::from_f64(at))
            .into();
        bounds.extend([low.next_up(), high.next_down(), low, high]);
        bounds
            .iter()
            .map(|&x| {
                if x < low {
                    low
                } else if x > high {
                    high
                } else {
                    x
                }
            })
            .collect()
    }

    /// Every two of the bounds lie between their places.
    fn check<S: Scalar>(low: S, high: S) {
        let bounds = bounds(low, high);
        let grid = Grid::over(&Aabb { min: [low; 3], max: [high; 3] });
        assert!(grid.scale.iter().all(|scale| scale.is_finite() && *scale >= S::ZERO));
        for &min in &bounds {
            for &max in bounds.iter().filter(|max| **max >= min) {
                let aabb = Aabb { min: [min; 3], max: [max; 3] };
                for (axis, [near, far]) in grid.around(&aabb).into_iter().enumerate() {
                    assert!(grid.at(axis, near) <= min && max <= grid.at(axis, far), "{low:?} {high:?}");
                    // The next places would cut something off.
                    assert!(near == 255 || grid.at(axis, near + 1) > min);
                    assert!(far == 0 || grid.at(axis, far - 1) < max);
                }
            }
        }
    }

    fn check_all<S: Scalar>(scales: &[f64]) {
        for &scale in scales {
            let scale = S::from_f64(scale);
            for (low, high) in [(0.0, 1.0), (-1.0, 0.0), (-0.3, 0.7), (1.0, 3.0), (1e-7, 1.0), (-5.0, -4.9)] {
                check(S::from_f64(low) * scale, S::from_f64(high) * scale);
            }
            // A point, and an extent of few roundings, far from the origin.
            for x in [scale, -scale, S::ZERO] {
                check(x, x);
                check(x, x.next_up());
                check(x, (0..300).fold(x, |x, _| x.next_up()));
            }
        }
        for (low, high) in [(-1.0, 1.0), (0.0, 1.0), (-1.0, 0.0), (-1.0, -0.5), (0.999, 1.0), (-0.1, 1.0)] {
            check(S::MAX * S::from_f64(low), S::MAX * S::from_f64(high));
        }
        check(S::ZERO, S::ZERO.next_up());
        check(S::ZERO.next_down(), S::MAX);
    }

    #[test]
    fn boxes_contain_what_was_quantised() {
        let scales = [1e-30, 1e-15, 1e-3, 1.0, 1e3, 1e15, 1e30];
        check_all::<f32>(&scales);
        check_all::<f64>(&scales);
        check_all::<f32>(&[1e-45, 1e-40, 1e37]);
        check_all::<f64>(&[1e-320, 1e-300, 1e300, 1e307]);
    }

    /// Where nothing is lost by rounding, a box is larger by less than a 127th of the node on each side.
    #[test]
    fn boxes_are_hardly_larger() {
        for extent in [1.0f32, 1.5, 1.99, 2.0, 2.01, 3.9, 254.0, 255.0, 256.0] {
            let grid = Grid::over(&Aabb { min: [1.0; 3], max: [1.0 + extent; 3] });
            assert!(grid.scale[0] <= extent / 127.0, "{extent}: {}", grid.scale[0]);
            assert!(grid.scale[0] >= extent / 255.5, "{extent}: {}", grid.scale[0]);
        }
    }
}
