//! Converts latitude and longitude to map metres and back.
//!
//! The map frame is the tangent plane at the map's reference: WGS-84 radii of curvature there,
//! x east, y north, turned by the map's heading. Differences of latitude and longitude are
//! computed in integers (1e-7 degrees, as receivers send them) before any float, so precision
//! is the same everywhere on the globe. The plane is flat: at distance d from the reference the
//! error is about d^2 tan(latitude) / R across (0.8 m at 3 km and 30 degrees);
//! [`MapFrame::RANGE_M`] bounds it.
//!
//! Deliberately absent: UTM zones, height.

use crate::scalar::wide;
use crate::vector::Vec2;
use serde::{Deserialize, Serialize};

/// WGS-84 semi-major axis, metres.
pub const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// WGS-84 first eccentricity squared.
pub const ECCENTRICITY_SQUARED: f64 = 6.694_379_990_141_316_5e-3;
/// Units of 1e-7 degrees in half a turn.
const HALF_TURN_E7: i64 = 1_800_000_000;

/// A place on the WGS-84 ellipsoid, in units of 1e-7 degrees (about 11 mm).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GeoPoint {
    /// Latitude, 1e-7 degrees north, -900_000_000 ..= 900_000_000.
    pub lat_e7: i32,
    /// Longitude, 1e-7 degrees east, -1_800_000_000 ..= 1_800_000_000.
    pub lon_e7: i32,
}

impl GeoPoint {
    /// The place of these degrees, rounded to 1e-7; `None` outside +-90 and +-180 degrees.
    pub fn from_degrees(lat: f64, lon: f64) -> Option<Self> {
        if !((-90.0..=90.0).contains(&lat) && (-180.0..=180.0).contains(&lon)) {
            return None;
        }
        Some(Self { lat_e7: libm::round(lat * 1e7) as i32, lon_e7: libm::round(lon * 1e7) as i32 })
    }

    /// Latitude, degrees.
    pub fn lat_deg(self) -> f64 {
        f64::from(self.lat_e7) / 1e7
    }

    /// Longitude, degrees.
    pub fn lon_deg(self) -> f64 {
        f64::from(self.lon_e7) / 1e7
    }

    /// Whether both angles are in range.
    pub fn is_valid(self) -> bool {
        self.lat_e7.unsigned_abs() <= 900_000_000 && self.lon_e7.unsigned_abs() <= 1_800_000_000
    }
}

/// The tangent plane of one map.
///
/// ```
/// use math::{MapFrame, GeoPoint};
/// // One minute of latitude is one nautical mile, 1,852 m, at 45 degrees.
/// let home = GeoPoint::from_degrees(45.0, 8.0).unwrap();
/// let north = GeoPoint::from_degrees(45.0 + 1.0 / 60.0, 8.0).unwrap();
/// let plain = MapFrame::new(home, [100.0, 200.0], 0.0).to_local(north).unwrap();
/// assert!((plain.x - 100.0).abs() < 0.1 && (plain.y - 2_052.0).abs() < 1.0);
/// // On a map whose y axis points east, north lies to the left: at negative x.
/// let east_up = MapFrame::new(home, [0.0, 0.0], core::f64::consts::FRAC_PI_2);
/// let turned = east_up.to_local(north).unwrap();
/// assert!((turned.x + 1_852.0).abs() < 1.0 && turned.y.abs() < 0.1);
/// ```
///
/// Built once, when a blob is loaded. After that [`MapFrame::to_local`] costs a few
/// single-precision multiplications.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFrame {
    reference: GeoPoint,
    /// Map coordinates of the reference, metres.
    offset: Vec2,
    metres_per_e7_lat: f32,
    metres_per_e7_lon: f32,
    cos_heading: f32,
    sin_heading: f32,
}

impl MapFrame {
    /// Largest distance of a fix from the reference, metres along either axis.
    pub const RANGE_M: f32 = 20_000.0;

    /// The map frame with the point `offset_m` (map metres) at `reference` and its y axis
    /// `heading_rad` clockwise of true north.
    pub fn new(reference: GeoPoint, offset_m: [f64; 2], heading_rad: f64) -> Self {
        let (per_lat, per_lon) = metres_per_degree(reference.lat_deg());
        Self {
            reference,
            offset: Vec2::new(offset_m[0] as f32, offset_m[1] as f32),
            metres_per_e7_lat: (per_lat * 1e-7) as f32,
            metres_per_e7_lon: (per_lon * 1e-7) as f32,
            cos_heading: wide::cos(heading_rad) as f32,
            sin_heading: wide::sin(heading_rad) as f32,
        }
    }

    /// Place of the reference.
    pub fn reference(&self) -> GeoPoint {
        self.reference
    }

    /// Position of a place, map metres; `None` if it is not on the globe or farther than
    /// [`MapFrame::RANGE_M`] from the reference.
    pub fn to_local(&self, place: GeoPoint) -> Option<Vec2> {
        if !place.is_valid() {
            return None;
        }
        let dlat = i64::from(place.lat_e7) - i64::from(self.reference.lat_e7);
        let dlon = wrap_e7(i64::from(place.lon_e7) - i64::from(self.reference.lon_e7));
        let east = dlon as f32 * self.metres_per_e7_lon;
        let north = dlat as f32 * self.metres_per_e7_lat;
        if !(east.abs() <= Self::RANGE_M && north.abs() <= Self::RANGE_M) {
            return None;
        }
        Some(self.offset + self.turned(east, north))
    }

    /// Turns a displacement or velocity (east, north) into the map's axes.
    pub fn turned(&self, east: f32, north: f32) -> Vec2 {
        Vec2::new(
            self.cos_heading * east - self.sin_heading * north,
            self.sin_heading * east + self.cos_heading * north,
        )
    }

