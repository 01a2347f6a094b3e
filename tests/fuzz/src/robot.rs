//! Bytes that reach a robot: its blob, its receiver, its link, its recorded traces.

use crate::mutate::Random;
use controller::State;
use embassy_futures::block_on;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use math::Vec2;
use plan_compiler::trace::{Trace, story};
use plan_format::{Blob, Cell, Layer, Parameters, limits};
use robot_io::limits::{COMMAND_RECORD_BYTES, SENSOR_RECORD_BYTES};
use robot_io::packet::{self, Downlink, Uplink};
use robot_io::{
    CommandRecord, Commands, Fix, Heard, Manual, Mate, News, Operator, Percepts, Pose,
    RangeReading, Receiver, SensorRecord,
};
use runtime::Slots;
use std::sync::OnceLock;

/// Size of a blob's header, bytes.
const HEADER_BYTES: usize = 28;
/// Most look-ups in all layers together; in larger blobs, cells are skipped at regular intervals.
const MAX_LOOK_UPS: u64 = 1 << 16;
/// Ticks of a run with a blob.
const BLOB_TICKS: u64 = 1_000;
/// Most ticks of a trace that are replayed.
const MAX_TICKS: usize = 2_000;

/// A blob as it is, and with its header and checksum repaired; then look-ups and 1,000 ticks.
pub(crate) fn blob(bytes: &[u8]) {
    let _ = (Blob::parse(bytes).is_ok(), Blob::parse_exact(bytes).is_ok());
    let blob = repaired(bytes);
    let mut beats = 0;
    let parsed = Blob::parse_paced(&blob, || beats += 1);
    let checks = blob.len() / 4 * limits::MAX_CHECKS_PER_WORD as usize;
    assert!(beats <= checks / limits::CHECKS_PER_BEAT as usize + 4, "{beats} beats");
    if let Ok(plan) = parsed {
        query(&plan);
        drive(&plan, bytes, BLOB_TICKS);
    }
}

/// The header of a sound blob, which [`repaired`] puts before other bytes.
fn header() -> &'static [u8] {
    static HEADER: OnceLock<Vec<u8>> = OnceLock::new();
    HEADER.get_or_init(|| {
        let blob = soak::fixtures::blob(soak::fixtures::endless_loop()).expect("a sound blob");
        blob[..HEADER_BYTES].to_vec()
    })
}

/// A blob with a correct header, length and checksum: its payload is that of the given blob, or the
/// given bytes if they are not a blob.
fn repaired(bytes: &[u8]) -> Vec<u8> {
    let payload = bytes.strip_prefix(&plan_format::MAGIC);
    let payload = payload.map_or(bytes, |rest| rest.get(HEADER_BYTES - 8..).unwrap_or_default());
    let mut blob = [header(), payload].concat();
    let length = blob.len() as u32;
    blob[12..16].copy_from_slice(&length.to_le_bytes());
    let crc = crc32(blob[..24].iter().chain(&blob[28..]));
    blob[24..28].copy_from_slice(&crc.to_le_bytes());
    blob
}

/// The CRC-32 of some bytes.
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32(bytes.iter())
}

/// CRC-32, bit by bit.
fn crc32<'b>(bytes: impl Iterator<Item = &'b u8>) -> u32 {
    !bytes.fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    })
}

/// Queries everything in a blob.
fn query(blob: &Blob<'_>) {
    let layers: Vec<Layer<'_>> =
        blob.parallel_plans().flat_map(|parallel| parallel.layers()).collect();
    for parallel in blob.parallel_plans() {
        assert_eq!(blob.find(parallel.name()).map(|found| found.goal_m()), Some(parallel.goal_m()));
    }
    let (columns, rows) = (u64::from(blob.grid().columns), u64::from(blob.grid().rows));
    let cells = columns * rows;
    let stride = (cells * layers.len() as u64 / MAX_LOOK_UPS).max(1);
    for layer in &layers {
        assert!(!layer.name().is_empty());
        for index in (0..cells).step_by(stride as usize) {
            let cell = Cell::new((index % columns) as u32, (index / columns) as u32);
            let _ = (layer.look_up(cell), layer.step(cell));
        }
        let _ = layer.look_up(Cell::new(u32::MAX, u32::MAX));
    }
}

/// Runs the controller with random percepts, seeded by the bytes.
pub(crate) fn drive(blob: &Blob<'_>, bytes: &[u8], ticks: u64) {
    let mut random = Random::new(checksum(bytes).into());
    let mut state = State::new(blob);
    let mut time_us = 0;
    for _ in 0..ticks {
        time_us += random.below(100_000) as u64;
        let percepts = percepts(blob, time_us, &mut random).sanitised();
        check_finite(&controller::tick(blob, &mut state, &percepts));
    }
}

fn check_finite(commands: &Commands) {
    assert!(commands.speed_mps.is_finite() && commands.turn_rate_radps.is_finite(), "{commands:?}");
}

