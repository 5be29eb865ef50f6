//! The closing table: every contestant side by side.

use crate::shared::columns::{self, decimal};
use crate::support::scenes::NamedScene;
use crate::tracing::check::Check;
use crate::tracing::family::{Family, Member};
use crate::tracing::kinds::Kind;
use crate::tracing::speed::{Pass, measure};
use crate::tracing::tracer::Way;
use bvhkit::Counters;
use comfy_table::Table;

const LEGEND: &str = "\
Under one (thread) and all (as many as rayon has, each tracing all the rays): M rays/s, medians, contestants taking
turns, each after a turn that is not timed.
Natural: in the order in which a renderer makes them. Shuffled: the same rays. Single: one by one. Batch: all in one call.
Shadow and ambient-occlusion ask for any hit, random-all-hits for all of them in order, the others for the closest.
Miss: random rays that end just short of what they would hit. Beside: rays that do not meet the scene's box.
Fast, Watertight, Precise: modes of triangles. Spheres and discs (tested one by one): in the triangles' places.
obvhs: its medium presets. Per ray: inner nodes, leaves, primitives tested. Bytes per primitive: of the hierarchy; with the
primitives. Differ: of a sample, the rays that hit where the naive reference says miss, miss where it says hit, or hit
another triangle. Ours are equal to it in the bits of t and in the index, or there is no table.";

const WORDS: [&str; 4] = ["scene", "rays", "primitives", "layout"];

const COUNTS: [&str; 7] = [
    "hit\n%",
    "nodes\nper ray",
    "leaves\nper ray",
    "tests\nper ray",
    "bytes\nof tree",
    "bytes\nin all",
    "differ\nfrom naive",
];

pub fn empty() -> Table {
    let speeds = passes().map(|Pass { is_shuffled, way, threads }| {
        let threads = if threads == 1 { "one" } else { "all" };
        let order = if is_shuffled { "shuffled" } else { "natural" };
        format!("{threads}\n{order}\n{}", way.name())
    });
    let header = WORDS.map(String::from).into_iter().chain(speeds).chain(COUNTS.map(String::from));
    columns::table(header.collect::<Vec<_>>(), WORDS.len())
}

pub fn print(table: &Table) {
    println!("\n{LEGEND}\n");
    println!("{table}");
}

/// Measures a scene's families with each kind of ray.
pub fn add(
    table: &mut Table,
    scene: &NamedScene,
    families: &[Family],
    checks: &[Vec<Check>],
    repetitions: usize,
) {
    // The facts of the scene go down the first column, beside the rays.
    let mut facts = [scene.name.clone(), format!("{} triangles", scene.triangles.len())].into_iter();
    for (number, kind) in families[0].kinds.iter().enumerate() {
        let columns: Vec<_> = passes().map(|pass| measure(families, number, pass, repetitions)).collect();
        let contestants = families.iter().zip(checks).flat_map(|(family, checks)| {
            let (kind, check) = (&family.kinds[number], &checks[number]);
            family.members.iter().zip(&check.differ).map(move |member| (family, kind, check, member))
        });
        let mut names = [kind.name.to_string(), format!("{} rays", kind.natural.len())].into_iter();
        for (place, (family, kind, check, (member, differ))) in contestants.enumerate() {
            let speeds = columns.iter().map(|column| column[place]);
            if speeds.clone().all(|speed| speed.is_none()) {
                continue;
            }
            let mut row = vec![
                facts.next().unwrap_or_default(),
                names.next().unwrap_or_default(),
                family.primitives.into(),
                member.name.clone(),
            ];
            row.extend(speeds.map(|speed| decimal(speed, 2)));
            row.extend(counts(kind, member, check, *differ));
            table.add_row(row);
        }
    }
}

fn counts(kind: &Kind, member: &Member, check: &Check, differ: usize) -> [String; COUNTS.len()] {
    let steps = member.tracer.steps(kind.query, &kind.natural);
    let per_ray = |mean: fn(&Counters) -> f64| decimal(steps.as_ref().map(mean), 2);
    let bytes = member.tracer.bytes();
    [
        decimal(Some(100.0 * check.hit), 0),
        per_ray(Counters::nodes_per_ray),
        per_ray(Counters::leaves_per_ray),
        per_ray(Counters::primitives_per_ray),
        decimal(bytes.map(|[tree, _]| tree), 1),
        decimal(bytes.map(|[_, all]| all), 1),
        format!("{differ} of {}", check.sample),
    ]
}

fn passes() -> impl Iterator<Item = Pass> {
    let mut threads = vec![1, rayon::current_num_threads()];
    threads.dedup();
    threads.into_iter().flat_map(|threads| {
        let orders = [false, true].into_iter();
        orders.flat_map(move |is_shuffled| Way::ALL.map(|way| Pass { is_shuffled, way, threads }))
    })
}
