//! Turns overlay statements into the map, in metres.

use super::grammar::Keyword;
use super::parser::{Coordinate, CoordinateValue, Statement};
use crate::formats::utm::Zone;
use crate::formats::{FARTHEST_LATITUDE_DEG, FARTHEST_M};
use crate::model::{Extent, Feature, Map, NamedPoint, Point, Reference, Role, Shape};
use crate::numbers::pair;
use crate::problem::{Problem, Source};
use math::GeoPoint;
use math::scalar::wide;
use std::ops::Range;
use std::sync::Arc;

/// Side of a map without a MISSION-AREA, metres: the language's default.
const DEFAULT_SIDE_M: f64 = 1000.0;
/// Largest distance between two places of one map, degrees.
const FAR_APART_DEG: f64 = 1.0;
const OUTSIDE_HELP: &str = "enlarge MISSION-AREA, or correct the coordinates";
/// The passage point at which robots start.
const START: &str = "StartPlace";

/// The map that the statements of a file describe.
pub(super) fn interpret(
    source: &Arc<Source>,
    statements: &[Statement],
    resolution_m: Option<f64>,
    problems: &mut Vec<Problem>,
) -> Map {
    let side = [DEFAULT_SIDE_M; 2];
    let map = Map { resolution_m, ..Map::empty(Extent { corner: [0.0; 2], size: side }) };
    let origin = Origin::default();
    let mut reader =
        Reader { source, problems, map, heading_rad: 0.0, origin, seen: vec![], words: vec![] };
    // The origin first, because it moves every coordinate in the file.
    for statement in statements {
        reader.information(statement);
    }
    for statement in statements {
        reader.measure(statement);
    }
    reader.finish();
    reader.map
}

/// The ORIGIN; without one, the first UTM coordinate determines zone and anchor.
#[derive(Debug, Default)]
struct Origin {
    /// Added to plain coordinates and subtracted from UTM ones, metres.
    at: Point,
    /// The zone that all UTM coordinates are projected in.
    zone: Option<Zone>,
    is_utm: bool,
    /// A place with its map point from UTM, and the direction of true north there.
    anchor: Option<Reference>,
    /// Whether a plain coordinate under a UTM origin was reported.
    mixed: bool,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
    map: Map,
    heading_rad: f64,
    origin: Origin,
    /// Statements that count once, with their values.
    seen: Vec<(Keyword, Vec<f64>)>,
    /// The keyword of each feature of the map.
    words: Vec<&'static str>,
}

impl Reader<'_> {
    fn error(&mut self, message: &str, span: &Range<usize>, label: &str, help: &str) {
        let problem = Problem::error(message).at(self.source, span.clone(), label).help(help);
        self.problems.push(problem);
    }

    fn warn(&mut self, message: String, span: &Range<usize>, label: &str, help: &str) {
        let problem = Problem::warning(message).at(self.source, span.clone(), label).help(help);
        self.problems.push(problem);
    }

    /// Warns if a statement is given twice with different values.
    fn once(&mut self, statement: &Statement, value: &[f64]) {
        let keyword = statement.form.keyword;
        let before = self.seen.iter_mut().find(|(seen, _)| *seen == keyword);
        match before {
            None => self.seen.push((keyword, value.to_vec())),
            Some((_, same)) if same == value => {}
            Some((_, other)) => {
                *other = value.to_vec();
                let word = statement.form.spellings[0];
                self.warn(
                    format!("{word} is given twice with different values"),
                    &statement.span,
                    "this one counts",
                    "remove the other one",
                );
            }
        }
    }
}

