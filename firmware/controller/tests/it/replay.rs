//! For all percepts: no panic, bounded commands, and a replay from a state repeats them.

use crate::bench::{ORIGIN, blob, open_field};
use controller::{State, tick};
use math::{GeoPoint, Vec2};
use plan_format::parameters::{Gains, OnTrouble, Selection, Steering};
use plan_format::{Blob, Parameters};
use proptest::prelude::*;
use robot_io::{Commands, Fix, Manual, Operator, Percepts, RangeReading, Receiver, TraceHash};

/// Any number, invalid ones included.
fn number() -> impl Strategy<Value = f32> {
    let wrong = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        0.0,
        -0.0,
    ];
    prop_oneof![prop::sample::select(wrong.to_vec()), -10.0_f32..10.0, prop::num::f32::ANY]
}

/// Places on the map, far from it and off the globe.
fn place() -> impl Strategy<Value = GeoPoint> {
    let near = (-300..3_000_i32, -300..3_000_i32).prop_map(|(lat, lon)| GeoPoint {
        lat_e7: ORIGIN.place.lat_e7 + lat,
        lon_e7: ORIGIN.place.lon_e7 + lon,
    });
    let any = (any::<i32>(), any::<i32>()).prop_map(|(lat_e7, lon_e7)| GeoPoint { lat_e7, lon_e7 });
    prop_oneof![4 => near, 1 => any]
}

prop_compose! {
    fn fix()(
        age_us in prop_oneof![Just(0_i64), -100_000..3_000_000_i64, any::<i64>()],
        is_valid in prop::bool::weighted(0.9),
        place in place(),
        accuracy_mm in prop_oneof![0..6_000_u32, any::<u32>()],
        velocity_mmps in prop::option::of(prop::array::uniform2(any::<i32>())),
        receiver_ms in prop::option::of(any::<u32>()),
    ) -> (i64, Fix) {
        (age_us, Fix { time_us: 0, is_valid, place, accuracy_mm, velocity_mmps, receiver_ms })
    }
}

prop_compose! {
    fn operator()(
        is_armed in prop::bool::weighted(0.9),
        is_emergency_stop in prop::bool::weighted(0.05),
        manual in prop::option::weighted(0.1, (number(), number())),
    ) -> Operator {
        let manual = manual
            .map(|(speed_mps, turn_rate_radps)| Manual { speed_mps, turn_rate_radps });
        Operator { is_armed, is_emergency_stop, manual }
    }
}

/// A tick's percepts, and the clock's step before it: usually one tick, sometimes none, a large
/// one, or one backwards.
fn step() -> impl Strategy<Value = (i64, Percepts)> {
    let elapsed_us =
        prop_oneof![4 => Just(50_000_i64), 1 => Just(0), 1 => 0..5_000_000_i64, 1 => any::<i64>()];
    let reading = (number(), number())
        .prop_map(|(bearing_rad, distance_m)| RangeReading { bearing_rad, distance_m });
    let sensors =
        (prop::option::of(number()), prop::option::of(number()), prop::option::of(number()));
    let ranges = prop::collection::vec(reading, 0..=16);
    let receiver = prop::sample::select(vec![
        Receiver::Silent,
        Receiver::Unreadable,
        Receiver::NoFix,
        Receiver::Sound,
    ]);
    (elapsed_us, (prop::option::of(fix()), receiver), sensors, ranges, operator()).prop_map(
        |(
            elapsed_us,
            (fix, receiver),
            (heading_rad, speed_mps, turn_rate_radps),
            ranges,
            operator,
        )| {
            // The time stamp carries the age until the clock is known.
            let fix = fix.map(|(age_us, fix)| Fix { time_us: age_us as u64, ..fix });
            let percepts = Percepts {
                time_us: 0,
                fix,
                heading_rad,
                speed_mps,
                turn_rate_radps,
                ranges: ranges.into_iter().collect(),
                inputs: Default::default(),
                operator,
                receiver,
                ..Percepts::default()
            };
            (elapsed_us, percepts)
        },
    )
}