fn percepts(blob: &Blob<'_>, time_us: u64, random: &mut Random) -> Percepts {
    let grid = blob.grid();
    let mut along = |corner: f64, cells: u32| {
        let reach = f64::from(cells) * grid.resolution_m;
        (corner + reach * f64::from(random.unit() * 1.1 - 0.05)) as f32
    };
    let at = Vec2::new(along(grid.corner_m[0], grid.columns), along(grid.corner_m[1], grid.rows));
    let fix = blob.map_frame().map(|frame| Fix {
        time_us,
        is_valid: random.below(20) > 0,
        place: frame.to_geodetic(at),
        accuracy_mm: random.below(8_000) as u32,
        velocity_mmps: (random.below(2) > 0).then_some([500, -700]),
        receiver_ms: (random.below(2) > 0).then_some(random.below(3) as u32 * 200),
    });
    let mut number = || match random.below(30) {
        0 => None,
        1 => Some(f32::from_bits(random.next() as u32)),
        _ => Some(random.unit() * 2.0 - 0.5),
    };
    let (heading_rad, speed_mps, turn_rate_radps) = (number(), number(), number());
    let inputs = [(); robot_io::limits::MAX_CHANNELS].map(|()| number());
    let manual = Manual { speed_mps: 1.0, turn_rate_radps: f32::NAN };
    let operator = Operator {
        is_armed: random.below(50) > 0,
        is_emergency_stop: random.below(100) == 0,
        manual: (random.below(100) == 0).then_some(manual),
    };
    let ranges = (0..random.below(5)).map(|_| RangeReading {
        bearing_rad: random.unit() * 7.0 - 3.5,
        distance_m: random.unit() * 6.0,
    });
    let ranges = ranges.collect();
    let receivers = [Receiver::Silent, Receiver::Unreadable, Receiver::NoVelocity, Receiver::Sound];
    Percepts {
        time_us,
        fix,
        heading_rad,
        speed_mps,
        turn_rate_radps,
        ranges,
        inputs,
        operator,
        scan_us: (random.below(3) > 0).then_some(time_us),
        pose: pose(time_us, random),
        is_link_lost: random.below(9) == 0,
        mates: (0..random.below(5)).map(|_| mate(time_us, random)).collect(),
        garbled_ranges: 0,
        receiver: receivers[random.below(receivers.len())],
    }
}

/// A mate at random, at times with numbers that are not finite or not of a team.
fn mate(time_us: u64, random: &mut Random) -> Mate {
    let position_m =
        (random.below(4) > 0).then(|| [random.unit() * 50.0, f32::from_bits(random.next() as u32)]);
    let news = News { robot: random.below(7) as u8, position_m, signal: random.below(3) as u16 };
    let quality = f32::from_bits(random.next() as u32);
    Mate { time_us: random.below(2) as u64 * time_us, heard: Heard { news, quality } }
}

/// Poses at random, some of them not finite.
fn pose(time_us: u64, random: &mut Random) -> Option<Pose> {
    (random.below(3) == 0).then(|| Pose {
        time_us,
        position_m: [random.unit() * 50.0, f32::from_bits(random.next() as u32)],
        heading_rad: (random.below(2) > 0).then_some(random.unit() * 9.0),
        accuracy_mm: random.below(8_000) as u32,
    })
}

/// A receiver's bytes, decoded by the drivers.
pub(crate) fn gps(bytes: &[u8]) {
    let mut decoder = runtime::gps::Decoder::default();
    for solution in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
        assert!(!solution.is_valid || solution.place.is_valid(), "{solution:?}");
    }
}

/// Packets in both directions, and the task that receives them.
pub(crate) fn link(bytes: &[u8]) {
    let (mut up, mut down) = (packet::Decoder::default(), packet::Decoder::default());
    for &byte in bytes {
        let uplink: Option<Uplink> = up.push(byte);
        if let Some(uplink) = uplink {
            assert!(packet::encode(&uplink).is_some(), "a decoded uplink can be encoded");
        }
        let downlink: Option<Downlink> = down.push(byte);
        if let Some(downlink) = downlink {
            assert!(packet::encode(&downlink).is_some(), "a decoded downlink can be encoded");
        }
    }
    let slots = Slots::<NoopRawMutex>::new();
    block_on(runtime::operator_task(bytes, &slots, || 7));
    let _ = slots.operator.at(u64::MAX, &Parameters::default().link);
}

/// A transport that delivers sensor records from bytes.
struct Records<'b>(std::slice::Chunks<'b, u8>);

impl runtime::lockstep::Transport for Records<'_> {
    fn receive(&mut self) -> Option<SensorRecord> {
        self.0.by_ref().find_map(SensorRecord::from_bytes)
    }

    fn send(&mut self, record: &CommandRecord) {
        check_finite(&record.commands);
        let bytes = record.to_bytes().expect("a record fits");
        assert_eq!(CommandRecord::from_bytes(&bytes), Some(*record));
    }
}

/// Sensor records, through the whole robot.
pub(crate) fn lockstep(bytes: &[u8]) {
    static BLOB: OnceLock<Vec<u8>> = OnceLock::new();
    for bytes in bytes.chunks(COMMAND_RECORD_BYTES) {
        let _ = CommandRecord::from_bytes(bytes);
    }
    let blob =
        BLOB.get_or_init(|| soak::fixtures::blob(soak::fixtures::sixteen()).expect("a sound blob"));
    let blob = Blob::parse(blob).expect("a sound blob");
    let records = Records(bytes.chunks(SENSOR_RECORD_BYTES));
    runtime::lockstep::run_blocking(blob, records, ());
}

/// A trace: its plans, the replay of its ticks, and its story.
pub(crate) fn trace(bytes: &[u8]) {
    let Ok(mut trace) = Trace::from_bytes(bytes) else { return };
    trace.percepts.truncate(MAX_TICKS);
    assert!(Trace::from_bytes(&trace.to_bytes()).is_ok());
    let blob = repaired(&trace.blob);
    let Ok(blob) = Blob::parse_exact(&blob) else { return };
    let _ = trace.replayed_hash(&blob);
    for turn in story::of(&blob, &trace.percepts).turns {
        assert!(turn.tick < trace.percepts.len());
    }
}
