//! The figures of the paper: routes over the map with its advice (figures 2 and 5 to 8), and a bar
//! for each row of a metric (figures 9 to 12).

use std::path::Path;

use plan_compiler::output;
use plan_compiler::render::{self, Overlay, Piece, Style};
use sim::Point;
use svg::Document;
use svg::node::element::{Line, Rectangle, Text};

use super::findings::Rows;
use super::metric::Metric;
use super::{Campaign, ROBOT_NAMES, ROBOTS, Row, Team, Trial};

/// Ticks between two points of a drawn route.
const EVERY: u64 = 10;
/// Width of the drawing of a bar, and room between two, pixels.
const BAR: f64 = 60.0;
const GAP: f64 = 40.0;
/// Height of the tallest bar, pixels.
const HEIGHT: f64 = 240.0;
/// Room around the bars, pixels.
const MARGIN: f64 = 50.0;

/// Writes `routes-ROW.svg` of the first trial of each row to a folder. The error is a message for the
/// user.
pub fn draw_routes(folder: &Path, campaign: &Campaign) -> Result<(), String> {
    for &row in &campaign.rows {
        // A colon cannot be part of a file's name everywhere.
        let name = row.name().replace(':', "-");
        write(folder, &format!("routes-{name}.svg"), &routes(campaign, row)?)?;
    }
    Ok(())
}

/// Writes `METRIC.svg` to a folder for each metric. The error is a message for the user.
pub fn draw_bars(folder: &Path, trials: &[Trial]) -> Result<(), String> {
    let mut metrics = Metric::ALL.into_iter();
    metrics.try_for_each(|metric| {
        write(folder, &format!("{}.svg", metric.name()), &bars(trials, metric))
    })
}

pub(super) fn write(folder: &Path, name: &str, svg: &str) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    output::write_file(&folder.join(name), |out| out.write_all(svg.as_bytes()))
        .map_err(|problem| problem.message)
}

/// The routes of the first trial of a row, over the most constrained layer of the robot in the
/// middle.
fn routes(campaign: &Campaign, row: Row) -> Result<String, String> {
    let team = Team::new(row, campaign.field_of(0), &campaign.variation)?;
    let mut routes: [Vec<Point>; ROBOTS] = Default::default();
    let mut ticks = 0;
    team.run(0, campaign.seed, |at| {
        if ticks % EVERY == 0 {
            routes.iter_mut().zip(at).for_each(|(route, at)| route.push(*at));
        }
        ticks += 1;
    })?;
    let scenario = &team.scenarios[ROBOTS / 2];
    let (plan, parallel) = (scenario.plan(), scenario.parallel_plan());
    let layer = parallel.layer(parallel.layer_count() - 1).ok_or("there is no layer to draw")?;
    let pieces = routes.iter().zip(ROBOT_NAMES).enumerate();
    let pieces: Vec<Piece<'_>> =
        pieces.map(|(style, (points, name))| Piece { name, style, points }).collect();
    let features = &scenario.map.features;
    let overlay = Overlay { features, routes: &pieces, ..Overlay::default() };
    Ok(render::picture(&plan, &parallel, &layer, &overlay, Style::default()))
}

/// The means of a metric as bars, each with a line of one standard deviation to either side.
fn bars(trials: &[Trial], metric: Metric) -> String {
    let rows = Rows(trials);
    let found = Row::ALL.into_iter().filter_map(|row| Some((row, rows.summary(row, metric)?)));
    let found: Vec<_> = found.collect();
    let most = found.iter().map(|(_, row)| row.mean + row.sd).fold(f64::MIN_POSITIVE, f64::max);
    let width = 2.0 * MARGIN + found.len() as f64 * (BAR + GAP);
    let text = |words: String, x: f64, y: f64| {
        let text = Text::new(words).set("x", x).set("y", y).set("text-anchor", "middle");
        text.set("font-family", "sans-serif").set("font-size", 13)
    };
    let height = HEIGHT + 2.0 * MARGIN;
    let mut drawing = Document::new()
        .set("viewBox", (0.0, 0.0, width, height))
        .add(Rectangle::new().set("width", width).set("height", height).set("fill", "white"))
        .add(text(format!("{}, mean and standard deviation", metric.heading()), width / 2.0, 20.0));
    let floor = MARGIN + HEIGHT;
    for (index, (row, summary)) in found.iter().enumerate() {
        let x = MARGIN + GAP / 2.0 + index as f64 * (BAR + GAP);
        let up = |value: f64| floor - HEIGHT * (value / most).max(0.0);
        let middle = x + BAR / 2.0;
        let bar = Rectangle::new().set("x", x).set("y", up(summary.mean)).set("width", BAR);
        let spread = Line::new().set("x1", middle).set("x2", middle).set("stroke", "black");
        drawing = drawing
            .add(bar.set("height", floor - up(summary.mean)).set("fill", "#4c78a8"))
            .add(
                spread
                    .set("y1", up(summary.mean - summary.sd))
                    .set("y2", up(summary.mean + summary.sd)),
            )
            .add(text(row.name().to_owned(), middle, floor + 18.0))
            .add(text(format!("{:.1}", summary.mean * metric.scale()), middle, floor + 36.0));
    }
    format!("{drawing}\n")
}
