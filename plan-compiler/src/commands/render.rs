//! `render`: layers as a picture.

use super::verify::compare_cells;
use super::{Failure, find, open, project, read_blob, refuse_output, tell, with_unreadable};
use crate::cli::Render;
use maps::numbers::{metres, pair};
use maps::problem::{Problem, has_errors};
use maps::{Feature, Point};
use plan_compiler::goals::numbered;
use plan_compiler::input::Options;
use plan_compiler::output;
use plan_compiler::render::{Mark, Overlay, Panel, Piece, Style, lacking, png, side_by_side};
use plan_compiler::route::{self, NoRoute, Route, Stretch};
use plan_compiler::width::{self, LayerPassages, Need, Passage};
use plan_format::{Blob, Layer, ParallelPlan};
use std::iter;
use std::path::PathBuf;

pub(super) fn run(args: &Render, quiet: bool) -> Result<(), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let as_png = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => false,
        Some("png") => true,
        _ => return Err(Failure::Usage("the output's name must end in .svg or .png".into())),
    };
    let inputs: Vec<&PathBuf> = iter::once(&args.plans).chain(&args.map).collect();
    refuse_output(&args.output, &inputs)?;
    let map = args.map.as_ref();
    let bytes = read_blob(&args.plans).map_err(|failure| with_unreadable(failure, map))?;
    let plan = open(&args.plans, &bytes).map_err(|failure| with_unreadable(failure, map))?;
    let drawn = chosen(args, &plan)?;
    let features = features(args, &bytes, &plan, quiet)?;
    let routes = match args.route {
        Some(start) if !args.chosen => routes(&plan, &drawn, start, quiet)?,
        _ => Vec::new(),
    };
    let stretches = match (args.route, drawn.first()) {
        (Some(start), Some((parallel, _))) if args.chosen => {
            stretches(&plan, parallel, start, quiet)?
        }
        _ => Vec::new(),
    };
    let chosen: Vec<Piece<'_>> = stretches.iter().map(|(name, own)| stretch(name, own)).collect();
    let pieces: Vec<Option<Piece<'_>>> =
        routes.iter().map(|route| route.as_ref().map(piece)).collect();
    let need = Need::of(plan.parameters());
    let narrow_text = format!("too narrow: below {} m", metres(need.width_m));
    let passages = width::of_blob(&plan, &bytes);
    let marks = drawn.iter().enumerate().map(|(index, (parallel, layer))| {
        let is_drawn =
            |own: &&LayerPassages| own.plan == parallel.name() && own.layer == layer.name();
        let passages = passages.iter().filter(is_drawn).flat_map(|own| &own.passages);
        let mut marks: Vec<_> =
            passages.map(|own| passage_mark(own, &need, &narrow_text)).collect();
        marks.extend(routes.get(index).into_iter().flat_map(|r| marks_of(args.route, r.as_ref())));
        marks.extend(args.route.filter(|_| args.chosen).map(|at| (Mark::Start, at, "start")));
        marks
    });
    let marks: Vec<Vec<(Mark, Point, &str)>> = marks.collect();
    let panels = drawn.iter().enumerate().map(|(index, &(parallel, layer))| {
        let routes = pieces.get(index).map_or(&chosen[..], Option::as_slice);
        let marks = marks.get(index).map_or(&[][..], Vec::as_slice);
        let overlay = Overlay { features: &features, routes, marks, ..Overlay::default() };
        Panel { parallel, layer, overlay }
    });
    let panels: Vec<Panel<'_>> = panels.collect();
    let style = Style { size_px: args.size, has_arrows: !args.no_arrows };
    let svg = side_by_side(&plan, &panels, style);
    let lacking = lacking(&plan);
    if as_png && !lacking.is_empty() {
        let message = format!("the font has no {lacking}: a PNG shows boxes instead");
        tell(&[Problem::warning(message).help("an SVG shows them in the viewer's fonts")], quiet);
    }
    let bytes = if as_png {
        png(&svg).map_err(|reason| Problem::error(format!("cannot draw the PNG: {reason}")))?
    } else {
        svg.into_bytes()
    };
    Ok(output::write_file(&args.output, |out| out.write_all(&bytes))?)
}

/// A route as it is drawn.
fn piece(route: &Route) -> Piece<'_> {
    Piece { name: "route that follows the advice", style: 0, points: &route.points }
}

/// A part of a route on which one layer was chosen, as it is drawn.
fn stretch<'s>(name: &'s str, own: &'s Stretch) -> Piece<'s> {
    Piece { name, style: own.layer.into(), points: &own.points }
}

