//! Robots with default parameters in tight worlds: they arrive, and they touch nothing.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use harness::drive_bench::table::Numbers;
use harness::drive_bench::worlds;
use harness::drive_bench::{
    Drives, Row, Run, Setting, Suite, VehicleKind, courses, drive, record, rows,
};
use harness::mission;
use harness::setup::{self, root};
use maps::Shape;
use math::scalar::wide;
use robot_io::Reason;
use sim::{Difference, HostPilot, Outcome, Random, SensorSettings, Start, Stream, World};

/// The runs of the suite's courses under the settings that are wanted.
fn driven(drives: &Drives, is_wanted: impl Fn(&Row) -> bool) -> Vec<(usize, Vec<Run>)> {
    let all = rows();
    let wanted = (0..all.len()).filter(|&number| is_wanted(&all[number]));
    let drives = Drives { rows: wanted.collect(), ..drives.clone() };
    let runs = drives.drive(&|| ()).expect("the courses are sound");
    let of = |row: usize| runs.iter().filter(|run| run.row == row).cloned().collect();
    drives.rows.iter().map(|&row| (row, of(row))).collect()
}

fn numbers(runs: &[Run]) -> Numbers {
    Numbers::of(&runs.iter().collect::<Vec<_>>())
}

fn of_suite(suite: Suite, count: usize) -> Drives {
    let courses = courses(&[suite], None, count, 1).expect("seeded courses need no files");
    Drives { courses, rows: Vec::new(), shard: (0, 1) }
}

/// A rover, without discs.
fn is_plain(row: &Row) -> bool {
    row.setting.vehicle == VehicleKind::Differential && !row.setting.has_discs
}

/// Fields of posts as in the BARN challenge: mapped, in part mapped, not mapped, with perfect and
/// with usual sensors.
#[test]
fn a_field_of_posts_is_passed_untouched() {
    let is_wanted = |row: &Row| row.suite == Suite::Barn && is_plain(row);
    for (row, runs) in driven(&of_suite(Suite::Barn, 8), is_wanted) {
        let setting = rows()[row].setting;
        let found = numbers(&runs);
        assert_eq!(found.contacts, 0.0, "{setting:?}: {runs:?}");
        if setting.unmapped_percent <= 10 {
            assert_eq!(found.success, 1.0, "{setting:?}: {runs:?}");
        }
    }
}

/// The challenge's own 50 worlds, where they lie beside the project.
#[test]
fn the_worlds_of_the_challenge_are_passed_untouched() {
    let folder = root().join("../shared/data/barn");
    if !folder.is_dir() {
        println!("{} is not here; nothing was driven", folder.display());
        return;
    }
    let courses = courses(&[Suite::Barn], Some(&folder), 0, 1).expect("the worlds are sound");
    let drives = Drives { courses, rows: Vec::new(), shard: (0, 1) };
    let is_wanted = |row: &Row| row.suite == Suite::Barn && is_plain(row);
    for (row, runs) in driven(&drives, is_wanted) {
        let setting = rows()[row].setting;
        let found = numbers(&runs);
        assert_eq!((found.runs, found.contacts), (50, 0.0), "{setting:?}");
        let (success, score) = match (setting.unmapped_percent, setting.has_usual_sensors) {
            (0, false) => (1.0, 0.45),
            (0, true) => (0.98, 0.45),
            (100, _) => (0.85, 0.25),
            _ => (0.96, 0.42),
        };
        assert!(found.success >= success && found.score >= score, "{setting:?}: {found:?}");
    }
}

/// Doors from 0.2 m wider than the body on, from both sides.
#[test]
fn mapped_doors_are_passed() {
    let is_wanted = |row: &Row| row.suite == Suite::Doors && is_plain(row);
    for (row, runs) in driven(&of_suite(Suite::Doors, 0), is_wanted) {
        let failed: Vec<&Run> = runs.iter().filter(|run| !run.is_success()).collect();
        assert!(failed.is_empty(), "{:?}: {failed:?}", rows()[row].setting);
        assert_eq!(runs.len(), 120);
    }
}

