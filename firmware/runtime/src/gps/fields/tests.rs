extern crate std;

use super::*;
use std::string::String;

fn angle(field: &str, degree_digits: usize) -> Option<i32> {
    angle_e7(field.as_bytes(), degree_digits, if degree_digits == 2 { 90 } else { 180 })
}

#[test]
fn angles_are_degrees_of_fixed_length_and_minutes() {
    for (field, digits, expected) in [
        ("0000.0000", 2, Some(0)),
        ("3346.53708", 2, Some(337_756_180)),
        ("08423.77980", 3, Some(843_963_300)),
        // A whole number of minutes: with a point, without one, and with surplus decimals.
        ("3330", 2, Some(335_000_000)),
        ("3330.", 2, Some(335_000_000)),
        ("3330.000000000000000000", 2, Some(335_000_000)),
        ("3346.537080000000000009", 2, Some(337_756_180)),
        // Half a unit or more is rounded up, less is not.
        ("0000.0000030", 2, Some(1)),
        ("0000.0000029", 2, Some(0)),
        // The receiver rounded up to the next degree.
        ("3360.00000", 2, Some(340_000_000)),
        ("17960.0000", 3, Some(1_800_000_000)),
        ("3360.00001", 2, None),
        ("3361.0", 2, None),
        ("9100.0", 2, None),
        ("18100.0", 3, None),
        // Missing or surplus digits.
        ("1026.6634", 3, None),
        ("026.6634", 2, None),
        ("03346.53708", 2, None),
        ("008423.77980", 3, None),
        ("", 2, None),
        (".5", 2, None),
        ("33", 2, None),
        ("33-6.5", 2, None),
        ("+346.5", 2, None),
        ("3346.5-", 2, None),
        ("3346.5.5", 2, None),
        ("33 6.5", 2, None),
        ("33nan", 2, None),
    ] {
        assert_eq!(angle(field, digits), expected, "{field}");
    }
}

/// Every angle on the globe is the same after a receiver has written it with seven decimals.
#[test]
fn angles_come_back_as_they_were_written() {
    for e7 in (0..=1_800_000_000).step_by(999_983) {
        let (degrees, rest) = (e7 / 10_000_000, e7 % 10_000_000);
        let minutes_e7 = u64::from(rest as u32) * 60;
        let (minutes, decimals) = (minutes_e7 / 10_000_000, minutes_e7 % 10_000_000);
        let field = std::format!("{degrees:03}{minutes:02}.{decimals:07}");
        assert_eq!(angle(&field, 3), Some(e7), "{field}");
    }
}

#[test]
fn halves_of_the_globe_are_named_and_places_lie_on_it() {
    let of = |lat: &str, n: &str, lon: &str, e: &str| {
        place(lat.as_bytes(), n.as_bytes(), lon.as_bytes(), e.as_bytes())
            .map(|place| (place.lat_e7, place.lon_e7))
    };
    assert_eq!(of("3330.0", "S", "01030.0", "W"), Some((-335_000_000, -105_000_000)));
    assert_eq!(of("3330.0", "N", "01030.0", "E"), Some((335_000_000, 105_000_000)));
    for (n, e) in [("", "E"), ("N", ""), ("E", "N"), ("n", "E"), ("NN", "E"), ("W", "S")] {
        assert_eq!(of("3330.0", n, "01030.0", e), None, "{n} {e}");
    }
    assert_eq!(of("9060.0", "N", "01030.0", "E"), None);
    assert_eq!(of("9000.1", "N", "01030.0", "E"), None);
    assert_eq!(of("3330.0", "N", "18000.1", "E"), None);
}

#[test]
fn times_are_six_digits_and_any_decimals() {
    for (field, expected) in [
        ("000000", Some(0)),
        ("101010.00", Some(36_610_000)),
        ("101010.1", Some(36_610_100)),
        ("101010.1234567", Some(36_610_123)),
        ("235959.999", Some(86_399_999)),
        // A leap second.
        ("235960.50", Some(86_400_500)),
        ("235961", None),
        ("240000", None),
        ("106000", None),
        ("10101", None),
        ("1010100", None),
        ("", None),
        ("10101a", None),
        ("101010.a", None),
        ("-10101", None),
    ] {
        assert_eq!(milliseconds(field.as_bytes()), expected, "{field}");
    }
}

#[test]
fn numbers_are_cut_off_at_thousandths() {
    for (field, expected) in [
        ("0", Some(0)),
        ("0.9", Some(900)),
        (".94", Some(940)),
        ("12.", Some(12_000)),
        ("000.0009", Some(0)),
        ("999999.999", Some(999_999_999)),
        ("1000000", None),
        ("", None),
        (".", None),
        ("-1", None),
        ("1e3", None),
        ("inf", None),
        ("1.2.3", None),
    ] {
        assert_eq!(thousandths(field.as_bytes()), expected, "{field}");
    }
}

#[test]
fn speed_and_course_become_a_velocity() {
    let of = |speed: &str, course: &str| velocity_mmps(speed.as_bytes(), course.as_bytes());
    assert_eq!(of("0.000", ""), Some([0, 0]));
    assert_eq!(of("0.1", ""), None, "it moves in an unknown direction");
    assert_eq!(of("", "90.0"), None);
    assert_eq!(of("1900.001", "90.0"), None);
    assert_eq!(of("1.0", "360.001"), None);
    assert_eq!(of("-1.0", "90.0"), None);
    for (course, east, north) in [
        ("0", 0, 1_000),
        ("90.0", 1_000, 0),
        ("180", 0, -1_000),
        ("270.00", -1_000, 0),
        ("360", 0, 1_000),
    ] {
        let [e, n] = of("1.944", course).expect("a velocity");
        assert!((e - east).abs() <= 3 && (n - north).abs() <= 3, "{course}: {e} {n}");
    }
}

