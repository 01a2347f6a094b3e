//! World files after what users of other simulators asked for or reported: obstacles that move or
//! are not on the map, maps that do not fit the world, sensors that fail. Each world lies beside a
//! map without a place on the globe, so the simulator gives it one.

use harness::mission::{self, Changes};
use math::scalar::wide;
use robot_io::Reason;
use sim::{Ending, HostPilot, Outcome, Robot, Scenario, Sensors, Start};

/// A lane of 40 m by 12 m with a kiosk in its middle. The goal is in the east.
const LANE: &str = "--RESOLUTION 0.25\nSITE lane\nORIGIN 0 0\nMISSION-AREA 40 12\nCONTROL MEASURES:\n\
    PP StartPlace* 3 6\nPP east 37 6\nOBSTACLE 20 6 1\nWALL kiosk\n 28 9  30 9  30 11  28 11  28 9\n 3\n";

/// The lane with this text in its mission and this world file.
fn scenario(mission: &str, world: &str) -> Scenario {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("a file in a folder of our own");
    };
    write("lane.ovl", LANE);
    write("lane.mission.toml", &format!("plan = \"east\"\n{mission}"));
    let start = "start = [3, 6]\ntime_limit = 300\ngps_sigma = 0.02";
    write("lane.world.toml", &format!("{start}\n{world}"));
    let scenario = mission::scenario(&folder.path().join("lane.ovl"), &Changes::default());
    let scenario = scenario.unwrap_or_else(|message| panic!("{message}"));
    assert_eq!(scenario.notes.len(), 1, "the map has no place on the globe: {:?}", scenario.notes);
    scenario
}

/// The robot at the start that the world file gives.
fn robot(scenario: &Scenario) -> Robot<Box<dyn Sensors>, HostPilot<'_>> {
    let surroundings = scenario.surroundings.as_ref().expect("it has a world file");
    let (position, sensors) = (surroundings.start, scenario.sensors());
    let start = Start { position, heading_rad: 0.0, seed: 1, sensors };
    scenario.robot(&start, HostPilot::new(scenario.plan())).expect("it is clear")
}

/// Runs on the lane with this world file.
fn run(world: &str) -> Outcome {
    let scenario = scenario("", world);
    scenario.run(robot(&scenario)).expect("the robot answers")
}

/// Checks that the robot arrives and touches nothing.
fn arrives(outcome: &Outcome, what: &str) {
    let Outcome { ending, touches, reasons, time_s, .. } = outcome;
    assert_eq!((*ending, *touches), (Some(Ending::Reached), 0), "{what}: {time_s} s, {reasons:?}");
}

/// Checks that the robot stands still to the end for a reason, and touches nothing.
fn stands(outcome: &Outcome, reason: Reason, what: &str) {
    assert_eq!(
        (outcome.ending, outcome.touches),
        (Some(Ending::Trapped), 0),
        "{what}: {outcome:?}"
    );
    let last = outcome.reasons.iter().max_by_key(|(_, ticks)| *ticks);
    assert_eq!(last.map(|(reason, _)| *reason), Some(reason), "{what}: {:?}", outcome.reasons);
    let ticks = outcome.ticks_of(reason);
    assert!(ticks >= 1_000, "{what}: {:?}", outcome.reasons);
}

#[test]
fn a_world_as_on_the_map_is_crossed() {
    arrives(&run(""), "the map is right");
}

/// In Gazebo, a scanner does not see moving people (ROBOTIS-GIT/turtlebot3 issue 980,
/// robotics-upo/hunav_gazebo_wrapper issue 1).
#[test]
fn a_person_who_crosses_the_lane_is_seen_and_not_touched() {
    let alone = run("");
    let person = "[[discs]]\nradius = 0.3\nspeed = 0.8\npath = [[10, 1], [10, 11]]\nstart = 0.5\n";
    let met = run(person);
    arrives(&met, "a person crosses");
    assert_ne!(met.trace_hash, alone.trace_hash, "the robot sees the person");
}

/// In turtlebot_simulator, the walls lie beside those of the map (issue 42); the warehouse of
/// ros_motion_planning is 20 cm narrower than its map (issue 76).
#[test]
fn a_world_that_is_shifted_turned_or_larger_than_its_map_is_crossed() {
    for world in ["shift = [0.3, -0.4]", "turn = 0.02", "scale = 1.03"] {
        let outcome = run(world);
        arrives(&outcome, world);
        assert_ne!(outcome.trace_hash, run("").trace_hash, "{world}");
    }
}