/// The route from a point with the layers that the robot would choose, each with its name in the
/// legend. Reports how long each layer is followed.
fn stretches(
    blob: &Blob<'_>,
    parallel: &ParallelPlan<'_>,
    start: Point,
    quiet: bool,
) -> Result<Vec<(String, Stretch)>, Failure> {
    let found = route::choose(blob.grid(), parallel, blob.parameters().selection, start);
    let found = found.map_err(|reason| {
        let message = format!("{} has no route from {}: {reason}", parallel.name(), pair(start));
        Problem::error(message).help(help(reason))
    })?;
    let name = |index: u8| {
        let layer = parallel.layer(index.into());
        layer.map_or(String::new(), |layer| layer.name().to_owned())
    };
    if !quiet {
        let each =
            found.iter().map(|own| format!("{} {} m", name(own.layer), metres(own.length_m)));
        let each: Vec<String> = each.collect();
        crate::say(&format!("{} from {}: {}\n", parallel.name(), pair(start), each.join(", ")));
    }
    Ok(found.into_iter().map(|own| (format!("route by layer {}", name(own.layer)), own)).collect())
}

/// The mark of a passage.
fn passage_mark<'t>(passage: &Passage, need: &Need, narrow: &'t str) -> (Mark, Point, &'t str) {
    match need.exceeds(passage) {
        true => (Mark::TooNarrow, passage.at_m, narrow),
        false => (Mark::Narrow, passage.at_m, "narrow passage"),
    }
}

/// The mark at the start of a route, or at a start without a route.
fn marks_of(start: Option<Point>, route: Option<&Route>) -> Vec<(Mark, Point, &'static str)> {
    let start = start.map(|start| match route {
        Some(_) => (Mark::Start, start, "start"),
        None => (Mark::Stop, start, "start without a route"),
    });
    start.into_iter().collect()
}

/// The layers to draw.
fn chosen<'b>(
    args: &Render,
    blob: &Blob<'b>,
) -> Result<Vec<(ParallelPlan<'b>, Layer<'b>)>, Failure> {
    if !args.layers {
        return Ok(vec![find(blob, args.layer.as_ref())?]);
    }
    let named = args.layer.as_ref().map(|name| find(blob, Some(name))).transpose()?;
    let followed = || blob.parallel_plan(usize::from(blob.parameters().plan));
    let parallel = named.map(|(parallel, _)| parallel).or_else(followed);
    let parallel = parallel.ok_or_else(|| Problem::error("the blob contains no plans"))?;
    Ok(parallel.layers().map(|layer| (parallel, layer)).collect())
}

/// The route in each layer that has one. It is an error if no layer has one.
fn routes(
    blob: &Blob<'_>,
    drawn: &[(ParallelPlan<'_>, Layer<'_>)],
    start: Point,
    quiet: bool,
) -> Result<Vec<Option<Route>>, Failure> {
    let follow = |(parallel, layer): &(ParallelPlan<'_>, Layer<'_>)| {
        let name = format!("{}/{}", parallel.name(), layer.name());
        (name, route::follow(blob.grid(), parallel, layer, start))
    };
    let followed: Vec<(String, Result<Route, NoRoute>)> = drawn.iter().map(follow).collect();
    let has_none = followed.iter().all(|(_, route)| route.is_err());
    let mut problems = Vec::new();
    let mut lengths = String::new();
    for (name, route) in &followed {
        match route {
            Ok(Route { length_m, goal, .. }) => {
                let to = match drawn.first() {
                    Some((parallel, _)) if parallel.goal_count() > 1 => {
                        format!(" to {}", numbered(parallel, *goal))
                    }
                    _ => String::new(),
                };
                lengths += &format!("{name}: {} m from {}{to}\n", metres(*length_m), pair(start));
            }
            Err(reason) => {
                let message = format!("{name} has no route from {}: {reason}", pair(start));
                let problem = if has_none { Problem::error } else { Problem::warning };
                problems.push(problem(message).help(help(*reason)));
            }
        }
    }
    if has_none {
        return Err(Failure::Wrong(problems));
    }
    tell(&problems, quiet);
    if !quiet {
        crate::say(&lengths);
    }
    Ok(followed.into_iter().map(|(_, route)| route.ok()).collect())
}

pub(super) fn help(reason: NoRoute) -> &'static str {
    match reason {
        NoRoute::OffMap => "`plan-compiler inspect` shows where the map lies",
        NoRoute::Unreachable => {
            "start elsewhere; a picture without --route shows which cells have a route"
        }
        NoRoute::Astray => "`plan-compiler verify` reports which cells are wrong",
    }
}

/// The exact shapes of the map, if one is given. It must be the map that the plans were built from.
fn features(
    args: &Render,
    bytes: &[u8],
    blob: &Blob<'_>,
    quiet: bool,
) -> Result<Vec<Feature>, Failure> {
    let Some(path) = &args.map else { return Ok(Vec::new()) };
    let mut problems = Vec::new();
    let asked = Options { reading: args.reading.options(), ..Options::default() };
    let project = project::read_for((bytes, blob), path, asked, None, &mut problems)?;
    if let Some(project) = &project {
        problems.extend(output::check_against(&args.output, &project.inputs));
        compare_cells(blob, project, &mut problems);
    }
    match project {
        Some(project) if !has_errors(&problems) => {
            tell(&problems, quiet);
            Ok(project.map.features)
        }
        _ => Err(Failure::Wrong(problems)),
    }
}