#[test]
fn mapped_courtyards_are_left() {
    let is_wanted = |row: &Row| row.suite == Suite::Courtyards && is_plain(row);
    for (row, runs) in driven(&of_suite(Suite::Courtyards, 6), is_wanted) {
        assert!(runs.iter().all(Run::is_success), "{:?}: {runs:?}", rows()[row].setting);
    }
}

/// A car and a boat turn on circles only: they back out where those are closed.
#[test]
fn a_car_and_a_boat_get_out_of_narrow_places() {
    for (suite, count) in [(Suite::Corridors, 0), (Suite::Courtyards, 8), (Suite::City, 8)] {
        let is_wanted =
            |row: &Row| row.suite == suite && row.setting.vehicle != VehicleKind::Differential;
        let rows_driven = driven(&of_suite(suite, count), is_wanted);
        assert_eq!(rows_driven.len(), 2);
        for (row, runs) in rows_driven {
            let failed: Vec<&Run> = runs.iter().filter(|run| !run.is_success()).collect();
            assert!(runs.iter().all(|run| run.contacts == 0), "{failed:?}");
            assert!(failed.is_empty(), "{:?}: {failed:?}", rows()[row].setting);
        }
    }
}

/// The trace of a benchmark's run explains why a car drives astern.
#[test]
fn a_trace_says_that_a_car_backs_out() {
    let courses = courses(&[Suite::Courtyards], None, 3, 1).expect("seeded courses need no files");
    let all = rows();
    let is_wanted =
        |row: &Row| row.suite == Suite::Courtyards && row.setting.vehicle == VehicleKind::Ackermann;
    let row = (0..all.len()).find(|&row| is_wanted(&all[row])).expect("there is such a row");
    let folder = tempfile::tempdir().expect("the system has a folder for temporary files");
    let path = folder.path().join("court.trace");
    let mut backed_out = 0;
    for course in &courses {
        let (driven, trace) = record(row, &all[row].setting, course).expect("the course is sound");
        let again = drive(row, &all[row].setting, course).expect("the course is sound");
        assert_eq!(driven.run, again.run, "recording changes nothing");
        std::fs::write(&path, trace.to_bytes()).expect("the folder is writable");
        let speed = |tick: usize| trace.percepts[tick].speed_mps.unwrap_or(0.0);
        let astern = (1..trace.percepts.len() - 1)
            .find(|&at| speed(at - 1) < 0.0 && speed(at + 1) < speed(at));
        let Some(tick) = astern else { continue };
        let explained = std::process::Command::new(setup::plan_compiler().expect("it builds"))
            .args(["explain", path.to_str().expect("a plain path"), "--tick", &tick.to_string()])
            .output()
            .expect("it runs");
        let text = String::from_utf8_lossy(&explained.stdout).into_owned();
        assert!(text.contains("rule       back out: astern"), "{text}");
        backed_out += 1;
    }
    assert!(backed_out > 0, "no car had to back out");
}

/// Cities where the route lies between a house and the edge of the map: turns, drift, and houses that
/// repelled it, led the vehicle off the map or left it beside the edge, where it could not turn away.
#[test]
fn a_route_along_the_edge_of_the_map_is_driven() {
    let cities = |vehicle, seeds: &[u64]| {
        let setting =
            Setting { unmapped_percent: 0, has_discs: false, has_usual_sensors: false, vehicle };
        let is_wanted = |row: &Row| row.suite == Suite::City && row.setting == setting;
        for &seed in seeds {
            let courses = courses(&[Suite::City], None, 1, seed).expect("they need no files");
            let city = Drives { courses, rows: Vec::new(), shard: (0, 1) };
            for (_, runs) in driven(&city, is_wanted) {
                assert!(runs.iter().all(Run::is_success), "{runs:?}");
            }
        }
    };
    cities(VehicleKind::Ackermann, &[9012, 9014, 9024, 9058, 9171, 9217, 9243]);
    cities(VehicleKind::Boat, &[100, 160, 182, 187, 360, 406, 539]);
    cities(VehicleKind::Differential, &[182, 369, 406, 408]);
}

