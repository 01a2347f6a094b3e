//! Sentences in, solutions out: a case for each kind of receiver output.
//!
//! Each case follows a receiver or a report of one. `gnss_logs.rs` has files from third parties,
//! `gps_streams.rs` tests cuts and garbage.

use math::GeoPoint;
use proptest::prelude::*;
use runtime::gps::{Decoder, Solution};
use sim::receiver::{sentence, ubx};

/// One place, as NMEA and as 1e-7 degrees.
const PLACE: &str = "3346.53708,N,08423.77980,W";
const AT: GeoPoint = GeoPoint { lat_e7: 337_756_180, lon_e7: -843_963_300 };

/// Sentences of one epoch, their bodies separated by spaces; `@` stands for the time, `#` for the
/// place.
const GOOD_RMC: &str = "GNRMC,@,A,#,1.944,90.0,010125,,,A";
const GOOD_GGA: &str = "GNGGA,@,#,1,12,0.9,45.0,M,46.9,M,,";
const VOID_RMC: &str = "GNRMC,@,V,#,1.944,90.0,010125,,,A";
const GOOD: &str = "GNRMC,@,A,#,1.944,90.0,010125,,,A GNGGA,@,#,1,12,0.9,45.0,M,46.9,M,,";
const GOOD_GGA_FIRST: &str = "GNGGA,@,#,1,12,0.9,45.0,M,46.9,M,, GNRMC,@,A,#,1.944,90.0,010125,,,A";

/// The bytes of the epochs, `step_ms` apart, from 10:10:00.
fn stream<'a>(epochs: impl IntoIterator<Item = &'a str>, step_ms: u32) -> String {
    let mut text = String::new();
    for (index, epoch) in (0..).zip(epochs) {
        let ms = index * step_ms;
        let time = format!("10{:02}{:02}.{:02}", 10 + ms / 60_000, ms / 1_000 % 60, ms / 10 % 100);
        let bodies = epoch.replace('@', &time).replace('#', PLACE);
        text.extend(bodies.split_whitespace().map(sentence));
    }
    text
}

fn decode(bytes: impl AsRef<[u8]>) -> Vec<Solution> {
    let mut decoder = Decoder::default();
    bytes.as_ref().iter().filter_map(|&byte| decoder.push(byte)).collect()
}

/// Number of valid solutions, and of those with velocity. Every valid solution must be at `AT`.
fn count(bytes: impl AsRef<[u8]>) -> (usize, usize) {
    let mut solutions = decode(bytes);
    solutions.retain(|solution| solution.is_valid);
    assert!(solutions.iter().all(|solution| solution.place == AT), "{solutions:?}");
    let moving = solutions.iter().filter(|solution| solution.velocity_mmps.is_some());
    (solutions.len(), moving.count())
}

/// Checks ten epochs of one kind, a second apart, without and after noise.
fn check(name: &str, epoch: &str, expected: (usize, usize)) {
    let text = stream([epoch; 10], 1_000);
    assert_eq!(count(&text), expected, "{name}\n{text}");
    let noise = b"\xb5\x62\x01\x07\x5c\0\xff$GNRMC,1010$PUBX\r\n*00,V,";
    assert_eq!(count([noise, text.as_bytes()].concat()), expected, "{name}, after noise");
}

#[test]
fn fields_that_the_robot_does_not_use_are_skipped() {
    let rmc = |tail: &str| format!("GNRMC,@,A,#,1.944,90.0,{tail} {GOOD_GGA}");
    for tail in [
        // Without a mode, with an empty one, and with those of ever better corrections.
        "010125,,",
        "010125,,,",
        "010125,,,A",
        "010125,,,D",
        "010125,,,P",
        "010125,,,R",
        "010125,,,F",
        // With the nav status of version 4.1: V if the receiver is not for ships.
        "010125,,,A,V",
        "010125,,,R,S",
        "010125,,,D,C",
        // Without a date, with an impossible one, with a month but no year.
        ",,,A",
        "000000,,,A",
        "999999,,,A",
        "0101,,,A",
        // A variation without a side, a side without a variation, both, and nonsense.
        "010125,3.1,,A",
        "010125,,E,A",
        "010125,3.1,W,A",
        "010125,x,y,A",
        // Surplus fields.
        "010125,,,A,V,,,,,,,,,,",
    ] {
        check(tail, &rmc(tail), (10, 10));
    }
    let gga = |tail: &str| format!("{GOOD_RMC} GNGGA,@,#,{tail}");
    for tail in [
        "1,12,0.9,45.0,M,46.9,M,,",
        "1,,0.9,45.0,M,46.9,M,,",
        "1,xx,0.9,45.0,M,46.9,M,,",
        "1,-1,0.9,45.0,M,46.9,M,,",
        "1,300,0.9,45.0,M,46.9,M,,",
        "1,12,0.9,,,,,,",
        "1,12,0.9,-999999.9,M,x,,,",
        "1,12,0.9",
        "1,12,0.9,45.0,M,46.9,M,,,,,,,,",
        // A reference station with a number, a name, and a long name.
        "2,12,0.9,45.0,M,46.9,M,1.0,0123",
        "2,12,0.9,45.0,M,46.9,M,1.0,RTCM",
        "2,12,0.9,45.0,M,46.9,M,1.0,A-STATION-WITH-A-VERY-LONG-NAME-INDEED-OF-SOME-NETWORK",
    ] {
        check(tail, &gga(tail), (10, 10));
    }
}

