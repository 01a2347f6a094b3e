//! The seeds of the targets.

use math::GeoPoint;
use plan_compiler::trace::Trace;
use robot_io::packet::{self, Downlink, Uplink};
use robot_io::{
    Checks, CommandRecord, Commands, Fix, Manual, Operator, Percepts, Reason, Receiver,
    SensorRecord,
};
use sim::receiver::Solution;
use sim::{Dialect, Mode};
use soak::fixtures;
use std::path::Path;

/// The seeds of a target: its corpus, the shipped maps and the inputs built by code.
pub(crate) fn of(name: &str) -> Vec<Vec<u8>> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut seeds = files(&here.join("corpus").join(name), "");
    for ending in shipped(name) {
        seeds.extend(files(&here.join("../maps"), ending));
    }
    seeds.extend(built(name));
    seeds
}

/// Endings of the files in `tests/maps` that a target reads.
fn shipped(name: &str) -> &'static [&'static str] {
    match name {
        "overlay" => &[".ovl"],
        "opar" => &[".opar"],
        "geojson" => &[".geojson"],
        "osm_xml" => &[".osm"],
        "osm_pbf" => &[".pbf"],
        "any_map" => &[".ovl", ".opar", ".geojson", ".osm", ".pbf"],
        "mission" => &[".mission.toml"],
        "world" => &[".world.toml"],
        _ => &[],
    }
}

/// The contents of a folder's files with an ending, sorted by name.
fn files(folder: &Path, ending: &str) -> Vec<Vec<u8>> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.is_file() && path.to_string_lossy().ends_with(ending));
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).expect("a seed can be read")).collect()
}

/// Inputs built by code, because they change with the robot's formats.
fn built(name: &str) -> Vec<Vec<u8>> {
    match name {
        "blob" => blobs(),
        "trace" => blobs().into_iter().map(|blob| trace(blob).to_bytes()).collect(),
        "gps" => vec![receiver(&[Dialect::Ubx]), receiver(&[Dialect::Nmea]), receiver(&BOTH)],
        "link" => vec![packets()],
        "lockstep" => vec![records()],
        _ => Vec::new(),
    }
}

const BOTH: [Dialect; 2] = [Dialect::Nmea, Dialect::Ubx];
const PLACE: GeoPoint = GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 };

fn blobs() -> Vec<Vec<u8>> {
    let missions = [fixtures::endless_loop(), fixtures::sixteen(), fixtures::budget()];
    let blobs = missions.into_iter().map(fixtures::blob);
    blobs.map(|blob| blob.expect("a sound blob")).collect()
}

fn trace(blob: Vec<u8>) -> Trace {
    let percepts = |tick: u64| Percepts {
        time_us: tick * 50_000,
        fix: Some(Fix {
            time_us: tick * 50_000,
            is_valid: true,
            place: PLACE,
            accuracy_mm: 500,
            velocity_mmps: Some([500, 0]),
            receiver_ms: Some(tick as u32 * 50),
        }),
        inputs: [Some(fixtures::wave(tick as u32)); robot_io::limits::MAX_CHANNELS],
        operator: Operator { is_armed: true, ..Operator::default() },
        ..Percepts::default()
    };
    Trace { blob, percepts: (0..20).map(percepts).collect(), hash: 7 }
}

/// Five solutions, each in all the dialects.
fn receiver(dialects: &[Dialect]) -> Vec<u8> {
    let solution = |number: u64| Solution {
        time_us: number * 200_000,
        place: PLACE,
        velocity_mps: [1.0, -0.5],
        accuracy_m: 0.5,
        mode: if number == 3 { Mode::Void } else { Mode::Autonomous },
    };
    let messages = (0..5).flat_map(|number| dialects.iter().map(move |dialect| (number, dialect)));
    messages.flat_map(|(number, dialect)| dialect.message(&solution(number))).collect()
}

fn packets() -> Vec<u8> {
    let manual = Some(Manual { speed_mps: 1.0, turn_rate_radps: -0.5 });
    let operators = [
        Operator { is_armed: true, ..Operator::default() },
        Operator { is_armed: true, is_emergency_stop: true, manual },
    ];
    let up = operators.map(|operator| packet::encode(&Uplink::Operator(operator)));
    let down = packet::encode(&Downlink::Telemetry(CommandRecord {
        time_us: 1 << 40,
        commands: Commands::stop(Reason::NoFix),
        trace_hash: u64::MAX,
        instructions: 3_000,
        receiver: Receiver::Sound,
        checks: Checks::HEADING,
        news: None,
        goal: None,
    }));
    up.into_iter().chain([down]).flat_map(|packet| packet.expect("a packet fits")).collect()
}

fn records() -> Vec<u8> {
    let record = |number: u8| SensorRecord {
        gps: receiver(&[Dialect::Ubx]).into_iter().take(100).collect(),
        heading_rad: Some(f32::from(number)),
        operator: Operator { is_armed: true, ..Operator::default() },
        ..SensorRecord::default()
    };
    (0..4).flat_map(|number| record(number).to_bytes().expect("a record fits")).collect()
}
