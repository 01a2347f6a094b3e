//! The narrowest passages that the routes of a layer use, and whether the robot's own distances
//! close them.
//!
//! The plan passes every gap that its grown obstacles leave open. The robot also keeps a stop
//! distance, and its schemas a margin: a door can be open in the plan and closed to the robot. This
//! module finds such places before the robot does.
//!
//! Method. Following the advice, each cell sends its routes on to the next cell, so one pass counts
//! the routes through every cell. Cells with many routes form the *trunk*; it is short on any map.
//! At each cell of the trunk, the nearest blocked cells on the left and on the right of the route
//! are the sides of a gap. A passage is a place of the trunk from which the gap widens in every
//! direction along the trunk. Everything but the trunk is one pass over the cells.
//!
//! Accuracy. Only the layer's cells are known, so that a blob alone is enough. A cell is blocked if
//! any part of it lies within the robot's radius of an obstacle, so the true width is at least the
//! free room between the sides plus two radii. Each side may lie up to one cell further back. At its
//! narrowest, a route passes within half a cell of the line between the sides.
//!
//! Deliberately absent: passages beside the edge of the map, which is not an obstacle.

mod gap;
mod routes;

use crate::field::{Field, advised, decode, is_blocked};
use crate::mission::PHYSICAL;
use crate::recipe;
use gap::{Gap, across};
use maps::numbers::{metres, pair};
use maps::{Bitmap, Point, Problem};
use math::scalar::wide;
use plan_format::{Blob, Cell, Grid, Layer, ParallelPlan, Parameters};
use rayon::prelude::*;
use routes::Routes;

/// Number of passages listed for a layer.
const LISTED: usize = 5;
/// A passage has at least this share of the routes, each from another cell.
const LEAST_SHARE: f64 = 0.05;
/// Cells of the trunk have at least one in this many of the routes. Several cells side by side can
/// share the routes of one passage.
const TRUNK: u32 = 100;
/// Of two narrow places with no wider place than this between them, only the narrower is listed.
const WIDENS: f64 = 1.25;
/// Passages wider than this many times the robot's need are not listed.
const WIDE: f64 = 4.0;
/// Limits of the distance, in cells, at which the sides of a passage are searched.
const REACH: (f64, f64) = (8.0, 512.0);
/// Layers of at most this many cells are measured side by side.
const AT_ONCE_CELLS: usize = 1 << 22;
/// The robot's numbers have single precision, which loses at most half a millimetre.
const TOLERANCE_M: f64 = 5e-4;

/// A narrow place that routes pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// The middle between its sides, metres.
    pub at_m: Point,
    /// Least and largest width between the obstacles that the map has, metres.
    pub width_m: [f64; 2],
    /// Share of the cells with a route whose route passes here.
    pub share: f64,
}

/// The width that a robot needs to pass between two obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Need {
    /// The width, metres.
    pub width_m: f64,
    /// Radius of the body, metres.
    pub radius_m: f64,
    /// The stop distance, metres.
    pub stop_m: f64,
    /// The margin, metres; 0 if margins do not act.
    pub margin_m: f64,
}

impl Need {
    /// The need of a robot with these parameters: its diameter and, on both sides, the stop
    /// distance or the margin, whichever is larger. Without reactive schemas, margins do not act.
    pub fn of(parameters: &Parameters) -> Self {
        let (vehicle, schemas) = (&parameters.vehicle, &parameters.schemas);
        let has_margin = parameters.gains.reactive > 0.0 && schemas.avoid_gain > 0.0;
        let margin_m = if has_margin { schemas.avoid_margin_m } else { 0.0 };
        let numbers = [vehicle.radius_m, vehicle.stop_distance_m, margin_m];
        let [radius_m, stop_m, margin_m] = numbers.map(f64::from);
        Self { width_m: 2.0 * (radius_m + stop_m.max(margin_m)), radius_m, stop_m, margin_m }
    }

    /// Whether a passage may be too narrow.
    pub fn exceeds(&self, passage: &Passage) -> bool {
        passage.width_m[0] + TOLERANCE_M < self.width_m
    }
}

/// The passages of one layer of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPassages {
    /// The plan.
    pub plan: String,
    /// The layer.
    pub layer: String,
    /// Its narrowest passages, the narrowest first.
    pub passages: Vec<Passage>,
}

/// What a search for passages has to know besides the field.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// The grid of the field.
    pub grid: &'a Grid,
    /// The cells that obstacles block: those of the layer `physical`. What other layers add keeps
    /// the routes away, but nothing stands there.
    pub solid: &'a Bitmap,
    /// How far the obstacles were grown, metres.
    pub grown_m: f64,
    /// What the robot needs.
    pub need: Need,
}

