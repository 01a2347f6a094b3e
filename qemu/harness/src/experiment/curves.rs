//! Curves of the conditions beyond the paper (W, section 6): the share of trials in which all robots
//! arrive, against the error of the map or of the GPS.

use std::path::Path;

use svg::Document;
use svg::node::element::{Circle, Line, Polyline, Rectangle, Text};

use super::figures::write;
use super::{Row, Trial};

/// The trials at one point of an axis.
#[derive(Clone, Debug)]
pub struct Point {
    /// What varies, with its unit.
    pub axis: &'static str,
    /// Its value.
    pub value: f64,
    /// All rows.
    pub trials: Vec<Trial>,
}

/// Size of the drawn area, pixels.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 240.0;
/// Room around it, and for the names of the rows.
const MARGIN: f64 = 60.0;
const NAMES: f64 = 110.0;
/// Colours of the rows, told apart also by the colour-blind (after Okabe and Ito).
const COLOURS: [&str; 6] = ["#000000", "#e69f00", "#56b4e9", "#009e73", "#d55e00", "#cc79a7"];

/// Writes a curve for each axis to a folder: `arrived-AXIS.svg`. `usual` are the trials at 0. The
/// error is a message for the user.
pub fn draw(folder: &Path, usual: &[Trial], points: &[Point]) -> Result<(), String> {
    for of_axis in points.chunk_by(|a, b| a.axis == b.axis) {
        let axis = of_axis[0].axis;
        let words = axis.split(',').next().unwrap_or(axis).to_lowercase().replace(' ', "-");
        write(folder, &format!("arrived-{words}.svg"), &curve(axis, usual, of_axis))?;
    }
    Ok(())
}

/// Share of the trials of a row in which all robots arrived; `None` without trials.
fn arrived(trials: &[Trial], row: Row) -> Option<f64> {
    let of_row: Vec<&Trial> = trials.iter().filter(|trial| trial.row == row).collect();
    let good = of_row.iter().filter(|trial| trial.unfinished == 0).count();
    (!of_row.is_empty()).then(|| good as f64 / of_row.len() as f64)
}

fn curve(axis: &str, usual: &[Trial], points: &[Point]) -> String {
    let most = points.iter().map(|point| point.value).fold(f64::MIN_POSITIVE, f64::max);
    let at =
        |value: f64, share: f64| (MARGIN + WIDTH * value / most, MARGIN + HEIGHT * (1.0 - share));
    let (width, height) = (WIDTH + 2.0 * MARGIN + NAMES, HEIGHT + 2.0 * MARGIN);
    let mut drawing = Document::new()
        .set("viewBox", (0.0, 0.0, width, height))
        .add(Rectangle::new().set("width", width).set("height", height).set("fill", "white"))
        .add(text("trials in which all robots arrive, %", MARGIN + WIDTH / 2.0, 24.0, "middle"))
        .add(text(axis, MARGIN + WIDTH / 2.0, height - 14.0, "middle"));
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let (x, y) = at(0.0, share);
        let line = Line::new().set("x1", x).set("x2", x + WIDTH).set("y1", y).set("y2", y);
        let label = text(&format!("{:.0}", 100.0 * share), x - 8.0, y + 4.0, "end");
        drawing = drawing.add(line.set("stroke", "#cccccc")).add(label);
    }
    for value in [0.0].into_iter().chain(points.iter().map(|point| point.value)) {
        let (x, y) = at(value, 0.0);
        drawing = drawing.add(text(&value.to_string(), x, y + 18.0, "middle"));
    }
    for (index, (row, colour)) in Row::ALL.into_iter().zip(COLOURS).enumerate() {
        let shares = [(0.0, arrived(usual, row))].into_iter();
        let shares =
            shares.chain(points.iter().map(|point| (point.value, arrived(&point.trials, row))));
        let places: Vec<(f64, f64)> =
            shares.filter_map(|(value, share)| Some(at(value, share?))).collect();
        if places.is_empty() {
            continue;
        }
        let list: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let line = Polyline::new().set("points", list.join(" ")).set("fill", "none");
        drawing = drawing.add(line.set("stroke", colour).set("stroke-width", 2));
        for (x, y) in places {
            drawing = drawing
                .add(Circle::new().set("cx", x).set("cy", y).set("r", 3).set("fill", colour));
        }
        let (x, y) = (MARGIN + WIDTH + 16.0, MARGIN + 20.0 * (index as f64 + 1.0));
        drawing = drawing.add(text(row.name(), x, y, "start").set("fill", colour));
    }
    format!("{drawing}\n")
}

fn text(words: &str, x: f64, y: f64, anchor: &str) -> Text {
    let text = Text::new(words).set("x", x).set("y", y).set("text-anchor", anchor);
    text.set("font-family", "sans-serif").set("font-size", 13)
}
