//! From degrees to the map's metres, for formats that give nothing else.
//!
//! The map is the plane about the centre of its bounds, which becomes the point 0,0: WGS-84,
//! x east, y north, by the arithmetic that the robot uses on its fixes. Bounds that the file
//! states outrank those of its coordinates: what is drawn later then moves no coordinate.

use crate::compile::metres;
use crate::map::{Extent, Map, Point, Reference, Role};
use crate::problem::Problem;
use math::GeoPoint;
use math::geodetic::{Frame, metres_per_degree, offset_m};

/// Room left around the outermost coordinates, so that there is a way around what stands there.
const MARGIN_M: f64 = 10.0;
/// The plane serves no farther than this from its centre, metres.
const REACH_M: f64 = Frame::RANGE_M as f64;

/// A latitude and a longitude, degrees.
pub(super) type Place = [f64; 2];

/// A box on the globe, degrees. It may lie across the date line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    south_west: Place,
    /// Extent to the north and to the east.
    size: Place,
}

impl Bounds {
    /// Between two corners; `None` where they are off the globe or the wrong way round in latitude.
    pub(super) fn between(south_west: Place, north_east: Place) -> Option<Self> {
        for [lat, lon] in [south_west, north_east] {
            GeoPoint::from_degrees(lat, lon)?;
        }
        let height = north_east[0] - south_west[0];
        let width = north_east[1] - south_west[1];
        // East of the date line longitudes start again.
        let width = if width < 0.0 { width + 360.0 } else { width };
        (height >= 0.0).then_some(Self { south_west, size: [height, width] })
    }

    /// An error where a map of these bounds would hold nothing: they have no area, or all that
    /// is drawn lies beside them.
    fn check(&self, drawn: Option<Self>) -> Result<(), Problem> {
        let mend = "state the bounds of the part that the robot will drive in, or none";
        if self.size.contains(&0.0) {
            let message = "the bounds that the file states have no area";
            return Err(Problem::error(message).mend(mend));
        }
        match drawn {
            Some(drawn) if !self.meets(&drawn) => {
                let message = "all that the file draws lies outside the bounds that it states";
                let mend = format!("{mend}; check whether latitude and longitude are swapped");
                Err(Problem::error(message).mend(mend))
            }
            _ => Ok(()),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        let apart = |axis: usize| {
            let apart = other.south_west[axis] - self.south_west[axis];
            if axis == 1 { turned(apart) } else { apart }
        };
        (0..2).all(|axis| apart(axis) <= self.size[axis] && -apart(axis) <= other.size[axis])
    }

    /// South, west, north, east, degrees.
    #[cfg(test)]
    pub(super) fn sides(self) -> [f64; 4] {
        let ([south, west], [height, width]) = (self.south_west, self.size);
        [south, west, south + height, turned(west + width)]
    }

    /// The smallest box around places; `None` where there are none.
    pub(super) fn around(places: impl Iterator<Item = Place>) -> Option<Self> {
        let mut places = places.peekable();
        let &[_, first] = places.peek()?;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [lat, lon] in places {
            // Longitudes go on across the date line, from wherever the first place is.
            for (axis, at) in [lat, first + turned(lon - first)].into_iter().enumerate() {
                low[axis] = low[axis].min(at);
                high[axis] = high[axis].max(at);
            }
        }
        Some(Self { south_west: low, size: [high[0] - low[0], high[1] - low[1]] })
    }
}

/// The place that makes an extent absurd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stray {
    /// Which of the places.
    pub(super) index: usize,
    /// Where the others are, if it is alone: of two heaps of equal size either may be astray.
    pub(super) far_from: Place,
    pub(super) is_alone: bool,
}

impl Stray {
    /// The place that lies farthest from the middle one; `None` where there are none.
    pub(super) fn among(places: &[Place]) -> Option<Self> {
        let &[_, first] = places.first()?;
        // Longitudes go on across the date line.
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

    /// What stands under an excerpt that shows it.
    pub(super) fn label(&self) -> String {
        let [lat, lon] = self.far_from;
        let where_the_others_are = format!("latitude {lat}, longitude {lon}");
        if self.is_alone {
            format!("far from the others, which lie about {where_the_others_are}")
        } else {
            format!("either this or what lies about {where_the_others_are} is astray")
        }
    }
}

/// A difference of longitudes the short way round, degrees.
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
    /// Where the extent comes from.
    by: String,
}