/// The passages of every layer of a blob, in the blob's order.
pub fn of_blob(blob: &Blob<'_>, bytes: &[u8]) -> Vec<LayerPassages> {
    let grid = blob.grid();
    let need = Need::of(blob.parameters());
    let layers = || blob.parallel_plans().flat_map(|plan| plan.layers().map(move |l| (plan, l)));
    // All plans have the same obstacles. A plan's goal may have chosen other layers only.
    let physical = layers().map(|(_, layer)| layer).find(|layer| layer.name() == PHYSICAL);
    let solid = physical.map(|layer| blocked(&decode(grid, &layer)));
    let radius_m = recipe::of_blob(bytes).and_then(|recipe| recipe.robot_radius_m);
    let grown_m = radius_m.unwrap_or(need.radius_m);
    let of_layer = |(plan, layer): &(ParallelPlan<'_>, Layer<'_>)| {
        let field = decode(grid, layer);
        let own = if solid.is_none() { Some(blocked(&field)) } else { None };
        let solid = solid.as_ref().or(own.as_ref())?;
        Some(LayerPassages {
            plan: plan.name().to_owned(),
            layer: layer.name().to_owned(),
            passages: passages(&field, &Site { grid, solid, grown_m, need }),
        })
    };
    let layers: Vec<_> = layers().collect();
    // A large layer takes about 11 bytes a cell: then one at a time.
    match grid.cells() <= AT_ONCE_CELLS {
        true => layers.par_iter().filter_map(of_layer).collect(),
        false => layers.iter().filter_map(of_layer).collect(),
    }
}

/// The blocked cells of a field.
fn blocked(field: &Field) -> Bitmap {
    let mut codes = field.code.iter();
    let next_is_blocked = |_| codes.next().is_some_and(|&code| is_blocked(code));
    Bitmap::from_fn(field.columns, field.rows, next_is_blocked)
}

/// The narrowest passages that the routes of a field use, the narrowest first.
pub fn passages(field: &Field, site: &Site<'_>) -> Vec<Passage> {
    let routes = Routes::count(field);
    let trunk = routes.trunk(TRUNK);
    let look = WIDE * site.need.width_m / site.grid.resolution_m;
    let reach = wide::ceil(look.clamp(REACH.0, REACH.1)) as u32;
    let gap = |&index: &usize| {
        let code = field.code.get(index).copied()?;
        let gap = across(site.solid, cell(field, index), advised(code)?, reach)?;
        let is_used = routes.share_through(index) >= LEAST_SHARE
            || routes.share_across(gap.sides) >= LEAST_SHARE;
        is_used.then_some(gap)
    };
    let gaps: Vec<Option<Gap>> = trunk.iter().map(gap).collect();
    let mut found: Vec<Passage> = Vec::new();
    for gap in narrow_places(&routes, &trunk, &gaps, site) {
        let at_m = middle(&gap, site.grid);
        let width_m = width_m(&gap, site);
        if found.len() == LISTED || width_m[0] > WIDE * site.need.width_m {
            break;
        }
        let near_m = 0.5 * width_m[0] + 1.5 * site.grid.resolution_m;
        if found.iter().any(|other| apart(at_m, other.at_m) <= near_m) {
            continue;
        }
        found.push(Passage { at_m, width_m, share: routes.share_across(gap.sides) });
    }
    found
}

fn apart(one: Point, other: Point) -> f64 {
    wide::hypot(one[0] - other[0], one[1] - other[1])
}

fn cell(field: &Field, index: usize) -> Cell {
    let columns = field.columns.max(1) as usize;
    Cell::new((index % columns) as u32, (index / columns) as u32)
}

/// Least and largest width of a gap between the obstacles before they were grown.
fn width_m(gap: &Gap, site: &Site<'_>) -> [f64; 2] {
    let [[x1, y1], [x2, y2]] = gap.sides.map(|side| site.grid.centre(side));
    let (dx, dy) = ((x1 - x2).abs(), (y1 - y2).abs());
    // The obstacle may begin at the far corner of the blocked cell on either side.
    let depth = (dx + dy) / wide::hypot(dx, dy).max(f64::MIN_POSITIVE);
    let metres = |cells: f64| cells * site.grid.resolution_m + 2.0 * site.grown_m;
    [metres(gap.cells), metres(gap.cells + 2.0 * depth)]
}

fn middle(gap: &Gap, grid: &Grid) -> Point {
    let [left, right] = gap.sides.map(|side| grid.centre(side));
    [0, 1].map(|axis| 0.5 * (left[axis] + right[axis]))
}

