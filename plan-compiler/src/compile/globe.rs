//! Goals given by latitude and longitude, and positions that look like latitude and longitude.

use crate::input::Input;
use maps::Point;
use maps::numbers::metres;
use maps::problem::Problem;
use math::geodetic::SEMI_MAJOR_M;
use math::scalar::wide;
use math::{GeoPoint, MapFrame};

/// The position of a place in the map, metres; otherwise what is wrong with it. `name` is the goal's,
/// for the message.
pub(super) fn position(input: &Input<'_>, name: &str, place: GeoPoint) -> Result<Point, Problem> {
    let Some(frame) = frame(input) else {
        let message = format!(
            "goal `{name}` is given by latitude and longitude, but the map has no place on the \
             globe"
        );
        return Err(Problem::error(message).help(format!(
            "give the goal in the map's metres: {name}=X,Y; or give the map a reference: \
             GLOBAL_REF_POINT in an overlay"
        )));
    };
    if let Some(at) = frame.to_local(place) {
        return Ok([f64::from(at.x), f64::from(at.y)]);
    }
    let away_km = distance_m(frame.reference(), place) / 1e3;
    let message = format!(
        "goal `{name}` at {} lies {} km away from the map",
        degrees(place),
        metres(wide::floor(away_km + 0.5))
    );
    let swapped = swapped(place).filter(|&place| frame.to_local(place).is_some());
    Err(Problem::error(message).help(match swapped {
        Some(right) => format!(
            "latitude and longitude look swapped: {name}=geo:{} lies in or near the map",
            uri(right)
        ),
        None => format!("the map lies at {}; latitude comes first", degrees(frame.reference())),
    }))
}

/// The goal that was probably meant by a position in metres: a place in or near the map, if the
/// position reads as its latitude and longitude (in either order).
pub(super) fn meant_as_degrees(input: &Input<'_>, at: Point) -> Option<String> {
    let frame = frame(input)?;
    let is_near = |place: &GeoPoint| frame.to_local(*place).is_some();
    let place = GeoPoint::from_degrees(at[0], at[1]).filter(is_near);
    let place = place.or_else(|| GeoPoint::from_degrees(at[1], at[0]).filter(is_near))?;
    Some(format!("geo:{}", uri(place)))
}

pub(super) fn frame(input: &Input<'_>) -> Option<MapFrame> {
    let reference = input.map.reference?;
    Some(MapFrame::new(reference.place, reference.at, reference.heading_rad))
}

fn swapped(place: GeoPoint) -> Option<GeoPoint> {
    GeoPoint::from_degrees(place.lon_deg(), place.lat_deg())
}

fn uri(place: GeoPoint) -> String {
    format!("{},{}", place.lat_deg(), place.lon_deg())
}

fn degrees(place: GeoPoint) -> String {
    format!("{}, {}", place.lat_deg(), place.lon_deg())
}

/// Along a great circle of a sphere, for a message.
fn distance_m(a: GeoPoint, b: GeoPoint) -> f64 {
    let [(a_lat, a_lon), (b_lat, b_lon)] =
        [a, b].map(|place| (place.lat_deg().to_radians(), place.lon_deg().to_radians()));
    let half = |angle: f64| {
        let sine = wide::sin(angle / 2.0);
        sine * sine
    };
    let chord = half(b_lat - a_lat) + wide::cos(a_lat) * wide::cos(b_lat) * half(b_lon - a_lon);
    let chord = chord.clamp(0.0, 1.0);
    2.0 * SEMI_MAJOR_M * wide::atan2(wide::sqrt(chord), wide::sqrt(1.0 - chord))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_an_atlas() {
        let place = |lat, lon| GeoPoint::from_degrees(lat, lon).unwrap();
        for (from, to, km) in [
            (place(51.5, -0.1), place(48.85, 2.35), 342.0),
            (place(51.5, -0.1), place(-0.1, 51.5), 7_580.0),
            (place(10.0, 20.0), place(10.0, 20.0), 0.0),
        ] {
            let said = distance_m(from, to) / 1e3;
            assert!((said - km).abs() <= 0.02 * km, "{said} {km}");
        }
    }
}
