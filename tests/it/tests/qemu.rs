//! The firmware in QEMU: a mission has the same trace as on the host, and the instructions of a tick
//! equal the golden file. QEMU and Rust targets are installed if they are missing; if that needs a
//! password, these tests fail with the command to run.

use std::io::{Read, Write};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use harness::mission::{self, Changes};
use harness::{Build, Machine, QemuPilot, counts};
use it::own_map;
use math::{GeoPoint, Vec2};
use plan_format::parameters::Gains;
use robot_io::packet::{Decoder, Downlink};
use robot_io::{CommandRecord, Reason, SensorRecord};
use sim::receiver::{Dialect, Mode, Solution};
use sim::{HostPilot, Outcome, Pilot, Scenario, SensorSettings, Start};

fn campus(gains: Gains) -> Scenario {
    let changes = Changes { gains: Some(gains), ..Changes::default() };
    mission::scenario(&own_map("campus.opar"), &changes).expect("the campus compiles")
}

fn run(scenario: &Scenario, seed: u64, pilot: impl Pilot) -> Outcome {
    let position = scenario.draw_start(seed).expect("the campus has free places");
    let start = Start { position, heading_rad: 0.5, seed, sensors: SensorSettings::USUAL };
    let robot = scenario.robot(&start, pilot).expect("the body is clear of obstacles");
    robot.run(&scenario.truth).expect("the robot answers")
}

fn boot(machine: Machine, build: Build, blob: &[u8]) -> QemuPilot {
    QemuPilot::boot(machine, build, blob).unwrap_or_else(|error| panic!("{error}"))
}

/// W45, N07: the same code gives the same bits on every target, debug and release.
#[test]
fn n07_a_mission_has_the_same_trace_everywhere() {
    let machines = [
        (Machine::CortexM4F, Build::Release),
        (Machine::CortexM4F, Build::Debug),
        (Machine::CortexM3, Build::Release),
    ];
    for (seed, gains) in [(1, Gains::MOSTLY_PLAN), (2, Gains::MOSTLY_REACTIVE)] {
        let scenario = campus(gains);
        let on_host = run(&scenario, seed, HostPilot::new(scenario.plan()));
        assert!(on_host.ticks > 500, "a mission, not a moment: {on_host:?}");
        for (machine, build) in machines {
            let in_qemu = run(&scenario, seed, boot(machine, build, &scenario.blob));
            let name = machine.name();
            assert_eq!(in_qemu.trace_hash, on_host.trace_hash, "{name}, {build:?}, seed {seed}");
            assert_eq!(in_qemu.route, on_host.route);
        }
    }
}

/// Twenty starts with the mostly planned mix: all arrive without touching anything, and their traces
/// are the same as on the host.
#[test]
fn twenty_missions_in_qemu_end_as_on_the_host() {
    let scenario = campus(Gains::MOSTLY_PLAN);
    for seed in 100..120 {
        let on_host = run(&scenario, seed, HostPilot::new(scenario.plan()));
        let pilot = boot(Machine::CortexM4F, Build::Release, &scenario.blob);
        let in_qemu = run(&scenario, seed, pilot);
        assert_eq!(in_qemu.trace_hash, on_host.trace_hash, "seed {seed}");
        assert!(in_qemu.reached() && in_qemu.touches == 0, "seed {seed}: {in_qemu:?}");
    }
}

/// N16: a damaged blob is refused with a reason, and the robot stands still.
#[test]
fn n16_a_damaged_blob_is_refused_in_the_firmware() {
    let scenario = campus(Gains::MOSTLY_PLAN);
    let mut damaged = scenario.blob.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 4;
    for blob in [&damaged[..], &[]] {
        let mut pilot = boot(Machine::CortexM4F, Build::Release, blob);
        let mut sensors = SensorRecord::default();
        sensors.operator.is_armed = true;
        let answer = pilot.exchange(&sensors).expect("the robot answers");
        assert_eq!(answer.commands.speed_mps, 0.0);
        let report = pilot.finish().expect("the guest ends well");
        assert!(report.console.contains("plan refused: code"), "{}", report.console);
    }
}

