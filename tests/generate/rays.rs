//! Strategies for rays at targets where rounding decides.
//!
//! Targets are corners, edges, faces of boxes, and surfaces.

use super::numbers::{LogUniform, log_uniform, scalar_from_bits};
use super::primitives::Corners;

use bvhkit::{Ray, Scalar};
use proptest::prelude::*;
use proptest::sample::Index;

/// A recipe for a ray, which picks primitives of a soup by index.
#[derive(Clone, Debug)]
pub struct Aim {
    from: From,
    toward: Toward,
    interval: Interval,
}

#[derive(Clone, Debug)]
enum From {
    Place(Place),
    /// A point with any exponents.
    Numbers([LogUniform; 3]),
}

/// A point of some primitive: a corner, on an edge, inside, or off it by its size.
#[derive(Clone, Debug)]
struct Place {
    primitive: Index,
    weights: [f64; 3],
}

#[derive(Clone, Debug)]
enum Toward {
    /// From the origin to a place, which is at t = 1.
    Place(Place),
    /// Along an axis, forward or back, with zeros of either sign.
    ///
    /// A ray from a corner is in the planes of that corner's box.
    Axis { axis: usize, length: f64, zeros: [bool; 3] },
    /// A direction with any bits.
    Bits([u64; 3]),
    /// A direction with any exponents.
    Numbers([LogUniform; 3]),
    /// A zero direction, which makes the ray invalid.
    Zero,
}

#[derive(Clone, Debug)]
enum Interval {
    Whole,
    From(f64),
    Between(f64, f64),
    Numbers(LogUniform, LogUniform),
    Line,
}

pub fn aims() -> impl Strategy<Value = Vec<Aim>> {
    let interval = prop_oneof![
        4 => Just(Interval::Whole),
        1 => (0.0..2.0).prop_map(Interval::From),
        // Backward, forward and empty intervals; then single points.
        2 => (-2.0..2.0, 0.0..3.0).prop_map(|(t_min, t_max)| Interval::Between(t_min, t_max)),
        1 => prop::sample::select(vec![0.0, 1.0]).prop_map(|t| Interval::Between(t, t)),
        1 => (log_uniform(), log_uniform()).prop_map(|(t_min, t_max)| Interval::Numbers(t_min, t_max)),
        1 => Just(Interval::Line),
    ];
    let toward = prop_oneof![
        8 => place().prop_map(Toward::Place),
        8 => (0..3usize, prop::sample::select(vec![1.0, -1.0, 0.3, -7.0]), any::<[bool; 3]>())
            .prop_map(|(axis, length, zeros)| Toward::Axis { axis, length, zeros }),
        1 => any::<[u64; 3]>().prop_map(Toward::Bits),
        1 => numbers().prop_map(Toward::Numbers),
        1 => Just(Toward::Zero),
    ];
    let from = prop_oneof![9 => place().prop_map(From::Place), 1 => numbers().prop_map(From::Numbers)];
    let aim = (from, toward, interval).prop_map(|(from, toward, interval)| Aim { from, toward, interval });
    prop::collection::vec(aim, 1..16)
}

fn numbers() -> impl Strategy<Value = [LogUniform; 3]> {
    [log_uniform(), log_uniform(), log_uniform()]
}

fn place() -> impl Strategy<Value = Place> {
    let corner = prop::sample::select(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let edge = (0.0..1.0).prop_map(|w| [w, 1.0 - w, 0.0]);
    let inside = (0.0..1.0, 0.0..1.0).prop_map(|(v, w)| [1.0 - w, w * (1.0 - v), w * v]);
    // Weights that do not sum to 1 also leave the plane.
    let beside = [-4.0..4.0, -4.0..4.0, -4.0..4.0];
    let weights = prop_oneof![corner, edge, inside, beside];
    (any::<Index>(), weights).prop_map(|(primitive, weights)| Place { primitive, weights })
}

impl Place {
    fn point<S: Scalar>(&self, soup: &[Corners<S>]) -> [S; 3] {
        let fallback = [[S::ZERO; 3]; 3];
        let corners = if soup.is_empty() { &fallback } else { self.primitive.get(soup) };
        // A corner itself must come out exactly, even with a negative zero.
        if let Some(corner) = self.weights.iter().position(|&w| w == 1.0) {
            return corners[corner];
        }
        let weighted = |corner: usize, axis: usize| corners[corner][axis] * S::from_f64(self.weights[corner]);
        [0, 1, 2].map(|axis| weighted(0, axis) + weighted(1, axis) + weighted(2, axis))
    }
}

impl Aim {
    pub fn ray<S: Scalar>(&self, soup: &[Corners<S>]) -> Ray<S> {
        let origin = match &self.from {
            From::Place(place) => place.point(soup),
            From::Numbers(numbers) => numbers.map(LogUniform::number),
        };
        let direction = match &self.toward {
            Toward::Place(place) => {
                let target = place.point(soup);
                [0, 1, 2].map(|axis| target[axis] - origin[axis])
            }
            Toward::Axis { axis, length, zeros } => {
                let mut direction = zeros.map(|negative| if negative { -S::ZERO } else { S::ZERO });
                direction[*axis] = S::from_f64(*length);
                direction
            }
            Toward::Bits(bits) => bits.map(scalar_from_bits),
            Toward::Numbers(numbers) => numbers.map(LogUniform::number),
            Toward::Zero => [S::ZERO, -S::ZERO, S::ZERO],
        };
        let (t_min, t_max) = match self.interval {
            Interval::Whole => (S::ZERO, S::INFINITY),
            Interval::From(t_min) => (S::from_f64(t_min), S::INFINITY),
            Interval::Between(t_min, t_max) => (S::from_f64(t_min), S::from_f64(t_max)),
            Interval::Numbers(t_min, t_max) => (t_min.number(), t_max.number()),
            Interval::Line => (S::NEG_INFINITY, S::INFINITY),
        };
        Ray::new(origin, direction).with_interval(t_min, t_max)
    }
}
