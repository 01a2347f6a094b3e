//! `query`: the advice at points, one line of JSON per point, or the route from a point.

mod points;
mod route;

use super::{Failure, find, open, read_blob};
use crate::cli::{PointAt, Query};
use maps::problem::Problem;
use math::GeoPoint;
use plan_compiler::field::{eighths_of, exact_metres};
use plan_compiler::tolls::LEAST;
use plan_format::{Answer, Blob, Layer};
use serde::Serialize;
use std::io::{self, BufRead, BufReader, BufWriter, Write};

/// One line of the output.
#[derive(Serialize)]
struct Line {
    x: Option<f64>,
    y: Option<f64>,
    cost_m: Option<f64>,
    direction: Option<&'static str>,
    /// Whether the direction leads out of a blocked cell.
    escape: bool,
    cell: &'static str,
    /// What a step out of the cell is multiplied by, in layers with tolls.
    #[serde(skip_serializing_if = "Option::is_none")]
    toll: Option<f64>,
    /// The speed limit, m/s, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    limit_mps: Option<f64>,
    /// The number of the goal that the advice leads to, if the plan has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    goal: Option<u8>,
}

pub(super) fn run(args: &Query) -> Result<(), Failure> {
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let found @ (_, layer) = find(&plan, args.layer.as_ref())?;
    let mut out = BufWriter::new(io::stdout().lock());
    if let Some(at) = args.at {
        write_line(&mut out, &answer(&plan, &layer, Some(at)))?;
    } else if let Some([lat, lon]) = args.geo {
        write_line(&mut out, &answer(&plan, &layer, local(&plan, lat, lon)?))?;
    } else if let Some(start) = args.route {
        let start = match start {
            PointAt::Map(at) => at,
            PointAt::Globe(place) => {
                local(&plan, place.lat_deg(), place.lon_deg())?.ok_or_else(|| too_far(&plan))?
            }
        };
        route::write(&mut out, &plan, &found, start, args.format)?;
    } else {
        answer_input(&plan, &layer, &mut out)?;
    }
    out.flush()?;
    Ok(())
}

/// Map metres of a place on the globe; `None` if it is too far away for the map frame.
fn local(blob: &Blob<'_>, lat: f64, lon: f64) -> Result<Option<[f64; 2]>, Failure> {
    let frame = blob.map_frame().ok_or_else(|| {
        Problem::error("the plans have no place on the globe")
            .help("use --at X,Y, or give the map a reference: GLOBAL_REF_POINT in an overlay")
    })?;
    let place = GeoPoint::from_degrees(lat, lon).ok_or_else(|| {
        Problem::error(format!("{lat},{lon} is not on the globe"))
            .help("latitude first, -90 to 90; then longitude, -180 to 180 degrees")
    })?;
    Ok(frame.to_local(place).map(|at| [f64::from(at.x), f64::from(at.y)]))
}

fn too_far(blob: &Blob<'_>) -> Problem {
    let at = blob.map_frame().map(|frame| frame.reference());
    let at = at.map_or(String::new(), |at| format!(", {}, {}", at.lat_deg(), at.lon_deg()));
    Problem::error("the place is too far away from the map")
        .help(format!("the map lies around its origin{at}; write the latitude first"))
}

/// Answers every line of standard input. Lines that are not points are reported as errors after all
/// other lines have been answered.
fn answer_input(blob: &Blob<'_>, layer: &Layer<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    /// More mistakes than this are only counted.
    const MAX_LISTED: usize = 20;
    let mut input = BufReader::new(io::stdin().lock());
    let mut problems = Vec::new();
    let mut wrong = 0_usize;
    let mut bytes = Vec::new();
    for line in 1_usize.. {
        // Flushed when input runs out: a user who types points sees each answer at once.
        if input.buffer().is_empty() {
            out.flush()?;
        }
        bytes.clear();
        let read = input
            .read_until(b'\n', &mut bytes)
            .map_err(|error| Problem::error(format!("cannot read standard input: {error}")))?;
        if read == 0 {
            break;
        }
        let text = String::from_utf8_lossy(&bytes);
        match points::point(&text) {
            Ok(None) => {}
            Ok(Some(at)) => write_line(out, &answer(blob, layer, Some(at)))?,
            Err(reason) => {
                wrong += 1;
                if wrong <= MAX_LISTED {
                    let message = format!("standard input, line {line}: {reason}");
                    problems.push(
                        Problem::error(message)
                            .help("write `X Y` or `X,Y` in metres, one point per line"),
                    );
                }
            }
        }
    }
    out.flush()?;
    if wrong > MAX_LISTED {
        problems.push(Problem::error(format!("{} more lines are not points", wrong - MAX_LISTED)));
    }
    if problems.is_empty() { Ok(()) } else { Err(Failure::Wrong(problems)) }
}

fn write_line(out: &mut dyn Write, line: &Line) -> io::Result<()> {
    serde_json::to_writer(&mut *out, line)?;
    out.write_all(b"\n")
}

fn answer(blob: &Blob<'_>, layer: &Layer<'_>, at: Option<[f64; 2]>) -> Line {
    let grid = blob.grid();
    // In double precision. The robot looks up in single precision, which differs only for points on
    // the edge of a cell.
    let cell = at.and_then(|[x, y]| grid.cell_at(x, y));
    let answer = cell.map_or(Answer::OffMap, |cell| layer.look_up_exact(cell));
    let priced = cell.filter(|_| layer.has_tolls());
    let toll = priced.and_then(|cell| eighths_of(grid, layer, cell));
    let toll = toll.map(|eighths| f64::from(eighths) / f64::from(LEAST));
    let limit = priced.and_then(|cell| layer.speed_limit(cell));
    // Limits are whole cm/s.
    let limit_mps = limit.map(|mps| (f64::from(mps) * 100.0).round() / 100.0);
    let (cost_m, direction) = match answer {
        Answer::Move { direction, cost } => {
            (Some(exact_metres(grid, layer, cost)), Some(direction.name()))
        }
        Answer::Goal => (Some(0.0), Some("goal")),
        Answer::Blocked { escape } => (None, escape.map(|direction| direction.name())),
        Answer::NoRoute | Answer::OffMap => (None, None),
    };
    let kind = match answer {
        Answer::Move { .. } | Answer::Goal | Answer::NoRoute => "free",
        Answer::Blocked { .. } => "blocked",
        Answer::OffMap => "off-map",
    };
    let has_route = matches!(answer, Answer::Move { .. } | Answer::Goal);
    let numbered = cell.filter(|_| has_route && layer.has_several_goals());
    let goal = numbered.map(|cell| layer.goal_number(cell));
    let escape = matches!(answer, Answer::Blocked { escape: Some(_) });
    let [x, y] = at.map_or([None, None], |[x, y]| [Some(x), Some(y)]);
    Line { x, y, cost_m, direction, escape, cell: kind, toll, limit_mps, goal }
}
