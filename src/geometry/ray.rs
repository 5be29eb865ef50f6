//! The ray: an origin, a direction and an interval of t.

use super::{Scalar, min};
use core::fmt;

/// The points `origin + t * direction` with t in the interval [`t_min`, `t_max`].
///
/// The interval is closed. The direction need not be normalised: t is in units of its length. A
/// component so small that its reciprocal overflows (2.9e-39 for `f32`, 5.6e-309 for `f64`) counts
/// as zero in box tests; scale such a direction up. An invalid ray (see
/// [`validate`](Self::validate)) hits nothing.
///
/// ```
/// use bvhkit::{Ray, RayError};
/// let ray = Ray::new([0.0, 0.0, -5.0], [0.0, 0.0, 2.0]).with_interval(1e-4, 10.0);
/// assert_eq!(ray.at(2.0), [0.0, 0.0, -1.0]);
/// assert_eq!(Ray::<f32>::new([0.0; 3], [0.0; 3]).validate(), Err(RayError::ZeroDirection));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray<S = f32> {
    /// The point where t = 0.
    pub origin: [S; 3],
    /// The vector that one unit of t adds to the point.
    pub direction: [S; 3],
    /// The smallest t in the interval, 0 unless set.
    pub t_min: S,
    /// The largest t in the interval, infinity unless set.
    pub t_max: S,
}

/// The reason why a ray hits nothing, whatever the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RayError {
    /// A coordinate of the origin is NaN or infinite.
    Origin,
    /// A coordinate of the direction is NaN or infinite.
    Direction,
    /// The direction is zero on all three axes.
    ZeroDirection,
    /// `t_min` or `t_max` is NaN, or `t_min` exceeds `t_max`.
    Interval,
}

impl fmt::Display for RayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Origin => "the ray's origin has a coordinate that is NaN or infinite: give a finite one",
            Self::Direction => {
                "the ray's direction has a coordinate that is NaN or infinite: give a finite one"
            }
            Self::ZeroDirection => "the ray's direction is zero on all axes: give one that points somewhere",
            Self::Interval => "the ray's interval is empty or NaN: give t_min <= t_max",
        })
    }
}

impl core::error::Error for RayError {}

impl<S: Scalar> Ray<S> {
    /// Creates the ray from `origin` along `direction`, with t in [0, infinity].
    #[inline(always)]
    pub fn new(origin: impl Into<[S; 3]>, direction: impl Into<[S; 3]>) -> Self {
        Self { origin: origin.into(), direction: direction.into(), t_min: S::ZERO, t_max: S::INFINITY }
    }

    /// Returns the same ray with t in the closed interval [`t_min`, `t_max`].
    ///
    /// Infinite ends are allowed.
    #[inline(always)]
    #[must_use]
    pub fn with_interval(self, t_min: S, t_max: S) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// Returns the point at `t`, rounded.
    #[inline(always)]
    pub fn at(&self, t: S) -> [S; 3] {
        let ([ox, oy, oz], [dx, dy, dz]) = (self.origin, self.direction);
        [ox + dx * t, oy + dy * t, oz + dz * t]
    }

    /// Returns whether `t` is in the ray's interval; false for NaN.
    #[inline(always)]
    pub fn includes(&self, t: S) -> bool {
        t >= self.t_min && t <= self.t_max
    }

    /// Checks that the ray is valid. An invalid ray hits nothing.
    ///
    /// # Errors
    ///
    /// Returns the reason why the ray hits nothing.
    pub fn validate(&self) -> Result<(), RayError> {
        if !self.origin.iter().all(|x| x.is_finite()) {
            return Err(RayError::Origin);
        }
        if !self.direction.iter().all(|x| x.is_finite()) {
            return Err(RayError::Direction);
        }
        if self.direction.iter().all(|&x| x == S::ZERO) {
            return Err(RayError::ZeroDirection);
        }
        // The comparison is false for NaN, too.
        if self.t_min <= self.t_max { Ok(()) } else { Err(RayError::Interval) }
    }

    /// Returns whether [`validate`](Self::validate) succeeds, quickly for most rays.
    #[inline(always)]
    pub(crate) fn is_valid(&self) -> bool {
        #[cold]
        #[inline(never)]
        fn of_others<S: Scalar>(ray: &Ray<S>) -> bool {
            ray.validate().is_ok()
        }
        self.is_ordinary() || of_others(self)
    }

