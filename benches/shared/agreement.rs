//! Whether answers agree: with the naive reference's, and between hierarchies.

use bvhkit::{Intersect, Ray, reference};

/// Which primitive, and where.
pub type Hit = bvhkit::Hit<f32, ()>;

/// The same hit without what its primitive tells of it.
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

/// How many rays were answered otherwise than expected; each counts once, by the gravest.
#[derive(Clone, Copy, Default)]
pub struct Disagreements {
    /// One says hit, the other miss, in either query.
    pub hit_or_miss: usize,
    /// Another primitive, with another t.
    pub primitive: usize,
    /// Another primitive of the same t: only the order among equals differs.
    pub tie: usize,
    /// The same primitive with a t of other bits: rounding.
    pub rounding: usize,
}

impl Disagreements {
    /// Those that an image would show.
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
                    // Whose rounding differs cannot be asked for a tie: we judge by our own.
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

/// # Panics
/// If an answer is not, bit for bit, the expected one. The message has all it takes to reproduce it.
pub fn assert_exact(what: &str, rays: &[Ray], expected: &Answers, actual: &Answers) {
    let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.index));
    for (i, ray) in rays.iter().enumerate() {
        let (a, b) = (expected.closest[i], actual.closest[i]);
        assert!(bits(a) == bits(b), "{what}: {ray:?} should hit {a:?}, but the answer is {b:?}");
        let (a, b) = (expected.any[i], actual.any[i]);
        assert!(a == b, "{what}: any hit of {ray:?} should be {a}, but the answer is {b}");
    }
}
