//! The whole shell on a host: GPS bytes in, commands out, through the tasks that a board runs.

use std::cell::RefCell;
use std::pin::pin;

use math::{GeoPoint, Vec2};
use plan_format::parameters::Gains;
use plan_format::{Blob, Origin, Parameters, TeamPolicy};
use robot_io::{
    CommandRecord, Commands, Heard, News, Operator, Percepts, RangeReading, Reason, SensorRecord,
};
use runtime::lockstep::{Mailbox, Transport, run, run_blocking};
use runtime::{Fallback, Observer, TICK_PERIOD_US, load};

const HOME: GeoPoint = GeoPoint { lat_e7: 337_756_180, lon_e7: -843_963_300 };
const ARMED: Operator = Operator { is_armed: true, is_emergency_stop: false, manual: None };

/// Reactive driving to a point 100 m east of home; no map.
fn eastward() -> Blob<'static> {
    let parameters = Parameters { gains: Gains::REACTIVE_ONLY, ..Parameters::default() };
    let origin = Origin { place: HOME, at_m: [0.0, 0.0], heading_rad: 0.0 };
    Blob::without_map(parameters, Some(origin), Some(Vec2::new(100.0, 0.0)))
}

/// NAV-PVT at home.
fn nav_pvt() -> Vec<u8> {
    let mut body = vec![1, 7, 92, 0];
    body.resize(4 + 92, 0);
    body[4 + 20] = 3;
    body[4 + 21] = 1;
    body[4 + 24..4 + 28].copy_from_slice(&HOME.lon_e7.to_le_bytes());
    body[4 + 28..4 + 32].copy_from_slice(&HOME.lat_e7.to_le_bytes());
    body[4 + 40..4 + 44].copy_from_slice(&1_000_u32.to_le_bytes());
    let (a, b) = body.iter().fold((0_u8, 0_u8), |(a, b), &byte| {
        let a = a.wrapping_add(byte);
        (a, b.wrapping_add(a))
    });
    [&[0xb5, 0x62], &body[..], &[a, b]].concat()
}

fn record(gps: &[u8]) -> SensorRecord {
    SensorRecord {
        gps: gps.iter().copied().collect(),
        heading_rad: Some(0.0),
        ranges: Some(Default::default()),
        operator: ARMED,
        ..SensorRecord::default()
    }
}

/// A world that plays back records and stores the answers.
struct Tape<'a> {
    records: std::slice::Iter<'a, SensorRecord>,
    answers: &'a RefCell<Vec<CommandRecord>>,
}

impl Transport for Tape<'_> {
    fn receive(&mut self) -> Option<SensorRecord> {
        self.records.next().cloned()
    }

    fn send(&mut self, record: &CommandRecord) {
        self.answers.borrow_mut().push(*record);
    }
}

/// Reports 77 instructions per tick, and checks one call before and one after each tick.
#[derive(Default)]
struct Count {
    is_ticking: bool,
}

impl Observer for Count {
    fn before(&mut self) {
        assert!(!self.is_ticking);
        self.is_ticking = true;
    }

    fn after(&mut self, percepts: &Percepts, commands: &Commands) -> u32 {
        assert!(self.is_ticking && percepts.time_us > 0);
        assert!(percepts.operator.is_armed || commands.speed_mps == 0.0);
        self.is_ticking = false;
        77
    }
}

fn play(blob: Blob<'_>, records: &[SensorRecord]) -> Vec<CommandRecord> {
    let answers = RefCell::new(Vec::new());
    run_blocking(blob, Tape { records: records.iter(), answers: &answers }, Count::default());
    answers.into_inner()
}

/// Fixes once a second, each cut in two; an obstacle and an emergency stop on the way.
fn mission() -> Vec<SensorRecord> {
    let fix = nav_pvt();
    let (head, tail) = fix.split_at(31);
    (0..200)
        .map(|tick| {
            let mut record = record(match tick % 20 {
                0 => head,
                1 => tail,
                _ => &[],
            });
            if (50..80).contains(&tick) {
                let reading = RangeReading { bearing_rad: 0.1, distance_m: 2.0 };
                record.ranges.get_or_insert_default().push(reading).expect("there is room");
            }
            record.operator.is_emergency_stop = (100..110).contains(&tick);
            record
        })
        .collect()
}

#[test]
fn a_fix_counts_in_the_tick_of_its_last_byte() {
    let fix = nav_pvt();
    let (head, tail) = fix.split_at(99);
    let answers = play(eastward(), &[record(&[]), record(head), record(tail), record(&[])]);
    let reasons: Vec<Reason> = answers.iter().map(|answer| answer.commands.reason).collect();
    assert_eq!(reasons[..2], [Reason::NoFix; 2]);
    assert!(answers[2].commands.speed_mps > 0.5 && answers[3].commands.speed_mps > 0.5);
}

