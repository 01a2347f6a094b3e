//! GeoJSON and OpenStreetMap files of users that once failed, read by the built binary.
//!
//! The files lie beside the project. Each is compared with its line of a table. The readers' own
//! tests have similar files, drawn anew.

use super::inspected;
use crate::cli::Run;

/// A corner that is free in each of these maps; all are of about the same area.
const GOAL: &str = "g=-19,-11";

/// The result of a build: exit status, messages, and blocked cells of the first layer.
struct Built {
    status: i32,
    said: String,
    blocked: Option<u64>,
}

fn build(name: &str, bytes: &[u8], options: &str) -> Built {
    let run = Run::new(&[(name, bytes)]);
    let ended = run.run(&format!("build {name} --robot-radius 0 --goal {GOAL} {options}"), "");
    let blocked = (ended.status == 0)
        .then(|| inspected(&run)["plans"][0]["layers"][0]["blocked"].as_u64().expect("a count"));
    Built { status: ended.status, said: ended.err, blocked }
}

/// Whether a build matches one of the table's alternatives.
fn holds(built: &Built, alternative: &str) -> bool {
    // Which of the words are printed with --quiet is for the tests of the command line.
    let alternative = alternative.trim().trim_start_matches("quiet:");
    if alternative == "refused" {
        return built.status == 1;
    }
    if let Some(words) = alternative.strip_prefix("says=") {
        let mut words = words.trim_matches(['(', ')']).split('|');
        return words.any(|word| built.said.contains(word));
    }
    let range = alternative.strip_prefix("blocked=").expect("an alternative of the table");
    let number = |text: &str| text.parse::<u64>().expect("a number");
    let (low, high) = range.split_once("..").unwrap_or((range, range));
    built.blocked.is_some_and(|blocked| (number(low)..=number(high)).contains(&blocked))
}

#[test]
fn maps_that_failed_are_read_as_their_table_says() {
    let Some(folder) = it::real_data("field/maps") else { return };
    let table = std::fs::read_to_string(folder.join("expected.tsv")).expect("a table");
    let lines = table.lines().filter_map(|line| line.split_once('\t'));
    let mut count = 0;
    for (name, expected) in lines {
        if !name.starts_with("geojson_") && !name.starts_with("osm_") {
            continue;
        }
        let bytes = std::fs::read(folder.join(name)).expect("a map");
        let built = build(name, &bytes, "");
        let is_right = expected.split(" or ").any(|alternative| holds(&built, alternative));
        let Built { status, said, blocked } = built;
        assert!(is_right, "{name}: {expected}, but {status} {blocked:?}\n{said}");
        count += 1;
    }
    assert!(count >= 14, "{count} cases");
}

#[test]
fn a_file_cut_off_within_a_letter_is_an_error_with_its_place() {
    let Some(folder) = it::real_data("field/hostile") else { return };
    let bytes = std::fs::read(folder.join("panic-min.geojson")).expect("a file");
    let built = build("panic-min.geojson", &bytes, "");
    assert_eq!(built.status, 1);
    assert!(built.said.contains("panic-min.geojson:1:"), "{}", built.said);
}

/// A pond of 20 m by 12 m in a yard of 40 m by 24 m, and a fence across it with a gate.
const YARD: &str = r#"<osm version="0.6">
<bounds minlat="51.4777921" minlon="-0.0017879" maxlat="51.4780079" maxlon="-0.0012121"/>
<node id="1" lat="51.4778461" lon="-0.0016439"/>
<node id="2" lat="51.4778461" lon="-0.0013561"/>
<node id="3" lat="51.4779539" lon="-0.0013561"/>
<node id="4" lat="51.4779539" lon="-0.0016439"/>
<node id="5" lat="51.4777921" lon="-0.0017"/>
<node id="6" lat="51.4778200" lon="-0.0017"><tag k="barrier" v="gate"/><tag k="width" v="4"/></node>
<node id="7" lat="51.4780079" lon="-0.0017"/>
<way id="1"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/><tag k="natural" v="water"/></way>
<way id="2"><nd ref="5"/><nd ref="6"/><nd ref="7"/><tag k="barrier" v="fence"/></way>
</osm>
"#;

#[test]
fn what_blocks_is_for_the_user_to_say() {
    let blocked = |options: &str| {
        let built = build("yard.osm", YARD.as_bytes(), options);
        built.blocked.unwrap_or_else(|| panic!("{options}\n{}", built.said))
    };
    let all = blocked("");
    let fence = blocked("--free natural=water");
    let pond = blocked("--free barrier");
    assert!((240..=286).contains(&pond), "{pond}");
    assert!((24..=25).contains(&fence), "{fence}");
    assert_eq!(all, pond + fence);
    let open = blocked("--open-gates");
    assert!((3..=4).contains(&(all - open)), "{all} {open}");
    assert_eq!(blocked("--free barrier=gate"), open);
    assert_eq!(blocked("--free natural=water --block natural=water"), all);
    let vain = build("yard.osm", YARD.as_bytes(), "--block natural=watter");
    assert!(vain.said.contains("natural=watter matches nothing on the map"), "{}", vain.said);
    let ovl = "ORIGIN 0 0\nMISSION-AREA 40 24\nCONTROL MEASURES:\nPP a 1 1\n";
    let run = Run::new(&[("yard.ovl", ovl.as_bytes())]);
    let ended = run.run("build yard.ovl --block natural=water --origin 51,7", "");
    assert!(ended.err.contains("has no tags") && ended.err.contains("the origin has no effect"));
}

#[test]
fn a_mission_says_it_too_and_fixes_the_origin() {
    let mission = "free = [\"natural=water\"]\nopen_gates = true\norigin = [51.4779, -0.0015]\n\
                   [goals]\ng = [-19, -11]\n";
    let shed = YARD.replace("minlat=\"51.4777921\"", "minlat=\"51.4770000\"");
    let origin = |yard: &str| {
        let files = [("yard.osm", yard.as_bytes()), ("yard.mission.toml", mission.as_bytes())];
        let run = Run::new(&files);
        run.done("build yard.osm --robot-radius 0");
        run.done("verify plans.bin --map yard.osm --robot-radius 0");
        inspected(&run)["origin"].clone()
    };
    assert_eq!(origin(YARD), origin(&shed));
    assert_eq!(origin(YARD)["lat_deg"], 51.4779);
}

#[test]
fn packed_files_are_read_or_named() {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(YARD.as_bytes()).expect("memory");
    let packed = encoder.finish().expect("memory");
    let plain = build("yard.osm", YARD.as_bytes(), "");
    assert_eq!(build("yard.osm.gz", &packed, "").blocked, plain.blocked);
    let named = build("yard.osm.bz2", b"BZh91AY&SY", "");
    assert_eq!(named.status, 1);
    assert!(named.said.contains("compressed with bzip2") && named.said.contains("bunzip2"));
}
