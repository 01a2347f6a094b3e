//! What [`guide`] tells the schemas: where the route leads, which goal counts, when it is reached.

use crate::bench::{Ground, ORIGIN, PLAIN, Robot, blob, blob_on, open_field};
use controller::guidance::{Guidance, Progress, Target, guide};
use math::{Vec2, vector};
use plan_format::mission::MissionDraft;
use plan_format::parameters::{Blend, Gains};
use plan_format::{Blob, Cell, Parameters};
use robot_io::{Reason, Receiver};

/// A blob with one layer, drawn as in the bench, with cells of another size. A step out of every cell
/// costs `eighths` of its length.
fn scaled(map: &str, resolution_m: f64, eighths: u32, parameters: Parameters) -> Vec<u8> {
    let ground = Ground { resolution_m, eighths, limit_mps: None };
    blob_on(ground, &[map], parameters, None, MissionDraft::default())
}

/// The first guidance of an armed robot at a position, with its progress.
fn first(bytes: &[u8], gains: Gains, (x, y): (f32, f32)) -> (Result<Guidance, Reason>, Progress) {
    let blob = Blob::parse(bytes).expect("the blob is valid");
    let mut progress = Progress::default();
    let target = Target { plan: 0, gains };
    let guided = guide(&blob, &target, &mut progress, Vec2::new(x, y), &[], true);
    (guided, progress)
}

/// The direction of the route ahead of a robot that looks so far ahead, in cells of such a size.
fn ahead(map: &str, resolution_m: f64, look_ahead_m: f32, at: (f32, f32)) -> Vec2 {
    let mut parameters = Parameters { blend: Blend::Route, ..Parameters::default() };
    parameters.schemas.look_ahead_m = look_ahead_m;
    parameters.schemas.goal_tolerance_m = 0.1;
    let (guided, _) = first(&scaled(map, resolution_m, 8, parameters), Gains::ROUTE, at);
    guided.expect("it drives").ahead
}

#[track_caller]
fn assert_points(found: Vec2, (x, y): (f32, f32)) {
    let expected = vector::unit(Vec2::new(x, y));
    assert!(vector::length(found - expected) < 1e-4, "{found:?}, not {expected:?}");
}

/// The reason in a robot's first tick, with a goal's tolerance.
fn reason(map: &str, resolution_m: f64, eighths: u32, tolerance_m: f32, at: (f32, f32)) -> Reason {
    let mut parameters = Parameters::default();
    parameters.schemas.goal_tolerance_m = tolerance_m;
    let (guided, _) = first(&scaled(map, resolution_m, eighths, parameters), Gains::ROUTE, at);
    guided.map_or_else(|reason| reason, |guidance| guidance.reason)
}

/// East for four cells, then north for six.
const CORNER: &str = "
    ####G
    ####.
    ####.
    ####.
    ####.
    ####.
    .....";

/// The advice points to the cell that is the look-ahead away along the route, seen from the robot.
#[test]
fn the_advice_points_to_the_route_the_look_ahead_away() {
    // 3 m are 6 cells of 0.5 m: the cell (4, 2), from (-0.2, 0.2) in cells.
    assert_points(ahead(CORNER, 0.5, 3.0, (0.15, 0.35)), (4.2, 1.8));
    // 4 m are 4 cells: (4, 2) from (2, 0).
    assert_points(ahead(CORNER, 1.0, 4.0, (2.5, 0.5)), (2.0, 2.0));
}

/// A robot in an obstacle looks past the cell where its route begins.
#[test]
fn the_way_out_of_an_obstacle_leads_on_along_the_route() {
    let map = "
        G....
        #####
        #####";
    // Two cells north, then two cells west.
    assert_points(ahead(map, 1.0, 4.0, (4.5, 0.5)), (-2.0, 2.0));
}

/// Over coarse cells the robot looks four cells ahead where the straight line is free, else two.
#[test]
fn over_coarse_cells_the_advice_does_not_lead_through_walls() {
    // The line to (4, 2) from (2, 0) would pass (3, 1).
    assert_points(ahead(CORNER, 1.0, 3.0, (2.5, 0.5)), (2.0, 0.0));
    // Two cells east, two north-east. The line to the goal passes three free cells. Cells are
    // blocked behind the robot, beside it and past the goal.
    let rising = "
        #######
        ####.G#
        ###...#
        #....##
        #######";
    assert_points(ahead(rising, 1.0, 3.0, (1.5, 1.3)), (4.0, 2.2));
    let mut falling: Vec<&str> = rising.split_whitespace().collect();
    falling.reverse();
    assert_points(ahead(&falling.join("\n"), 1.0, 3.0, (1.5, 3.7)), (4.0, -2.2));
}

/// The guidance names the layer that advises, and its destination is the first goal, whichever goal
/// the route leads to.
#[test]
fn the_guidance_names_its_layer_and_its_destination() {
    let both = blob(&["G......G"], Parameters::default());
    for (x, goal_x) in [(2.5, 0.5), (5.5, 7.5)] {
        let guidance = first(&both, Gains::ROUTE, (x, 0.5)).0.expect("it drives");
        assert_eq!(guidance.layer, Some(0));
        assert_eq!(guidance.goal, Vec2::new(goal_x, 0.5));
        assert_eq!(guidance.destination, Vec2::new(0.5, 0.5));
    }
}

