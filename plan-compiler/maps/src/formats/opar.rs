//! OPAR: the area and the obstructions of a radio path attenuation scenario.
//!
//! Neither an original file nor a specification could be found. The layout is known from the
//! first author's reader (W): a value is the first token of its line; lines that are blank, begin
//! with `#` or have no number separate parts. Section 1 is a title; section 2 a latitude, a
//! longitude and N pairs of deltas (the area); section 3 K1 and K2; section 4 the foliage model
//! (Weissberger's: a cutoff and two rows a, b, c). Then follow, for each obstruction, its type,
//! height, latitude, longitude and M pairs of deltas.
//!
//! Assumptions, which [`OparOptions`] can change: degrees are WGS-84; deltas are metres, east
//! before north, each an offset from its record's own position; polygons close themselves; type 1
//! is a building (an obstacle), type 2 foliage (it weakens radio); heights are metres above ground.
//! Deltas that look like the other unit are refused.

mod lines;
mod options;

pub use options::{DeltaOrder, DeltaUnit, ObstructionKind, ObstructionType, OparOptions};

use super::{FARTHEST_LATITUDE_DEG, FARTHEST_M};
use crate::model::{
    Extent, Feature, FoliageLoss, LossTerm, Map, NamedPoint, Point, Radio, Reference, Role, Shape,
};
use crate::problem::{Problem, Severity, Source};
use lines::{Lines, Value};
use math::GeoPoint;
use math::geodetic::{metres_per_degree, offset_m};
use std::ops::Range;
use std::sync::Arc;

/// If every delta is smaller, they are not in metres.
const SMALLEST_DELTA_M: f64 = 0.05;
/// A larger delta, in degrees, is beyond any map for a robot.
const LARGEST_DELTA_DEG: f64 = 1.0;

/// Whether a text looks like OPAR: at most one title line, then a latitude, a longitude, a count
/// of pairs, and at least that many numbers.
pub fn recognises(text: &str) -> bool {
    let lines = Lines::split(text);
    [lines.values(), lines.values_and_title()].iter().any(|values| {
        let value = |at: usize| values.get(at).map(|value| value.number);
        let (Some(lat), Some(lon), Some(pairs)) = (value(0), value(1), value(2)) else {
            return false;
        };
        let is_place = lat.abs() <= 90.0 && lon.abs() <= 180.0;
        is_place && pairs.fract() == 0.0 && pairs >= 3.0 && 2.0 * pairs < values.len() as f64
    })
}

/// Reads an OPAR scenario: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>, options: &OparOptions) -> (Option<Map>, Vec<Problem>) {
    let lines = Lines::split(&source.text);
    let mut titled = Reader::new(source, options, &lines, lines.values());
    let map = titled.read();
    let errors = |problems: &[Problem]| {
        problems.iter().filter(|problem| problem.severity == Severity::Error).count()
    };
    if lines.title_number.is_none() || errors(&titled.problems) == 0 {
        return (map, titled.problems);
    }
    // A first line that begins with a number may be the latitude of a file without a title: the
    // interpretation with fewer errors wins.
    let mut untitled = Reader::new(source, options, &lines, lines.values_and_title());
    let untitled_map = untitled.read();
    if errors(&untitled.problems) < errors(&titled.problems) {
        let map = untitled_map.map(|map| Map { title: None, ..map });
        return (map, untitled.problems);
    }
    (map, titled.problems)
}

/// A position and the offsets from it, as written.
struct Outline {
    /// Latitude and longitude, degrees.
    place: [f64; 2],
    /// Bytes of the latitude.
    place_span: Range<usize>,
    deltas: Vec<Value>,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    options: &'a OparOptions,
    lines: &'a Lines,
    values: Vec<Value>,
    /// Values consumed.
    next: usize,
    problems: Vec<Problem>,
    /// Largest absolute delta in the file.
    largest_delta: f64,
    first_delta: Option<Range<usize>>,
    /// Warnings that apply only if the deltas are in the right unit.
    outside: Vec<Problem>,
}

impl<'a> Reader<'a> {
    fn new(
        source: &'a Arc<Source>,
        options: &'a OparOptions,
        lines: &'a Lines,
        values: Vec<Value>,
    ) -> Self {
        let problems = Vec::new();
        let (largest_delta, first_delta, outside) = (0.0, None, Vec::new());
        Self {
            source,
            options,
            lines,
            values,
            next: 0,
            problems,
            largest_delta,
            first_delta,
            outside,
        }
    }

