//! Converts degrees to the map's metres, for formats that give degrees only.
//!
//! The map is the plane around an origin, which becomes the point 0,0: WGS-84, x east, y north,
//! with the arithmetic that the robot uses on its fixes. The user or the file gives the origin;
//! otherwise it is the centre of the map's bounds. Bounds that the file states outrank those of its
//! coordinates, so later additions do not move existing coordinates.

use super::tags::{TagRules, Unused};
use crate::model::{Extent, Feature, Map, Point, Reference, Role};
use crate::numbers::metres;
use crate::problem::{Problem, Source};
use math::GeoPoint;
use math::geodetic::{MapFrame, metres_per_degree, offset_m};
use std::ops::Range;
use std::sync::Arc;

/// Margin around the outermost coordinates, metres, so that robots can pass around them.
const MARGIN_M: f64 = 10.0;
/// Largest distance from its centre at which the plane is valid, metres.
const REACH_M: f64 = MapFrame::RANGE_M as f64;

/// Largest latitude of a plane, degrees: beyond it meridians converge too fast.
const MAX_LATITUDE_DEG: f64 = 85.0;

/// A latitude and a longitude, degrees.
pub(super) type Place = [f64; 2];

/// A box on the globe, degrees. It may cross the date line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    south_west: Place,
    /// Extent to the north and to the east.
    size: Place,
}

impl Bounds {
    /// The box between two corners; `None` if one is off the globe or south lies above north.
    pub(super) fn between(south_west: Place, north_east: Place) -> Option<Self> {
        for [lat, lon] in [south_west, north_east] {
            GeoPoint::from_degrees(lat, lon)?;
        }
        let height = north_east[0] - south_west[0];
        let width = north_east[1] - south_west[1];
        // Longitudes wrap at the date line.
        let width = if width < 0.0 { width + 360.0 } else { width };
        (height >= 0.0).then_some(Self { south_west, size: [height, width] })
    }

    /// An error if a map of these bounds would be empty: they have no area, or the whole drawing
    /// lies outside them.
    fn check(&self, drawn: Option<Self>) -> Result<(), Problem> {
        let help = "state the bounds of the area that the robot uses, or none";
        if self.size.contains(&0.0) {
            let message = "the file's stated bounds have no area";
            return Err(Problem::error(message).help(help));
        }
        match drawn {
            Some(drawn) if !self.meets(&drawn) => {
                let message = "everything in the file lies outside its stated bounds";
                let fits = drawn.swapped().is_some_and(|swapped| self.meets(&swapped));
                let help = if fits {
                    "latitude and longitude are swapped in one of the two: exchange them there"
                        .into()
                } else {
                    format!("{help}; check whether latitude and longitude are swapped")
                };
                Err(Problem::error(message).help(help))
            }
            _ => Ok(()),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        let north = other.south_west[0] - self.south_west[0];
        // Once around the globe, the other box begins in this one, or ends beyond its west side.
        let east = (other.south_west[1] - self.south_west[1]).rem_euclid(360.0);
        let meets_in_width = east <= self.size[1] || east + other.size[1] >= 360.0;
        north <= self.size[0] && -north <= other.size[0] && meets_in_width
    }

    /// The smallest box that holds both.
    pub(super) fn and(self, other: Self) -> Self {
        let corners = |bounds: Self| {
            let ([south, west], [height, width]) = (bounds.south_west, bounds.size);
            [[south, west], [south + height, west + width]]
        };
        let all = [corners(self), corners(other)].concat();
        Self::around(all.into_iter()).unwrap_or(self)
    }

    /// The box with latitude and longitude exchanged, if that is on the globe.
    fn swapped(&self) -> Option<Self> {
        let ([south, west], [height, width]) = (self.south_west, self.size);
        Self::between([west, south], [west + width, south + height])
    }

    fn middle(&self) -> Place {
        [self.south_west[0] + self.size[0] / 2.0, turned(self.south_west[1] + self.size[1] / 2.0)]
    }

    /// A warning if the map lies in the open sea or in Antarctica, and on land with latitude and
    /// longitude exchanged.
    pub(super) fn suspect(&self) -> Option<Problem> {
        let (here, there) = (self.middle(), self.swapped()?.middle());
        (is_desert(here) && !is_desert(there)).then(|| {
            let [lat, lon] = here;
            Problem::warning(format!(
                "the map lies at latitude {lat:.4}, longitude {lon:.4}, on open sea or ice: latitude and \
                 longitude may be swapped"
            ))
            .help("in GeoJSON longitude comes first: [longitude, latitude]")
        })
    }

    /// South, west, north, east, degrees.
    #[cfg(test)]
    pub(super) fn sides(self) -> [f64; 4] {
        let ([south, west], [height, width]) = (self.south_west, self.size);
        [south, west, south + height, turned(west + width)]
    }

    /// The smallest box around places; `None` for an empty list.
    pub(super) fn around(places: impl Iterator<Item = Place>) -> Option<Self> {
        let mut places = places.peekable();
        let &[_, first] = places.peek()?;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [lat, lon] in places {
            // Unwrap longitudes across the date line, relative to the first place.
            for (axis, at) in [lat, first + turned(lon - first)].into_iter().enumerate() {
                low[axis] = low[axis].min(at);
                high[axis] = high[axis].max(at);
            }
        }
        Some(Self { south_west: low, size: [high[0] - low[0], high[1] - low[1]] })
    }
}

/// Boxes without land for a small robot: south, west, north, east, degrees. Only those in which
/// Europe and the Americas lie when latitude and longitude are swapped.
const DESERTS: [[f64; 4]; 7] = [
    // Antarctica.
    [-90.0, -180.0, -60.0, 180.0],
    // The Indian Ocean off Somalia.
    [-3.0, 47.0, 2.0, 72.0],
    [2.0, 51.5, 9.0, 72.0],
    [9.0, 52.0, 11.5, 72.0],
    // The South Atlantic.
    [-50.0, -55.0, -41.0, -12.0],
    // The Barents Sea.
    [72.0, 5.0, 74.0, 50.0],
    [74.7, 5.0, 76.3, 50.0],
];

fn is_desert([lat, lon]: Place) -> bool {
    DESERTS.iter().any(|[south, west, north, east]| {
        (south..=north).contains(&&lat) && (west..=east).contains(&&lon)
    })
}

/// The place that makes an extent absurd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stray {
    /// Index of the place.
    pub(super) index: usize,
    /// Median of all places. If `is_alone`, most others lie near it.
    pub(super) far_from: Place,
    pub(super) is_alone: bool,
}