#[test]
fn several_fixes_in_one_record_are_all_read() {
    let fixes = nav_pvt().repeat(5);
    let answers = play(eastward(), &[record(&fixes)]);
    assert!(answers[0].commands.speed_mps > 0.5, "{:?}", answers[0]);
}

#[test]
fn time_counts_ticks_and_instructions_are_the_observers() {
    let answers = play(eastward(), &mission());
    assert_eq!(answers.len(), 200);
    for (tick, answer) in (1..).zip(&answers) {
        assert_eq!(answer.time_us, tick * TICK_PERIOD_US);
        assert_eq!(answer.instructions, 77);
    }
}

#[test]
fn the_same_records_give_the_same_answers_in_every_way_of_running() {
    let records = mission();
    let answers = play(eastward(), &records);
    assert_eq!(play(eastward(), &records), answers);

    let mailbox = Mailbox::default();
    let mut robot = pin!(run(eastward(), &mailbox, &mailbox));
    for (record, expected) in records.into_iter().zip(answers) {
        let answer = mailbox.step(robot.as_mut(), record).expect("an answer");
        // This observer counts no instructions.
        assert_eq!(CommandRecord { instructions: 77, ..answer }, expected);
    }
}

#[test]
fn the_trace_hash_notices_any_change() {
    let hash = |records: &[SensorRecord]| {
        play(eastward(), records).last().expect("there are answers").trace_hash
    };
    let records = mission();
    let unchanged = hash(&records);
    for tick in [0, 1, 60, 105, 199] {
        let mut changed = records.clone();
        changed[tick].heading_rad = Some(1e-6);
        assert_ne!(hash(&changed), unchanged, "tick {tick}");
    }
}

#[test]
fn nan_and_infinity_are_not_percepts() {
    let mut noisy = mission();
    for record in &mut noisy {
        record.turn_rate_radps = Some(f32::NAN);
        let nowhere = RangeReading { bearing_rad: 1.0, distance_m: f32::INFINITY };
        record.ranges.get_or_insert_default().push(nowhere).expect("there is room");
    }
    assert_eq!(play(eastward(), &noisy), play(eastward(), &mission()));
}

#[test]
fn the_operator_outranks_the_plan() {
    for (tick, answer) in play(eastward(), &mission()).iter().enumerate() {
        let is_stopped = (100..110).contains(&tick);
        assert_eq!(answer.commands.reason == Reason::EmergencyStop, is_stopped, "tick {tick}");
        assert!(!is_stopped || answer.commands.speed_mps == 0.0);
    }
}

#[test]
fn a_refused_blob_stands_still_or_drives_reactively_as_the_build_chooses() {
    for region in [&[][..], &[0; 192], &[0xff; 4096], b"not a blob at all, however long it is"] {
        let stop = load(region, &Fallback::default());
        assert!(stop.refusal.is_some());
        assert!(play(stop.blob, &mission()).iter().all(|answer| answer.commands.speed_mps == 0.0));

        let plan = eastward();
        let fallback =
            Fallback { parameters: *plan.parameters(), origin: plan.origin(), goal: plan.goal() };
        let reactive = load(region, &fallback);
        assert_eq!(reactive.refusal, stop.refusal);
        assert_eq!(play(reactive.blob, &mission()), play(plan, &mission()));
    }
}

/// Five robots and one of another team share a channel, which also echoes the robot's own news.
#[test]
fn an_echo_and_a_stranger_never_displace_a_mate() {
    let team = TeamPolicy { robot: 1, robots: 5, ..TeamPolicy::default() };
    let blob = Blob::without_map(Parameters { team, ..Parameters::default() }, None, None);
    let mailbox = Mailbox::default();
    let mut robot = pin!(run(blob, &mailbox, &mailbox));
    for (tick, sender) in (0..60).zip([3, 1, 0, 9, 4, 2].into_iter().cycle()) {
        let news = News { robot: sender, position_m: None, signal: tick };
        let heard = [Heard { news, quality: 1.0 }].into_iter().collect();
        let record = SensorRecord { heard, ..SensorRecord::default() };
        mailbox.step(robot.as_mut(), record).expect("an answer");
        let mates = mailbox.take_percepts().expect("percepts").mates;
        let known: Vec<u8> = mates.iter().map(|mate| mate.heard.news.robot).collect();
        let arrived = [1, 1, 2, 2, 3].get(usize::from(tick)).copied().unwrap_or(4);
        assert_eq!(known, [3, 0, 4, 2][..arrived], "tick {tick}");
        let latest = mates.iter().map(|mate| mate.heard.news.signal).max();
        let is_mate = ![1, 9].contains(&sender);
        assert!(!is_mate || latest == Some(tick), "tick {tick}: {latest:?}");
    }
}

#[test]
fn a_mailbox_without_a_robot_gives_no_answer() {
    let mailbox = Mailbox::default();
    let elsewhere = Mailbox::default();
    let mut robot = pin!(run(eastward(), &elsewhere, ()));
    assert_eq!(mailbox.step(robot.as_mut(), SensorRecord::default()), None);
}