/// A dock often stands at the edge of the map: goals closer to it than the vehicle's radius.
#[test]
fn a_goal_beside_the_edge_of_the_map_is_reached() {
    let map = worlds::map([0.0, 0.0], [12.0, 12.0], vec![]);
    for steering in ["differential", "ackermann", "boat"] {
        for goal in [[0.1, 6.0], [6.0, 11.9], [11.85, 0.15]] {
            let circle = if steering == "ackermann" { "min_turn_radius = 0.5\n" } else { "" };
            let mission = format!(
                "resolution = 0.1\n[goals]\ngoal = {goal:?}\n[vehicle]\nradius = 0.25\n\
                 max_speed = 1\nsteering = \"{steering}\"\n{circle}\
                 [schemas]\ngoal_tolerance = 0.1\n[progress]\nafter = 20\n"
            );
            let scenario = mission::of_map(&map, &mission, &Difference::default(), 1);
            let scenario = scenario.unwrap_or_else(|message| panic!("{mission}\n{message}"));
            let sensors = SensorSettings::PERFECT;
            let start = Start { position: [6.0, 6.0], heading_rad: 0.5, seed: 1, sensors };
            let pilot = HostPilot::new(scenario.plan());
            let robot = scenario.robot(&start, pilot).expect("the start is clear");
            let outcome = scenario.run(robot.within_time(120.0)).expect("the robot answers");
            assert!(outcome.reached(), "{steering} {goal:?}: {outcome:?}");
        }
    }
}

/// What a vehicle does that faces the closed end of an alley, at its start, and has to leave it.
/// `behind` are obstacles besides the alley's walls.
fn leaving_an_alley(steering: &str, width_m: f64, behind: Option<Shape>) -> Outcome {
    let (left, right) = (4.0, 4.0 + width_m);
    let alley = Shape::Polyline(vec![[left, 8.0], [left, 2.0], [right, 2.0], [right, 8.0]]);
    let map = worlds::map([0.0, 0.0], [12.0, 12.0], vec![alley]);
    let circle = if steering == "ackermann" { "min_turn_radius = 0.5\n" } else { "" };
    let mission = format!(
        "resolution = 0.1\n[goals]\ngoal = [8, 10]\n[vehicle]\nradius = 0.25\nmax_speed = 1\n\
         steering = \"{steering}\"\n{circle}[progress]\nafter = 20\n"
    );
    let scenario = mission::of_map(&map, &mission, &Difference::default(), 1);
    let mut scenario = scenario.unwrap_or_else(|message| panic!("{mission}\n{message}"));
    let all = map.features.iter().map(|feature| &feature.shape).chain(&behind);
    scenario.truth = World::new(all);
    let start = Start {
        position: [left + 0.5 * width_m, 2.8],
        heading_rad: -1.5,
        seed: 1,
        sensors: SensorSettings::PERFECT,
    };
    let pilot = HostPilot::new(scenario.plan());
    let robot = scenario.robot(&start, pilot).expect("the start is clear").within_time(120.0);
    scenario.run(robot).expect("the robot answers")
}

/// As in reports about Nav2 (2739, 3011): the goal lies behind a car that has no room to turn. As in
/// report 2453: something stands behind it as well.
#[test]
fn a_vehicle_that_faces_the_end_of_an_alley_leaves_it() {
    for steering in ["ackermann", "boat", "differential"] {
        for width_m in [0.8, 1.0, 1.6, 2.4] {
            let outcome = leaving_an_alley(steering, width_m, None);
            assert!(outcome.reached() && outcome.touches == 0, "{steering} {width_m}: {outcome:?}");
        }
        let barrier = Shape::Polyline(vec![[4.0, 3.1], [4.8, 3.1]]);
        let outcome = leaving_an_alley(steering, 0.8, Some(barrier));
        let last =
            outcome.reasons.iter().max_by_key(|(_, ticks)| *ticks).map(|(reason, _)| *reason);
        assert_eq!(outcome.touches, 0, "{steering}: {outcome:?}");
        let is_true = matches!(last, Some(Reason::ObstacleStop | Reason::NoProgress));
        assert!(is_true, "{steering}: {outcome:?}");
    }
}