#[test]
fn any_talker_is_heard() {
    for talker in "GP GN GL GA GB GQ GI BD QZ II IN YD EC LC PQ".split(' ') {
        check(talker, &GOOD.replace("GN", talker), (10, 10));
        check(talker, &GOOD_GGA_FIRST.replace("GN", talker), (10, 10));
    }
    // Two talkers: some receivers keep their constellations apart.
    check("two", &GOOD.replace("GNGGA", "GPGGA"), (10, 10));
}

#[test]
fn a_second_talker_without_a_fix_removes_nothing() {
    let without = "GLGGA,@,#,0,00,99.99,,M,,M,,";
    let nowhere = "GLGGA,@,,,,,0,00,,,M,,M,,";
    for second in [without, nowhere, "GLGGA,@,#,6,12,0.9,45.0,M,46.9,M,,"] {
        check("after", &format!("{GOOD} {second}"), (10, 10));
        check("between", &format!("{GOOD_RMC} {second} {GOOD_GGA}"), (10, 10));
        check("before", &format!("{second} {GOOD}"), (10, 10));
        check("GGA first", &format!("{second} {GOOD_GGA_FIRST}"), (10, 10));
        check("GGA first", &format!("{GOOD_GGA} {second} {GOOD_RMC}"), (10, 10));
    }
    // The latest solution counts, so the second talker must give none after it.
    for second in [without, nowhere, "GLGGA,,,,,,0,00,99.99,,,,,,"] {
        let solutions = decode(stream([format!("{GOOD} {second}").as_str(); 10], 1_000));
        assert!(solutions.iter().all(|solution| solution.is_valid), "{second}: {solutions:?}");
        assert_eq!(solutions.len(), 10, "{second}");
    }
    // The first talker itself may lose its fix.
    let lost = decode(stream([GOOD, "GNGGA,,,,,,0,00,99.99,,,,,,"], 1_000));
    assert_eq!(lost.iter().map(|solution| solution.is_valid).collect::<Vec<_>>(), [true, false]);
    // A second talker with a fix does not give a second solution.
    let elsewhere = GOOD_GGA.replace("GN", "GL").replace('#', "3346.54000,N,08423.77980,W");
    check("a second fix", &format!("{GOOD} {elsewhere}"), (10, 10));
    check("a second RMC", &format!("{GOOD} {}", GOOD_RMC.replace("GN", "GL")), (10, 10));
}

#[test]
fn proprietary_sentences_are_skipped() {
    for own in [
        "PUBX,00,101010.00,3346.53708,N,08423.77980,W,45.0,G3,2.0,3.0,0.0,0.0,0.0,,0.9,1.2,1.0,12,0,0",
        "PMTK001,314,3",
        // Garmin's set-up of its sensors: as an RMC, its first fields would be void.
        "PGRMC,A,218.8,100,6378137.000,298.257223563,0.0,0.0,0.0,A,3,1,1,4,30",
    ] {
        let own = own.replace(' ', "");
        check(&own, &format!("{own} {GOOD_RMC} {own} {GOOD_GGA} {own}"), (10, 10));
    }
}