/// Statements that describe the whole map.
impl Reader<'_> {
    fn information(&mut self, statement: &Statement) {
        let numbers: Vec<f64> = statement.numbers.iter().map(|(value, _)| *value).collect();
        let name = clean(&statement.name);
        match (statement.form.keyword, numbers.as_slice()) {
            (Keyword::Scenario, _) => self.map.title = Some(name),
            (Keyword::Site, _) => self.remark("site", &name),
            (Keyword::LoadMap, _) => self.remark("background", &name),
            (Keyword::Heightmap, _) => self.remark("heightmap", &name),
            (Keyword::Origin, _) => self.origin(statement),
            (Keyword::MissionArea, &[width, height]) => self.area(statement, [width, height]),
            (Keyword::Heading, &[degrees]) => {
                self.once(statement, &numbers);
                self.heading_rad = degrees.to_radians();
            }
            (Keyword::GlobalRefPoint, &[lat, lon]) => {
                self.once(statement, &numbers);
                match GeoPoint::from_degrees(lat, lon) {
                    Some(_) if lat.abs() > FARTHEST_LATITUDE_DEG => self.at_a_pole(&statement.span),
                    // It is the map's centre; `finish` sets `at` when the area is known.
                    Some(place) => {
                        let at = [0.0; 2];
                        self.map.reference = Some(Reference { place, at, heading_rad: 0.0 });
                    }
                    None if lat.abs() <= 180.0 && lon.abs() <= 90.0 => self.error(
                        "this place is not on the globe",
                        &statement.span,
                        "latitude is -90 to 90, longitude -180 to 180 degrees",
                        &format!("if the two are swapped, write GLOBAL_REF_POINT {lon} {lat}"),
                    ),
                    None => self.off_the_globe(&statement.span),
                }
            }
            _ => {}
        }
    }

    fn remark(&mut self, what: &str, name: &str) {
        self.map.remarks.push(format!("{what} {name}"));
    }

    fn area(&mut self, statement: &Statement, size: Point) {
        self.once(statement, &size);
        if size[0] > 0.0 && size[1] > 0.0 {
            self.map.extent.size = size;
        } else {
            self.error(
                "MISSION-AREA is empty",
                &statement.span,
                "width and height must be above zero",
                "write MISSION-AREA width height, in metres",
            );
        }
    }

    fn origin(&mut self, statement: &Statement) {
        let Some(coordinate) = statement.points.first() else { return };
        self.origin = Origin::default();
        match coordinate.value {
            CoordinateValue::Plain(at) => {
                self.once(statement, &at);
                self.origin.at = at;
            }
            CoordinateValue::Utm { lat, lon } => {
                self.once(statement, &[lat, lon]);
                // Its own map point is (0, 0): the origin minus itself.
                self.origin.is_utm = true;
                if let Some(at) = self.project(lat, lon, &coordinate.span) {
                    self.origin.at = at;
                    self.anchor(lat, lon, [0.0; 2]);
                }
            }
        }
    }

    /// Warns if GLOBAL_REF_POINT and the UTM coordinates disagree.
    fn compare(&mut self, reference: &Reference) {
        let Some(anchor) = self.origin.anchor else { return };
        let degrees = |place: GeoPoint| [place.lat_deg(), place.lon_deg()];
        let ([lat, lon], theirs) = (degrees(reference.place), degrees(anchor.place));
        let apart = |place: [f64; 2]| wide::hypot(place[0] - theirs[0], place[1] - theirs[1]);
        if apart([lat, lon]) <= FAR_APART_DEG {
            return;
        }
        let help = if apart([lon, lat]) <= FAR_APART_DEG {
            format!("the two seem to be swapped: write GLOBAL_REF_POINT {lon} {lat}")
        } else {
            "latitude comes first; west and south are negative".into()
        };
        self.problems.push(
            Problem::warning(format!(
                "GLOBAL_REF_POINT {lat} {lon} lies far from the UTM coordinates, which are about \
                 latitude {}, longitude {}",
                theirs[0], theirs[1]
            ))
            .help(help),
        );
    }

    fn finish(&mut self) {
        let Extent { corner, size } = self.map.extent;
        if let Some(reference) = &mut self.map.reference {
            reference.at = [corner[0] + size[0] / 2.0, corner[1] + size[1] / 2.0];
            reference.heading_rad = self.heading_rad;
            let reference = *reference;
            self.compare(&reference);
        } else if let Some(anchor) = self.origin.anchor {
            // The map's axes are those of the UTM grid, rotated by HEADING.
            let heading_rad = self.heading_rad + anchor.heading_rad;
            self.map.reference = Some(Reference { heading_rad, ..anchor });
        }
        if self.origin.zone.is_some() {
            self.problems.push(Problem::note(
                "UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866",
            ));
        }
        self.outside();
        if !self.seen.iter().any(|(keyword, _)| *keyword == Keyword::MissionArea) {
            self.problems.push(
                Problem::note("there is no MISSION-AREA; 1000 m by 1000 m are assumed")
                    .help("write MISSION-AREA width height above CONTROL MEASURES:"),
            );
        }
    }
}

