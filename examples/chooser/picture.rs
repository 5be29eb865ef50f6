//! A plot of the speed of the rays against the time of the build.

use crate::pareto;
use crate::shared::labels::Labels;
use crate::survey::{Finding, Survey};
use crate::ways::Sort;
use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// The size of a scene's panel, below the heading.
const PANEL: (u32, u32) = (900, 520);
const HEADING: u32 = 52;
const OURS: RGBColor = RGBColor(20, 90, 200);
const PRESETS: RGBColor = RGBColor(170, 20, 90);
const PEERS: RGBColor = RGBColor(200, 90, 20);
const TITLE: &str = "Left builds faster, up traces faster";
const NOTE: &str = "open: as the heuristic splits; filled: with reinsertion; diamonds: presets; line: nothing is better in both";

type Root<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub fn draw(path: &Path, surveys: &[Survey]) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let height = HEADING + PANEL.1 * surveys.len() as u32;
    let root = SVGBackend::new(path, (PANEL.0, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let middle = PANEL.0 as i32 / 2;
    root.draw(&Text::new(TITLE, (middle, 14), text(20, &BLACK)))?;
    root.draw(&Text::new(NOTE, (middle, 42), text(13, &BLACK)))?;
    let (_, panels) = root.split_vertically(HEADING);
    for (survey, panel) in surveys.iter().zip(panels.split_evenly((surveys.len(), 1))) {
        draw_panel(&root, &panel, survey)?;
    }
    Ok(root.present()?)
}

fn text(size: i32, color: &RGBColor) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&color.mix(0.85)).pos(Pos::new(HPos::Center, VPos::Center))
}

fn draw_panel(root: &Root<'_>, panel: &Root<'_>, survey: &Survey) -> Result<()> {
    let at = |finding: &Finding| (finding.build_ms, finding.geometric_mean);
    let points: Vec<_> = survey.findings.iter().map(at).collect();
    let least = points.iter().fold(f64::INFINITY, |least, point| least.min(point.0));
    let (most, fastest) =
        points.iter().fold((0.0f64, 0.0f64), |most, point| (most.0.max(point.0), most.1.max(point.1)));

    let title = format!("{}, {} triangles", survey.scene, survey.triangles);
    let mut chart = ChartBuilder::on(panel)
        .caption(title, text(16, &BLACK))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d((0.7 * least..1.5 * most).log_scale(), 0.0..1.12 * fastest)?;
    // The labels are drawn below: the chart itself has them at 100, 200,
    // ..., 1000, and none under 100.
    chart
        .configure_mesh()
        .disable_x_mesh()
        .set_tick_mark_size(LabelAreaPosition::Bottom, 0)
        .x_label_formatter(&|_| String::new())
        .bold_line_style(BLACK.mix(0.1))
        .light_line_style(TRANSPARENT)
        .x_desc("build, ms on one thread")
        .y_desc("M rays/s on one thread, geometric mean of the kinds")
        .label_style(text(13, &BLACK))
        .draw()?;

    let (_, rows) = chart.plotting_area().get_pixel_range();
    for ms in ticks(0.7 * least, 1.5 * most) {
        let (x, foot) = chart.backend_coord(&(ms, 0.0));
        root.draw(&PathElement::new([(x, rows.start), (x, foot)], BLACK.mix(0.1)))?;
        root.draw(&Text::new(ms.to_string(), (x, foot + 14), text(13, &BLACK)))?;
    }

    let front = pareto::front(&points).into_iter().map(|place| points[place]);
    chart.draw_series([PathElement::new(front.collect::<Vec<_>>(), BLACK.mix(0.35).stroke_width(2))])?;
    for (pair, ends) in survey.findings.windows(2).zip(points.windows(2)) {
        if pair[1].sort == Sort::Reinserted {
            chart.draw_series([PathElement::new(ends, OURS.mix(0.4))])?;
        }
    }
    let mut labels = Labels::default();
    for (finding, &point) in survey.findings.iter().zip(&points) {
        let mark = chart.backend_coord(&point);
        labels.bar(mark, mark);
        draw_mark(root, finding.sort, mark)?;
    }
    // Presets come first, so that their labels are nearest to their marks. Reinserted ways have no
    // labels: a line leads to the mark of their heuristic.
    let mut named: Vec<_> = survey.findings.iter().zip(&points).collect();
    named.retain(|(finding, _)| finding.sort != Sort::Reinserted);
    named.sort_by_key(|(finding, _)| finding.sort != Sort::Preset);
    for (finding, point) in named {
        let mark = chart.backend_coord(point);
        let at = labels.place(&finding.name, mark, &rows);
        root.draw(&PathElement::new([mark, (mark.0, at.1)], BLACK.mix(0.25)))?;
        root.draw(&Text::new(finding.name.clone(), at, text(13, color(finding.sort))))?;
    }
    Ok(())
}

/// Returns 1, 2 and 5 times the powers of ten, within `from..to`.
fn ticks(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let powers = (from.log10().floor() as i32)..=(to.log10().floor() as i32);
    let ticks = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|tick| tick * 10f64.powi(power)));
    ticks.filter(move |tick| (from..to).contains(tick))
}

fn draw_mark(root: &Root<'_>, sort: Sort, (x, y): (i32, i32)) -> Result<()> {
    let filled = color(sort).filled();
    match sort {
        Sort::Split => {
            root.draw(&Circle::new((x, y), 4, WHITE.filled()))?;
            root.draw(&Circle::new((x, y), 4, color(sort).stroke_width(2)))?;
        }
        Sort::Reinserted => root.draw(&Circle::new((x, y), 4, filled))?,
        Sort::Preset => root.draw(&Polygon::new([(x - 8, y), (x, y - 8), (x + 8, y), (x, y + 8)], filled))?,
        Sort::Peer => root.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], filled))?,
    }
    Ok(())
}

fn color(sort: Sort) -> &'static RGBColor {
    match sort {
        Sort::Split | Sort::Reinserted => &OURS,
        Sort::Preset => &PRESETS,
        Sort::Peer => &PEERS,
    }
}
