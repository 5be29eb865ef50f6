//! Bounds of 8 bits each: planes of a grid that covers a node, rounded outward.

use crate::geometry::{Aabb, Scalar};

/// The grid of a node, on three axes: plane q is at `origin + q * scale`.
///
/// # Why decoded boxes contain the children's boxes
///
/// The bound of a quantized plane is the value that [`at`](Self::at) computes. Nothing compares
/// this value with the result of exact arithmetic. `q * scale` is rounded only where it overflows
/// or underflows, because the scale is a power of two. The sum may be rounded anywhere. Both
/// operations are monotone in q, so `at` is monotone too.
///
/// Each plane is chosen by the values of `at`. For a minimum it is the last plane that is not above
/// the minimum. Plane 0 is not above it, because `origin` is the least of the minima, to the bit.
/// For a maximum it is the first plane that is not below the maximum. Plane 255 is not below it,
/// because the scale is doubled until then. Lanes do the same two operations, and nothing is fused,
/// so they compute the same bits. Whatever the size and the place of the scene, the box that a ray
/// meets contains the child's box. Far from the origin, planes coincide. Near the end of the range,
/// the last planes are infinite. Both make boxes larger.
///
/// No plane is NaN, because origin and scale are finite.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Grid<S> {
    pub origin: [S; 3],
    pub scale: [S; 3],
}

impl<S: Scalar> Grid<S> {
    /// Creates the grid over a valid box.
    pub fn over(aabb: &Aabb<S>) -> Self {
        let scale = |axis: usize| scale(aabb.min[axis], aabb.max[axis]);
        Self { origin: aabb.min, scale: [scale(0), scale(1), scale(2)] }
    }

    /// Returns the coordinate of a quantized plane.
    #[inline(always)]
    pub fn at(&self, axis: usize, place: u8) -> S {
        at(self.origin[axis], self.scale[axis], place)
    }

    /// Returns the quantized planes of the least box around a box inside the grid.
    ///
    /// They are the minimum and the maximum on each axis.
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

/// Returns the first plane that is far enough, or 256 if none is.
///
/// All planes behind a plane that is far enough are far enough.
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

/// Returns the least power of two with which a grid reaches from `min` to `max`.
///
/// It may be larger than the least where the extent is subnormal. It is 0 if the bounds are equal.
fn scale<S: Scalar>(min: S, max: S) -> S {
    if min == max {
        return S::ZERO;
    }
    // Half of the extent, from halves of the bounds: it never overflows, and is at most 2 * power.
    let half = max * S::HALF - min * S::HALF;
    let power = S::ONE / half.inverse_power_of_two();
    // The extent is at most 4 * power. 255 steps of power / 32 cover it, so at most
    // two doublings are needed.
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

    /// Returns bounds in a grid from `low` to `high`.
    ///
    /// They are the ends of the grid, the scalars next to them, and scalars between.
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

    /// Checks that any two of the bounds are between their quantized planes.
    fn check<S: Scalar>(low: S, high: S) {
        let bounds = bounds(low, high);
        let grid = Grid::over(&Aabb { min: [low; 3], max: [high; 3] });
        assert!(grid.scale.iter().all(|scale| scale.is_finite() && *scale >= S::ZERO));
        for &min in &bounds {
            for &max in bounds.iter().filter(|max| **max >= min) {
                let aabb = Aabb { min: [min; 3], max: [max; 3] };
                for (axis, [near, far]) in grid.around(&aabb).into_iter().enumerate() {
                    assert!(grid.at(axis, near) <= min && max <= grid.at(axis, far), "{low:?} {high:?}");
                    // The next planes inward would cut off a part of the box.
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
            // A point, and extents of a few roundings, far from the origin.
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

    /// Checks that boxes grow by less than a 127th of the node on each side.
    ///
    /// Nothing is lost by rounding here.
    #[test]
    fn boxes_are_hardly_larger() {
        for extent in [1.0f32, 1.5, 1.99, 2.0, 2.01, 3.9, 254.0, 255.0, 256.0] {
            let grid = Grid::over(&Aabb { min: [1.0; 3], max: [1.0 + extent; 3] });
            assert!(grid.scale[0] <= extent / 127.0, "{extent}: {}", grid.scale[0]);
            assert!(grid.scale[0] >= extent / 255.5, "{extent}: {}", grid.scale[0]);
        }
    }
}
