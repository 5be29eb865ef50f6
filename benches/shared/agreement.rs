//! Agreement of answers: with the naive reference, and between hierarchies.

use bvhkit::{Intersect, Ray, reference};

/// A hit on a primitive, without its payload.
pub type Hit = bvhkit::Hit<f32, ()>;

/// Returns the hit without its payload.
pub fn bare<T>(hit: bvhkit::Hit<f32, T>) -> Hit {
    Hit { t: hit.t, index: hit.index, payload: () }
}

/// The answers to both queries for each ray of a list.
#[derive(Default)]
pub struct Answers {
    pub closest: Vec<Option<Hit>>,
    pub any: Vec<bool>,
}

impl Answers {
    pub fn naive(primitives: &[impl Intersect<Scalar = f32>], rays: &[Ray]) -> Self {
        Self {
            closest: rays.iter().map(|ray| reference::closest_hit(primitives, ray).map(bare)).collect(),
            any: rays.iter().map(|ray| reference::any_hit(primitives, ray)).collect(),
        }
    }
}

/// The numbers of rays that are answered otherwise than expected.
///
/// Each ray counts once, by its gravest disagreement.
#[derive(Clone, Copy, Default)]
pub struct Disagreements {
    /// One answer is a hit, the other a miss, in either query.
    pub hit_or_miss: usize,
    /// Another primitive, with another t.
    pub primitive: usize,
    /// Another primitive of the same t: only the order among equals differs.
    pub tie: usize,
    /// The same primitive with a t of other bits: rounding.
    pub rounding: usize,
}

impl Disagreements {
    /// Returns the number of rays whose disagreement an image would show.
    pub fn visible(&self) -> usize {
        self.hit_or_miss + self.primitive
    }

    pub fn count(
        primitives: &[impl Intersect<Scalar = f32>],
        rays: &[Ray],
        expected: &Answers,
        actual: &Answers,
    ) -> Self {
        let mut counts = Self::default();
        for (i, ray) in rays.iter().enumerate() {
            if expected.any[i] != actual.any[i] {
                counts.hit_or_miss += 1;
                continue;
            }
            match (expected.closest[i], actual.closest[i]) {
                (None, None) => {}
                (Some(a), Some(b)) if a.index == b.index => {
                    counts.rounding += usize::from(a.t.to_bits() != b.t.to_bits());
                }
                (Some(a), Some(b)) => {
                    // A peer cannot be asked for its own rounding of a tie,
                    // so our test decides about ties.
                    let other = reference::closest_hit(&primitives[b.index..=b.index], ray);
                    let tie = other.is_some_and(|other| other.t == a.t);
                    *(if tie { &mut counts.tie } else { &mut counts.primitive }) += 1;
                }
                _ => counts.hit_or_miss += 1,
            }
        }
        counts
    }
}

/// Asserts that each answer is, bit for bit, the expected one.
///
/// # Panics
///
/// If an answer differs. The message has all that is needed to reproduce it.
pub fn assert_exact(what: &str, rays: &[Ray], expected: &Answers, actual: &Answers) {
    let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.index));
    for (i, ray) in rays.iter().enumerate() {
        let (a, b) = (expected.closest[i], actual.closest[i]);
        assert!(bits(a) == bits(b), "{what}: {ray:?} should hit {a:?}, but the answer is {b:?}");
        let (a, b) = (expected.any[i], actual.any[i]);
        assert!(a == b, "{what}: any hit of {ray:?} should be {a}, but the answer is {b}");
    }
}