impl Plane {
    /// The plane of stated bounds, else of coordinates with a margin. Where bounds are stated, it
    /// is they who are wrong if there is none.
    pub(super) fn new(
        stated: Option<Bounds>,
        drawn: impl Iterator<Item = Place>,
    ) -> Result<Self, Problem> {
        let around = Bounds::around(drawn);
        let (bounds, margin, by) = match stated {
            Some(bounds) => {
                bounds.check(around)?;
                (bounds, 0.0, "by the bounds that the file states".into())
            }
            None => match around {
                Some(bounds) => (bounds, MARGIN_M, format!("{MARGIN_M} m around what it draws")),
                None => {
                    return Err(Problem::error("the file draws nothing and states no bounds")
                        .mend("check that this is the file you mean"));
                }
            },
        };
        let middle = [0, 1].map(|axis| bounds.south_west[axis] + bounds.size[axis] / 2.0);
        let reference = GeoPoint::from_degrees(middle[0], turned(middle[1]));
        let reference = reference.unwrap_or(GeoPoint { lat_e7: 0, lon_e7: 0 });
        let (per_lat, per_lon) = metres_per_degree(reference.lat_deg());
        let size = [bounds.size[1] * per_lon, bounds.size[0] * per_lat];
        if size.iter().any(|side| *side > 2.0 * REACH_M) {
            let [width, height] = size.map(|side| metres((side / 1e3).ceil()));
            let reach = metres(REACH_M / 1e3);
            let (what, mend) = match stated {
                Some(_) => (
                    "by the bounds that the file states the map is",
                    "state the bounds of the part that the robot will drive in, or none",
                ),
                None => (
                    "the map is",
                    "cut the part out that the robot will drive in; one stray point is enough",
                ),
            };
            return Err(Problem::error(format!(
                "{what} {width} km x {height} km, but a plan holds for {reach} km around its centre"
            ))
            .mend(mend));
        }
        let mut plane = Self { reference, extent: Extent { corner: [0.0; 2], size }, by };
        plane.extent.corner = plane.metres(bounds.south_west);
        for axis in 0..2 {
            plane.extent.corner[axis] -= margin;
            plane.extent.size[axis] += 2.0 * margin;
        }
        Ok(plane)
    }

    /// The map's metres of a place.
    pub(super) fn metres(&self, place: Place) -> Point {
        offset_m([self.reference.lat_deg(), self.reference.lon_deg()], place)
    }

    /// A map with nothing in it.
    pub(super) fn map(&self) -> Map {
        let reference = Reference { place: self.reference, at: [0.0; 2], heading_rad: 0.0 };
        Map { reference: Some(reference), ..Map::empty(self.extent) }
    }

