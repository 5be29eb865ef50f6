//! The ways to build.

use crate::shared::obvhs::{Peer, convert};
use crate::tracing::tracer::Tracer;
use bvhkit::heuristic::{BinnedSah, Clustered, Heuristic, Median, Midpoint, Morton, SpatialSah, SweepSah};
use bvhkit::{Builder, Bvh, Optimise, Quality, Triangle};
use obvhs::BvhBuildParams;
use std::rc::Rc;

pub struct Way<'a> {
    pub name: String,
    pub sort: Sort,
    /// Builds from triangles in the way's own format to a tree that is ready to trace.
    pub build: Box<dyn Fn() -> Box<dyn Built> + 'a>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// A heuristic, with the tree as it splits.
    Split,
    /// The same heuristic with reinsertion; comes right after it.
    Reinserted,
    Preset,
    /// A preset of another library.
    Peer,
}

/// A hierarchy that a way has built.
pub trait Built: Tracer {
    /// Returns the SAH cost, as [`bvhkit::TreeReport`] defines it.
    ///
    /// `None` if nodes have another number of children, so that the costs would not compare.
    fn sah_cost(&self) -> Option<f64>;

    /// Returns the EPO, as [`Bvh::epo`] defines it; `None` in the same case.
    fn epo(&self) -> Option<f64>;
}

pub fn all(triangles: &[Triangle]) -> Vec<Way<'_>> {
    let mut ways = Vec::new();
    ways.extend(both(triangles, "median", Median));
    ways.extend(both(triangles, "midpoint", Midpoint));
    ways.extend(both(triangles, "Morton", Morton));
    let clustered = Clustered { size: 128, heuristic: BinnedSah::new(16) };
    ways.extend(both(triangles, "clusters of 128", clustered));
    for (name, bins) in [("binned 8", 8), ("binned 16", 16), ("binned 32", 32)] {
        ways.extend(both(triangles, name, BinnedSah::new(bins)));
    }
    ways.extend(both(triangles, "sweep", SweepSah::default()));
    ways.extend(both(triangles, "spatial", SpatialSah::default()));
    for (name, quality) in [("Fast", Quality::Fast), ("Balanced", Quality::Balanced), ("High", Quality::High)]
    {
        ways.push(ours(triangles, name.into(), Sort::Preset, Bvh::builder().quality(quality)));
    }
    ways.extend(peers(triangles));
    ways
}

/// Returns two ways of a heuristic: as it splits, and with reinsertion.
fn both<'a>(
    triangles: &'a [Triangle],
    name: &str,
    heuristic: impl Heuristic<f32> + Clone + 'a,
) -> [Way<'a>; 2] {
    let builder = Bvh::builder().heuristic(heuristic);
    let reinserted = builder.clone().optimise(Optimise::default());
    [
        ours(triangles, name.into(), Sort::Split, builder),
        ours(triangles, format!("{name}, reinserted"), Sort::Reinserted, reinserted),
    ]
}

fn ours<'a, H>(triangles: &'a [Triangle], name: String, sort: Sort, builder: Builder<Triangle, H>) -> Way<'a>
where
    H: Heuristic<f32> + Clone + 'a,
{
    let build = move || -> Box<dyn Built> {
        let bvh = builder.clone().build(triangles.iter().copied());
        Box::new(bvh.expect("the coordinates are finite"))
    };
    Way { name, sort, build: Box::new(build) }
}

impl Built for Bvh<Triangle> {
    fn sah_cost(&self) -> Option<f64> {
        Some(self.report().sah_cost)
    }

    fn epo(&self) -> Option<f64> {
        Some(self.epo())
    }
}

/// Returns the ways of `obvhs`, one for each of its trees and presets.
fn peers<'a>(triangles: &[Triangle]) -> Vec<Way<'a>> {
    let triangles: Rc<[_]> = convert(triangles).into();
    let presets = [
        ("fastest", BvhBuildParams::fastest_build as fn() -> BvhBuildParams),
        ("medium", BvhBuildParams::medium_build),
        ("slow", BvhBuildParams::slow_build),
    ];
    let mut ways = Vec::new();
    for (preset, parameters) in presets {
        let here = Rc::clone(&triangles);
        ways.push(peer(format!("obvhs BVH2 {preset}"), move || Peer::bvh2(parameters(), &here)));
    }
    for (preset, parameters) in presets {
        let here = Rc::clone(&triangles);
        ways.push(peer(format!("obvhs CWBVH {preset}"), move || Peer::cwbvh(parameters(), &here)));
    }
    ways
}

fn peer<'a, B>(name: String, build: impl Fn() -> Peer<B> + 'a) -> Way<'a>
where
    Peer<B>: Tracer + 'static,
{
    Way { name, sort: Sort::Peer, build: Box::new(move || Box::new(build())) }
}

impl<B> Built for Peer<B>
where
    Self: Tracer,
{
    fn sah_cost(&self) -> Option<f64> {
        None
    }

    fn epo(&self) -> Option<f64> {
        None
    }
}
