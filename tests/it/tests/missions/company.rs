//! Obstacles that the map does not have: a crate on the route, another robot.

use super::*;
use harness::mission::{self, Changes};
use maps::{Role, Shape};
use robot_io::Reason;
use sim::{Scenario, Simulation, Start};

/// South of the street, on the way to the north gate.
const SOUTH: Point = [70.5, 15.5];

fn scenario() -> Scenario {
    let scenario = mission::scenario(&it::own_map("campus.opar"), &Changes::default());
    scenario.unwrap_or_else(|error| panic!("{error}"))
}

fn start(position: Point, seed: u64) -> Start {
    Start { position, heading_rad: 0.0, seed, sensors: SensorSettings::USUAL }
}

/// The plans do not contain the crate, so only the sensors keep the robot off it.
#[test]
fn an_obstacle_that_is_not_on_the_map_is_driven_around() {
    let known = scenario();
    let run = |scenario: &Scenario| {
        let robot = scenario.robot(&start(SOUTH, 1), HostPilot::new(scenario.plan()));
        robot.expect("the start is clear").run(&scenario.truth).expect("the robot answers")
    };
    let free = run(&known);
    let on_the_route = free.route[free.route.len() / 4];
    let crate_there = Shape::Circle { centre: on_the_route, radius: 0.6 };
    let obstacles = known.map.features.iter().filter(|feature| feature.role == Role::Obstacle);
    let shapes = obstacles.map(|feature| &feature.shape).chain([&crate_there]);
    let truth = World::new(shapes);
    assert!(!truth.is_clear(on_the_route, 0.0) && known.truth.is_clear(on_the_route, 0.3));

    let changed = Scenario { truth, ..known.clone() };
    assert_eq!(changed.blob, known.blob, "the plans are those of the map");
    let around = run(&changed);
    assert!(around.reached() && around.touches == 0, "{:?}", around.reasons);
    assert_ne!(around.trace_hash, free.trace_hash);
}

/// Two robots that meet see each other, and their order in the simulation does not change their
/// traces.
#[test]
fn two_robots_that_meet_have_the_same_traces_in_both_orders() {
    let scenario = scenario();
    let starts = [start(SOUTH, 1), start([SOUTH[0] + 3.0, SOUTH[1] + 0.5], 2)];
    let run = |starts: &[Start]| -> Vec<Outcome> {
        let robots = starts.iter().map(|start| {
            let robot = scenario.robot(start, HostPilot::new(scenario.plan()));
            robot.expect("the start is clear")
        });
        Simulation::new(&scenario.truth, robots).finish().expect("the robots answer")
    };
    let [first, second] = starts;
    let forwards = run(&starts);
    let mut backwards = run(&[second, first]);
    backwards.reverse();
    assert_eq!(forwards, backwards);
    for (start, outcome) in starts.iter().zip(&forwards) {
        assert!(outcome.ticks_of(Reason::Driving) > 100, "{:?}", outcome.reasons);
        assert_ne!(run(&[*start])[0].trace_hash, outcome.trace_hash, "they see each other");
    }
}
