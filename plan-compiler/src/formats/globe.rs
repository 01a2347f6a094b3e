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
    /// The plane of stated bounds, else of coordinates with a margin.
    pub(super) fn new(
        stated: Option<Bounds>,
        drawn: impl Iterator<Item = Place>,
    ) -> Result<Self, Problem> {
        let (bounds, margin, by) = match stated {
            Some(bounds) => (bounds, 0.0, "by the bounds that the file states".into()),
            None => match Bounds::around(drawn) {
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
            return Err(Problem::error(format!(
                "the map is {width} km x {height} km, but a plan holds for {reach} km around \
                 its centre"
            ))
            .mend("cut the part out that the robot will drive in; one stray point is enough"));
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