#[test]
fn a_void_rmc_outranks_all_other_fields() {
    for status in ["V", "", "N", "a", "X"] {
        for place in ["#", ",,,"] {
            for mode in ["", ",", ",A", ",N", ",D", ",R", ",A,V"] {
                for time in ["@", ""] {
                    let rmc = format!("GNRMC,{time},{status},{place},1.944,90.0,010125,,{mode}");
                    check(&rmc, &format!("{rmc} {GOOD_GGA}"), (0, 0));
                    check(&rmc, &format!("{GOOD_GGA} {rmc}"), (0, 0));
                }
            }
        }
    }
    // Valid by status but not by mode: no fix, estimated, by hand, simulated, unknown.
    for mode in ["N", "E", "M", "S", "X"] {
        let rmc = format!("GNRMC,@,A,#,1.944,90.0,010125,,,{mode}");
        check(mode, &format!("{rmc} {GOOD_GGA}"), (0, 0));
        check(mode, &format!("{GOOD_GGA} {rmc}"), (0, 0));
    }
    // Two talkers that disagree within an epoch.
    let valid = GOOD_RMC.replace("GN", "GP");
    check("void first", &format!("{VOID_RMC} {valid} {GOOD_GGA}"), (0, 0));
    check("void after", &format!("{valid} {VOID_RMC} {GOOD_GGA}"), (0, 0));
    check("cut off", &format!("GNRMC,@,V {GOOD_GGA}"), (0, 0));
    check("not clear", &format!("GPRMC,@,A,3346.53K,D {GOOD_GGA}"), (0, 0));
}

/// Epochs as letters: `g` valid, `v` void with RMC first, `w` void with GGA first, `a` GGA
/// alone, `n` void after its GGA and without a time.
fn epochs(letters: &str) -> Vec<String> {
    let epoch = |letter| match letter {
        'g' => GOOD.to_owned(),
        'v' => format!("{VOID_RMC} {GOOD_GGA}"),
        'w' => format!("{GOOD_GGA} {VOID_RMC}"),
        'a' => GOOD_GGA.to_owned(),
        'n' => format!("{GOOD_GGA} {}", VOID_RMC.replace('@', "")),
        _ => unreachable!("no such epoch"),
    };
    letters.chars().map(epoch).collect()
}

#[test]
fn void_lasts_until_an_rmc_is_valid_again() {
    for (letters, expected) in [
        ("gggvvv", (3, 3)),
        ("vvvggg", (3, 3)),
        ("gvgvgv", (3, 3)),
        ("gwgwgw", (3, 3)),
        ("gnng", (2, 2)),
        // After a void RMC no GGA alone counts, however long RMC is missing.
        ("gggvaaaaaaaaaa", (3, 3)),
        ("vaaaaaaaaaaaaaaaa", (0, 0)),
        ("naaaaaaaaaaaaaaaa", (0, 0)),
        ("waaaaaaaaaaaaaaag", (1, 1)),
        // GGA alone counts until an RMC is void.
        ("aaaaavaaaaaa", (3, 0)),
        ("aaaaavaaaaaag", (4, 1)),
    ] {
        let epochs = epochs(letters);
        let text = stream(epochs.iter().map(String::as_str), 1_000);
        assert_eq!(count(&text), expected, "{letters}");
    }
}

#[test]
fn gga_faster_than_rmc_counts_and_has_velocity_where_rmc_is_fresh() {
    // Ten, five and two GGA per RMC, either first; ten seconds.
    for every in [10, 5, 2] {
        for both in [GOOD, GOOD_GGA_FIRST] {
            let epochs = (0..10 * every).map(|i| if i % every == 0 { both } else { GOOD_GGA });
            let (valid, moving) = count(stream(epochs, 1_000 / every));
            let sent = 10 * every as usize;
            assert!(valid + 3 >= sent && valid <= sent + 10, "{valid} of {sent}");
            assert_eq!(moving, 10, "{every}");
        }
        // Void at the slow rate: nothing counts after that.
        let epochs = (0..10 * every).map(|i| match i % every {
            0 if i >= 5 * every => "GNRMC,@,V,#,1.944,90.0,010125,,,N GNGGA,@,#,1,12,0.9",
            0 => GOOD,
            _ => GOOD_GGA,
        });
        let (valid, moving) = count(stream(epochs, 1_000 / every));
        assert!(valid <= 5 * every as usize && moving == 5, "{every}: {valid}, {moving}");
    }
}