    /// What became of the file: where the map lies, and what it holds.
    pub(super) fn note(&self, map: &Map, ignored: usize) -> Problem {
        let [width, height] = self.extent.size.map(|side| metres((side * 10.0).round() / 10.0));
        let (lat, lon) = (self.reference.lat_deg(), self.reference.lon_deg());
        let count = |role: Role| map.features.iter().filter(|one| one.role == role).count();
        let (obstacles, areas, zones) =
            (count(Role::Obstacle), count(Role::Attenuating), count(Role::Zone));
        let points = map.points.len();
        Problem::note(format!(
            "the map is {width} m x {height} m, {by}; 0,0 is its centre, latitude {lat}, \
             longitude {lon}; obstacles: {obstacles}, areas that weaken radio: {areas}, zones: \
             {zones}, named points: {points}, without a meaning here: {ignored}",
            by = self.by
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(stated: Option<[Place; 2]>, drawn: &[Place], expected: &str) {
        let stated = stated.map(|[low, high]| Bounds::between(low, high).expect("bounds"));
        let got = match Plane::new(stated, drawn.iter().copied()) {
            Ok(plane) => {
                let GeoPoint { lat_e7, lon_e7 } = plane.reference;
                let [corner, size] = [plane.extent.corner, plane.extent.size]
                    .map(|at| at.map(|at| format!("{at:.2}")).join(","));
                let drawn: Vec<String> = drawn
                    .iter()
                    .map(|place| plane.metres(*place).map(|at| format!(" {at:.2}")).join(","))
                    .collect();
                format!("{lat_e7} {lon_e7} {corner} + {size}:{}", drawn.concat())
            }
            Err(problem) => problem.message,
        };
        assert_eq!(got, expected);
    }

    #[test]
    fn the_plane_lies_about_the_centre_of_the_bounds() {
        check(
            Some([[51.0, 7.0], [51.001, 7.002]]),
            &[[51.0005, 7.001]],
            "510005000 70010000 -70.20,-55.62 + 140.39,111.25: 0.00, 0.00",
        );
        check(
            None,
            &[[51.0, 7.0], [51.001, 7.002]],
            "510005000 70010000 -80.20,-65.62 + 160.39,131.25: -70.20, -55.62 70.20, 55.62",
        );
        check(None, &[[51.0, 7.0]], "510000000 70000000 -10.00,-10.00 + 20.00,20.00: 0.00, 0.00");
    }

    #[test]
    fn the_date_line_is_no_border() {
        check(
            None,
            &[[10.0, 179.9999], [10.0, -179.9999]],
            "100000000 1800000000 -20.96,-10.00 + 41.93,20.00: -10.96, 0.00 10.96, 0.00",
        );
        check(
            Some([[10.0, 179.9999], [10.0001, -179.9999]]),
            &[],
            "100000500 1800000000 -10.96,-5.53 + 21.93,11.06:",
        );
    }

    #[test]
    fn what_is_no_map_of_a_robot_is_refused() {
        check(None, &[], "the file draws nothing and states no bounds");
        check(
            None,
            &[[51.0, 7.0], [0.0, 0.0]],
            "the map is 704 km x 5650 km, but a plan holds for 20 km around its centre",
        );
        assert_eq!(Bounds::between([51.0, 7.0], [50.0, 7.1]), None);
        assert_eq!(Bounds::between([51.0, 7.0], [91.0, 7.1]), None);
    }

    #[test]
    fn stated_bounds_that_hold_nothing_are_to_blame() {
        let outside = "all that the file draws lies outside the bounds that it states";
        // Longitude and latitude swapped; and one that was cut out elsewhere.
        check(Some([[7.0, 51.0], [7.001, 51.001]]), &[[51.0, 7.0]], outside);
        check(Some([[51.0, 7.0], [51.001, 7.001]]), &[[51.002, 7.0], [51.002, 7.001]], outside);
        check(
            Some([[0.0, 0.0], [1.0, 0.0001]]),
            &[[0.0, 0.0]],
            "by the bounds that the file states the map is 1 km x 111 km, but a plan holds for 20 \
             km around its centre",
        );
        let no_area = "the bounds that the file states have no area";
        check(Some([[51.0, 7.0], [51.0, 7.0]]), &[[51.0, 7.0]], no_area);
        check(Some([[51.0, 7.0], [51.1, 7.0]]), &[], no_area);
        // A wood all around has no corner within.
        check(
            Some([[51.0, 7.0], [51.001, 7.002]]),
            &[[50.0, 6.0], [52.0, 8.0]],
            "510005000 70010000 -70.20,-55.62 + 140.39,111.25: -70267.12, -111303.91 70126.73, \
             111192.66",
        );
    }

    #[test]
    fn the_place_astray_is_the_one_far_from_most() {
        let check = |places: &[Place], expected: &str| {
            let got =
                Stray::among(places).map(|stray| format!("{} {}", stray.index, stray.label()));
            assert_eq!(got.unwrap_or_default(), expected);
        };
        check(&[], "");
        let others = "far from the others, which lie about latitude 51, longitude 7";
        check(&[[51.0, 7.0], [51.0, 7.001], [0.0, 0.0]], &format!("2 {others}"));
        check(&[[0.0, 0.0], [51.0, 7.0], [51.001, 7.0]], &format!("0 {others}"));
        check(&[[51.0, 7.0], [15.0, 7.0], [51.0, 7.001]], &format!("1 {others}"));
        // Of two nobody can tell.
        check(
            &[[51.0, 7.0], [0.0, 0.0]],
            "0 either this or what lies about latitude 0, longitude 0 is astray",
        );
        check(
            &[[0.0, 179.9], [0.0, -179.9], [0.0, 90.0]],
            "2 far from the others, which lie about latitude 0, longitude 179.9",
        );
    }

    #[test]
    fn the_robot_finds_itself_where_the_map_says() {
        let places = [[51.48, -0.002], [51.4815, 0.001]];
        let plane = Plane::new(None, places.into_iter()).expect("a plane");
        let frame = Frame::new(plane.reference, [0.0; 2], 0.0);
        for place in places {
            let fix = GeoPoint::from_degrees(place[0], place[1]).expect("on the globe");
            let there = frame.to_local(fix).expect("near");
            let [x, y] = plane.metres(place);
            assert!((f64::from(there.x) - x).abs() < 0.01 && (f64::from(there.y) - y).abs() < 0.01);
        }
    }
}