/// A robot that does without advice drives to the nearest goal, and among equals to the first.
#[test]
fn without_advice_the_nearest_goal_counts() {
    let both = blob(&["G......G"], Parameters::default());
    for (x, number, goal_x) in [(2.5, 0, 0.5), (4.0, 0, 0.5), (5.5, 1, 7.5)] {
        let (guided, progress) = first(&both, Gains::REACTIVE_ONLY, (x, 0.5));
        assert_eq!(progress.goal, Some(number), "{x}");
        assert_eq!(guided.expect("it drives").goal, Vec2::new(goal_x, 0.5), "{x}");
    }
    let one = blob(&["G......."], Parameters::default());
    assert_eq!(first(&one, Gains::REACTIVE_ONLY, (2.5, 0.5)).1.goal, None);
}

/// A robot that has arrived starts again two tolerances away from the goal, with any plan.
#[test]
fn a_robot_at_its_goal_leaves_it_two_tolerances_away() {
    let mut parameters = Parameters::default();
    parameters.schemas.goal_tolerance_m = 0.5;
    let blob = Blob::without_map(parameters, None, Some(Vec2::zeros()));
    for plan in [0, 1] {
        let target = Target { plan, gains: Gains::ROUTE };
        let mut progress = Progress::default();
        for (x, is_there) in [(0.9, false), (0.4, true), (0.9, true), (1.1, false), (0.9, false)] {
            let guided = guide(&blob, &target, &mut progress, Vec2::new(x, 0.0), &[], true);
            assert_eq!(guided.err() == Some(Reason::AtGoal), is_there, "{plan}: {x}");
            assert_eq!(progress.is_at_goal, is_there, "{plan}: {x}");
            assert_eq!(progress.plan, plan);
        }
    }
}

/// One blocked cell between the robot and the goal. The way around it is 4 cells long.
const POST: &str = "
    ...
    G#.";

/// Within the tolerance the robot has arrived if its route is as short as a free path. The bound is
/// 1.082 times the distance plus a cell's diagonal.
#[test]
fn a_robot_behind_an_obstacle_has_not_arrived() {
    for (map, resolution_m, at, expected) in [
        // 1 m of route; a free path has 2.07 m at most.
        ("G..", 1.0, (1.0, 0.5), Reason::AtGoal),
        // 2 m; 4.14 m.
        ("G..", 2.0, (2.0, 1.0), Reason::AtGoal),
        // 4 m; 3.69 m.
        (POST, 1.0, (2.5, 0.5), Reason::Driving),
        // 2 m; 1.85 m.
        (POST, 0.5, (1.25, 0.25), Reason::Driving),
    ] {
        assert_eq!(reason(map, resolution_m, 8, 3.0, at), expected, "{map}, {resolution_m} m");
    }
}

/// With tolls the length of the route counts and not its cost, up to 32 steps.
#[test]
fn with_tolls_the_steps_to_the_goal_are_counted() {
    let row = format!("G{}", ".".repeat(39));
    for (map, eighths, x, expected) in [
        ("G...", 256, 2.5, Reason::AtGoal),
        (POST, 16, 2.5, Reason::Driving),
        (&row, 8, 39.5, Reason::AtGoal),
        (&row, 16, 39.5, Reason::Driving),
        (&row, 16, 30.5, Reason::AtGoal),
    ] {
        assert_eq!(reason(map, 1.0, eighths, 50.0, (x, 0.5)), expected, "{map}, {eighths}, {x}");
    }
}

/// A robot just beyond the edge is in the nearest cell, whatever the size of the cells.
#[test]
fn a_robot_just_off_its_map_is_in_the_nearest_cell() {
    let map = "
        .....
        G....
        .....";
    for resolution_m in [0.5, 2.0] {
        let bytes = scaled(map, resolution_m, 8, Parameters::default());
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let side_m = resolution_m as f32;
        let cell = |x: f32, y: f32| controller::edge::cell(&blob, Vec2::new(x, y));
        assert_eq!(cell(-0.1, 1.5 * side_m), Some(Cell::new(0, 1)));
        assert_eq!(cell(5.0 * side_m + 0.1, 2.5 * side_m), Some(Cell::new(4, 2)));
        assert_eq!(cell(2.5 * side_m, -0.1), Some(Cell::new(2, 0)));
        assert_eq!(cell(-1.0, 1.5 * side_m), None, "farther than its radius");
    }
}

/// A robot that looks for its heading obeys the limit where it is: a slow zone allows no speed that shows
/// a course.
#[test]
fn creeping_obeys_the_speed_limit() {
    for (limit_mps, expected_mps) in [(None, 0.6), (Some(0.55), 0.55), (Some(0.3), 0.0)] {
        let ground = Ground { limit_mps, ..PLAIN };
        let drawing = open_field(30, 30, (25, 15));
        let parameters = Parameters::default();
        let bytes = blob_on(ground, &[&drawing], parameters, Some(ORIGIN), MissionDraft::default());
        let mut robot = Robot::new(Blob::parse(&bytes).expect("the blob is valid"), 5.5, 15.5);
        let commands = robot.tick_with(|percepts| {
            percepts.heading_rad = None;
            percepts.receiver = Receiver::Sound;
        });
        let found = (commands.reason, commands.speed_mps);
        assert_eq!(found, (Reason::NoHeading, expected_mps), "{limit_mps:?}");
    }
}