/// W13: the instructions of a look-up, a tick and a validation are bounded and repeatable.
#[test]
fn w13_instruction_counts_are_as_in_the_golden_file() {
    let counted = counts::measure().unwrap_or_else(|error| panic!("{error}"));
    for &(name, limit) in counts::LIMITS {
        let number = number(&counted, name);
        assert!(number <= limit, "{name} is {number}, above its limit of {limit}");
    }
    let golden = std::fs::read_to_string(counts::golden()).unwrap_or_default();
    assert_eq!(
        counted, golden,
        "the counts have changed; if that is intended, run: cargo instructions --update"
    );
}

fn number(counted: &str, name: &str) -> u64 {
    let line = counted.lines().find_map(|line| line.strip_prefix(name)).map(str::trim);
    line.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("no {name} in {counted}"))
}

/// Validation, look-up and tick cannot panic: their image links although its panic handler has an
/// undefined symbol.
#[test]
fn no_panic_can_be_reached_from_a_tick() {
    for machine in [Machine::CortexM4F, Machine::CortexM3] {
        machine.image("panic_free", Build::Release).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The real peripherals: GPS bytes on an interrupt-driven UART, ticks by a timer's interrupts with
/// sleep in between, and telemetry packets back on the same line.
#[test]
fn fixes_arrive_and_telemetry_leaves_by_uart() {
    let scenario = campus(Gains::MOSTLY_PLAN);
    let (mut command, _plans) = Machine::CortexM4F
        .command("uart", Build::Release, &scenario.blob)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut guest = command.args(["-serial", "stdio"]).spawn().expect("QEMU starts");
    let mut to_guest = guest.stdin.take().expect("a pipe");
    let mut from_guest = guest.stdout.take().expect("a pipe");
    let (sender, records) = channel();
    thread::spawn(move || {
        let (mut decoder, mut byte) = (Decoder::default(), [0]);
        while from_guest.read_exact(&mut byte).is_ok() {
            if let Some(Downlink::Telemetry(record)) = decoder.push(byte[0])
                && sender.send(record).is_err()
            {
                return;
            }
        }
    });
    let frame = *scenario.plan().map_frame().expect("the campus is on the globe");
    let mut seen: Vec<CommandRecord> = Vec::new();
    let has = |seen: &[CommandRecord], reason| seen.iter().any(|r| r.commands.reason == reason);
    // Simulates a drive north at 1 m/s, with a solution for every fourth telemetry record.
    let deadline = std::time::Instant::now() + Duration::from_secs(30);
    while !has(&seen, Reason::Driving) && std::time::Instant::now() < deadline {
        match records.recv_timeout(Duration::from_secs(5)) {
            Ok(record) => seen.push(record),
            Err(_) => break,
        }
        if seen.len().is_multiple_of(4) {
            let time_us = seen.last().map_or(0, |record| record.time_us);
            let place: GeoPoint = frame.to_geodetic(Vec2::new(125.5, 60.0 + time_us as f32 * 1e-6));
            let velocity_mps = [0.0, 1.0];
            let solution =
                Solution { time_us, place, velocity_mps, accuracy_m: 0.5, mode: Mode::Autonomous };
            to_guest.write_all(&Dialect::Ubx.message(&solution)).expect("the guest listens");
            to_guest.flush().expect("the guest listens");
        }
    }
    let _ = guest.kill();
    let _ = guest.wait();
    assert!(has(&seen, Reason::NoFix), "it begins without a fix: {seen:?}");
    assert!(has(&seen, Reason::Driving), "fixes with a course make it drive: {seen:?}");
    for pair in seen.windows(2) {
        let apart_us = pair[1].time_us - pair[0].time_us;
        assert!(apart_us >= runtime::TICK_PERIOD_US / 2, "ticks keep their period: {apart_us}");
    }
}