/// Checks that what blocks lies on the map.
impl Reader<'_> {
    /// Notes the statements whose shape lies wholly outside the map, by keyword. Warns if all do.
    fn outside(&mut self) {
        let is_obstacle = |feature: &&Feature| feature.role == Role::Obstacle;
        let is_inside = |feature: &Feature| touches(&feature.shape, &self.map.extent);
        let has_obstacles = self.map.features.iter().any(|feature| is_obstacle(&feature));
        let is_empty =
            has_obstacles && !self.map.features.iter().filter(is_obstacle).any(is_inside);
        let mut kinds: Vec<(&str, usize, Range<usize>)> = Vec::new();
        for (feature, word) in self.map.features.iter().zip(&self.words) {
            if is_inside(feature) {
                continue;
            }
            match kinds.iter_mut().find(|(known, ..)| known == word) {
                Some((_, count, _)) => *count += 1,
                None => kinds.push((word, 1, feature.span.clone())),
            }
        }
        let Extent { corner, size } = self.map.extent;
        let area = format!("the map, {} m by {} m from {}", size[0], size[1], pair(corner));
        if is_empty && let Some((_, _, span)) = kinds.first() {
            let help = match self.origin.at {
                [0.0, 0.0] => OUTSIDE_HELP.into(),
                _ if self.origin.is_utm => "check the UTM coordinates against ORIGIN".into(),
                [x, y] => format!(
                    "ORIGIN {x} {y} is added to every coordinate: leave it out if they are already on \
                     the map"
                ),
            };
            let list: Vec<String> =
                kinds.iter().map(|(word, count, _)| format!("{word} {count}")).collect();
            let message = format!(
                "nothing blocks: every obstacle lies outside {area}; outside: {}",
                list.join(", ")
            );
            self.warn(message, &span.clone(), "the first of them", &help);
            return;
        }
        for (word, count, span) in kinds {
            let label = if count == 1 { "this one" } else { "the first of them" };
            // Real overlays have walls beyond their area.
            let note = Problem::note(format!("{word} outside {area}: {count}"));
            self.problems.push(note.at(self.source, span, label).help(OUTSIDE_HELP));
        }
    }
}

/// Whether the box around a shape touches a rectangle.
fn touches(shape: &Shape, area: &Extent) -> bool {
    let (points, reach) = match shape {
        Shape::Circle { centre, radius } => (std::slice::from_ref(centre), *radius),
        Shape::Polyline(points) => (points.as_slice(), 0.0),
        Shape::Polygon(rings) => (rings.first().map_or(&[][..], Vec::as_slice), 0.0),
    };
    (0..2).all(|axis| {
        let along = points.iter().map(|point| point[axis]);
        let low = along.clone().fold(f64::INFINITY, f64::min) - reach;
        let high = along.fold(f64::NEG_INFINITY, f64::max) + reach;
        low <= area.corner[axis] + area.size[axis] && high >= area.corner[axis]
    })
}

/// Conversion of coordinates to the map's metres.
impl Reader<'_> {
    fn locate(&mut self, coordinate: &Coordinate) -> Option<Point> {
        let origin = self.origin.at;
        match coordinate.value {
            CoordinateValue::Plain([x, y]) => {
                if self.origin.is_utm && !self.origin.mixed {
                    self.origin.mixed = true;
                    self.warn(
                        "plain coordinates under a UTM ORIGIN lie hundreds of kilometres away"
                            .into(),
                        &coordinate.span,
                        "the origin's easting and northing are added to this",
                        "write these coordinates as UTM too, or the ORIGIN as plain numbers",
                    );
                }
                self.near([x + origin[0], y + origin[1]], &coordinate.span)
            }
            CoordinateValue::Utm { lat, lon } => {
                let [east, north] = self.project(lat, lon, &coordinate.span)?;
                let at = [east - origin[0], north - origin[1]];
                if self.origin.anchor.is_none() {
                    self.anchor(lat, lon, at);
                }
                self.near(at, &coordinate.span)
            }
        }
    }

    /// Refuses points beyond any map.
    fn near(&mut self, at: Point, span: &Range<usize>) -> Option<Point> {
        let is_near = at.iter().all(|value| value.abs() <= FARTHEST_M);
        if !is_near {
            self.error("this coordinate is too large", span, "with ORIGIN applied", "check both");
        }
        is_near.then_some(at)
    }

    /// Easting and northing in the map's single zone.
    fn project(&mut self, lat: f64, lon: f64, span: &Range<usize>) -> Option<Point> {
        if GeoPoint::from_degrees(lat, lon).is_none() {
            self.off_the_globe(span);
            return None;
        }
        if lat.abs() > FARTHEST_LATITUDE_DEG {
            self.at_a_pole(span);
            return None;
        }
        let zone = *self.origin.zone.get_or_insert(Zone::of(lat, lon));
        let projected = zone.project(lat, lon);
        if projected.is_none() {
            self.error(
                "this place is too far from the map's UTM zone",
                span,
                "more than 30 degrees away, or at a pole",
                "check latitude, longitude and their signs against ORIGIN",
            );
        }
        projected.map(|projected| projected.at)
    }

    fn anchor(&mut self, lat: f64, lon: f64, at: Point) {
        let zone = self.origin.zone.unwrap_or(Zone::of(lat, lon));
        let place = GeoPoint::from_degrees(lat, lon);
        self.origin.anchor = zone.project(lat, lon).zip(place).map(|(projected, place)| {
            Reference { place, at, heading_rad: projected.convergence_rad }
        });
    }

    fn at_a_pole(&mut self, span: &Range<usize>) {
        self.error(
            "this place is too near to a pole",
            span,
            &format!("maps are supported up to {FARTHEST_LATITUDE_DEG} degrees north and south"),
            "check the latitude; a map without a position on the globe does not need this line",
        );
    }

    fn off_the_globe(&mut self, span: &Range<usize>) {
        self.error(
            "this place is not on the globe",
            span,
            "latitude is -90 to 90, longitude -180 to 180 degrees",
            "check the numbers, and that the latitude comes first; west and south are negative",
        );
    }
}