#[test]
fn rmc_that_is_faster_than_gga_is_as_good() {
    let epochs = (0..100).map(|i| if i % 10 == 0 { GOOD } else { GOOD_RMC });
    assert_eq!(count(stream(epochs, 100)), (10, 10));
    let epochs = (0..100).map(|i| match i {
        // Void in between, valid again, and void at the end.
        45 | 95.. => VOID_RMC,
        _ if i % 10 == 0 => GOOD_GGA_FIRST,
        _ => GOOD_RMC,
    });
    let text = stream(epochs, 100);
    assert_eq!(count(&text), (10, 10));
    assert_eq!(count(text + &stream([GOOD_GGA], 1_000)), (10, 10), "the last RMC was void");
}

#[test]
fn whole_seconds_at_five_a_second_are_five_epochs() {
    for epoch in [GOOD, GOOD_GGA_FIRST] {
        let five = [epoch; 5].join(" ");
        check("whole seconds", &five, (50, 50));
    }
}

#[test]
fn coordinates_are_read_correctly_or_not_at_all() {
    for place in [
        "3346.53708,N,8423.77980,W",
        "346.53708,N,08423.77980,W",
        "03346.53708,N,08423.77980,W",
        "3346.53708,,08423.77980,W",
        "3346.53708,N,08423.77980,",
        "3346.53708,X,08423.77980,W",
        "3346.53708,N,08423.77980,w",
        "-3346.53708,N,08423.77980,W",
        "33.7756180,N,084.3963300,W",
        "3360.00001,N,08423.77980,W",
        ",,,",
    ] {
        check(place, &GOOD.replace('#', place), (0, 0));
        check(place, &GOOD_GGA.replace('#', place), (0, 0));
    }
    // Few and many decimals, and a minute that was rounded up to 60.
    for (place, lat_e7, lon_e7) in [
        ("3346.5,N,08423.7,W", 337_750_000, -843_950_000),
        ("3346,S,08423,E", -337_666_667, 843_833_333),
        ("3346.53708000000,N,08423.77980000000,W", AT.lat_e7, AT.lon_e7),
        ("3360.0000,N,08460.0000,W", 340_000_000, -850_000_000),
    ] {
        let solutions = decode(stream([&GOOD.replace('#', place)[..]; 3], 1_000));
        assert_eq!(solutions.len(), 3);
        let expected = GeoPoint { lat_e7, lon_e7 };
        assert!(solutions.iter().all(|s| s.is_valid && s.place == expected), "{solutions:?}");
    }
}

#[test]
fn a_leap_second_and_midnight_are_times_like_any_other() {
    let text: String = ["235958.00", "235959.00", "235960.00", "000000.00", "000001.00"]
        .iter()
        .map(|time| stream([&GOOD.replace('@', time)[..]], 1_000))
        .collect();
    assert_eq!(count(text), (5, 5));
}

#[test]
fn checksums_have_either_case_and_lines_any_end() {
    let text = stream([GOOD; 10], 1_000);
    let lower: String = text
        .lines()
        .map(|line| {
            let (body, sum) = line.split_once('*').expect("a checksum");
            format!("{body}*{}\r\n", sum.to_lowercase())
        })
        .collect();
    assert_ne!(lower, text);
    for text in [text, lower] {
        for end in ["\n", "\r", "\r\r\n", " \r\n", "   \n", "\t\r\n", "", "\0\r\n", ";\r\n"] {
            assert_eq!(count(text.replace("\r\n", end)), (10, 10), "{end:?}");
        }
    }
}

#[test]
fn a_sentence_without_a_right_checksum_is_refused() {
    let text = stream([GOOD; 10], 1_000);
    let bare: String =
        text.lines().map(|line| format!("{}\r\n", &line[..line.len() - 3])).collect();
    assert_eq!(decode(bare), []);
    for sum in ["*", "*G0", "*0", "* 6A"] {
        let bad: String = text
            .lines()
            .map(|line| format!("{}{sum}\r\n", line.split('*').next().expect("a body")))
            .collect();
        assert_eq!(decode(bad), [], "{sum}");
    }
}

/// NAV-PVT at `AT`, with or without a fix.
fn nav_pvt(is_ok: bool) -> Vec<u8> {
    let mut payload = [0; 92];
    payload[20..22].copy_from_slice(&[3, u8::from(is_ok)]);
    payload[24..28].copy_from_slice(&AT.lon_e7.to_le_bytes());
    payload[28..32].copy_from_slice(&AT.lat_e7.to_le_bytes());
    payload[40..44].copy_from_slice(&1_000_u32.to_le_bytes());
    ubx(1, 7, &payload)
}