/// An obstacle is in the world and not on the map (ros-agriculture/lawn_tractor issue 29), or the
/// other way round.
#[test]
fn obstacles_that_only_the_world_or_only_the_map_has_are_passed() {
    let extra = "[[extra]]\ncircle = [10, 6, 0.4]\n";
    arrives(&run(extra), extra);
    let gone = run("[[missing]]\nat = [20, 6]\nwithin = 0.5\n");
    arrives(&gone, "the obstacle in the middle is gone");
    // The plan still leads around it.
    assert!(gone.route.iter().all(|at| wide::hypot(at[0] - 20.0, at[1] - 6.0) > 1.0));
    arrives(&run("removed = 1"), "nothing is there");
}

/// A rover spins when its GPS is lost (PX4/PX4-Autopilot issue 15211). ArduPilot's SIM_GPS_DISABLE
/// leaves the position known (issue 27103).
#[test]
fn without_gps_the_robot_stands_and_does_not_spin() {
    let lost = run("[[faults]]\nsensor = \"gps\"\nkind = \"lost\"\nfrom = 10\n");
    stands(&lost, Reason::StaleFix, "lost after 10 s");
    assert!(lost.distance_m > 5.0 && lost.turn_rad < 3.0, "{lost:?}");
    let never = run("[gps]\nrate = 0\n");
    stands(&never, Reason::NoFix, "a silent receiver");
    assert_eq!(never.distance_m, 0.0);
}

/// A robot indoors gets its pose from cameras (ArduPilot pull request 12414 simulates them).
#[test]
fn poses_replace_a_silent_receiver() {
    arrives(&run("[gps]\nrate = 0\n[pose]\nrate = 10\nheading_sigma = 0.01\n"), "poses alone");
}

/// Wheels slip (PX4/PX4-SITL_gazebo-classic pull request 1030), are unequal, and the body turns and
/// speeds up slowly.
#[test]
fn slipping_and_unequal_wheels_arrive() {
    let usual = run("");
    for (world, is_slower) in [
        ("[wheels]\nslip = 0.3\n", true),
        ("[wheels]\nunequal = 0.05\n", false),
        ("[body]\nacceleration = 0.3\nturn_acceleration = 2\n", true),
    ] {
        let outcome = run(world);
        arrives(&outcome, world);
        assert_ne!(outcome.trace_hash, usual.trace_hash, "{world}");
        assert!(!is_slower || outcome.time_s > usual.time_s + 1.0, "{world}: {}", outcome.time_s);
    }
}

/// Receivers near buildings wander (multipath), and sensors have few beams and a short reach.
#[test]
fn worse_sensors_change_the_run_and_touch_nothing() {
    for world in [
        "[gps]\nmultipath = 1\n",
        "[gps]\ncorrelation = 20\ndelay = 0.4\nrate = 2\n",
        "[compass]\noffset = 0.2\n",
        "[ranges]\nsectors = 8\nbeams = 8\nreach = 5\n",
    ] {
        let outcome = run(world);
        assert_eq!(outcome.touches, 0, "{world}");
        assert_ne!(outcome.trace_hash, run("").trace_hash, "{world}");
    }
}

/// The body has the mission's own top speed; that of earlier versions never exceeded 2 m/s.
#[test]
fn a_fast_robot_is_fast() {
    let scenario = scenario("[vehicle]\nmax_speed = 6\nbase_speed = 6\n", "");
    let sensors = scenario.sensors().without_error();
    let start = Start { position: [3.0, 6.0], heading_rad: 0.0, seed: 1, sensors };
    let robot = scenario.robot(&start, HostPilot::new(scenario.plan())).expect("it is clear");
    let mut simulation = scenario.simulation([robot]);
    let mut fastest_mps: f64 = 0.0;
    while !simulation.is_over() {
        simulation.step().expect("the robot answers");
        fastest_mps = fastest_mps.max(simulation.robots()[0].body().speed_mps);
    }
    arrives(simulation.robots()[0].outcome(), "6 m/s");
    assert!((2.5..=6.0).contains(&fastest_mps), "{fastest_mps} m/s");
}

/// A contact that a user reported: 6 m/s with the usual sensors, past the kiosk and the obstacle.
#[test]
fn a_fast_robot_with_usual_sensors_touches_nothing() {
    for base in ["", "base_speed = 6\n"] {
        let scenario = scenario(&format!("[vehicle]\nmax_speed = 6\n{base}"), "");
        let outcome = scenario.run(robot(&scenario)).expect("the robot answers");
        arrives(&outcome, "6 m/s, usual sensors");
        assert!(outcome.time_s < 20.0, "{outcome:?}");
    }
}
