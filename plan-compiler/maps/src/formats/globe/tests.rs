//! Places on the globe in, metres of a plane or an error out.

use super::*;

fn check(stated: Option<[Place; 2]>, drawn: &[Place], expected: &str) {
    let stated = stated.map(|[low, high]| Bounds::between(low, high).expect("bounds"));
    let got = match Plane::new(stated, drawn.iter().copied(), None) {
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
fn the_date_line_is_not_a_border() {
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
fn maps_unfit_for_a_robot_are_refused() {
    check(None, &[], "the file has no coordinates and no bounds");
    check(
        None,
        &[[51.0, 7.0], [0.0, 0.0]],
        "the map is 704 km x 5650 km, but a plan is valid up to 20 km from its centre",
    );
    for east in [7.0, -7.0, 180.0, -180.0] {
        check(
            Some([[-90.0, -180.0], [90.0, 180.0]]),
            &[[51.0, east]],
            "by the file's bounds the map is 40076 km x 19904 km, but a plan is valid up to 20 km from \
             its centre",
        );
    }
    assert_eq!(Bounds::between([51.0, 7.0], [50.0, 7.1]), None);
    assert_eq!(Bounds::between([51.0, 7.0], [91.0, 7.1]), None);
}

#[test]
fn empty_stated_bounds_are_reported() {
    let outside = "everything in the file lies outside its stated bounds";
    // Longitude and latitude swapped; then bounds of another area.
    check(Some([[7.0, 51.0], [7.001, 51.001]]), &[[51.0, 7.0]], outside);
    check(Some([[51.0, 7.0], [51.001, 7.001]]), &[[51.002, 7.0], [51.002, 7.001]], outside);
    check(
        Some([[0.0, 0.0], [1.0, 0.0001]]),
        &[[0.0, 0.0]],
        "by the file's bounds the map is 1 km x 111 km, but a plan is valid up to 20 \
         km from its centre",
    );
    let no_area = "the file's stated bounds have no area";
    check(Some([[51.0, 7.0], [51.0, 7.0]]), &[[51.0, 7.0]], no_area);
    check(Some([[51.0, 7.0], [51.1, 7.0]]), &[], no_area);
    // An area around the bounds has no corner within them.
    check(
        Some([[51.0, 7.0], [51.001, 7.002]]),
        &[[50.0, 6.0], [52.0, 8.0]],
        "510005000 70010000 -70.20,-55.62 + 140.39,111.25: -70267.12, -111303.91 70126.73, \
         111192.66",
    );
}

#[test]
fn the_stray_place_is_the_one_far_from_most() {
    let check = |places: &[Place], expected: &str| {
        let got = Stray::among(places).map(|stray| format!("{} {}", stray.index, stray.label()));
        assert_eq!(got.unwrap_or_default(), expected);
    };
    check(&[], "");
    let others = "far from the others, which lie about latitude 51, longitude 7";
    check(&[[51.0, 7.0], [51.0, 7.001], [0.0, 0.0]], &format!("2 {others}"));
    check(&[[0.0, 0.0], [51.0, 7.0], [51.001, 7.0]], &format!("0 {others}"));
    check(&[[51.0, 7.0], [15.0, 7.0], [51.0, 7.001]], &format!("1 {others}"));
    // Of two places either may be the stray one.
    check(
        &[[51.0, 7.0], [0.0, 0.0]],
        "0 either this or the part about latitude 0, longitude 0 is misplaced",
    );
    check(
        &[[0.0, 179.9], [0.0, -179.9], [0.0, 90.0]],
        "2 far from the others, which lie about latitude 0, longitude 179.9",
    );
}

#[test]
fn the_robot_and_the_map_agree_on_positions() {
    let places = [[51.48, -0.002], [51.4815, 0.001]];
    let plane = Plane::new(None, places.into_iter(), None).expect("a plane");
    let frame = MapFrame::new(plane.reference, [0.0; 2], 0.0);
    for place in places {
        let fix = GeoPoint::from_degrees(place[0], place[1]).expect("on the globe");
        let there = frame.to_local(fix).expect("near");
        let [x, y] = plane.metres(place);
        assert!((f64::from(there.x) - x).abs() < 0.01 && (f64::from(there.y) - y).abs() < 0.01);
    }
}

#[test]
fn an_origin_that_is_given_stays_where_it_is() {
    let origin = GeoPoint::from_degrees(51.0, 7.0);
    for places in [&[[51.0, 7.001]][..], &[[51.0, 7.001], [51.003, 7.02]]] {
        let plane = Plane::new(None, places.iter().copied(), origin).expect("a plane");
        assert_eq!(plane.metres([51.0, 7.0]), [0.0, 0.0]);
        assert_eq!(plane.map().reference.map(|there| there.place), origin);
    }
    let refusal = |place: Place| {
        let problem = Plane::new(None, [place].into_iter(), origin).expect_err("too far");
        format!("{}: {}", problem.message, problem.help.unwrap_or_default())
    };
    let far = "but a plan is valid up to 20 km: ";
    assert_eq!(
        refusal([51.3, 7.0]),
        format!(
            "the map reaches 34 km from its origin, {far}check the origin: latitude, then \
             longitude, near the map"
        )
    );
    assert!(refusal([7.0, 51.0]).ends_with("are swapped, in the origin or in the map"));
}

#[test]
fn maps_near_a_pole_are_refused() {
    check(
        Some([[84.9, 7.0], [84.901, 7.002]]),
        &[],
        "849005000 70010000 -9.93,-55.84 + 19.86,111.69:",
    );
    let refusal =
        |lat: f64| Plane::new(None, [[lat, 7.0]].into_iter(), None).expect_err("a pole").message;
    for lat in [85.1, 90.0, -89.0] {
        assert!(refusal(lat).starts_with(&format!("the map lies at latitude {lat}, but")));
    }
}

#[test]
fn several_bounds_merge() {
    let bounds = |low, high| Bounds::between(low, high).expect("bounds");
    let west = bounds([51.0, 7.0], [51.1, 7.1]);
    let east = bounds([51.05, 7.1], [51.2, 7.2]);
    let sides = west.and(east).sides().map(|side| (side * 1e6).round() / 1e6);
    assert_eq!(sides, [51.0, 7.0, 51.2, 7.2]);
    let across = bounds([0.0, 179.0], [1.0, 180.0]).and(bounds([0.0, -180.0], [1.0, -179.0]));
    assert_eq!(across.sides(), [0.0, 179.0, 1.0, -179.0]);
}

#[test]
fn swapped_coordinates_are_suspected_off_land() {
    let suspect = |lat: f64, lon: f64| {
        Bounds::around([[lat, lon]].into_iter()).is_some_and(|it| it.suspect().is_some())
    };
    // London, Bremen and New York, swapped and not.
    for [lat, lon] in [[51.48, 0.0], [53.1, 8.8], [40.7, -74.0]] {
        assert!(suspect(lon, lat) && !suspect(lat, lon), "{lat} {lon}");
    }
    // A survey in Antarctica or off Svalbard is suspected only if the swapped place is on land.
    assert!(!suspect(-77.8, 166.7) && !suspect(78.2, 15.6));
}