/// The places of the trunk where the gap is narrowest, the narrowest first.
///
/// Places of the trunk are joined in the order of their widths, as if water rose along it. When two
/// basins meet, the shallower one was a passage of its own if it has become [`WIDENS`] times as wide
/// since.
fn narrow_places(
    routes: &Routes<'_>,
    trunk: &[usize],
    gaps: &[Option<Gap>],
    site: &Site<'_>,
) -> Vec<Gap> {
    let cells = |place: usize| gaps[place].map_or(f64::INFINITY, |gap| gap.cells);
    let mut joints: Vec<(f64, [usize; 2])> = Vec::new();
    for (place, &index) in trunk.iter().enumerate() {
        let next = routes.next(index).and_then(|next| trunk.binary_search(&next).ok());
        if let Some(next) = next.filter(|&next| gaps[place].is_some() && gaps[next].is_some()) {
            joints.push((cells(place).max(cells(next)), [place, next]));
        }
    }
    joints.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    // Only clear gaps are passages; the others join what lies on either side.
    let is_clear = |gap: &Option<Gap>| gap.is_some_and(|gap| gap.is_clear(site.solid));
    let is_clear: Vec<bool> = gaps.iter().map(is_clear).collect();
    let depth = |place: usize| if is_clear[place] { cells(place) } else { f64::INFINITY };
    // The parent of each place in its basin; a root is the basin's narrowest place.
    let mut parents: Vec<usize> = (0..trunk.len()).collect();
    let mut narrow: Vec<usize> = Vec::new();
    for (level, places) in joints {
        let [one, other] = places.map(|place| root(&mut parents, place));
        if one == other {
            continue;
        }
        let (deep, shallow) = if depth(one) <= depth(other) { (one, other) } else { (other, one) };
        let grown = 2.0 * site.grown_m / site.grid.resolution_m;
        if level + grown >= WIDENS * (depth(shallow) + grown) + 1.0 {
            narrow.push(shallow);
        }
        parents[shallow] = deep;
    }
    narrow.extend((0..trunk.len()).filter(|&place| is_clear[place] && parents[place] == place));
    narrow.sort_by(|&one, &other| cells(one).total_cmp(&cells(other)).then(one.cmp(&other)));
    narrow.into_iter().filter_map(|place| gaps[place]).collect()
}

/// The root of a place's basin; shortens the way to it.
fn root(parents: &mut [usize], mut place: usize) -> usize {
    while parents[place] != place {
        parents[place] = parents[parents[place]];
        place = parents[place];
    }
    place
}

/// One warning per passage that is too narrow for the robot, the narrowest first.
pub fn warnings(layers: &[LayerPassages], need: &Need) -> Vec<Problem> {
    let mut closed: Vec<(&Passage, Vec<&LayerPassages>)> = Vec::new();
    for layer in layers {
        for passage in layer.passages.iter().filter(|passage| need.exceeds(passage)) {
            let near_m = 0.5 * need.width_m;
            let same = closed.iter_mut().find(|(one, _)| apart(one.at_m, passage.at_m) <= near_m);
            match same {
                Some((_, of)) => of.push(layer),
                None => closed.push((passage, vec![layer])),
            }
        }
    }
    closed.sort_by(|one, other| one.0.width_m[0].total_cmp(&other.0.width_m[0]));
    let more = closed.len().saturating_sub(LISTED);
    closed.truncate(LISTED);
    let mut warnings: Vec<Problem> =
        closed.iter().map(|(passage, of)| warning(passage, of, need)).collect();
    if let (Some(last), 1..) = (warnings.last_mut(), more) {
        last.message += &format!("; {more} more passages are too narrow");
    }
    warnings
}

fn warning(passage: &Passage, layers: &[&LayerPassages], need: &Need) -> Problem {
    let mut plans: Vec<&str> = layers.iter().map(|layer| layer.plan.as_str()).collect();
    plans.dedup();
    let to = match plans[..] {
        [only] => format!("`{only}`"),
        [first, ..] => format!("`{first}` and {} more", plans.len() - 1),
        [] => String::new(),
    };
    let [width, at] = in_words(passage);
    let message = format!(
        "the routes to {to} pass between obstacles {width} apart at {at}, but the robot needs {} m",
        metres(need.width_m)
    );
    Problem::warning(message).help(help(passage, need))
}

/// What the robot keeps free, which keys would let it pass, and how to make the routes avoid the
/// passage.
fn help(passage: &Passage, need: &Need) -> String {
    let distances =
        [("stop_distance", need.stop_m, "stops"), ("avoid_margin", need.margin_m, "is repelled")];
    let fitting = wide::floor((0.5 * passage.width_m[0] - need.radius_m) * 100.0 + 1e-6) / 100.0;
    let larger = distances.iter().filter(|(_, distance, _)| *distance > fitting + TOLERANCE_M);
    let (keys, reasons): (Vec<&str>, Vec<String>) = larger
        .map(|(key, distance, what)| (*key, format!("{what} within {} m", metres(*distance))))
        .unzip();
    let (keys, reasons) = (keys.join(" and "), reasons.join(" and "));
    let why = format!("its body of {} m {reasons} of obstacles", metres(2.0 * need.radius_m));
    let grown = metres(0.5 * need.width_m);
    let avoid = format!("set robot_radius = {grown}, so that the routes avoid the passage");
    match fitting > 0.0 {
        true => format!("{why}; set {keys} to {} at most, or {avoid}", metres(fitting)),
        false => format!("{why}; {avoid}"),
    }
}

/// The width of a passage and its place as text, to the centimetre.
pub fn in_words(passage: &Passage) -> [String; 2] {
    // Adding 0 turns -0 into 0.
    let rounded = |metres: f64| (metres * 100.0).round() / 100.0 + 0.0;
    let [least, most] = passage.width_m.map(|width| metres(rounded(width)));
    [format!("{least} to {most} m"), pair(passage.at_m.map(rounded))]
}

#[cfg(test)]
mod tests;