/// The kind of a sentence.
fn kind(body: &str) -> &'static str {
    match parse(body.as_bytes()) {
        Some(Sentence::Gga(Gga { has_fix, .. })) => {
            if has_fix {
                "fix"
            } else {
                "no fix"
            }
        }
        Some(Sentence::Rmc(Rmc { is_valid, .. })) => {
            if is_valid {
                "valid"
            } else {
                "void"
            }
        }
        None => "-",
    }
}

#[test]
fn any_two_letters_are_a_talker_but_garmins() {
    let two = |a: u8, b: u8| String::from_utf8(std::vec![a, b]).expect("ASCII");
    for talker in (b'A'..=b'Z').flat_map(|a| (b'A'..=b'Z').map(move |b| two(a, b))) {
        let rmc = kind(&std::format!("{talker}RMC,101010,A,3346.5,N,08423.7,W,0,0,010125,,,A"));
        assert_eq!(rmc, if talker == "PG" { "-" } else { "valid" }, "{talker}");
    }
    for body in
        ["PUBX,00,101010", "PMTK001,314,3", "gpRMC,", "G1RMC,", "GPRMC", "RMC,", "", "GNGNS,101010"]
    {
        assert_eq!(kind(body), "-", "{body}");
    }
}

#[test]
fn a_gga_without_fix_needs_nothing_more_and_one_with_a_fix_needs_all() {
    for (body, expected) in [
        ("GNGGA,101010.00,3346.5,N,08423.7,W,1,12,0.9,45.0,M,46.9,M,,", "fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,1,12,0.9", "fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,1,many,0.9,,,,,1.0,ATLANTA-REFERENCE-1", "fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,1,,0.9,45.0,M,46.9,M,,,,,,", "fix"),
        ("GNGGA,101010.00, 3346.5 ,N,08423.7,W,1 ,12,0.9", "fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,1,12,,45.0,M,46.9,M,,", "no fix"),
        ("GNGGA,,,,,,0,00,99.99,,,,,,", "no fix"),
        ("GNGGA,,,,,,,,,,,,,,", "no fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,,12,0.9,45.0,M,46.9,M,,", "no fix"),
        ("GNGGA,101010.00,3346.5,N,08423.7,W,11,12,0.9,45.0,M,46.9,M,,", "no fix"),
        ("GNGGA,,3346.5,N,08423.7,W,1,12,0.9,45.0,M,46.9,M,,", "-"),
        ("GNGGA,101010.00,3346.5,N,8423.7,W,1,12,0.9,45.0,M,46.9,M,,", "-"),
        ("GNGGA,101010.00,3346.5,,08423.7,W,1,12,0.9,45.0,M,46.9,M,,", "-"),
        // A lost piece; the checksum happens to be right.
        ("GPGGA,201019.00,3249.20458,N,1,-25.6,M,,", "no fix"),
    ] {
        assert_eq!(kind(body), expected, "{body}");
    }
}

#[test]
fn an_rmc_is_valid_only_if_it_says_so_clearly() {
    let with = |status: &str, place: &str, tail: &str| {
        kind(&std::format!("GNRMC,101010.00,{status},{place},1.9,90.0{tail}"))
    };
    const PLACE: &str = "3346.5,N,08423.7,W";
    for status in ["A", "D"] {
        for tail in ["", ",", ",010125", ",000000,,", ",,,,A", ",010125,3.1,,A", ",010125,,W,A"] {
            assert_eq!(with(status, PLACE, tail), "valid", "{status}{tail}");
        }
        for mode in ["", "A", "D", "P", "R", "F", "A,V", "R,S", "A,C", "A,"] {
            let tail = std::format!(",010125,,,{mode}");
            assert_eq!(with(status, PLACE, &tail), "valid", "{status} {mode}");
        }
        for mode in ["N", "E", "M", "S", "X", "V", "AA", "N,V"] {
            let tail = std::format!(",010125,,,{mode}");
            assert_eq!(with(status, PLACE, &tail), "void", "{status} {mode}");
        }
        assert_eq!(with(status, ",,,", ",010125,,,A"), "void", "{status} without a place");
    }
    for status in ["V", "", "a", "N", "AV", "1"] {
        for (place, mode) in [(PLACE, "A"), (PLACE, "N"), (PLACE, ""), (",,,", "N"), (",,,", "A")] {
            let tail = std::format!(",010125,,,{mode}");
            assert_eq!(with(status, place, &tail), "void", "{status} {place} {mode}");
        }
    }
    for body in ["GPRMC,,V", "GPRMC,", "GPRMC,,,,,,,,,,,,", "GPRMC,181536.000,A,5936.79K,D"] {
        assert_eq!(kind(body), "void", "{body}");
    }
}

#[test]
fn accuracy_follows_quality_and_hdop() {
    for (quality, mm) in
        [("1", 3_600), ("2", 1_800), ("3", 3_600), ("4", 45), ("5", 450), ("9", 3_600)]
    {
        // Some makers pad the number with zeros.
        for quality in [String::from(quality), std::format!("0{quality}")] {
            let body = std::format!("GNGGA,101010.00,3346.5,N,08423.7,W,{quality},12,0.9");
            let Some(Sentence::Gga(gga)) = parse(body.as_bytes()) else { panic!("{body}") };
            assert_eq!((gga.has_fix, gga.accuracy_mm), (true, mm), "{quality}");
        }
    }
    for quality in ["00", "06", "08", "10", "-1", "1.0", "0x1", "+1", "1000001"] {
        let body = std::format!("GNGGA,101010.00,3346.5,N,08423.7,W,{quality},12,0.9");
        assert_eq!(kind(&body), "no fix", "{quality}");
    }
}