/// Discs of 1 m/s that cross the way, in doors of all widths, courtyards and fields of posts. A robot
/// that could have stopped in time touches none of them; see `sim::sighting`. The exception is one
/// disc that turns in beside the robot, in one of 120 doors.
#[test]
fn a_disc_that_was_seen_in_time_is_not_touched() {
    for (suite, count, most) in
        [(Suite::Doors, 0, 1), (Suite::Courtyards, 10, 0), (Suite::Barn, 10, 0)]
    {
        let is_wanted = |row: &Row| row.suite == suite && row.setting.has_discs;
        for (_, runs) in driven(&of_suite(suite, count), is_wanted) {
            let touching: Vec<&Run> = runs.iter().filter(|run| run.contacts > 0).collect();
            assert!(touching.len() <= most, "{touching:?}");
            let reached = runs.iter().filter(|run| run.is_reached).count();
            assert!(reached * 10 >= runs.len() * 9, "{suite:?}: {reached} of {}", runs.len());
            assert!(runs.iter().any(|run| run.strikes > 0), "{suite:?}: the discs meet the robot");
        }
    }
}

#[test]
fn shards_add_up_to_the_whole() {
    let is_wanted = |row: &Row| row.suite == Suite::Corridors && is_plain(row);
    let whole = of_suite(Suite::Corridors, 0);
    let parts = [0, 1, 2].map(|index| {
        let shard = Drives { shard: (index, 3), ..whole.clone() };
        driven(&shard, is_wanted).into_iter().flat_map(|(_, runs)| runs).collect::<Vec<_>>()
    });
    let mut merged = parts.concat();
    merged.sort_by_key(|run| run.number);
    let all: Vec<Run> = driven(&whole, is_wanted).into_iter().flat_map(|(_, runs)| runs).collect();
    assert_eq!(merged, all);
    assert!(parts.iter().all(|part| !part.is_empty() && part.len() < all.len()));
}

/// Bodies, limits and gains at random, in worlds that the map does not show: whatever pulls, the
/// brakes keep the robot from everything that it sees. Fast robots see posts too late, because
/// beams miss them (see `sim::RingSettings`); so the speed is one from which the robot stops within
/// 1.2 m.
#[test]
fn whatever_the_body_and_the_gains_nothing_is_touched() {
    let posts = of_suite(Suite::Barn, 12).courses;
    let mut random = Random::new(7, Stream::Start);
    let presets = ["route", "100:0", "66:34", "34:66", "0:100"];
    for number in 0..60 {
        let course = &posts[number % posts.len()];
        let radius_m = random.between(0.1, 0.4);
        let braking = random.between(0.7, 4.0);
        let fastest = braking * (wide::sqrt(0.01 + 2.4 / braking) - 0.1);
        let speed = random.between(0.3, 1.0) * fastest.min(3.0);
        let turn = random.between(0.5, 6.0);
        let preset = presets[number % presets.len()];
        let unmapped = [0.0, 0.5, 1.0][number % 3];
        let (steering, circle) = match number % 4 {
            2 => ("boat", "back_out = \"always\"\n"),
            3 => ("ackermann", "min_turn_radius = 0.4\nback_out = \"always\"\n"),
            _ => ("differential", ""),
        };
        let mission = format!(
            "resolution = 0.05\nrobot_radius = {radius_m}\n[goals]\ngoal = [3.75, 14]\n\
             [gains]\npreset = \"{preset}\"\n[vehicle]\nsteering = \"{steering}\"\n{circle}\
             radius = {radius_m}\nmax_speed = {speed}\nbraking = {braking}\nmax_turn_rate = {turn}\n"
        );
        let difference = Difference { unmapped, ..Difference::default() };
        let scenario = mission::of_map(&course.map, &mission, &difference, number as u64);
        let scenario = scenario.unwrap_or_else(|message| panic!("{mission}\n{message}"));
        let start = Start {
            position: course.start,
            heading_rad: random.between(-3.0, 3.0),
            seed: number as u64,
            sensors: SensorSettings::PERFECT,
        };
        let pilot = HostPilot::new(scenario.plan());
        let robot = scenario.robot(&start, pilot).expect("the start is clear").within_time(60.0);
        let outcome = scenario.run(robot).expect("the robot answers");
        assert_eq!(
            outcome.touches, 0,
            "number {number}, {unmapped} unmapped:\n{mission}{outcome:?}"
        );
    }
}

