//! Missions to one of several goals, from their text to the robot's arrival.

use harness::mission::{self, Changes};
use it::own_map;
use robot_io::Reason;
use sim::{Ending, HostPilot, Outcome, Point, Scenario, Start};

/// The shipped yard with three pumps and this mission, without its first line, which names the map.
fn stations(mission: &str) -> Scenario {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = |name: &str| std::fs::read_to_string(own_map(name)).expect("it is shipped");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("a file in a folder of our own");
    };
    write("stations.ovl", &copy("stations.ovl"));
    let shipped = copy("stations.mission.toml");
    write("stations.mission.toml", &format!("{shipped}\n{mission}"));
    let scenario = mission::scenario(&folder.path().join("stations.ovl"), &Changes::default());
    scenario.unwrap_or_else(|message| panic!("{message}"))
}

fn run(scenario: &Scenario, position: Point, seed: u64) -> Outcome {
    let start = Start { position, heading_rad: 0.0, seed, sensors: scenario.sensors() };
    let robot = scenario.robot(&start, HostPilot::new(scenario.plan())).expect("it is clear");
    scenario.run(robot).expect("the robot answers")
}

const PUMPS: [Point; 3] = [[20.0, 6.0], [46.0, 10.0], [8.0, 34.0]];

fn distance(a: Point, b: Point) -> f64 {
    math::scalar::wide::hypot(a[0] - b[0], a[1] - b[1])
}

/// The pump with this number was reached and named, and nothing was touched.
#[track_caller]
fn assert_reached(outcome: &Outcome, pump: usize) {
    assert_eq!((outcome.ending, outcome.touches), (Some(Ending::Reached), 0), "{outcome:?}");
    assert_eq!(outcome.goal, Some(pump as u8));
    let end = *outcome.route.last().expect("a route");
    assert!(distance(end, PUMPS[pump]) < 4.0, "{end:?}");
}

/// W51: the goal that costs least, not the one that is nearest in a straight line.
#[test]
fn a_robot_reaches_the_goal_that_costs_least() {
    let scenario = stations("");
    // The fence stands between the first start and the pump in the east.
    let near: Vec<f64> = PUMPS.map(|pump| distance([36.0, 10.0], pump)).into();
    assert!(near[1] < near[0] && near[1] < near[2], "{near:?}");
    for (start, pump) in [
        ([36.0, 10.0], 0),
        ([55.0, 15.0], 1),
        ([50.0, 35.0], 1),
        ([12.0, 22.0], 2),
        ([33.0, 30.0], 2),
    ] {
        let plan = scenario.plan();
        let layer = scenario.layer_from(start).expect("a route");
        let cell = plan.cell_at(math::Vec2::new(start[0] as f32, start[1] as f32)).expect("on it");
        assert_eq!(usize::from(layer.goal_number(cell)), pump, "{start:?}");
        assert_reached(&run(&scenario, start, 1), pump);
    }
}

/// A position that wavers between the ways to two goals costs little time.
#[test]
fn a_start_between_two_goals_is_harmless() {
    let scenario = stations("");
    let plan = scenario.plan();
    let number = |at: Point| {
        let layer = scenario.layer_from(at)?;
        Some(layer.goal_number(plan.cell_at(math::Vec2::new(at[0] as f32, at[1] as f32))?))
    };
    // The border between the pumps in the south and the north, along a line west of the workshop.
    let border = (0..300).map(|step| [10.0, 8.0 + 0.1 * f64::from(step)]);
    let border = border.clone().zip(border.skip(1)).find(|(a, b)| number(*a) != number(*b));
    let (south, north) = border.expect("a border");
    assert_eq!((number(south), number(north)), (Some(0), Some(2)));
    let alone_s = run(&scenario, [10.0, north[1] + 6.0], 1).time_s;
    for seed in 1..=6 {
        let outcome = run(&scenario, north, seed);
        assert_reached(&outcome, usize::from(outcome.goal.expect("several goals")));
        assert!(outcome.time_s < 2.5 * alone_s + 10.0, "{} s, {alone_s} s", outcome.time_s);
    }
}

/// Without advice, a robot drives to the goal that is nearest in a straight line.
#[test]
fn a_robot_without_advice_drives_to_the_nearest_goal() {
    let scenario = stations("[gains]\npreset = \"100:0\"\n");
    assert_reached(&run(&scenario, [50.0, 16.0], 1), 1);
    assert_reached(&run(&scenario, [14.0, 30.0], 1), 2);
    // The fence is in the way, and nothing leads around it.
    let trapped = run(&scenario, [36.0, 10.0], 1);
    assert_eq!((trapped.ending, trapped.goal), (Some(Ending::Trapped), Some(1)));
}

/// Behaviours are at the goal of a plan at any of its goals.
#[test]
fn a_behaviour_refuels_at_any_goal() {
    let mission = "[inputs]\ntank = { source = \"fuel\", missing = { hold_s = 1, then = 0 } }\n\
        [behaviours]\nrefuel = { criticality = { tank = \"PB PB PB PB PB PB PB\" } }\n\
        [frames]\nrefuel = { productions = [\"entry -> to fuel -> fill -> exit\"] }\n\
        [actions]\n\"to fuel\" = { do = \"follow fuel at 34:66\" }\nfill = { do = \"hold 5 s\" }\n";
    let scenario = stations(mission);
    for (position, pump) in [([36.0, 10.0], 0), ([55.0, 15.0], 1), ([12.0, 22.0], 2)] {
        let start = Start { position, heading_rad: 0.0, seed: 1, sensors: scenario.sensors() };
        let robot = scenario.robot(&start, HostPilot::new(scenario.plan())).expect("it is clear");
        let outcome = scenario.run(robot.within_time(60.0)).expect("the robot answers");
        assert!(outcome.ticks_of(Reason::Holding) >= 90, "{outcome:?}");
        assert_eq!(outcome.goal, Some(pump as u8), "{outcome:?}");
        let end = *outcome.route.last().expect("a route");
        assert!(distance(end, PUMPS[pump]) < 4.0, "{end:?}");
    }
}
