//! Counts of errors.

use crate::judge::Outcome;
use crate::mesh::Place;
use std::fmt;
use std::ops::AddAssign;

/// The number of cases found, of all cases examined.
#[derive(Clone, Copy, Default)]
pub struct Count {
    pub found: u64,
    pub of: u64,
}

impl Count {
    pub fn add(&mut self, is_found: bool) {
        self.found += u64::from(is_found);
        self.of += 1;
    }

    /// Returns the share of the cases found.
    pub fn rate(self) -> f64 {
        self.found as f64 / self.of as f64
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        self.found += other.found;
        self.of += other.of;
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.of == 0 { f.write_str("-") } else { write!(f, "{} of {}", self.found, self.of) }
    }
}

/// The errors of one contestant, explained in the legend of the table.
#[derive(Clone, Default)]
pub struct Tally {
    pub vertex_leaks: Count,
    pub edge_leaks: Count,
    pub false_hits: Count,
    /// The largest edge slack of a false hit.
    pub slack: f64,
    /// The largest distance of a ray from the triangle of its false hit, in roundings.
    pub beside: f64,
    pub wrong: Count,
    /// The size of the error of t, in ulps, of each true hit.
    pub ulps: Vec<f32>,
    pub self_hits: Count,
    pub unlike_naive: Count,
}

impl Tally {
    pub fn leaks(&self) -> Count {
        let mut leaks = self.vertex_leaks;
        leaks += self.edge_leaks;
        leaks
    }

    /// Returns the errors of t that half, 99 of 100, and all of the true hits keep to.
    pub fn quantiles(&self) -> Option<[f32; 3]> {
        let mut sorted = self.ulps.clone();
        sorted.sort_unstable_by(f32::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        Some([0.5, 0.99, 1.0].map(|share| sorted[(share * last as f64).round() as usize]))
    }
}

impl AddAssign<&Self> for Tally {
    fn add_assign(&mut self, other: &Self) {
        self.vertex_leaks += other.vertex_leaks;
        self.edge_leaks += other.edge_leaks;
        self.false_hits += other.false_hits;
        self.slack = self.slack.max(other.slack);
        self.beside = self.beside.max(other.beside);
        self.wrong += other.wrong;
        self.ulps.extend(&other.ulps);
        self.self_hits += other.self_hits;
        self.unlike_naive += other.unlike_naive;
    }
}

/// Adds the tallies of several contestants, each to its own.
pub fn merge(mut into: Vec<Tally>, from: Vec<Tally>) -> Vec<Tally> {
    for (into, from) in into.iter_mut().zip(&from) {
        *into += from;
    }
    into
}

/// Returns the leaks of contestant `i` at each place, over all meshes.
pub fn by_place(outcomes: &[Outcome], i: usize) -> Vec<(Place, Count)> {
    let mut places: Vec<(Place, Count)> = Vec::new();
    for Outcome { place, tallies, .. } in outcomes {
        let leaks = tallies[i].leaks();
        match places.iter_mut().find(|(known, _)| known == place) {
            Some((_, sum)) => *sum += leaks,
            None => places.push((*place, leaks)),
        }
    }
    places
}
