//! Tracers: a tree, or the naive loop over all shapes.

use bvhkit::heuristic::{BinnedSah, Heuristic, Median, Midpoint, SweepSah};
use bvhkit::{Barycentrics, BuildError, Bvh, Counters, Ray, reference};
use clap::ValueEnum;

use crate::scene::Shape;

/// A method to find the hits of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// No tree: every ray is tested against every primitive.
    None,
    Median,
    Midpoint,
    BinnedSah,
    SweepSah,
}

impl Method {
    /// Returns the name, as on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn heuristic(self) -> Option<Box<dyn Heuristic<f32>>> {
        match self {
            Self::None => None,
            Self::Median => Some(Box::new(Median)),
            Self::Midpoint => Some(Box::new(Midpoint)),
            Self::BinnedSah => Some(Box::new(BinnedSah::default())),
            Self::SweepSah => Some(Box::new(SweepSah::default())),
        }
    }
}

pub type Hit = bvhkit::Hit<f32, Option<Barycentrics>>;

/// The shapes of a scene, ready for queries.
pub enum Tracer {
    Naive(Vec<Shape>),
    Tree(Bvh<Shape>),
}

impl Tracer {
    pub fn build(
        shapes: Vec<Shape>,
        method: Method,
        max_leaf_size: Option<usize>,
        threads: usize,
    ) -> Result<Self, BuildError> {
        let Some(heuristic) = method.heuristic() else { return Ok(Self::Naive(shapes)) };
        let mut builder = Bvh::builder().heuristic(&*heuristic).threads(threads);
        if let Some(size) = max_leaf_size {
            builder = builder.max_leaf_size(size);
        }
        builder.build(shapes).map(Self::Tree)
    }

    pub fn closest_hit(&self, ray: &Ray, counters: &mut Counters) -> Option<Hit> {
        match self {
            Self::Naive(shapes) => reference::closest_hit_with(shapes, ray, counters),
            Self::Tree(bvh) => bvh.closest_hit_with(ray, counters),
        }
    }

    pub fn any_hit(&self, ray: &Ray, counters: &mut Counters) -> bool {
        match self {
            Self::Naive(shapes) => reference::any_hit_with(shapes, ray, counters),
            Self::Tree(bvh) => bvh.any_hit_with(ray, counters),
        }
    }
}

/// A ray and its query.
#[derive(Clone, Copy, Debug)]
pub enum Query {
    Closest(Ray),
    Any(Ray),
}

/// A caster of rays that counts them and keeps some of them if asked to.
pub struct Caster<'a> {
    tracer: &'a Tracer,
    pub counters: Counters,
    /// Every `keep_every`th ray is kept; 0 keeps none.
    keep_every: u64,
    pub kept: Vec<Query>,
}

impl<'a> Caster<'a> {
    pub fn new(tracer: &'a Tracer, keep_every: u64) -> Self {
        Self { tracer, counters: Counters::default(), keep_every, kept: Vec::new() }
    }

    pub fn closest_hit(&mut self, ray: &Ray) -> Option<Hit> {
        self.keep(Query::Closest(*ray));
        self.tracer.closest_hit(ray, &mut self.counters)
    }

    pub fn any_hit(&mut self, ray: &Ray) -> bool {
        self.keep(Query::Any(*ray));
        self.tracer.any_hit(ray, &mut self.counters)
    }

    fn keep(&mut self, query: Query) {
        if self.keep_every != 0 && self.counters.rays.is_multiple_of(self.keep_every) {
            self.kept.push(query);
        }
    }
}
