//! A survey: one scene built in every way, and the same rays through each tree.

use crate::shared::timing::turns;
use crate::support::scenes::NamedScene;
use crate::tracing::check::check;
use crate::tracing::family::{Family, Member};
use crate::tracing::kinds::{self, Kind};
use crate::tracing::speed::{Pass, measure};
use crate::tracing::tracer::{Query, Tracer, Way};
use crate::ways::{self, Sort};
use bvhkit::Counters;
use std::slice;

/// The kinds of rays that a renderer traces, each by closest hit or any hit.
pub const KINDS: [&str; 5] = ["primary", "diffuse", "random", "shadow", "ambient-occlusion"];

/// Tests of one triangle that the naive reference may spend on a scene.
///
/// They take a few seconds.
const NAIVE_TESTS: usize = 300_000_000;
/// Repetitions of each build.
const BUILDS: usize = 7;
/// Repetitions of the rays.
const TRACES: usize = 15;
/// Rays are traced one by one, in a renderer's order.
const PASS: Pass = Pass { is_shuffled: false, way: Way::Single, threads: 1 };

pub struct Survey {
    pub scene: String,
    pub triangles: usize,
    /// The number of rays that the naive reference answers too.
    pub sample: usize,
    /// For each kind with rays: its name, their number, and the share that hits.
    pub kinds: Vec<(&'static str, usize, f64)>,
    pub findings: Vec<Finding>,
}

/// The measurements of one way to build.
pub struct Finding {
    pub name: String,
    pub sort: Sort,
    pub build_ms: f64,
    pub sah_cost: Option<f64>,
    pub epo: Option<f64>,
    /// Bytes for each triangle, of the hierarchy and the triangles together.
    pub bytes: Option<f64>,
    /// Nodes, leaves and tests for each ray, over all kinds.
    pub steps: Option<[f64; 3]>,
    /// Millions of rays a second, for each kind in turn.
    pub rates: Vec<f64>,
    /// The geometric mean of the rates.
    pub geometric_mean: f64,
    /// The number of rays in the sample that visibly differ from the naive reference.
    pub differ: usize,
}

impl Survey {
    /// Builds a scene in every way, checks all answers and measures.
    ///
    /// # Panics
    ///
    /// If any of our answers is not, bit for bit, the naive reference's.
    pub fn new(scene: &NamedScene, rays: usize) -> Self {
        let ways = ways::all(&scene.triangles);
        let built: Vec<_> = ways.iter().map(|way| (way.build)()).collect();
        let costs: Vec<_> = built.iter().map(|built| (built.sah_cost(), built.epo())).collect();
        let members = ways.iter().zip(built).map(|(way, tracer)| Member {
            name: way.name.clone(),
            ours: way.sort != Sort::Peer,
            tracer,
        });
        let family = Family {
            primitives: "triangles",
            kinds: kinds(scene, rays).into(),
            naive: Box::new(scene.triangles.clone()),
            members: members.collect(),
        };
        let checks = check(&scene.name, &family, NAIVE_TESTS);

        // The shortest time counts: builds are so long that a median would
        // include the machine's other work.
        let build_times = turns(ways.len(), BUILDS, |_| (), |i| (ways[i].build)());
        let fastest = |i: usize| build_times[i].iter().min().expect("a build was timed").as_secs_f64();
        let rates: Vec<_> = (0..family.kinds.len())
            .map(|kind| measure(slice::from_ref(&family), kind, PASS, TRACES))
            .collect();
        let finding = |(i, way): (usize, ways::Way<'_>)| {
            let tracer = &*family.members[i].tracer;
            let rates: Vec<f64> = rates.iter().filter_map(|kind| kind[i]).collect();
            Finding {
                name: way.name,
                sort: way.sort,
                build_ms: 1e3 * fastest(i),
                sah_cost: costs[i].0,
                epo: costs[i].1,
                bytes: tracer.bytes().map(|[_, all]| all),
                steps: steps(tracer, &family.kinds),
                geometric_mean: geometric_mean(&rates),
                rates,
                differ: checks.iter().map(|check| check.differ[i]).sum(),
            }
        };
        let kind = |(kind, hit): (&Kind, f64)| (kind.name, kind.natural.len(), hit);
        Self {
            scene: scene.name.clone(),
            triangles: scene.triangles.len(),
            sample: checks.iter().map(|check| check.sample).sum(),
            kinds: family.kinds.iter().zip(checks.iter().map(|check| check.hit)).map(kind).collect(),
            findings: ways.into_iter().enumerate().map(finding).collect(),
        }
    }
}

/// Returns the rays of each kind, in the order of [`KINDS`].
///
/// If the camera sees nothing, there are only primary and random rays.
fn kinds(scene: &NamedScene, rays: usize) -> Vec<Kind> {
    let place = |kind: &Kind| KINDS.iter().position(|&name| name == kind.name);
    let mut kinds = kinds::all(&scene.triangles, scene, rays);
    kinds.retain(|kind| place(kind).is_some() && !kind.natural.is_empty());
    kinds.sort_by_key(place);
    kinds
}

fn steps(tracer: &dyn Tracer, kinds: &[Kind]) -> Option<[f64; 3]> {
    let mut all = Counters::default();
    for Kind { query, natural, .. } in kinds {
        debug_assert!(*query != Query::All);
        all += tracer.steps(*query, natural)?;
    }
    Some([all.nodes_per_ray(), all.leaves_per_ray(), all.primitives_per_ray()])
}

fn geometric_mean(rates: &[f64]) -> f64 {
    (rates.iter().map(|rate| rate.ln()).sum::<f64>() / rates.len() as f64).exp()
}
