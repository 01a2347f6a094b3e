//! `comms`: where radio reaches.

use super::progress::with_patience;
use super::{Failure, file_name, print_json, print_text, project, tell};
use crate::cli::Comms;
use maps::numbers::{metres, pair};
use maps::problem::{Problem, has_errors};
use maps::radio::{Model, Settings};
use maps::{Bitmap, Point};
use plan_compiler::comms::{Margins, Need};
use plan_compiler::compile;
use plan_compiler::mission::{NEEDS, RadioKey, RadioRule};
use plan_compiler::output;
use plan_compiler::render::{Reach, lacking_in, png, reach};
use plan_format::Grid;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// The kind of file to write.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Svg,
    Png,
    Npy,
}

/// Everything that was computed.
struct Found {
    /// The map, as it was named.
    name: String,
    grid: Grid,
    rule: RadioRule,
    places: Vec<(String, Point)>,
    blocked: Bitmap,
    margins: Margins,
}

pub(super) fn run(args: &Comms, quiet: bool) -> Result<(), Failure> {
    let kind = args.output.as_deref().map(kind).transpose()?;
    let mut problems = Vec::new();
    let reading = || project::read(&args.input, None, &[], &args.map, &mut problems);
    let Some(mut project) = with_patience(quiet, "reading", reading)? else {
        return Err(Failure::Wrong(problems));
    };
    let rule = match rule(args, project.mission.radio.take()) {
        // A radio with a mistake has no places; the mistake is the reason.
        Err(_) if has_errors(&problems) => return Err(Failure::Wrong(problems)),
        rule => rule?,
    };
    if let Some(output) = &args.output {
        problems.extend(output::check_against(output, &project.inputs));
    }
    let input = project.input();
    let computing = || {
        let grid = compile::grid(&input, &mut problems)?;
        let layers = compile::layers(&input, &grid, &mut problems)?;
        let blocked = layers.layers().first()?.terrain.blocked.clone();
        let model = Model::of(&project.map, &rule.settings);
        let places = compile::places(&input, &rule, &model, &grid, &mut problems);
        if has_errors(&problems) {
            return None;
        }
        let at: Vec<Point> = places.iter().map(|(_, at)| *at).collect();
        let free = Bitmap::from_fn(grid.columns, grid.rows, |cell| !blocked.get(cell));
        let margins = Margins::of(&model, &grid, &at, rule.need, rule.threshold_db, &free);
        let name = file_name(&args.input);
        Some(Found { name, grid, rule, places, blocked, margins })
    };
    let Some(found) = with_patience(quiet, "computing the links", computing) else {
        return Err(Failure::Wrong(problems));
    };
    if let (Some(output), Some(kind)) = (&args.output, kind) {
        let bytes = match kind {
            Kind::Npy => None,
            Kind::Svg | Kind::Png => Some(picture(args, &found, &input, kind, &mut problems)?),
        };
        output::write_file(output, |out| match &bytes {
            Some(bytes) => out.write_all(bytes),
            None => output::write_numbers(out, &found.grid, found.margins.all()),
        })?;
    }
    tell(&problems, quiet);
    if args.json {
        return print_json(&found.summary());
    }
    if quiet { Ok(()) } else { print_text(&found.text()) }
}

fn kind(output: &Path) -> Result<Kind, Failure> {
    let extension = output.extension().and_then(|extension| extension.to_str());
    match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => Ok(Kind::Svg),
        Some("png") => Ok(Kind::Png),
        Some("npy") => Ok(Kind::Npy),
        _ => Err(Failure::Usage("the output's name must end in .svg, .png or .npy".into())),
    }
}

/// The mission's rule, or the default one, with what the command line sets.
fn rule(args: &Comms, of_mission: Option<RadioRule>) -> Result<RadioRule, Failure> {
    let mut rule = of_mission.unwrap_or_default();
    for (name, value) in args.radio.given() {
        if let (Some(key), Some(value)) = (RadioKey::find(name), value) {
            (key.set)(&mut rule, value);
        }
    }
    rule.need = args.need.map_or(rule.need, Need::from);
    if !args.places.is_empty() {
        rule.places.clone_from(&args.places);
    }
    if rule.places.is_empty() {
        let message = "no place to reach: give --place NAME=X,Y, or `places` in the mission's \
                       table [radio]";
        return Err(Failure::Usage(message.into()));
    }
    Ok(rule)
}