impl Stray {
    /// The place farthest from the median; `None` for an empty list.
    pub(super) fn among(places: &[Place]) -> Option<Self> {
        let &[_, first] = places.first()?;
        // Unwrap longitudes across the date line.
        let places: Vec<Place> =
            places.iter().map(|[lat, lon]| [*lat, first + turned(lon - first)]).collect();
        let middle = [0, 1].map(|axis| {
            let mut sorted: Vec<f64> = places.iter().map(|place| place[axis]).collect();
            sorted.sort_by(f64::total_cmp);
            sorted.get((sorted.len() - 1) / 2).copied().unwrap_or_default()
        });
        let away = |place: &Place| (place[0] - middle[0]).abs().max((place[1] - middle[1]).abs());
        let farthest = places.iter().enumerate().max_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        let (index, farthest) = farthest?;
        let half = away(farthest) / 2.0;
        let near = places.iter().filter(|place| away(place) < half).count();
        let far_from = [middle[0], turned(middle[1])];
        Some(Self { index, far_from, is_alone: 2 * near > places.len() })
    }

    /// Label for an excerpt that shows it.
    pub(super) fn label(&self) -> String {
        let [lat, lon] = self.far_from;
        let others = format!("latitude {lat}, longitude {lon}");
        if self.is_alone {
            format!("far from the others, which lie about {others}")
        } else {
            format!("either this or the part about {others} is misplaced")
        }
    }
}

/// A difference of longitudes, wrapped to -180 to 180 degrees.
fn turned(difference: f64) -> f64 {
    if difference > 180.0 {
        difference - 360.0
    } else if difference < -180.0 {
        difference + 360.0
    } else {
        difference
    }
}

/// The plane of a map.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    reference: GeoPoint,
    extent: Extent,
    /// Origin of the extent, for messages.
    by: String,
    /// Whether the user or the file gave the origin.
    is_fixed: bool,
}

/// Counts a flaw, and where it is found first.
#[derive(Debug, Default)]
pub(super) struct Flaw {
    pub(super) count: usize,
    /// Bytes of the first object with it; empty in a binary file.
    first: Range<usize>,
}

impl Flaw {
    pub(super) fn add(&mut self, span: &Range<usize>) {
        if self.count == 0 {
            self.first = span.clone();
        }
        self.count += 1;
    }

    /// Adds a warning if the flaw was found.
    pub(super) fn report(
        &self,
        message: String,
        help: &str,
        source: Option<&Arc<Source>>,
        problems: &mut Vec<Problem>,
    ) {
        if self.count == 0 {
            return;
        }
        let problem = Problem::warning(message).help(help);
        let label = if self.count == 1 { "this one" } else { "the first of them" };
        problems.push(at(problem, source, &self.first, label));
    }
}

