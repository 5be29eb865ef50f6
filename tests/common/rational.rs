//! Ray-triangle tests in rational numbers, by the meeting point.
//!
//! The test finds the point where the line meets the plane. Then it decides whether the point is in
//! the triangle, with both projected along an axis.

use bvhkit::{Ray, Scalar, Triangle};
use num_rational::BigRational;

type Point = [BigRational; 3];

/// The point where a line meets a triangle's plane.
pub struct Meeting {
    pub t: BigRational,
    /// The largest of the point's negated barycentrics: at most 0 in the triangle.
    pub slack: BigRational,
}

/// Converts a number exactly; `None` for NaN and infinities.
pub fn exact<S: Scalar>(x: S) -> Option<BigRational> {
    BigRational::from_float(x.to_f64())
}

fn point<S: Scalar>([x, y, z]: [S; 3]) -> Option<Point> {
    Some([exact(x)?, exact(y)?, exact(z)?])
}

fn sub(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn dot(a: &Point, b: &Point) -> BigRational {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn size(x: &BigRational) -> BigRational {
    x.clone().max(-x)
}

/// Returns where line and plane meet; `None` if parallel, or for invalid input.
pub fn meeting<S: Scalar>(triangle: &Triangle<S>, ray: &Ray<S>) -> Option<Meeting> {
    let (a, b, c) = (point(triangle.a)?, point(triangle.b)?, point(triangle.c)?);
    let (origin, direction) = (point(ray.origin)?, point(ray.direction)?);
    // Rejects empty intervals, and NaN, which has no order.
    ray.t_min.partial_cmp(&ray.t_max).filter(|order| order.is_le())?;
    let zero = BigRational::default();
    // Twice the area of p q r, projected along an axis. The three projections of a triangle are
    // the components of its normal.
    let area = |axis: usize, p: &Point, q: &Point, r: &Point| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        (&q[i] - &p[i]) * (&r[j] - &p[j]) - (&q[j] - &p[j]) * (&r[i] - &p[i])
    };
    let normal = [0, 1, 2].map(|axis| area(axis, &a, &b, &c));
    let slope = dot(&normal, &direction);
    if slope == zero {
        return None;
    }
    let t = dot(&normal, &sub(&a, &origin)) / slope;
    let p = [0, 1, 2].map(|i| &origin[i] + &t * &direction[i]);
    let axis = (0..3).max_by_key(|&axis| size(&normal[axis]))?;
    let parts = [area(axis, &p, &b, &c), area(axis, &a, &p, &c), area(axis, &a, &b, &p)];
    let slack = parts.into_iter().map(|part| -part / &normal[axis]).max()?;
    Some(Meeting { t, slack })
}

impl Meeting {
    /// Returns whether the point is in the triangle and t in the ray's interval.
    pub fn is_hit<S: Scalar>(&self, ray: &Ray<S>) -> bool {
        let from_start = exact(ray.t_min).map_or(ray.t_min < S::ZERO, |t_min| t_min <= self.t);
        let to_end = exact(ray.t_max).map_or(ray.t_max > S::ZERO, |t_max| self.t <= t_max);
        self.slack <= BigRational::default() && from_start && to_end
    }
}

/// Returns whether `x` is the number nearest to `value`, ties to even.
///
/// Compares `value` with the midpoints between `x` and its neighbours.
pub fn is_nearest<S: Scalar>(x: S, value: &BigRational) -> bool {
    let two = BigRational::from_integer(2.into());
    let largest = S::INFINITY.next_down();
    let [last, last_but_one] = [largest, largest.next_down()].map(|x| exact(x).unwrap());
    let overflow = &last + (&last - last_but_one) / &two;
    let Some(here) = exact(x) else {
        return if x > S::ZERO { *value >= overflow } else { x < S::ZERO && *value <= -overflow };
    };
    let middle = |neighbour: S, beyond: BigRational| match exact(neighbour) {
        Some(neighbour) => (&here + neighbour) / &two,
        None => beyond,
    };
    let below = middle(x.next_down(), -overflow.clone());
    let above = middle(x.next_up(), overflow);
    let even = x.abs().to_ordered_bits() & 1 == 0;
    if even { below <= *value && *value <= above } else { below < *value && *value < above }
}

/// Returns the distance between the neighbours in `S` of `value`.
///
/// `nearest` is the number nearest to `value`.
pub fn spacing<S: Scalar>(nearest: S, value: &BigRational) -> BigRational {
    let mut below = nearest.abs();
    if exact(below).unwrap() > size(value) {
        below = below.next_down();
    }
    let neighbours = exact(below.next_up()).zip(exact(below));
    // The largest number has no finite neighbour above it, so its spacing is the one below it.
    let neighbours = neighbours.or_else(|| exact(below).zip(exact(below.next_down())));
    neighbours.map(|(above, below)| above - below).unwrap()
}