fn picture(
    args: &Comms,
    found: &Found,
    input: &plan_compiler::input::Input<'_>,
    kind: Kind,
    problems: &mut Vec<Problem>,
) -> Result<Vec<u8>, Failure> {
    let whose = match (found.rule.need, found.places.len()) {
        (_, 1) => "to its place",
        (Need::All, _) => "to the worst place",
        (Need::Any, _) => "to the best place",
    };
    let title = format!("{}: link {whose}", found.name);
    let svg = reach(
        &Reach {
            title: &title,
            grid: &found.grid,
            heading_rad: compile::origin(input).map(|origin| origin.heading_rad),
            margins: &found.margins,
            threshold_db: found.rule.threshold_db,
            blocked: &found.blocked,
            features: &input.map.features,
            places: &found.places,
        },
        args.size,
    );
    if kind == Kind::Svg {
        return Ok(svg.into_bytes());
    }
    let lacking = lacking_in(&found.places);
    if !lacking.is_empty() {
        let message = format!("the font has no {lacking}: a PNG shows boxes instead");
        problems.push(Problem::warning(message).help("an SVG shows them in the viewer's fonts"));
    }
    let failed = |reason| Problem::error(format!("cannot draw the PNG: {reason}"));
    Ok(png(&svg).map_err(failed)?)
}

/// The output of `--json`.
#[derive(Serialize)]
struct Summary<'f> {
    map: &'f str,
    columns: u32,
    rows: u32,
    resolution_m: f64,
    corner_m: [f64; 2],
    threshold_db: f64,
    need: &'f str,
    frequency_ghz: f64,
    power_dbm: f64,
    sensitivity_dbm: f64,
    antenna_m: f64,
    place_antenna_m: f64,
    obstacle_height_m: f64,
    foliage_height_m: f64,
    wall_loss_db: Option<f64>,
    small_m: f64,
    free_cells: usize,
    /// Free cells whose link is below the threshold.
    out_of_reach: usize,
    places: Vec<PlaceSummary<'f>>,
}

#[derive(Serialize)]
struct PlaceSummary<'f> {
    name: &'f str,
    at_m: [f64; 2],
    out_of_reach: usize,
}

impl Found {
    fn free(&self) -> usize {
        self.grid.cells() - self.blocked.count()
    }

    /// Free cells whose link is below the threshold.
    fn out_of_reach(&self) -> usize {
        let below = self.margins.below(self.rule.threshold_db);
        below.iter().filter(|cell| !self.blocked.get(*cell)).count()
    }

    fn need(&self) -> &'static str {
        NEEDS.iter().find(|(_, need)| *need == self.rule.need).map_or("", |(word, _)| *word)
    }

    fn summary(&self) -> Summary<'_> {
        let Grid { columns, rows, resolution_m, corner_m } = self.grid;
        let Settings {
            frequency_ghz,
            power_dbm,
            sensitivity_dbm,
            antenna_heights_m: [place_antenna_m, antenna_m],
            obstacle_height_m,
            foliage_height_m,
            wall_db,
            small_m,
            ..
        } = self.rule.settings;
        let places = self.places.iter().zip(&self.margins.out_of_reach);
        Summary {
            map: &self.name,
            columns,
            rows,
            resolution_m,
            corner_m,
            threshold_db: self.rule.threshold_db,
            need: self.need(),
            frequency_ghz,
            power_dbm,
            sensitivity_dbm,
            antenna_m,
            place_antenna_m,
            obstacle_height_m,
            foliage_height_m,
            wall_loss_db: wall_db,
            small_m,
            free_cells: self.free(),
            out_of_reach: self.out_of_reach(),
            places: places
                .map(|((name, at_m), out_of_reach)| PlaceSummary {
                    name,
                    at_m: *at_m,
                    out_of_reach: *out_of_reach,
                })
                .collect(),
        }
    }

    fn text(&self) -> String {
        let free = self.free();
        let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / free.max(1) as f64);
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{}: {} x {} cells of {} m, {free} free; out of reach below {} dB of margin:",
            self.name,
            self.grid.columns,
            self.grid.rows,
            self.grid.resolution_m,
            metres(self.rule.threshold_db)
        );
        for ((name, at), count) in self.places.iter().zip(&self.margins.out_of_reach) {
            let _ = writeln!(text, "  {name} at {}: {}", pair(*at), share(*count));
        }
        if self.places.len() > 1 {
            let whose = match self.rule.need {
                Need::All => "at least one of them",
                Need::Any => "all of them",
            };
            let _ = writeln!(text, "  {whose}: {}", share(self.out_of_reach()));
        }
        text
    }
}
