//! Universal Transverse Mercator on WGS-84, to well below a millimetre.
//!
//! Krueger's series in the third flattening n, as given by Karney, "Transverse Mercator
//! with an accuracy of a few nanometers", Journal of Geodesy 85 (2011), equations 7 to 14,
//! 23, 24 and 35, cut after n^4: the omitted terms stay below a micrometre anywhere in a zone and
//! its neighbours. The zone follows from the longitude alone.
//! Deliberately absent: the exceptions of Norway and Svalbard, and the inverse projection.

use crate::model::Point;
use math::geodetic::{ECCENTRICITY_SQUARED, SEMI_MAJOR_M};
use math::scalar::wide::{asinh, atan2, atanh, cos, cosh, floor, hypot, sin, sinh, sqrt, tan};

const SCALE_ON_MERIDIAN: f64 = 0.9996;
const FALSE_EASTING_M: f64 = 500_000.0;
const FALSE_NORTHING_SOUTH_M: f64 = 10_000_000.0;
/// Largest distance from the central meridian, degrees: beyond it the projection is too distorted.
const MAX_FROM_MERIDIAN_DEG: f64 = 30.0;

/// One zone of the grid, on one side of the equator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    /// Zone number, 1 to 60.
    pub number: u8,
    /// Whether northings count from 10,000 km south of the equator.
    pub south: bool,
}

/// A projected place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Easting and northing, metres.
    pub at: Point,
    /// Direction of the grid's north, radians clockwise from true north.
    pub convergence_rad: f64,
}

impl Zone {
    /// The zone that a place on the globe (degrees) lies in.
    pub fn of(lat_deg: f64, lon_deg: f64) -> Self {
        // 180 degrees east is 180 degrees west, the first zone's edge.
        let number = floor((lon_deg + 180.0) / 6.0).rem_euclid(60.0) as u8 + 1;
        Self { number, south: lat_deg < 0.0 }
    }

    /// Projects any place into this zone's grid; `None` if it is off the globe or too far from the
    /// zone.
    pub fn project(self, lat_deg: f64, lon_deg: f64) -> Option<Projected> {
        let meridian_deg = 6.0 * f64::from(self.number) - 183.0;
        // Wrapped to -180 to 180 degrees.
        let east_deg = (lon_deg - meridian_deg + 540.0).rem_euclid(360.0) - 180.0;
        if !(lat_deg.abs() < 90.0 && east_deg.abs() <= MAX_FROM_MERIDIAN_DEG) {
            return None;
        }
        let false_northing = if self.south { FALSE_NORTHING_SOUTH_M } else { 0.0 };
        let (east, north, convergence_rad) =
            transverse_mercator(lat_deg.to_radians(), east_deg.to_radians());
        Some(Projected {
            at: [
                FALSE_EASTING_M + SCALE_ON_MERIDIAN * east,
                false_northing + SCALE_ON_MERIDIAN * north,
            ],
            convergence_rad,
        })
    }
}