fn command(program: &str, folder: &Path, arguments: &str) -> Command {
    let program = setup::built("harness", program, "dev", None).expect("the program is built");
    let mut command = Command::new(program);
    command.args(arguments.split(' ')).current_dir(folder);
    command
}

fn bench(folder: &Path, arguments: &str) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } =
        command("drive_bench", folder, arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

#[test]
fn shards_of_the_bench_merge_into_the_object_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let run = |more: &str| {
        let (_, out, err) = bench(at, &format!("--suites corridors --only boat --json {more}"));
        assert!(out.starts_with('{'), "{err}");
        out
    };
    let whole = run("--shard 0/1");
    for shard in ["0", "1"] {
        fs::write(at.join(shard), run(&format!("--shard {shard}/2"))).unwrap();
    }
    fs::write(at.join("other"), run("--shard 1/2 --seed 2")).unwrap();
    assert_eq!(bench(at, "--json --merge 1 0").1, whole);
    assert!(whole.contains("\"trace_hash\":\""), "text: a program may read numbers as floats");
    for (arguments, status, message) in [
        ("--merge 0", 3, "are in none of the files, the first of them run 1"),
        ("--merge 0 other", 3, "are of different campaigns"),
        ("--merge 0 0", 3, "is in two files"),
        ("--merge 0 1 --gallery g", 2, "cannot be used with"),
        ("--merge 0 1 --count 3", 2, "cannot be used with"),
        ("--only zzz", 2, "none of the rows of these suites contains \"zzz\""),
        ("--suites campus --only boat", 2, "none of the rows of these suites contains \"boat\""),
    ] {
        let (ended, out, err) = bench(at, arguments);
        assert!(ended == Some(status) && out.is_empty(), "{arguments}: {ended:?} {out}{err}");
        assert!(err.contains(message), "{arguments}: {err}");
    }
    let twice = "--suites corridors,corridors --only boat --json";
    assert_eq!(bench(at, twice).1, whole, "each course once");
}

/// A full disk is an error; a reader that has closed the pipe wants no more.
#[test]
fn an_output_that_cannot_be_written_has_its_status() {
    let folder = tempfile::tempdir().unwrap();
    for (program, arguments) in [
        ("drive_bench", "--suites corridors --only boat --shard 0/12 --json"),
        ("fault_table", "--seeds 1 --sensor battery --kind lost --json"),
        ("experiment", "--rows plan --trials 1 --json"),
    ] {
        if let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") {
            let mut command = command(program, folder.path(), arguments);
            let Output { status, stderr, .. } = command.stdout(full).output().unwrap();
            let err = String::from_utf8_lossy(&stderr);
            assert_eq!(status.code(), Some(3), "{program}: {err}");
            assert!(err.contains("cannot write to standard output"), "{program}: {err}");
        }
        let mut command = command(program, folder.path(), arguments);
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it starts");
        drop(child.stdout.take());
        let status = child.wait().expect("it ends");
        assert_ne!(status.code(), Some(3), "{program}");
    }
}
