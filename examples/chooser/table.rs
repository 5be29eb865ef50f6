//! A table of all ways, side by side.

use crate::shared::columns::{decimal, table};
use crate::survey::{Finding, KINDS, Survey};

const HEADER: [&str; 10] = [
    "scene",
    "way to build",
    "build\nms",
    "SAH\ncost",
    "EPO",
    "bytes per\ntriangle",
    "nodes\nper ray",
    "leaves\nper ray",
    "tests\nper ray",
    "differ\nfrom naive",
];
/// The first column of the rates: a column for each kind of ray, then their mean.
const RATES: usize = 9;

const LEGEND: &str = "\
One thread, ways taking turns. Build: the quickest, from triangles in the library's format to what is ready to trace.
Under the kinds of rays: M rays/s, medians, one by one in a renderer's order; any hit for shadow and ambient-occlusion,
closest hit for the others. Mean: the geometric one of those. SAH cost, nodes, leaves and tests: of nodes of up to 16 children.
EPO: the mean cost, in the same unit, of nodes around a point of the surface that do not have it below them.
Fast, Balanced, High: the presets. Reinserted: with Optimise::default(). Bytes: with the triangles.
Differ: of the sample that the naive reference answered too, the rays that hit where it says miss, miss where it says hit,
or hit another triangle. Ours are equal to it in the bits of t and in the index, or there is no table.";

pub fn print(surveys: &[Survey]) {
    println!("{LEGEND}\n");
    let mut header = HEADER.map(String::from).to_vec();
    let rates = KINDS.iter().map(|kind| kind.replace('-', "\n")).chain(["mean".into()]);
    header.splice(RATES..RATES, rates);
    let mut table = table(header, 2);
    for survey in surveys {
        table.add_rows(rows(survey));
    }
    println!("{table}");
}

fn rows(survey: &Survey) -> impl Iterator<Item = Vec<String>> + '_ {
    // The facts of the scene go down the first column, beside the ways.
    let mut facts = vec![survey.scene.clone(), format!("{} triangles", survey.triangles)];
    facts.extend(
        survey.kinds.iter().map(|(kind, rays, hit)| format!("{rays} {kind}, {:.0} % hit", 100.0 * hit)),
    );
    let mut facts = facts.into_iter();
    survey.findings.iter().map(move |finding| {
        let Finding { build_ms, sah_cost, epo, bytes, steps, geometric_mean, differ, .. } = finding;
        let mut row = vec![facts.next().unwrap_or_default(), finding.name.clone()];
        row.push(decimal(Some(*build_ms), 1));
        row.push(decimal(*sah_cost, 1));
        row.push(decimal(*epo, 2));
        row.push(decimal(*bytes, 1));
        row.extend((0..3).map(|step| decimal(steps.map(|steps| steps[step]), 2)));
        row.extend(KINDS.map(|kind| {
            let place = survey.kinds.iter().position(|&(name, ..)| name == kind);
            decimal(place.map(|place| finding.rates[place]), 2)
        }));
        row.push(decimal(Some(*geometric_mean), 2));
        row.push(format!("{differ} of {}", survey.sample));
        row
    })
}