/// Easting and northing in metres at scale 1, and the convergence, of a place `lat`, `lon`
/// radians from the equator and the central meridian.
fn transverse_mercator(lat: f64, lon: f64) -> (f64, f64, f64) {
    let e2 = ECCENTRICITY_SQUARED;
    let e = sqrt(e2);
    // n = (a - b) / (a + b), from e^2 = 1 - (b / a)^2.
    let axes = sqrt(1.0 - e2);
    let n = (1.0 - axes) / (1.0 + axes);
    let (n2, n3, n4) = (n * n, n * n * n, n * n * n * n);
    let rectifying_radius = SEMI_MAJOR_M / (1.0 + n) * (1.0 + n2 / 4.0 + n4 / 64.0);
    let alpha = [
        n / 2.0 - 2.0 / 3.0 * n2 + 5.0 / 16.0 * n3 + 41.0 / 180.0 * n4,
        13.0 / 48.0 * n2 - 3.0 / 5.0 * n3 + 557.0 / 1440.0 * n4,
        61.0 / 240.0 * n3 - 103.0 / 140.0 * n4,
        49_561.0 / 161_280.0 * n4,
    ];

    // Tangents of the geographic and of the conformal latitude.
    let tau = tan(lat);
    let secant = hypot(1.0, tau);
    let sigma = sinh(e * atanh(e * tau / secant));
    let tau_c = tau * hypot(1.0, sigma) - sigma * secant;

    // On the sphere, then from the sphere to the ellipsoid.
    let xi = atan2(tau_c, cos(lon));
    let eta = asinh(sin(lon) / hypot(tau_c, cos(lon)));
    let (mut north, mut east, mut p, mut q) = (xi, eta, 1.0, 0.0);
    for (k, a) in (1..).map(|j| 2.0 * f64::from(j)).zip(alpha) {
        north += a * sin(k * xi) * cosh(k * eta);
        east += a * cos(k * xi) * sinh(k * eta);
        p += k * a * cos(k * xi) * cosh(k * eta);
        q += k * a * sin(k * xi) * sinh(k * eta);
    }
    let on_sphere = atan2(tau_c * tan(lon), hypot(1.0, tau_c));
    (rectifying_radius * east, rectifying_radius * north, on_sphere + atan2(q, p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zone_follows_the_longitude() {
        for (lon, number) in
            [(-180.0, 1), (-177.0, 1), (-84.4, 16), (-0.1, 30), (0.0, 31), (86.0, 45), (180.0, 1)]
        {
            assert_eq!(Zone::of(10.0, lon).number, number, "{lon}");
        }
        assert!(Zone::of(-1.0, 0.0).south && !Zone::of(0.0, 0.0).south);
    }

    #[test]
    fn places_project_to_published_coordinates() {
        // On a central meridian the northing is 0.9996 of the meridian arc; a quarter of that
        // arc is 10,001,965.7293 m. The first place is the example of GeographicLib's GeoConvert.
        for (zone, lat, lon, east, north, tolerance) in [
            (38, 33.3, 44.4, 444_140.54, 3_684_706.36, 0.006),
            (31, 0.0, 3.0, 500_000.0, 0.0, 1e-6),
            (31, 89.999_999_999, 3.0, 500_000.0, 0.9996 * 10_001_965.729_3, 1e-3),
        ] {
            let got = Zone { number: zone, south: false }.project(lat, lon).unwrap().at;
            assert!((got[0] - east).abs() < tolerance, "{got:?}");
            assert!((got[1] - north).abs() < tolerance, "{got:?}");
        }
    }

    #[test]
    fn the_convergence_is_the_direction_of_true_north_on_the_grid() {
        for (lat, lon) in [(33.3, 44.4), (60.0, 47.9), (-45.0, 42.1), (10.0, 50.0), (0.0, 46.0)] {
            let zone = Zone { number: 38, south: lat < 0.0 };
            let here = zone.project(lat, lon).unwrap();
            let north = zone.project(lat + 1e-5, lon).unwrap().at;
            let d = [north[0] - here.at[0], north[1] - here.at[1]];
            // True north lies to the left of the grid's where the convergence is positive.
            let expected = atan2(-d[0], d[1]);
            assert!((here.convergence_rad - expected).abs() < 1e-6, "{lat} {lon} {here:?}");
        }
    }

    #[test]
    fn short_distances_on_the_grid_are_true_times_the_scale() {
        // The scale k of a transverse Mercator at easting E is 0.9996 (1 + (E / R)^2 / 2).
        let (lat, lon) = (34.9999, 85.9999);
        let zone = Zone::of(lat, lon);
        let a = zone.project(lat, lon).unwrap().at;
        let b = zone.project(35.0, 86.0).unwrap().at;
        let [east, north] = math::geodetic::offset_m([lat, lon], [35.0, 86.0]);
        let grid = hypot(b[0] - a[0], b[1] - a[1]);
        let offset = (a[0] - FALSE_EASTING_M) / 6.37e6;
        let scale = SCALE_ON_MERIDIAN * (1.0 + offset * offset / 2.0);
        assert!((grid - scale * hypot(east, north)).abs() < 1e-4, "{grid}");
    }

    #[test]
    fn a_place_of_the_next_zone_continues_the_grid() {
        let zone = Zone::of(50.0, 5.999_999);
        let a = zone.project(50.0, 5.999_999).unwrap().at;
        let b = zone.project(50.0, 6.000_001).unwrap().at;
        assert!((hypot(b[0] - a[0], b[1] - a[1]) - 0.143).abs() < 0.001);
        // And across the equator and the date line.
        let zone = Zone { number: 60, south: true };
        let a = zone.project(-1e-6, 179.999_999).unwrap().at;
        let b = zone.project(1e-6, -179.999_999).unwrap().at;
        assert!(hypot(b[0] - a[0], b[1] - a[1]) < 0.4);
    }

    #[test]
    fn far_places_are_refused() {
        let zone = Zone { number: 31, south: false };
        for (lat, lon) in [(90.0, 0.0), (0.0, 100.0), (f64::NAN, 0.0), (0.0, f64::INFINITY)] {
            assert_eq!(zone.project(lat, lon), None);
        }
    }
}