/// Adds the bytes of an object to a problem, where the encoding gives them.
pub(super) fn at(
    problem: Problem,
    source: Option<&Arc<Source>>,
    span: &Range<usize>,
    label: &str,
) -> Problem {
    match source.filter(|_| !span.is_empty()) {
        Some(source) => problem.at(source, span.clone(), label),
        None => problem,
    }
}

/// The warning about outlines that should close.
pub(super) fn open_outlines(count: usize) -> String {
    format!("outlines that do not close: {count}; drawn as walls with free ground inside")
}

/// Objects of a file that are not drawn, or not as they should be.
#[derive(Debug, Default)]
pub(super) struct Passed {
    /// Objects without a meaning.
    pub(super) unused: Unused,
    /// Objects with a meaning but without coordinates.
    pub(super) nowhere: Unused,
    /// Areas that are drawn as points.
    pub(super) pointlike: Unused,
}

impl Passed {
    /// Adds a warning for each kind. `help` explains how to fetch the file with geometry.
    pub(super) fn report(&self, help: &str, problems: &mut Vec<Problem>) {
        if self.nowhere.total() > 0 {
            problems.push(Problem::warning(self.nowhere_text()).help(help));
        }
        self.report_points(help, problems);
    }

    pub(super) fn nowhere_text(&self) -> String {
        format!("without coordinates, so not on the map: {}", self.nowhere.list())
    }

    /// Adds a warning if areas are drawn as points.
    pub(super) fn report_points(&self, help: &str, problems: &mut Vec<Problem>) {
        if self.pointlike.total() > 0 {
            let list = self.pointlike.list();
            let message =
                format!("drawn as points, without an outline: {list}; each blocks one cell");
            let help = format!("{help}, or give the point a `radius` in metres");
            problems.push(Problem::warning(message).help(help));
        }
    }
}

impl Plane {
    /// A plane with the stated bounds, else those of the coordinates plus a margin; around the
    /// given origin, else around the centre. An error is about the stated bounds if there are any.
    pub(super) fn new(
        stated: Option<Bounds>,
        drawn: impl Iterator<Item = Place>,
        origin: Option<GeoPoint>,
    ) -> Result<Self, Problem> {
        let around = Bounds::around(drawn);
        let (bounds, margin, by) = match stated {
            Some(bounds) => {
                bounds.check(around)?;
                (bounds, 0.0, "by the file's bounds".into())
            }
            None => match around {
                Some(bounds) => (bounds, MARGIN_M, format!("{MARGIN_M} m around its contents")),
                None => {
                    return Err(Problem::error("the file has no coordinates and no bounds")
                        .help("check that this is the file you mean"));
                }
            },
        };
        let [lat, lon] = bounds.middle();
        let middle = GeoPoint::from_degrees(lat, lon).unwrap_or(GeoPoint { lat_e7: 0, lon_e7: 0 });
        let reference = origin.unwrap_or(middle);
        refuse_pole(reference)?;
        let (per_lat, per_lon) = metres_per_degree(reference.lat_deg());
        let size = [bounds.size[1] * per_lon, bounds.size[0] * per_lat];
        check_size(size, stated.is_some())?;
        let mut plane = Self {
            reference,
            extent: Extent { corner: [0.0; 2], size },
            by,
            is_fixed: origin.is_some(),
        };
        plane.extent.corner = plane.metres(bounds.south_west);
        for axis in 0..2 {
            plane.extent.corner[axis] -= margin;
            plane.extent.size[axis] += 2.0 * margin;
        }
        plane.check_reach(&bounds)?;
        Ok(plane)
    }

    /// An error if a part of the map is too far from a given origin.
    fn check_reach(&self, bounds: &Bounds) -> Result<(), Problem> {
        let far = (0..2).map(|axis| {
            let [low, size] = [self.extent.corner[axis], self.extent.size[axis]];
            low.abs().max((low + size).abs())
        });
        let far = far.fold(0.0, f64::max);
        if !self.is_fixed || far <= REACH_M {
            return Ok(());
        }
        let (far, reach) = (metres((far / 1e3).ceil()), metres(REACH_M / 1e3));
        let message = format!(
            "the map reaches {far} km from its origin, but a plan is valid up to {reach} km"
        );
        let to_swapped = bounds.swapped().map(|swapped| self.metres(swapped.middle()));
        let is_swapped = to_swapped.is_some_and(|at| at.iter().all(|axis| axis.abs() <= REACH_M));
        let help = match is_swapped {
            true => "latitude and longitude are swapped, in the origin or in the map",
            false => "check the origin: latitude, then longitude, near the map",
        };
        Err(Problem::error(message).help(help))
    }

