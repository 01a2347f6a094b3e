//! Malicious input, and files that users take for a map.

use super::{Run, YARD};
use std::ffi::OsString;
use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Checks that a text has no control characters except line ends and tabs, and no characters that
/// change the direction of the text.
#[track_caller]
fn check_safe(text: &str) {
    let is_bad = |c: char| {
        c.is_control() && !matches!(c, '\n' | '\t')
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    assert!(!text.contains(is_bad), "{text:?}");
}

const EVIL: &str = "\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}";

#[test]
fn nothing_reaches_the_terminal_as_a_control() {
    // With comments, so that the share of control characters is below that of a binary file.
    let comments = "-- comment comment comment comment comment comment\n".repeat(40);
    let overlay = format!("{comments}{YARD}PP g{EVIL} 7 7\nFOO {EVIL}red 1 2\n");
    let run = Run::new(&[
        ("yard.ovl", overlay.as_bytes()),
        ("a.mission.toml", format!("\"{EVIL}\" = 1\nmap = \"{EVIL}\"\n").as_bytes()),
        ("good.ovl", YARD.as_bytes()),
        (
            "a.json",
            format!("{{\"type\": \"FeatureCollection\", \"features\": [{EVIL}]}}").as_bytes(),
        ),
        ("a.yaml", format!("image: \"{EVIL}\"\nresolution: 1\norigin: [{EVIL}]\n").as_bytes()),
    ]);
    for arguments in [
        "build|yard.ovl".to_owned(),
        "build|yard.ovl|--quiet".to_owned(),
        "build|a.mission.toml".to_owned(),
        "build|a.json".to_owned(),
        "build|a.yaml".to_owned(),
        format!("build|{EVIL}.ovl"),
        format!("build|good.ovl|--goal|a\u{202e}b=3,3|-o|{EVIL}.bin"),
        format!("inspect|{EVIL}.bin"),
        format!("verify|{EVIL}.bin"),
        format!("build|good.ovl|--goal|{EVIL}=3,3"),
        format!("build|good.ovl|--{EVIL}"),
        format!("{EVIL}|good.ovl"),
        format!("query|{EVIL}.bin|--layer|{EVIL}/b|--at|1,2"),
        format!("render|{EVIL}.bin|--layer|a/{EVIL}|-o|a.svg"),
        format!("build|good.ovl|-o|no/{EVIL}.bin"),
    ] {
        let ended = run.run(&arguments, "");
        check_safe(&ended.err);
        check_safe(&ended.out);
        assert!(!(ended.err.is_empty() && ended.out.is_empty()), "{arguments:?}");
    }
    let Some(folder) = it::real_data("field/hostile") else { return };
    let map = folder.join("terminal-escape.ovl").canonicalize().expect("a map");
    for quiet in ["", "--quiet|"] {
        let ended = run.run(&format!("{quiet}build|{}", map.display()), "");
        check_safe(&ended.err);
        assert!(ended.err.contains("␛]0;owned␇"), "{}", ended.err);
    }
}

#[test]
fn warnings_are_told_when_quiet_and_notes_are_not() {
    let run = Run::yard();
    let ended = run.run("build yard.ovl --quiet", "");
    // The plan `shed` lies in the zone without radio; the summary stays away.
    assert_eq!((ended.status, ended.err.contains('⚠')), (0, true), "{}", ended.err);
    assert!(!ended.err.contains("☞") && !ended.err.contains("bytes"), "{}", ended.err);
    let ended = run.run("build yard.ovl --quiet --goal gate=35,25", "");
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
}

/// Runs a command that must end within a time limit.
fn ends(command: &mut Command) -> (i32, String) {
    let limit = Duration::from_secs(60);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = child.stderr.take().unwrap();
    let reading = std::thread::spawn(move || {
        let mut err = String::new();
        std::io::Read::read_to_string(&mut errors, &mut err).map(|_| err)
    });
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if started.elapsed() > limit {
            child.kill().unwrap();
            panic!("{command:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    (status.code().expect("an exit status"), reading.join().unwrap().unwrap())
}

#[cfg(unix)]
#[test]
fn a_pipe_is_a_map_as_any_other() {
    let program = harness::setup::plan_compiler().unwrap();
    for (arguments, output) in [
        (&["build", "pipe.ovl", "-o"][..], "plans.bin"),
        (&["convert", "pipe.ovl", "-o"], "Iplan.dat"),
        (&["convert", "pipe.ovl", "-o"], "plans.bin"),
    ] {
        let run = Run::new(&[]);
        let pipe = run.path("pipe.ovl");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        // The writer opens it once, as `<(cat yard.ovl)` does.
        let feeding = std::thread::spawn(move || fs::write(pipe, YARD));
        let mut command = Command::new(&program);
        command.args(arguments).arg(output).current_dir(run.folder.path());
        let (status, err) = ends(&mut command);
        assert_eq!(status, 0, "{arguments:?} {err}");
        feeding.join().unwrap().unwrap();
        assert!(run.path(output).exists());
    }
    let run = Run::new(&[]);
    let ended = run.run("build /dev/stdin", YARD);
    assert_eq!(ended.status, 0, "{}", ended.err);
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_refused() {
    let program = harness::setup::plan_compiler().unwrap();
    let run = Run::new(&[("empty.ovl", b"")]);
    let socket = std::os::unix::net::UnixListener::bind(run.path("socket")).unwrap();
    for (input, words) in [
        (".", "is a directory"),
        ("empty.ovl", "is empty"),
        ("/dev/null", "is empty"),
        ("/dev/zero", "is larger than"),
        ("socket", "cannot read socket"),
        ("empty.ovl/deeper", "empty.ovl/deeper"),
    ] {
        let mut command = Command::new(&program);
        command.args(["build", input]).current_dir(run.folder.path());
        let (status, err) = ends(&mut command);
        assert_eq!(status, 1, "{input}: {err}");
        assert!(err.contains(words), "{input}: {err}");
    }
    drop(socket);
}

#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_leaves_the_json_whole() {
    use std::os::unix::ffi::OsStringExt;
    let run = Run::yard();
    let name = OsString::from_vec(b"pl\xff.bin".to_vec());
    let output = Command::new(harness::setup::plan_compiler().unwrap())
        .args(["build", "yard.ovl", "--json", "-o"])
        .arg(&name)
        .current_dir(run.folder.path())
        .output()
        .unwrap();
    assert!(output.status.success());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("whole JSON");
    assert_eq!(json["output"], "pl\u{fffd}.bin");
    assert!(run.folder.path().join(name).exists());
}

#[test]
fn a_flood_of_mistakes_takes_no_longer_than_it_must() {
    const MANY: usize = 100_000;
    let lines = |line: fn(usize) -> String| (0..MANY).map(line).collect::<String>();
    let program = harness::setup::plan_compiler().unwrap();
    for (what, mission, overlay) in [
        ("unknown keys", lines(|n| format!("resolutoin{n} = 1\n")), YARD.to_owned()),
        (
            "unknown keys of a table",
            format!("[vehicle]\n{}", lines(|n| format!("max_sped{n} = 1\n"))),
            YARD.to_owned(),
        ),
        (
            "goals in a wall",
            format!("[goals]\n{}", lines(|n| format!("g{n} = [30, 10]\n"))),
            YARD.to_owned(),
        ),
        (
            "goals of no point",
            format!("[goals]\n{}", lines(|n| format!("g{n} = 'gaet{n}'\n"))),
            YARD.to_owned(),
        ),
        (
            "areas of no map",
            format!("[layers]\nnight = [{}]\n", lines(|n| format!("'Zone{n}',"))),
            YARD.to_owned(),
        ),
        ("points alike", String::new(), YARD.to_owned() + &lines(|_| "PP gate 35 25\n".into())),
        (
            "points in a wall",
            String::new(),
            YARD.to_owned() + &lines(|n| format!("PP p{n} 30 10\n")),
        ),
        (
            "words of no meaning",
            String::new(),
            YARD.to_owned() + &lines(|n| format!("FOO{n} 30 10\n")),
        ),
    ] {
        let run = Run::new(&[
            ("yard.ovl", overlay.as_bytes()),
            ("yard.mission.toml", format!("# {what}\n{mission}").as_bytes()),
        ]);
        let started = Instant::now();
        let (_, err) =
            ends(Command::new(&program).args(["build", "yard.ovl"]).current_dir(run.folder.path()));
        eprintln!("{what}: {:.2} s", started.elapsed().as_secs_f64());
        assert!(err.contains("more mistakes are not shown"), "{what}: {err:.3000}");
        assert!(err.len() < 2_000_000, "{what}: {}", err.len());
    }
}

#[test]
fn files_that_are_no_map_are_named_with_what_to_do() {
    let kml = "<?xml version=\"1.0\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"></kml>\n";
    for (name, bytes, words) in [
        ("yard.kml", kml.as_bytes(), "ogr2ogr -f GeoJSON yard.geojson yard.kml"),
        ("yard.gpx", b"<gpx version=\"1.1\"></gpx>", "--goal NAME=X,Y"),
        ("yard.waypoints", b"QGC WPL 110\n0\t1\t0\t16\n", "--goal NAME=X,Y"),
        ("yard.plan", b"{\"fileType\": \"Plan\", \"version\": 1}", "--goal NAME=X,Y"),
        ("yard.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF", "save it as yard.png"),
        ("yard.dxf", b"0\nSECTION\n2\nHEADER\n", "DXF drawing"),
        ("yard.png", b"\x89PNG\r\n\x1a\n", "name the YAML file"),
        ("yard.yaml", b"robot:\n  name: carl\n", "does not describe a map"),
        ("yard.npy", b"\x93NUMPY\x01\0", "an array"),
    ] {
        let run = Run::new(&[(name, bytes)]);
        let ended = run.run(&format!("build {name}"), "");
        assert_eq!(ended.status, 1, "{name}");
        assert!(ended.err.contains(words), "{name}: {}", ended.err);
        assert_eq!(ended.err.matches('×').count(), 1, "{name}: {}", ended.err);
    }
}

#[test]
fn a_map_that_was_hardly_meant_is_built_with_a_warning() {
    let shut_in =
        "MISSION-AREA 40 30\nCONTROL MEASURES:\nWALL w 10 10  13 10  13 13  10 13  10 10\n";
    let crowded = "MISSION-AREA 40 30\nCONTROL MEASURES:\nBOUNDARY NoFlyZone1 1 1  2 1  2 2\n\
        OBSTACLE 20 15 22\n";
    let fences: String = (0..9).map(|n| format!("WALL w{n} {0} 0  {0} 28\n", 4 * n + 2)).collect();
    let fences = format!("MISSION-AREA 38 30\nCONTROL MEASURES:\n{fences}");
    for (map, arguments, words) in [
        (shut_in, "--goal a=11.5,11.5", "free cells have a route to goal `a` in layer `physical`"),
        (crowded, "--goal a=0.5,0.5", "of the map's cells"),
        (
            fences.as_str(),
            "--goal a=37,5 --robot-radius 1.9",
            "grown by the robot's radius of 1.9 m",
        ),
        (YARD, "--goal a=5,25 --resolution 8", "cells of 8 m are coarse for this map"),
    ] {
        let run = Run::new(&[("yard.ovl", map.as_bytes())]);
        let ended = run.run(&format!("build yard.ovl {arguments} --quiet"), "");
        assert_eq!(ended.status, 0, "{arguments}: {}", ended.err);
        assert!(ended.err.contains(words), "{arguments}: {}", ended.err);
    }
    let mission = "map = 'yard.ovl'\ngoals.a = [35, 25]\nschemas.goal_tolerance = 0.5\n";
    let files = [("yard.ovl", YARD.as_bytes()), ("a.mission.toml", mission.as_bytes())];
    let run = Run::new(&files);
    for (cells, warns) in [("0.708", true), ("0.707", false)] {
        let ended = run.run(&format!("build a.mission.toml --resolution {cells} -o a.bin -q"), "");
        assert_eq!(ended.status, 0, "{cells}: {}", ended.err);
        let words = "the robot stops anywhere";
        assert_eq!(ended.err.contains(words), warns, "{cells}: {}", ended.err);
    }
    let yaml = "image: yard.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n\
        occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    let mut pgm = b"P5 40 40 255\n".to_vec();
    // Posts every half metre, and an open corner.
    let post = |at: u32| at % 40 % 5 + at / 40 % 5 == 0 && at / 40 > 9;
    pgm.extend((0..1600).map(|at| if post(at) { 0 } else { 254 }));
    let run = Run::new(&[("yard.yaml", yaml.as_bytes()), ("yard.pgm", &pgm)]);
    for (resolution, words) in [
        ("0.5", "of the map's free area is left"),
        ("0.01", "far finer than the map's own, 0.1 m"),
        ("1", "whose own cells are 0.1 m"),
    ] {
        let arguments = format!(
            "build yard.yaml --robot-radius 0 --goal a=0.3,3.8 --resolution {resolution} --quiet"
        );
        let ended = run.run(&arguments, "");
        assert_eq!(ended.status, 0, "{resolution}: {}", ended.err);
        assert!(ended.err.contains(words), "{resolution}: {}", ended.err);
    }
    let fine = "build yard.yaml --robot-radius 0 --goal a=0.35,3.85 --quiet";
    let ended = run.run(fine, "");
    // The body of 0.6 m is wider than the gaps between the posts.
    assert!(ended.err.contains("pass between obstacles 0.4 to 0.6 m apart"), "{}", ended.err);
    assert!(!ended.err.contains("cells") && !ended.err.contains("area"), "{}", ended.err);
}

#[test]
fn maps_at_a_pole_and_places_the_wrong_way_round_are_refused() {
    let overlay = |reference: &str| {
        format!(
            "MISSION-AREA 40 30\n{reference}\nCONTROL MEASURES:\nPP a UTM LAT 51.0001 LON 7.0001\n"
        )
    };
    let opar = |lat: &str| {
        format!(
            "Farm\n{lat}\n7.0\n4\n0\n0\n50\n0\n50\n50\n0\n50\n0.9\n1.1\n14\n0.45\n0.284\n1\n1.33\n\
             0.284\n0.588\n"
        )
    };
    for (name, text, status, words) in [
        ("a.ovl", overlay("GLOBAL_REF_POINT 90 0"), 1, "too near to a pole"),
        ("a.ovl", overlay("GLOBAL_REF_POINT -89.5 0"), 1, "too near to a pole"),
        ("a.ovl", overlay("GLOBAL_REF_POINT -122.4 37.8"), 1, "GLOBAL_REF_POINT 37.8 -122.4"),
        (
            "a.ovl",
            overlay("ORIGIN UTM LAT 51 LON 7\nGLOBAL_REF_POINT 7 51"),
            0,
            "GLOBAL_REF_POINT 51 7",
        ),
        ("a.opar", opar("90"), 1, "too near to a pole"),
        ("a.opar", opar("-87"), 1, "too near to a pole"),
    ] {
        let run = Run::new(&[(name, text.as_bytes())]);
        let ended = run.run(&format!("build {name}"), "");
        assert_eq!(ended.status, status, "{text}: {}", ended.err);
        assert!(ended.err.contains(words), "{text}: {}", ended.err);
    }
}
