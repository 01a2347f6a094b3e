//! Aspects of interest and facts (H25, H46).

use crate::bench::{Robot, blob, check};

/// H46: the last value is kept for a time, then the declared one is used. A value that is not
/// finite is missing. An input that never had a value has the declared one at once.
#[test]
fn missing_inputs_hold_and_then_count_as_declared() {
    let mission = "
        input fuel; hold 250; missing 0
        action step hold 9000
        frame work
        = step
        behaviour a work; when fuel NB NM NS ZO PS PM PB; unconditional 1
    ";
    let bytes = blob(mission);
    for gap in ["?", "NaN", "inf"] {
        let mut robot = Robot::new(&bytes);
        let mut criticality = |line: &str| {
            robot.go(line);
            robot.report.criticalities[0]
        };
        let (declared, last) = (1.0 / 18.0, 0.5);
        for (line, expected) in [
            (format!("fuel={gap}"), declared),
            ("fuel=0.5".into(), last),
            (format!("fuel={gap}"), last),
            ("x1".into(), last),
            ("x1".into(), declared),
            ("fuel=0.5".into(), last),
        ] {
            assert!((criticality(&line) - expected).abs() < 1e-3, "{line}");
        }
    }
}

/// H25: every source of an aspect of interest, results of rules included.
#[test]
fn every_source_is_heard() {
    let mission = "
        input channel
        input time; of time; range 0 10
        input place; of distance 3 4; range 0 10
        input lamp; of output 2
        input way; of cost; range 0 100
        input dear; of price 3; range 0 60
        input tank; of range-left 0 300; range 0 100
        input drawn; of rules channel PB PM PS ZO NS NM NB; range 0 1
        action on set 2 on
        action step wander 90000
        frame work
        = on step
        behaviour a work; when channel NB NM NS ZO PS PM PB
        behaviour b work; when time NB NM NS ZO PS PM PB
        behaviour c work; when place NB NM NS ZO PS PM PB
        behaviour d work; when lamp NB NM NS ZO PS PM PB
        behaviour e work; when way NB NM NS ZO PS PM PB
        behaviour f work; when dear NB NM NS ZO PS PM PB
        behaviour g work; when drawn NB NM NS ZO PS PM PB
        behaviour h work; when tank NB NM NS ZO PS PM PB
    ";
    let bytes = blob(mission);
    let mut robot = Robot::new(&bytes);
    robot.go("channel=0.3333 at=0,0 tick=2000");
    assert!(robot.report.criticalities[3] < 0.06, "the output is not on yet");
    robot.go("x1");
    // A third of a tank for 300 m, less the cost of 50 m.
    let expected = [0.3333, 0.5, 0.5, 0.9444, 0.5, 0.5, 0.6667, 0.5];
    for (behaviour, expected) in expected.into_iter().enumerate() {
        let found = robot.report.criticalities[behaviour];
        assert!((found - expected).abs() < 0.01, "{behaviour}: {found}, not {expected}");
    }
    robot.go("at=6,8");
    assert!((robot.report.criticalities[2] - 0.5).abs() < 0.01, "as far from the other side");
    robot.go("at=?");
    assert!(robot.report.criticalities[2] < 0.06, "a distance needs a position");
    robot.go("at=0,0 channel=?");
    assert!(robot.report.criticalities[7] < 0.06, "a range needs a level");
}

/// Every kind of fact, at its borders.
#[test]
fn every_kind_of_fact() {
    let mission = "
        input level
        fact unset symbol
        fact set set
        fact low level level 0.2 0.4
        fact near near 1 1 2
        fact inside inside 0 0 2 2
        fact stuck stuck 1 200
        action step wander 90000
        frame work
        = step
        behaviour a work; when always PS
    ";
    let bytes = blob(mission);
    let mut robot = Robot::new(&bytes);
    let table = [
        ("level=0.2 at=3,1", "set low near"),
        ("level=0.4 at=2,2", "set low near inside"),
        ("level=0.41 at=2.1,2", "set near"),
        ("x1", "set near"),
        ("x1", "set near stuck"),
        ("at=0,0", "set near inside"),
        ("at=?", "set"),
        ("level=? x1", "set"),
    ];
    for (line, expected) in table {
        robot.go(line);
        assert_eq!(robot.facts(), expected, "{line}");
    }
}

/// An action that drives begins without the standstill of the one before it.
#[test]
fn a_new_drive_is_not_stuck_yet() {
    check(
        "input a
         fact stuck stuck 1 200
         action first wander 90000; until stuck
         action second wander 90000; until stuck
         frame work
         = first second
         behaviour a work; when always PS",
        "at=0,0 x7",
        "1: a engaged, [first second], first
         2: first
         5: second",
    );
}

/// A clock that jumps back neither ends nor starts an action.
#[test]
fn a_clock_that_jumps_back_stops_nothing() {
    check(
        "input a
         action step hold 300
         frame work
         = step
         behaviour a work; when always PS",
        "x2
         back=900 x3",
        "1: a engaged, [step], step
         2: step
         5: a finished, a engaged, [step], step",
    );
}

/// A fact is an aspect of interest too: 1 in each tick in which it holds, otherwise 0. Sensed facts
/// count as they are in this tick, and symbols as the last tick left them.
#[test]
fn facts_are_aspects_of_interest() {
    let mission = "
        input fuel
        input low; of fact low
        input drawn; of rules low NB NB NB NB PM PM PM
        input over; of fact done
        fact low level fuel 0 0.25
        fact done symbol
        fact high level drawn 0.5 1
        action step hold 200; adds done
        frame work
        = step
        behaviour a work; when low NB NB NB NB PS PS PS
        behaviour b work; when drawn NB NM NS ZO PS PM PB; dormant 0.99
        behaviour c work; when over PS PS PS PS NB NB NB
    ";
    let bytes = blob(mission);
    let mut robot = Robot::new(&bytes);
    let table = [
        // The first tick already knows the fact.
        ("fuel=0.2", [0.6667, 0.8333, 0.6667], "low high"),
        ("fuel=0.3", [0.0556, 0.1296, 0.6667], ""),
        // The step of 200 ms ends at the start of the tick after the criticalities.
        ("x1", [0.0556, 0.1296, 0.6667], "done"),
        ("x1", [0.0556, 0.1296, 0.0556], "done"),
        ("fuel=0.25", [0.6667, 0.8333, 0.0556], "low done high"),
    ];
    for (line, expected, facts) in table {
        robot.go(line);
        for (behaviour, expected) in expected.into_iter().enumerate() {
            let found = robot.report.criticalities[behaviour];
            assert!((found - expected).abs() < 0.001, "{line}, {behaviour}: {found}");
        }
        assert_eq!(robot.facts(), facts, "{line}");
    }
}

/// A plan whose last step makes its behaviour dormant is carried out once.
#[test]
fn a_behaviour_that_makes_itself_dormant_does_not_begin_again() {
    let mission = "
        input over; of fact done
        fact done symbol
        action step hold 200; adds done
        frame work
        = step
        behaviour a work; when over PS PS PS PS NB NB NB
    ";
    check(mission, "x6", "1: a engaged, [step], step\n2: step\n3: a finished, -\n4: -");
}