    /// Place of a position on the map, to 1e-7 degrees.
    pub fn to_geodetic(&self, local: Vec2) -> GeoPoint {
        let d = local - self.offset;
        let east = self.cos_heading * d.x + self.sin_heading * d.y;
        let north = -self.sin_heading * d.x + self.cos_heading * d.y;
        let dlat = libm::roundf(north / self.metres_per_e7_lat) as i64;
        let dlon = libm::roundf(east / self.metres_per_e7_lon) as i64;
        let lat = (i64::from(self.reference.lat_e7) + dlat).clamp(-900_000_000, 900_000_000);
        let lon = wrap_e7(i64::from(self.reference.lon_e7) + dlon);
        GeoPoint { lat_e7: lat as i32, lon_e7: lon as i32 }
    }
}

/// Metres in a degree of latitude and of longitude at `lat_deg`, WGS-84.
pub fn metres_per_degree(lat_deg: f64) -> (f64, f64) {
    let phi = lat_deg.to_radians();
    let w2 = 1.0 - ECCENTRICITY_SQUARED * wide::sin(phi) * wide::sin(phi);
    let w = wide::sqrt(w2);
    let meridian = SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQUARED) / (w2 * w);
    // At a pole a degree of longitude has length 0; a hundredth of a millimetre keeps the
    // inverse finite.
    let parallel = (SEMI_MAJOR_M / w * wide::cos(phi)).max(1e-5);
    (meridian.to_radians(), parallel.to_radians())
}

/// Metres east and north from one place to another, both `[latitude, longitude]` in degrees, in
/// the tangent plane of the first. [`MapFrame`]'s arithmetic in double precision, for maps with
/// more digits than a receiver has.
pub fn offset_m(from_deg: [f64; 2], to_deg: [f64; 2]) -> [f64; 2] {
    let (per_lat, per_lon) = metres_per_degree(from_deg[0]);
    let dlon = to_deg[1] - from_deg[1];
    // The short way round, as in `wrap_e7`. Short differences stay exact.
    let dlon = if dlon > 180.0 {
        dlon - 360.0
    } else if dlon < -180.0 {
        dlon + 360.0
    } else {
        dlon
    };
    [dlon * per_lon, (to_deg[0] - from_deg[0]) * per_lat]
}

/// A longitude difference the short way round.
fn wrap_e7(difference: i64) -> i64 {
    if difference > HALF_TURN_E7 {
        difference - 2 * HALF_TURN_E7
    } else if difference < -HALF_TURN_E7 {
        difference + 2 * HALF_TURN_E7
    } else {
        difference
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(lat: f64, lon: f64) -> GeoPoint {
        GeoPoint::from_degrees(lat, lon).unwrap()
    }

    #[test]
    fn lengths_of_a_degree_agree_with_published_tables() {
        for (lat, per_lat, per_lon) in
            [(0.0, 110_574.3, 111_319.5), (45.0, 111_131.8, 78_846.8), (60.0, 111_412.3, 55_800.0)]
        {
            let (a, b) = metres_per_degree(lat);
            assert!((a - per_lat).abs() < 0.5 && (b - per_lon).abs() < 0.5, "{lat}: {a} {b}");
        }
    }

    #[test]
    fn there_and_back_is_within_the_unit() {
        let frame = MapFrame::new(place(33.7756, -84.399), [10.0, -20.0], 0.3);
        for i in -20..20 {
            let p = Vec2::new(i as f32 * 37.0, i as f32 * -21.5);
            let back = frame.to_local(frame.to_geodetic(p)).unwrap();
            assert!((back - p).amax() < 0.02, "{p:?} {back:?}");
        }
    }

    #[test]
    fn heading_turns_the_axes_clockwise_of_north() {
        // A map whose y axis points east: a place to the east has positive y.
        let frame = MapFrame::new(place(0.0, 0.0), [0.0, 0.0], core::f64::consts::FRAC_PI_2);
        let p = frame.to_local(place(0.0, 0.001)).unwrap();
        assert!(p.y > 111.0 && p.x.abs() < 0.01, "{p:?}");
    }

    #[test]
    fn places_on_both_sides_of_the_date_line_are_near() {
        let frame = MapFrame::new(place(10.0, 179.9999), [0.0, 0.0], 0.0);
        let p = frame.to_local(place(10.0, -179.9999)).unwrap();
        assert!((p.x - 21.9).abs() < 0.1, "{p:?}");
    }

    #[test]
    fn double_precision_offsets_agree_with_the_frame() {
        let frame = MapFrame::new(place(33.7756, -84.399), [0.0, 0.0], 0.0);
        let [x, y] = offset_m([33.7756, -84.399], [33.776141, -84.398784]);
        let p = frame.to_local(place(33.776141, -84.398784)).unwrap();
        assert!((x - f64::from(p.x)).abs() < 1e-3 && (y - f64::from(p.y)).abs() < 1e-3);
        let [x, _] = offset_m([10.0, 179.9999], [10.0, -179.9999]);
        assert!((x - 21.9).abs() < 0.1, "{x}");
    }

    #[test]
    fn what_is_too_far_or_off_the_globe_is_refused() {
        let frame = MapFrame::new(place(50.0, 7.0), [0.0, 0.0], 0.0);
        assert!(frame.to_local(place(51.0, 7.0)).is_none());
        assert!(frame.to_local(GeoPoint { lat_e7: 2_000_000_000, lon_e7: 0 }).is_none());
        assert!(GeoPoint::from_degrees(f64::NAN, 0.0).is_none());
    }
}
