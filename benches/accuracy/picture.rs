//! A plot of speed against leaks.

use crate::judge::Outcome;
use crate::labels::Labels;
use crate::tally::{Count, by_place};
use crate::tracer::Contestant;
use anyhow::Result;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

const SIZE: (u32, u32) = (900, 600);
const OURS: RGBColor = RGBColor(20, 90, 200);
const PEERS: RGBColor = RGBColor(200, 90, 20);
const NOTES: [&str; 2] = [
    "rays aimed at corners and edges from inside closed meshes; bar: from the best place (size, offset) to the worst",
    "open: no leak found, drawn at 3/N, below which the rate is at 95 %",
];

/// The mark of one contestant.
struct Point {
    label: String,
    color: RGBColor,
    speed: f64,
    leaks: Count,
    /// The smallest and the largest rate of leaks at one place.
    range: [f64; 2],
}

pub fn draw(path: &Path, contestants: &[Contestant], speeds: &[f64], outcomes: &[Outcome]) -> Result<()> {
    let points: Vec<Point> = contestants
        .iter()
        .zip(speeds)
        .enumerate()
        .map(|(i, (contestant, &speed))| point(i, contestant, speed, outcomes))
        .collect();
    let floor = points.iter().map(Point::shown).fold(1.0, f64::min) / 4.0;
    let fastest = speeds.iter().copied().fold(0.0, f64::max);

    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let text = |size: i32, h, v| ("sans-serif", size).into_font().color(&BLACK.mix(0.8)).pos(Pos::new(h, v));
    let heading = "Speed and leaks: to the right is faster, below is closer";
    root.draw(&Text::new(heading, (450, 14), text(20, HPos::Center, VPos::Top)))?;
    for (note, y) in NOTES.into_iter().zip([42, 59]) {
        root.draw(&Text::new(note, (450, y), text(13, HPos::Center, VPos::Top)))?;
    }
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .margin_top(84)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(0.0..1.15 * fastest, (floor..1.0).log_scale())?;
    chart
        .configure_mesh()
        .bold_line_style(BLACK.mix(0.1))
        .light_line_style(TRANSPARENT)
        .x_desc("closest hits, millions a second, on one thread in a torus of 100,000 triangles")
        .y_desc("rays that leak, of all aimed")
        .x_label_formatter(&|x| format!("{x:.1}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .label_style(text(13, HPos::Center, VPos::Center))
        .draw()?;

    let mut labels = Labels::default();
    for point in &points {
        let (x, y) = (point.speed, point.shown());
        let is_found = point.leaks.found > 0;
        // The bar goes from the best place to the worst.
        let bar = if is_found { point.range.map(|rate| (x, rate.max(floor))) } else { [(x, y); 2] };
        chart.draw_series([PathElement::new(bar, point.color.mix(0.4).stroke_width(2))])?;
        let style = ShapeStyle { color: point.color.into(), filled: is_found, stroke_width: 2 };
        chart.draw_series([Circle::new((x, y), 5, style)])?;
        let [from, to] = bar.map(|end| chart.backend_coord(&end));
        labels.bar(from, to);
    }
    let (_, rows) = chart.plotting_area().get_pixel_range();
    for point in &points {
        let mark = chart.backend_coord(&(point.speed, point.shown()));
        let at = labels.place(&point.label, mark, &rows);
        root.draw(&PathElement::new([mark, (mark.0, at.1)], BLACK.mix(0.25)))?;
        let style = text(14, HPos::Center, VPos::Center).color(&point.color);
        root.draw(&Text::new(point.label.clone(), at, style))?;
    }
    Ok(root.present()?)
}

fn point(i: usize, contestant: &Contestant, speed: f64, outcomes: &[Outcome]) -> Point {
    let mut leaks = Count::default();
    let mut range = [1.0f64, 0.0];
    for (_, here) in by_place(outcomes, i) {
        leaks += here;
        range = [range[0].min(here.rate()), range[1].max(here.rate())];
    }
    let name = contestant.name;
    let label = if leaks.found == 0 { format!("{name}: {leaks}") } else { name.to_string() };
    Point { label, color: if contestant.ours { OURS } else { PEERS }, speed, leaks, range }
}

impl Point {
    fn shown(&self) -> f64 {
        if self.leaks.found == 0 { 3.0 / self.leaks.of.max(3) as f64 } else { self.leaks.rate() }
    }
}
