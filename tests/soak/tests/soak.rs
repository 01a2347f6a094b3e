//! A short soak, and measurements on missions made for them.

use behaviour::Decision;
use controller::{State, explain};
use math::Vec2;
use plan_format::Blob;
use robot_io::{Fix, Operator, Percepts};
use soak::{KINDS, fixtures, soak};

#[test]
fn three_hundred_thousand_ticks() {
    let summary = soak(1, 300_000, &mut |_| {}).unwrap_or_else(|failure| panic!("{failure}"));
    assert!(summary.refused > 0);
    let missing: Vec<_> =
        KINDS.iter().filter(|kind| !summary.decisions.contains_key(*kind)).collect();
    assert!(missing.is_empty(), "never decided: {missing:?}");
}

#[test]
fn equal_seeds_give_equal_runs() {
    let run = || soak(77, 3_000, &mut |_| {});
    assert_eq!(run(), run());
}

/// In tick 732 of this mission, eight actions that take no time begin and end, and nothing else
/// happens.
#[test]
fn a_tick_full_of_actions_that_take_no_time_is_not_dead() {
    soak(1666, 1, &mut |_| {}).unwrap_or_else(|failure| panic!("{failure}"));
}

/// What a robot perceives that passes the checks for arming.
fn armed(blob: &Blob<'_>, time_us: u64, inputs: [Option<f32>; 8]) -> Percepts {
    let frame = blob.map_frame().expect("the blob is on the globe");
    let fix = Fix {
        time_us,
        is_valid: true,
        place: frame.to_geodetic(Vec2::new(10.0, 10.0)),
        accuracy_mm: 10,
        velocity_mmps: None,
        receiver_ms: None,
    };
    Percepts {
        time_us,
        inputs,
        fix: Some(fix),
        heading_rad: Some(0.0),
        operator: Operator { is_armed: true, ..Operator::default() },
        ..Percepts::default()
    }
}

/// H07: a million iterations through the whole tick, in constant memory.
#[test]
fn a_million_iterations_take_constant_memory() {
    let blob = fixtures::blob(fixtures::endless_loop()).expect("the mission is sound");
    let blob = Blob::parse(&blob).expect("the blob is sound");
    let mut state = State::new(&blob);
    let (mut iterations, mut tick) = (0_u32, 0);
    while iterations < 1_000_000 {
        tick += 1;
        let explanation = explain(&blob, &mut state, &armed(&blob, tick * 50_000, [None; 8]));
        let chosen = explanation.report.decisions.iter();
        let chosen = chosen.filter(|decision| matches!(decision, Decision::Chose { .. })).count();
        assert!(chosen > 0 && state.behaviours.components() <= 3, "tick {tick}");
        iterations += chosen as u32;
    }
    assert!(tick <= 250_000, "an iteration is two steps, and a tick has eight");
}

/// H36: sixteen behaviours whose criticalities change all the time. A behaviour that is clearly the
/// most critical has the robot as soon as the running action ends.
#[test]
fn sixteen_behaviours_starve_nobody() {
    let blob = fixtures::blob(fixtures::sixteen()).expect("the mission is sound");
    let blob = Blob::parse(&blob).expect("the blob is sound");
    let hysteresis = blob.mission().behaviours().get(0).expect("there are sixteen").hysteresis;
    let mut state = State::new(&blob);
    let (mut waits, mut longest, mut switches) = ([0_u32; 16], 0, 0);
    for tick in 1..=20_000_u32 {
        // Eight waves of different lengths.
        let wave = |channel: u32| Some(fixtures::wave(tick * 64 / (7 + 4 * channel)));
        let inputs = [0, 1, 2, 3, 4, 5, 6, 7].map(wave);
        let explanation =
            explain(&blob, &mut state, &armed(&blob, u64::from(tick) * 50_000, inputs));
        let criticalities = explanation.report.criticalities;
        let most = criticalities.iter().copied().fold(0.0, f32::max);
        for (index, wait) in waits.iter_mut().enumerate() {
            let others = criticalities.iter().enumerate().filter(|&(other, _)| other != index);
            let second = others.map(|(_, &value)| value).fold(0.0, f32::max);
            let is_clear = criticalities[index] == most && most > second + hysteresis;
            let has_robot = state.behaviours.phase(index) == behaviour::Phase::Active;
            *wait = if is_clear && !has_robot { *wait + 1 } else { 0 };
            longest = longest.max(*wait);
        }
        let is_switch = |d: &&Decision| matches!(d, Decision::Interrupted { .. });
        switches += explanation.report.decisions.iter().filter(is_switch).count();
    }
    assert!(switches > 2_000, "only {switches} switches");
    // An action of 100 ms is two ticks of 50 ms.
    assert!(longest <= 2, "a behaviour waited for {longest} ticks");
}

/// The mission of the instruction budget keeps its promises: each behaviour has the robot in turn,
/// twelve components live at once, and an action always drives.
#[test]
fn the_mission_of_the_budget_is_as_large_as_it_says() {
    let blob = fixtures::blob(fixtures::budget()).expect("the mission is sound");
    let blob = Blob::parse(&blob).expect("the blob is sound");
    let mission = blob.mission();
    assert_eq!((mission.behaviours().len(), mission.rules().len()), (4, 16));
    let mut state = State::new(&blob);
    let (mut most, mut engaged) = (0, 0_u16);
    for tick in 1..=400_u32 {
        let mut percepts = armed(&blob, u64::from(tick) * 50_000, [Some(fixtures::wave(tick)); 8]);
        percepts.fix = blob.map_frame().map(|frame| robot_io::Fix {
            time_us: percepts.time_us,
            is_valid: true,
            place: frame.to_geodetic(math::Vec2::new(3.5, 3.5)),
            accuracy_mm: 500,
            velocity_mmps: None,
            receiver_ms: Some(tick * 50),
        });
        // It stands in front of something.
        (percepts.heading_rad, percepts.speed_mps) = (Some(0.0), Some(0.0));
        // Disarmed at times: motors that do not answer for longer would stop it.
        percepts.operator.is_armed = tick % 50 != 0;
        let explanation = explain(&blob, &mut state, &percepts);
        if percepts.operator.is_armed {
            assert_eq!(explanation.commands.reason, robot_io::Reason::Driving, "tick {tick}");
        }
        assert_eq!(explanation.report.omitted, 0, "tick {tick}");
        most = most.max(state.behaviours.components());
        for decision in &explanation.report.decisions {
            if let Decision::Interrupted { by, .. } = decision {
                engaged |= 1 << by;
            }
        }
    }
    assert!(most >= 12, "only {most} components");
    assert_eq!(engaged, 0b1111, "each has interrupted another");
}