    fn error(&mut self, message: String, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    /// `None` if the numbers end before the obstructions.
    fn read(&mut self) -> Option<Map> {
        for span in &self.lines.garbled {
            let token = &self.source.text[span.clone()];
            self.problems.push(
                Problem::error(format!("{token} is not a number"))
                    .at(self.source, span.clone(), "a value must come first on its line")
                    .help("write a number as 12, -0.5 or 1.2e3, with a point"),
            );
        }
        let map = self.map();
        self.check_unit();
        // In the order of the file.
        self.problems
            .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |p| p.span.start));
        map
    }

    fn map(&mut self) -> Option<Map> {
        let area = self.outline("the area")?;
        let radio = self.radio()?;
        let boundary = self.metres(&area, [0.0; 2]);
        let extent = self.extent(&boundary, &area);
        let place = GeoPoint::from_degrees(area.place[0], area.place[1]);
        let reference = place.map(|place| Reference { place, at: [0.0; 2], heading_rad: 0.0 });
        let mut map = Map {
            boundary: Some(boundary),
            reference,
            start: Some(NamedPoint {
                name: "reference".into(),
                at: [0.0; 2],
                span: area.place_span.clone(),
            }),
            title: self.lines.title.clone().map(|span| self.source.text[span].into()),
            radio: Some(radio),
            ..Map::empty(extent)
        };
        while self.next < self.values.len() {
            let number = map.features.len() + 1;
            // After a misplaced number the rest cannot be interpreted.
            let Some(feature) = self.obstruction(number, area.place, &map.extent) else { break };
            map.features.push(feature);
        }
        Some(map)
    }

    /// Sections 3 and 4; messages name their values as the original reader does.
    fn radio(&mut self) -> Option<Radio> {
        Some(Radio {
            k1: self.take("K1")?.number,
            k2: self.take("K2")?.number,
            foliage: FoliageLoss {
                cutoff_m: self.take("distanceCutoff")?.number,
                near: self.loss_term(["a1", "b1", "c1"])?,
                far: self.loss_term(["a2", "b2", "c2"])?,
            },
        })
    }

    fn loss_term(&mut self, [a, b, c]: [&str; 3]) -> Option<LossTerm> {
        Some(LossTerm { a: self.take(a)?.number, b: self.take(b)?.number, c: self.take(c)?.number })
    }

    /// The next value; reports if the file ends before it.
    fn take(&mut self, what: &str) -> Option<Value> {
        if let Some(value) = self.values.get(self.next) {
            self.next += 1;
            return Some(value.clone());
        }
        let title = self.lines.title.clone().unwrap_or(0..0);
        let last = self.values.last().map_or(title, |value| value.span.clone());
        self.error(
            format!("the file ends before {what}"),
            last,
            "nothing follows this",
            "add what is missing, or check the counts of delta pairs above",
        );
        None
    }

    /// Latitude, longitude, count and deltas; `whose` is for messages.
    fn outline(&mut self, whose: &str) -> Option<Outline> {
        let lat = self.take(&format!("the latitude of {whose}"))?;
        let lon = self.take(&format!("the longitude of {whose}"))?;
        let is_swapped = lat.number.abs() <= 180.0 && lon.number.abs() <= 90.0;
        for (value, name, limit) in [(&lat, "latitude", 90.0), (&lon, "longitude", 180.0)] {
            if value.number.abs() > limit {
                self.error(
                    format!("the {name} of {whose} is not on the globe"),
                    value.span.clone(),
                    &format!("must be -{limit} to {limit} degrees"),
                    if is_swapped {
                        "latitude comes first: the two may be swapped"
                    } else {
                        "check it, and the count of delta pairs before it"
                    },
                );
            }
        }
        if (FARTHEST_LATITUDE_DEG..=90.0).contains(&lat.number.abs()) {
            self.error(
                format!("{whose} lies too near to a pole"),
                lat.span.clone(),
                &format!(
                    "maps are supported up to {FARTHEST_LATITUDE_DEG} degrees north and south"
                ),
                "check the latitude, and the count of delta pairs before it",
            );
        }
        let count = self.take(&format!("the number of delta pairs of {whose}"))?;
        let deltas = self.deltas(whose, &count)?;
        if let Some(first) = deltas.first().filter(|_| self.first_delta.is_none()) {
            self.first_delta = Some(first.span.clone());
        }
        for delta in &deltas {
            if delta.number.abs() > FARTHEST_M {
                let label = "beyond the largest map";
                self.error(
                    format!("a delta of {whose} is too large"),
                    delta.span.clone(),
                    label,
                    "check it, and the count of delta pairs before it",
                );
            }
            self.largest_delta = self.largest_delta.max(delta.number.abs());
        }
        Some(Outline { place: [lat.number, lon.number], place_span: lat.span, deltas })
    }

    fn deltas(&mut self, whose: &str, count: &Value) -> Option<Vec<Value>> {
        let pairs = count.number;
        let remaining = self.values.len() - self.next;
        let (message, label, help) = if pairs.fract() != 0.0 || pairs < 0.0 {
            (
                format!("the number of delta pairs of {whose} is not a count"),
                "must be a whole number".into(),
                "check it, and that no number above is missing or surplus",
            )
        } else if pairs < 3.0 {
            (
                format!("{whose} has fewer than three points"),
                "a polygon needs at least three delta pairs".into(),
                "add delta pairs, or leave the record out",
            )
        // In floating point, because the count may exceed every integer.
        } else if 2.0 * pairs > remaining as f64 {
            let written = &self.source.text[count.span.clone()];
            (
                format!("the file ends before the last delta of {whose}"),
                format!("{written} pairs expected, but {remaining} numbers follow"),
                "correct the count, or add the missing deltas",
            )
        } else {
            let end = self.next + 2 * pairs as usize;
            let deltas = self.values[self.next..end].to_vec();
            self.next = end;
            return Some(deltas);
        };
        self.error(message, count.span.clone(), &label, help);
        None
    }

    /// The points of an outline, metres; its own position is at `at`.
    fn metres(&self, outline: &Outline, at: Point) -> Vec<Point> {
        let (per_lat, per_lon) = match self.options.units {
            DeltaUnit::Metres => (1.0, 1.0),
            DeltaUnit::Degrees => metres_per_degree(outline.place[0]),
        };
        let pairs = outline.deltas.chunks_exact(2).map(|pair| [pair[0].number, pair[1].number]);
        pairs
            .map(|[first, second]| match self.options.order {
                DeltaOrder::EastNorth => [first, second],
                DeltaOrder::NorthEast => [second, first],
            })
            .map(|[east, north]| [at[0] + east * per_lon, at[1] + north * per_lat])
            .collect()
    }

    /// The bounding box of the area.
    fn extent(&mut self, boundary: &[Point], area: &Outline) -> Extent {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in boundary {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        if !(size[0] > 0.0 && size[1] > 0.0) {
            self.error(
                "the area is empty".into(),
                area.place_span.clone(),
                "its delta pairs lie on one line",
                "check the delta pairs of section 2",
            );
        }
        Extent { corner: low, size }
    }

    /// `None` if the numbers end or a count is wrong.
    fn obstruction(
        &mut self,
        number: usize,
        reference: [f64; 2],
        extent: &Extent,
    ) -> Option<Feature> {
        let name = format!("obstruction {number}");
        let kind = self.take(&format!("the type of {name}"))?;
        let height = self.take(&format!("the height of {name}"))?;
        let outline = self.outline(&name)?;
        let role = match self.options.kind(kind.number) {
            Some(ObstructionKind::Building) => Role::Obstacle,
            Some(ObstructionKind::Foliage) => Role::Attenuating,
            None => {
                let number = kind.number;
                let is_type =
                    number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
                let help = if is_type {
                    format!("state what it is: --opar-type {number}=building, or =foliage")
                } else {
                    "check the count of delta pairs before it".into()
                };
                self.error(
                    format!("{name} has an unknown type"),
                    kind.span.clone(),
                    "known types are 1 (building) and 2 (foliage)",
                    &help,
                );
                Role::Obstacle
            }
        };
        let ring = self.metres(&outline, offset_m(reference, outline.place));
        if is_outside(&ring, extent) {
            let [lat, lon] = outline.place;
            let swapped = self.metres(&outline, offset_m(reference, [lon, lat]));
            self.outside.push(
                Problem::warning(format!("{name} lies outside the area"))
                    .at(self.source, outline.place_span.clone(), "its position begins here")
                    .help(if is_outside(&swapped, extent) {
                        "check its latitude and longitude against section 2"
                    } else {
                        "its latitude and longitude seem to be swapped: latitude comes first"
                    }),
            );
        }
        let end = self.values[self.next - 1].span.end;
        Some(Feature {
            shape: Shape::Polygon(vec![ring]),
            role,
            name,
            height_m: Some(height.number),
            span: kind.span.start..end,
        })
    }

    /// Refuses deltas that look like the other unit.
    fn check_unit(&mut self) {
        let Some(span) = self.first_delta.clone() else { return };
        let largest = self.largest_delta;
        match self.options.units {
            DeltaUnit::Metres if largest < SMALLEST_DELTA_M => self.error(
                "the deltas look like degrees, not metres".into(),
                span,
                &format!("none is larger than {largest}"),
                "if they are degrees, pass --opar-units deg",
            ),
            DeltaUnit::Degrees if largest > LARGEST_DELTA_DEG => self.error(
                "the deltas look like metres, not degrees".into(),
                span,
                &format!("the largest is {largest}"),
                "if they are metres, omit --opar-units deg",
            ),
            _ => self.problems.append(&mut self.outside),
        }
    }
}

/// Whether a ring's bounding box lies outside the extent.
fn is_outside(ring: &[Point], extent: &Extent) -> bool {
    (0..2).any(|axis| {
        let (low, high) = (extent.corner[axis], extent.corner[axis] + extent.size[axis]);
        ring.iter().all(|point| point[axis] < low) || ring.iter().all(|point| point[axis] > high)
    })
}

#[cfg(test)]
mod tests;
