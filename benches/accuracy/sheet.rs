//! All counts as a CSV sheet: a row for each contestant, mesh and place.

use crate::judge::Outcome;
use crate::tally::Count;
use crate::tracer::Contestant;
use anyhow::Result;
use std::path::Path;

const HEADER: [&str; 24] = [
    "contestant",
    "mesh",
    "scale",
    "offset",
    "closest_mrays_per_s",
    "vertex_leaks",
    "vertex_rays",
    "edge_leaks",
    "edge_rays",
    "false_hits",
    "false_hits_of",
    "largest_slack",
    "largest_roundings_beside",
    "wrong_triangle",
    "wrong_triangle_of",
    "t_ulps_p50",
    "t_ulps_p99",
    "t_ulps_max",
    "self_hits",
    "self_hits_of",
    "unlike_naive",
    "unlike_naive_of",
    "leaks",
    "leaks_of",
];

pub fn write(path: &Path, contestants: &[Contestant], speeds: &[f64], outcomes: &[Outcome]) -> Result<()> {
    let mut sheet = csv::Writer::from_path(path)?;
    sheet.write_record(HEADER)?;
    for Outcome { mesh, place, tallies } in outcomes {
        for ((contestant, speed), tally) in contestants.iter().zip(speeds).zip(tallies) {
            let pair = |count: Count| [count.found.to_string(), count.of.to_string()];
            let quantiles = tally.quantiles().map(|ulps| ulps.map(|x| x.to_string())).unwrap_or_default();
            let mut row = vec![contestant.name.into(), mesh.clone()];
            row.extend([place.scale, place.offset, *speed].map(|x| x.to_string()));
            row.extend([tally.vertex_leaks, tally.edge_leaks, tally.false_hits].into_iter().flat_map(pair));
            row.extend([tally.slack, tally.beside].map(|x| x.to_string()));
            row.extend(pair(tally.wrong));
            row.extend(quantiles);
            row.extend([tally.self_hits, tally.unlike_naive, tally.leaks()].into_iter().flat_map(pair));
            sheet.write_record(row)?;
        }
    }
    Ok(sheet.flush()?)
}