/// The sources of the valid solutions, with the length of each uninterrupted series: a minute of
/// NMEA at 10 Hz, with a NAV-PVT every `pvt_every` epochs up to `pvt_until`.
fn sources(pvt_every: usize, pvt_until: usize) -> Vec<(&'static str, usize)> {
    let mut decoder = Decoder::default();
    let mut series: Vec<(&'static str, usize)> = Vec::new();
    let text = stream([GOOD; 600], 100);
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for (index, epoch) in lines.chunks(2).enumerate() {
        let is_due = index % pvt_every == pvt_every / 2 && index < pvt_until;
        let pvt = if is_due { nav_pvt(true) } else { Vec::new() };
        for byte in epoch.concat().into_bytes().into_iter().chain(pvt) {
            let Some(solution) = decoder.push(byte) else { continue };
            assert!(solution.is_valid);
            let source = if solution.accuracy_mm == 1_000 { "ubx" } else { "nmea" };
            match series.last_mut() {
                Some((last, count)) if *last == source => *count += 1,
                _ => series.push((source, 1)),
            }
        }
    }
    series
}

#[test]
fn nav_pvt_that_is_rarer_than_nmea_does_not_alternate_with_it() {
    assert_eq!(sources(10, 600), [("nmea", 6), ("ubx", 60)], "once a second");
    assert_eq!(sources(5, 600), [("nmea", 3), ("ubx", 120)], "twice a second");
    assert_eq!(sources(1, 600), [("nmea", 1), ("ubx", 600)], "as often");
    // Once in ten seconds is too rare: NMEA counts, except for the first NAV-PVT.
    let rare = sources(100, 600);
    assert_eq!(rare.len(), 3, "{rare:?}");
    assert_eq!((rare[1], rare[2].0), (("ubx", 1), "nmea"), "{rare:?}");
    // Switched off after half a minute.
    let off = sources(10, 300);
    assert_eq!(
        off.iter().map(|part| part.0).collect::<Vec<_>>(),
        ["nmea", "ubx", "nmea"],
        "{off:?}"
    );
    assert!(off[2].1 > 250, "{off:?}");
}

#[test]
fn nav_pvt_without_a_fix_is_not_overruled_by_nmea() {
    let mut bytes = nav_pvt(true);
    for second in 0..10 {
        let epoch = GOOD.replace('@', &format!("1010{second:02}.00"));
        bytes.extend(stream([&epoch[..]], 1_000).bytes());
        bytes.extend(nav_pvt(false));
    }
    assert_eq!(count(bytes), (1, 1));
}

/// An epoch from the tables above, or garbage.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    let text = |epoch: &str| stream([epoch], 1_000).into_bytes();
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..200),
        prop::collection::vec(
            prop_oneof![Just(b'$'), Just(b'*'), Just(b','), Just(0xb5), Just(0x62), Just(b'G')],
            0..60
        ),
        Just(text(GOOD)),
        Just(text(GOOD_GGA)),
        Just(text(VOID_RMC)),
        Just(nav_pvt(false)[..50].to_vec()),
        (0_usize..60).prop_map(move |cut| text(GOOD)[..cut].to_vec()),
    ]
}

proptest! {
    /// A good epoch of a later time is read after any bytes.
    #[test]
    fn a_good_epoch_is_read_after_any_bytes(pieces in prop::collection::vec(piece(), 0..20)) {
        let before = pieces.concat();
        let mut decoder = Decoder::default();
        let _ = before.iter().filter_map(|&byte| decoder.push(byte)).count();
        let after = stream([&GOOD.replace('@', "101112.00")[..]], 1_000);
        let solutions: Vec<Solution> =
            after.bytes().filter_map(|byte| decoder.push(byte)).collect();
        prop_assert_eq!(solutions.len(), 1);
        prop_assert!(solutions[0].is_valid && solutions[0].place == AT);
        prop_assert!(solutions[0].velocity_mmps.is_some());
    }

    /// Fields of any content never panic, and give no place but the sent one.
    #[test]
    fn fields_of_any_content_are_survived(
        fields in prop::collection::vec("[ -)+-~]{0,12}", 0..20),
        kind in prop_oneof![Just("GNGGA"), Just("GNRMC")],
    ) {
        let body = format!("{kind},{}", fields.join(","));
        let solutions = decode(stream([GOOD], 1_000) + &sentence(&body));
        prop_assert!(solutions.iter().filter(|s| s.is_valid).all(|s| s.place == AT));
    }
}