    /// Returns whether the ray is valid and nothing about it is special.
    ///
    /// Most rays are ordinary. An ordinary ray looks only ahead of its origin. No component of its
    /// direction is zero, or so small or large that the inverse loses precision. Its coordinates
    /// are below `Scalar::LARGE_AREA`. This is one test without branches in place of several.
    #[inline(always)]
    pub(crate) fn is_ordinary(&self) -> bool {
        let ([ox, oy, oz], [dx, dy, dz]) = (self.origin, self.direction);
        let ([ox, oy, oz], [dx, dy, dz]) = ([ox.abs(), oy.abs(), oz.abs()], [dx.abs(), dy.abs(), dz.abs()]);
        // A sum is NaN if one of its terms is. Then it does not matter that the minimum
        // may drop the NaN.
        (ox + oy + oz < S::LARGE_AREA)
            & (dx + dy + dz < S::LARGE_AREA)
            & (min(min(dx, dy), dz) > S::ONE / S::LARGE_AREA)
            & (self.t_min >= S::ZERO)
            & (self.t_max > S::ZERO)
            & (self.t_min <= self.t_max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ScalarParts;

    #[test]
    fn validate_names_what_is_wrong_and_agrees_with_the_quick_check() {
        let good = Ray::new([0.0f32; 3], [0.0, -0.0, 1e-45]);
        let cases = [
            (good, Ok(())),
            (good.with_interval(2.0, 2.0), Ok(())),
            (good.with_interval(f32::NEG_INFINITY, f32::INFINITY), Ok(())),
            (Ray::new([f32::NAN, 0.0, 0.0], [1.0; 3]), Err(RayError::Origin)),
            (Ray::new([0.0, f32::INFINITY, 0.0], [1.0; 3]), Err(RayError::Origin)),
            (Ray::new([0.0; 3], [0.0, f32::NAN, 1.0]), Err(RayError::Direction)),
            (Ray::new([0.0; 3], [0.0, 1.0, f32::NEG_INFINITY]), Err(RayError::Direction)),
            (Ray::new([0.0; 3], [0.0, -0.0, 0.0]), Err(RayError::ZeroDirection)),
            (good.with_interval(1.0, 0.5), Err(RayError::Interval)),
            (good.with_interval(f32::NAN, 1.0), Err(RayError::Interval)),
            (good.with_interval(0.0, f32::NAN), Err(RayError::Interval)),
        ];
        for (ray, expected) in cases {
            assert_eq!(ray.validate(), expected, "{ray:?}");
            assert_eq!(ray.is_valid(), expected.is_ok(), "{ray:?}");
        }
    }

    /// Replaces one scalar after another in an ordinary ray.
    #[test]
    fn what_is_ordinary_is_valid_and_has_what_is_said_of_it() {
        let values = [f32::NAN, f32::INFINITY, 1e38, 1.2e18, 1.1e18, 1.0, 8.7e-19, 8.6e-19, 1e-39, 0.0];
        let usual = Ray::new([0.5f32, -0.5, 2.0], [1.0, -0.25, 0.125]).with_interval(0.25, 8.0);
        let (mut ordinary, mut special) = (0, 0);
        for value in values.into_iter().flat_map(|x| [x, -x]) {
            for place in 0..8 {
                let mut ray = usual;
                match place {
                    0..3 => ray.origin[place] = value,
                    3..6 => ray.direction[place - 3] = value,
                    6 => ray.t_min = value,
                    _ => ray.t_max = value,
                }
                assert_eq!(ray.is_valid(), ray.validate().is_ok(), "{ray:?}");
                if !ray.is_ordinary() {
                    special += 1;
                    continue;
                }
                ordinary += 1;
                assert!(ray.validate().is_ok(), "{ray:?}");
                let small = |x: f32| x.abs() < f32::LARGE_AREA;
                assert!(ray.origin.into_iter().chain(ray.direction).all(small), "{ray:?}");
                assert!(ray.direction.iter().all(|x| x.recip().is_normal() && small(x.recip())), "{ray:?}");
                assert!(ray.t_min >= 0.0 && ray.t_max > 0.0, "{ray:?}");
            }
        }
        assert!(ordinary > 50 && special > 50, "{ordinary} {special}");
    }
}