fn history() -> impl Strategy<Value = Vec<Percepts>> {
    prop::collection::vec(step(), 1..60).prop_map(|steps| {
        let mut time_us = 1_000_000_u64;
        let at = |(elapsed_us, percepts): (i64, Percepts)| {
            time_us = time_us.wrapping_add_signed(elapsed_us);
            let stamp = |fix: Fix| Fix { time_us: time_us.wrapping_sub(fix.time_us), ..fix };
            Percepts { time_us, fix: percepts.fix.map(stamp), ..percepts }
        };
        steps.into_iter().map(at).collect()
    })
}

prop_compose! {
    fn parameters()(
        gains in prop::sample::select(vec![
            Gains::REACTIVE_ONLY, Gains::MOSTLY_REACTIVE, Gains::MOSTLY_PLAN, Gains::PLAN_ONLY,
        ]),
        selection in prop::sample::select(vec![Selection::Static, Selection::Dynamic]),
        steering in prop::sample::select(vec![
            Steering::Differential, Steering::Ackermann, Steering::Boat,
        ]),
        trouble in prop::sample::select(vec![OnTrouble::Stop, OnTrouble::Reactive]),
        sizes in prop::array::uniform4(prop_oneof![Just(0.0_f32), 0.0_f32..50.0]),
        noise_persistence_ticks in 0..30_u16,
        seed in any::<u32>(),
    ) -> Parameters {
        let [radius_m, stop_distance_m, avoid_sphere_m, min_turn_radius_m] = sizes;
        let mut p = Parameters { gains, selection, seed, ..Parameters::default() };
        p.vehicle.steering = steering;
        p.vehicle.radius_m = radius_m;
        p.vehicle.stop_distance_m = stop_distance_m;
        p.vehicle.min_turn_radius_m = min_turn_radius_m;
        p.schemas.avoid_sphere_m = avoid_sphere_m;
        p.schemas.noise_persistence_ticks = noise_persistence_ticks;
        p.trouble.off_map = trouble;
        p.trouble.no_route = trouble;
        p
    }
}

/// Whether a vehicle with these parameters can carry out the commands.
fn is_bounded(commands: &Commands, parameters: &Parameters) -> bool {
    let vehicle = &parameters.vehicle;
    let turns_on_circles = vehicle.steering == Steering::Ackermann;
    commands.speed_mps.abs() <= vehicle.max_speed_mps
        && commands.turn_rate_radps.abs() <= vehicle.max_turn_rate_radps
        && (!turns_on_circles
            || commands.turn_rate_radps.abs() * vehicle.min_turn_radius_m
                <= commands.speed_mps.abs() * 1.0001 + f32::MIN_POSITIVE)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn whatever_is_perceived_commands_are_finite_and_bounded(
        history in history(), parameters in parameters(), has_map in any::<bool>(),
    ) {
        let free = open_field(30, 30, (25, 25));
        let walled = free.replacen("....", ".##.", 40);
        let blob = blob(&[&free, &walled], parameters);
        let blob = if has_map {
            Blob::parse(&blob).expect("the blob is valid")
        } else {
            Blob::without_map(parameters, Some(ORIGIN), Some(Vec2::new(25.0, 25.0)))
        };
        let mut state = State::new(&blob);
        for percepts in &history {
            let commands = tick(&blob, &mut state, percepts);
            // False for NaN.
            prop_assert!(is_bounded(&commands, &parameters), "{:?}", commands);
        }
    }

    /// A stored state continues like the original.
    #[test]
    fn a_frozen_state_replays_the_same_ticks(history in history(), parameters in parameters()) {
        let blob = blob(&[&open_field(30, 30, (25, 25))], parameters);
        let blob = Blob::parse(&blob).expect("the blob is valid");
        let (before, after) = history.split_at(history.len() / 2);
        let mut state = State::new(&blob);
        run(&blob, &mut state, before);
        let mut cloned = state.clone();
        let trace = run(&blob, &mut state, after);
        prop_assert_eq!(run(&blob, &mut cloned, after), trace);
        prop_assert_eq!(cloned, state);
    }
}

fn run(blob: &Blob<'_>, state: &mut State, history: &[Percepts]) -> TraceHash {
    let mut trace = TraceHash::default();
    for percepts in history {
        let commands = tick(blob, state, percepts);
        trace.record(&percepts.sanitised(), &commands);
    }
    trace
}