    /// A place in the map's metres.
    pub(super) fn metres(&self, place: Place) -> Point {
        offset_m([self.reference.lat_deg(), self.reference.lon_deg()], place)
    }

    /// An empty map on this plane.
    pub(super) fn map(&self) -> Map {
        let reference = Reference { place: self.reference, at: [0.0; 2], heading_rad: 0.0 };
        Map { reference: Some(reference), ..Map::empty(self.extent) }
    }

    /// Adds a note on where the map lies and what it contains, and a warning if the drawing has no
    /// obstacles.
    pub(super) fn note(
        &self,
        map: &Map,
        unused: &Unused,
        rules: &TagRules,
        problems: &mut Vec<Problem>,
    ) {
        let [width, height] = self.extent.size.map(|side| metres((side * 10.0).round() / 10.0));
        let (lat, lon) = (self.reference.lat_deg(), self.reference.lon_deg());
        let count = |role: Role| map.features.iter().filter(|one| one.role == role).count();
        let (obstacles, areas, zones) =
            (count(Role::Obstacle), count(Role::Attenuating), count(Role::Zone));
        let points = map.points.len();
        let what = if self.is_fixed { "the given origin" } else { "its centre" };
        let not_used = match unused.total() {
            0 => "0".into(),
            total => format!("{total} ({})", unused.list()),
        };
        let is_idle = |one: &&Feature| one.role == Role::Zone && !rules.used.contains(&one.name);
        let idle: Vec<&Feature> = map.features.iter().filter(is_idle).collect();
        if obstacles + areas == 0 && idle.len() + unused.total() > 0 {
            problems.push(nothing_blocks(&idle, unused));
        }
        let note = Problem::note(format!(
            "the map is {width} m x {height} m, {by}; 0,0 is {what}, latitude {lat}, longitude \
             {lon}; obstacles: {obstacles}, areas that weaken radio: {areas}, zones: {zones}, named \
             points: {points}, not used: {not_used}",
            by = self.by
        ));
        problems.push(match self.is_fixed {
            true => note,
            false => note.help(format!(
                "0,0 depends on the file: `origin = [{lat}, {lon}]` in the mission file or --origin \
                 {lat},{lon} keeps it in place when the map changes"
            )),
        });
    }
}

fn nothing_blocks(zones: &[&Feature], unused: &Unused) -> Problem {
    let mut names: Vec<&str> = zones.iter().map(|zone| zone.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.truncate(8);
    let zones = match names[..] {
        [] => String::new(),
        _ => format!("; zones, which only a mission can use: {}", names.join(", ")),
    };
    let list = match unused.total() {
        0 => String::new(),
        _ => format!("; not used: {}", unused.list()),
    };
    Problem::warning(format!("nothing on the map is an obstacle{zones}{list}")).help(
        "--block KEY=VALUE, or `block = [\"KEY=VALUE\"]` in the mission file, makes listed \
         objects obstacles; `plan-compiler build --help` lists what blocks by default",
    )
}

/// An error if a map lies near a pole.
pub(super) fn refuse_pole(place: GeoPoint) -> Result<(), Problem> {
    let lat = place.lat_deg();
    if lat.abs() <= MAX_LATITUDE_DEG {
        return Ok(());
    }
    Err(Problem::error(format!(
        "the map lies at latitude {lat}, but beyond {MAX_LATITUDE_DEG} degrees a plan is not valid: \
         meridians converge there"
    ))
    .help("draw the map in metres around a point that you choose, for example as an overlay (.ovl)"))
}

/// An error if a map is larger than the plane's valid area.
fn check_size(size: [f64; 2], is_stated: bool) -> Result<(), Problem> {
    if size.iter().all(|side| *side <= 2.0 * REACH_M) {
        return Ok(());
    }
    let [width, height] = size.map(|side| metres((side / 1e3).ceil()));
    let reach = metres(REACH_M / 1e3);
    let (what, help) = match is_stated {
        true => (
            "by the file's bounds the map is",
            "state the bounds of the area that the robot uses, or none",
        ),
        false => (
            "the map is",
            "crop the map to the area that the robot uses; one stray point can cause this",
        ),
    };
    Err(Problem::error(format!(
        "{what} {width} km x {height} km, but a plan is valid up to {reach} km from its centre"
    ))
    .help(help))
}

#[cfg(test)]
mod tests;