/// Statements that add to the map.
impl Reader<'_> {
    fn measure(&mut self, statement: &Statement) {
        let number = statement.numbers.first().cloned();
        match statement.form.keyword {
            Keyword::Obstacle => self.circle(statement, number, 1.0),
            // The style comes after the diameter; the first of them is FIXED.
            Keyword::Object if statement.choice == 0 => self.circle(statement, number, 0.5),
            Keyword::Wall => self.wall(statement),
            Keyword::Boundary => self.boundary(statement),
            Keyword::PassagePoint => self.passage_point(statement),
            Keyword::ObsoleteStart => {
                self.warn(
                    "SP is obsolete and ignored".into(),
                    &statement.span,
                    "no start place",
                    "use PP StartPlace x y",
                );
            }
            _ => {}
        }
    }

    /// All coordinates of a statement; `None` after a report.
    fn points(&mut self, statement: &Statement) -> Option<Vec<Point>> {
        let located: Vec<_> = statement.points.iter().map(|point| self.locate(point)).collect();
        located.into_iter().collect()
    }

    fn push(&mut self, statement: &Statement, shape: Shape, role: Role, height_m: Option<f64>) {
        let name = clean(&statement.name);
        let span = statement.span.clone();
        self.map.features.push(Feature { shape, role, name, height_m, span });
        self.words.push(statement.form.spellings[0]);
    }

    /// The radius is `number * to_radius`: an OBSTACLE gives its radius, an OBJECT its diameter.
    fn circle(
        &mut self,
        statement: &Statement,
        number: Option<(f64, Range<usize>)>,
        to_radius: f64,
    ) {
        let Some((number, span)) = number else { return };
        let centre = self.points(statement).and_then(|points| points.first().copied());
        if !(0.0..=FARTHEST_M).contains(&number) {
            let label = if number < 0.0 { "below zero" } else { "too large" };
            self.error("the circle's size is invalid", &span, label, "write it in metres");
            return;
        }
        let Some(centre) = centre else { return };
        let height_m = statement.numbers.get(1).map(|(height, _)| *height);
        let shape = Shape::Circle { centre, radius: number * to_radius };
        self.push(statement, shape, Role::Obstacle, height_m);
    }

    fn wall(&mut self, statement: &Statement) {
        let Some(mut points) = self.points(statement) else { return };
        // A wall of one point is allowed: it is a line from the point to itself.
        if let &[only] = points.as_slice() {
            points.push(only);
        }
        let height_m = statement.numbers.first().map(|(height, _)| *height);
        self.push(statement, Shape::Polyline(points), Role::Obstacle, height_m);
    }

    fn boundary(&mut self, statement: &Statement) {
        let Some(points) = self.points(statement) else { return };
        let Some(role) = zone_role(&statement.name) else { return };
        if points.len() < 3 {
            self.error(
                "a zone needs at least three points",
                &statement.span,
                "its name makes it a zone",
                "add points, or rename the line",
            );
            return;
        }
        self.push(statement, Shape::Polygon(vec![points]), role, None);
    }

    fn passage_point(&mut self, statement: &Statement) {
        let Some(&[at]) = self.points(statement).as_deref() else { return };
        let point = NamedPoint { name: clean(&statement.name), at, span: statement.span.clone() };
        if point.name != START {
            self.map.points.push(point);
        } else if self.map.start.is_none() {
            self.map.start = Some(point);
        } else {
            self.warn(
                "StartPlace is given twice".into(),
                &statement.span,
                "ignored",
                "keep one of them, or rename this one",
            );
        }
    }
}

/// A name, trimmed, without the trailing `*` that hides its label.
fn clean(name: &str) -> String {
    let name = name.trim();
    name.strip_suffix('*').unwrap_or(name).trim_end().into()
}

/// The role of a BOUNDARY, by its name.
fn zone_role(name: &str) -> Option<Role> {
    let name = name.to_ascii_lowercase();
    if name.contains("nocommzone") {
        return Some(Role::Attenuating);
    }
    let is_zone = name.contains("noflyzone") || name.contains("weatherzone");
    is_zone.then_some(Role::Zone)
}
