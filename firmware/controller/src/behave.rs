//! What the mission's behaviours want the robot to do.
//!
//! Without behaviours, the robot follows the parallel plan of the blob's parameters. With
//! behaviours, the running atomic actions set the destination, the maximum speed and the
//! outputs. A behaviour that drives has the resource `motion`, so at most one action drives.
//!
//! Behaviours pause while the robot is disarmed or the emergency stop is pressed: their plans
//! keep their state. They continue during manual driving, because the world that they watch
//! continues too.

use behaviour::{Behaviours, Observations, Report, Running, World};
use math::{Vec2, vector};
use plan_format::grid::cost_metres;
use plan_format::mission::ActionKind;
use plan_format::parameters::{Gains, Vehicle};
use plan_format::{Answer, Blob, Layer};
use robot_io::{Commands, Percepts, Reason};
use schemas::Dock;

use crate::edge;
use crate::guidance::{self, Guidance, Target};
use crate::sense::Sensed;

const _: () = assert!(robot_io::limits::MAX_CHANNELS == plan_format::limits::MAX_CHANNELS);
const _: () = assert!(robot_io::limits::MAX_OUTPUTS == plan_format::limits::MAX_OUTPUTS);

/// What the behaviours want in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intent {
    errand: Errand,
    /// Weight of the noise for actions that set no gains.
    noise: f32,
    /// Highest speed that the actions allow, m/s.
    max_speed_mps: f32,
    /// Smallest distance to an obstacle that the actions allow, metres.
    min_distance_m: f32,
    /// Digital outputs, one bit each.
    outputs: u16,
    /// Signal code to report; 0 for none.
    signal: u16,
}

/// What an intent asks of the motors.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Errand {
    Follow(Target),
    GoTo(Vec2),
    Wander,
    /// Move ahead in a direction on the globe, radians counter-clockwise from east.
    Ahead(f32),
    /// Dock; the direction is on the globe.
    Dock(Dock),
    /// Stand still for this reason.
    None(Reason),
}

/// How to reach the destination of an intent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// By the advice of a parallel plan.
    ByPlan(Target),
    /// By the reactive schemas only.
    Straight(Guidance, Attraction),
}

/// What attracts a robot that drives by the reactive schemas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attraction {
    /// The goal.
    Goal,
    /// A direction, radians counter-clockwise from the map's x axis.
    Ahead(f32),
    /// A dock.
    Dock(Dock),
}

/// A robot that moves ahead has a goal this far ahead, metres: far enough never to be reached in a tick.
const AHEAD_M: f32 = 100.0;

/// What the step of a tick depends on.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'s> {
    /// The percepts.
    pub percepts: &'s Percepts,
    /// The estimate of position and heading.
    pub sensed: &'s Sensed,
    /// The mates that are heard.
    pub mates: &'s [behaviour::Mate],
    /// Whether the robot is armed: plans pause until its checks have passed.
    pub is_armed: bool,
}

/// Advances the behaviours by one step and returns what they want. Their decisions go into
/// the report.
pub fn behave(
    blob: &Blob<'_>,
    behaviours: &mut Behaviours,
    situation: &Situation<'_>,
    report: &mut Report,
) -> Intent {
    let &Situation { percepts, sensed, mates, is_armed } = situation;
    let parameters = blob.parameters();
    let mission = blob.mission();
    let intent = Intent {
        errand: Errand::None(Reason::Idle),
        noise: parameters.gains.noise,
        max_speed_mps: f32::INFINITY,
        min_distance_m: 0.0,
        outputs: behaviours.outputs(),
        signal: 0,
    };
    if mission.behaviours().is_empty() {
        let target = Target { plan: parameters.plan, gains: parameters.gains };
        return Intent { errand: Errand::Follow(target), ..intent };
    }
    if !is_armed || percepts.operator.is_emergency_stop {
        behaviours.pause(percepts.time_us);
        return intent;
    }
    let position = sensed.position.ok();
    let seen = Observations {
        time_us: percepts.time_us,
        position,
        channels: &percepts.inputs,
        mates,
        team: parameters.team.mates(),
        world: &Surroundings { blob, position, heading_rad: sensed.heading_rad },
    };
    let running = behaviours.step(&mission, &seen, report);
    Intent { outputs: behaviours.outputs(), ..intent.of(&running) }
}

impl Intent {
    /// This intent, changed by every running action.
    fn of(self, running: &Running) -> Self {
        running.iter().fold(self, |intent, part| {
            let errand = match part.kind {
                ActionKind::Follow { plan, reactive, advice, noise } => {
                    let gains = Gains { reactive, plan: advice, noise };
                    Errand::Follow(Target { plan, gains })
                }
                ActionKind::GoTo { x_m, y_m } => Errand::GoTo(Vec2::new(x_m, y_m)),
                ActionKind::Wander { .. } => Errand::Wander,
                ActionKind::MoveAhead { direction_rad, .. } => Errand::Ahead(direction_rad),
                ActionKind::Dock { x_m, y_m, direction_rad, radius_cm } => {
                    let (at, radius_m) = (Vec2::new(x_m, y_m), f32::from(radius_cm) / 100.0);
                    Errand::Dock(Dock { at, direction_rad, radius_m })
                }
                // Beside an action that drives it only waits.
                ActionKind::Hold { .. } if intent.drives() => intent.errand,
                ActionKind::Hold { .. } => Errand::None(Reason::Holding),
                ActionKind::Signal { code } => return Self { signal: code, ..intent },
                // A return without a place to return to is over at once.
                ActionKind::SetOutput { .. } | ActionKind::Return => intent.errand,
            };
            Self {
                errand,
                max_speed_mps: intent.max_speed_mps.min(part.max_speed_mps),
                min_distance_m: intent.min_distance_m.max(part.min_distance_m),
                ..intent
            }
        })
    }

    fn drives(&self) -> bool {
        !matches!(self.errand, Errand::None(_))
    }

    /// The vehicle with the constraints of the running actions, and the latency that counts.
    pub fn constrained(&self, vehicle: &Vehicle) -> Vehicle {
        Vehicle {
            max_speed_mps: vehicle.max_speed_mps.min(self.max_speed_mps),
            stop_distance_m: vehicle.stop_distance_m.max(self.min_distance_m),
            ..vehicle.with_least_latency()
        }
    }

    /// The commands with the outputs and the signal of this intent.
    pub fn with_outputs(&self, commands: Commands) -> Commands {
        Commands { outputs: self.outputs, signal: self.signal, ..commands }
    }

    /// The approach from a position. The error is the reason to stand still.
    /// `north_rad` is the direction of the map's y axis, radians clockwise from true north.
    pub fn approach(&self, position: Vec2, north_rad: f32) -> Result<Approach, Reason> {
        let by = |attraction, goal, noise| {
            let gains = Gains { reactive: 1.0, plan: 0.0, noise };
            let guidance = Guidance::straight(position, goal, gains, Reason::Driving);
            Approach::Straight(guidance, attraction)
        };
        let straight = |goal, noise| by(Attraction::Goal, goal, noise);
        match self.errand {
            Errand::Follow(target) => Ok(Approach::ByPlan(target)),
            Errand::GoTo(goal) => Ok(straight(goal, self.noise)),
            // A goal at the robot's own position attracts nowhere: noise and repulsion remain.
            Errand::Wander => Ok(straight(position, 1.0)),
            Errand::Ahead(direction_rad) => {
                let direction_rad = direction_rad + north_rad;
                let goal = position + vector::from_angle(direction_rad) * AHEAD_M;
                Ok(by(Attraction::Ahead(direction_rad), goal, self.noise))
            }
            Errand::Dock(dock) => {
                let dock = Dock { direction_rad: dock.direction_rad + north_rad, ..dock };
                Ok(by(Attraction::Dock(dock), dock.at, self.noise))
            }
            Errand::None(reason) => Err(reason),
        }
    }
}

/// The direction of the map's y axis, radians clockwise from true north.
pub fn north_rad(blob: &Blob<'_>) -> f32 {
    blob.origin().map_or(0.0, |origin| origin.heading_rad as f32)
}

/// Answers the behaviours' questions about the robot's position from the plans.
struct Surroundings<'s, 'p> {
    blob: &'s Blob<'p>,
    position: Option<Vec2>,
    heading_rad: Option<f32>,
}

impl Surroundings<'_, '_> {
    /// Cost to the goal of a parallel plan in one of its layers, in the plan's cost units.
    fn cost(&self, plan: u16, layer: usize) -> Option<u32> {
        let cell = edge::cell(self.blob, self.position?)?;
        match self.blob.parallel_plan(usize::from(plan))?.layer(layer)?.look_up(cell) {
            Answer::Move { cost, .. } => Some(cost),
            Answer::Goal => Some(0),
            Answer::NoRoute | Answer::Blocked { .. } | Answer::OffMap => None,
        }
    }

    /// The most constrained layer of a parallel plan that has a route, with its cost.
    fn best(&self, plan: u16) -> Option<(Layer<'_>, u32)> {
        let parallel_plan = self.blob.parallel_plan(usize::from(plan))?;
        (0..parallel_plan.layer_count())
            .rev()
            .find_map(|layer| Some((parallel_plan.layer(layer)?, self.cost(plan, layer)?)))
    }

    fn metres(&self, cost: u32) -> f32 {
        cost_metres(cost, self.blob.grid().resolution_m) as f32
    }
}

impl World for Surroundings<'_, '_> {
    fn cost_to_goal(&self, plan: u16) -> Option<f32> {
        self.best(plan).map(|(_, cost)| self.metres(cost))
    }

    fn price(&self, plan: u16, layer: u8) -> Option<f32> {
        let (dear, cheap) = (self.cost(plan, usize::from(layer))?, self.cost(plan, 0)?);
        Some(self.metres(dear.saturating_sub(cheap)))
    }

    fn is_at_goal(&self, plan: u16) -> bool {
        let (Some(parallel_plan), Some(position)) =
            (self.blob.parallel_plan(usize::from(plan)), self.position)
        else {
            return false;
        };
        self.best(plan).is_some_and(|(layer, cost)| {
            let number = edge::cell(self.blob, position).map_or(0, |cell| layer.goal_number(cell));
            let distance_m = vector::length(parallel_plan.goal_at(number) - position);
            let is_near = distance_m <= self.blob.parameters().schemas.goal_tolerance_m;
            let is_there =
                || guidance::is_there(self.blob, Some(layer), Some(cost), position, distance_m);
            cost == 0 || is_near && is_there()
        })
    }

    fn is_at(&self, place: Vec2) -> bool {
        let tolerance_m = self.blob.parameters().schemas.goal_tolerance_m;
        self.position.is_some_and(|at| vector::length(place - at) <= tolerance_m)
    }

    fn is_docked(&self, at: Vec2, direction_rad: f32) -> bool {
        let (Some(position), Some(heading_rad)) = (self.position, self.heading_rad) else {
            return false;
        };
        let tolerance_m = self.blob.parameters().schemas.goal_tolerance_m;
        let direction_rad = direction_rad + north_rad(self.blob);
        let dock = Dock { at, direction_rad, radius_m: tolerance_m };
        schemas::is_docked(position, heading_rad, &dock, tolerance_m)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use behaviour::RunningAction;
    use core::f32::consts::FRAC_PI_2;
    use maps::Bitmap;
    use math::GeoPoint;
    use plan_compiler::pack::pack;
    use plan_compiler::search::{Corners, Query, solve};
    use plan_compiler::terrain::Terrain;
    use plan_format::{
        Cell, Draft, Grid, LayerDraft, Origin, PackedLayer, Parameters, PlanDraft, write,
    };
    use std::vec::Vec;

    /// A map of 5 by 2 cells of 1 m with the goal in the south-eastern cell. The second layer
    /// blocks the cell (2, 0). The map's y axis points to the east.
    fn two_layers() -> Vec<u8> {
        let grid = Grid { columns: 5, rows: 2, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        let goal = Cell::new(4, 0);
        let packed = |blocks: bool| -> PackedLayer {
            let blocked = Bitmap::from_fn(5, 2, |cell| blocks && cell == Cell::new(2, 0));
            let terrain = Terrain::new(blocked);
            let corners = Corners::Forbid;
            pack(&solve(&Query { terrain: &terrain, goals: &[goal], corners }))
        };
        let layer = |(name, rank, blocks): (&str, u8, bool)| LayerDraft {
            name: name.into(),
            rank,
            packed: packed(blocks),
        };
        let layers = [("free", 0, false), ("walled", 1, true)].map(layer).into();
        let plans = Vec::from([PlanDraft {
            name: "goal".into(),
            goals_m: Vec::from([grid.centre(goal)]),
            layers,
        }]);
        let origin = Some(Origin {
            place: GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 },
            at_m: [0.0, 0.0],
            heading_rad: f64::from(FRAC_PI_2),
        });
        let parameters = Parameters::default();
        write(&Draft { grid, origin, parameters, plans, mission: Default::default() })
            .expect("the draft is sound")
    }

    fn assert_near(found: Option<f32>, expected: f32) {
        assert!(found.is_some_and(|found| (found - expected).abs() < 1e-3), "{found:?}");
    }

    /// The behaviours' questions are answered from the robot's cell. The goal's tolerance is 1 m.
    #[test]
    fn questions_about_the_position_are_answered_from_the_plan() {
        let bytes = two_layers();
        let blob = Blob::parse(&bytes).expect("the blob is valid");
        let at = |x: f32, y: f32| Surroundings {
            blob: &blob,
            position: Some(Vec2::new(x, y)),
            heading_rad: Some(FRAC_PI_2),
        };
        // Straight it is 4 m. Around the blocked cell there are two diagonals and two cells.
        let far = at(0.5, 0.5);
        assert_near(far.cost_to_goal(0), 4.8284);
        assert_near(far.price(0, 1), 0.8284);
        // Where the second layer has no route, the first one counts.
        assert_near(at(2.5, 0.5).cost_to_goal(0), 2.0);
        assert_eq!(at(2.5, 0.5).price(0, 1), None);
        for (x, is_at_goal) in [(0.5, false), (3.1, false), (3.9, true), (4.1, true)] {
            assert_eq!(at(x, 0.5).is_at_goal(0), is_at_goal, "{x}");
        }
        for (x, is_at) in [(1.9, false), (2.1, true), (3.9, true), (4.1, false)] {
            assert_eq!(at(x, 0.5).is_at(Vec2::new(3.0, 0.5)), is_at, "{x}");
        }
        // East on the globe is the map's y axis.
        for (direction_rad, is_docked) in [(0.0, true), (FRAC_PI_2, false), (-FRAC_PI_2, false)] {
            assert_eq!(at(2.0, 0.5).is_docked(Vec2::new(2.0, 1.2), direction_rad), is_docked);
        }
    }

    fn running(kind: ActionKind, max_speed_mps: f32, min_distance_m: f32) -> RunningAction {
        RunningAction { behaviour: 0, component: 0, action: 0, kind, max_speed_mps, min_distance_m }
    }

    /// What actions make of an idle intent.
    fn intent(actions: &[RunningAction]) -> Intent {
        let idle = Intent {
            errand: Errand::None(Reason::Idle),
            noise: 0.25,
            max_speed_mps: f32::INFINITY,
            min_distance_m: 0.0,
            outputs: 0,
            signal: 0,
        };
        idle.of(&actions.iter().copied().collect())
    }

    /// Beside an action that drives, a hold only waits. Alone it stands still.
    #[test]
    fn a_hold_does_not_stop_an_action_that_drives() {
        let hold = running(ActionKind::Hold { for_ms: 1 }, f32::INFINITY, 0.0);
        let go = running(ActionKind::GoTo { x_m: 3.0, y_m: 4.0 }, f32::INFINITY, 0.0);
        assert_eq!(intent(&[hold]).errand, Errand::None(Reason::Holding));
        for both in [[go, hold], [hold, go]] {
            assert_eq!(intent(&both).errand, Errand::GoTo(Vec2::new(3.0, 4.0)));
        }
    }

    /// The lowest speed and the largest distance of all actions limit the vehicle.
    #[test]
    fn the_strictest_action_limits_the_vehicle() {
        let go = ActionKind::GoTo { x_m: 3.0, y_m: 4.0 };
        let hold = ActionKind::Hold { for_ms: 1 };
        let both = intent(&[running(go, 0.75, 2.0), running(hold, 0.5, 1.5)]);
        let mut vehicle = Parameters::default().vehicle;
        (vehicle.max_speed_mps, vehicle.stop_distance_m) = (1.0, 0.1);
        let limited = both.constrained(&vehicle);
        assert_eq!((limited.max_speed_mps, limited.stop_distance_m), (0.5, 2.0));
        (vehicle.max_speed_mps, vehicle.stop_distance_m) = (0.25, 3.0);
        let limited = both.constrained(&vehicle);
        assert_eq!((limited.max_speed_mps, limited.stop_distance_m), (0.25, 3.0));
    }

    /// Directions on the globe become directions on the map, whose y axis points to the east. The
    /// goal of a robot that moves ahead is 100 m away.
    #[test]
    fn directions_on_the_globe_are_turned_into_the_maps_axes() {
        let position = Vec2::new(1.0, 2.0);
        let approach = |kind| {
            let approach = intent(&[running(kind, 1.0, 0.0)]).approach(position, FRAC_PI_2);
            match approach.expect("it drives") {
                Approach::Straight(guidance, attraction) => (guidance.goal, attraction),
                Approach::ByPlan(_) => panic!("it has a plan"),
            }
        };
        let (goal, attraction) = approach(ActionKind::MoveAhead { direction_rad: 0.0, for_ms: 1 });
        assert!(vector::length(goal - Vec2::new(1.0, 102.0)) < 1e-3, "{goal:?}");
        assert_eq!(attraction, Attraction::Ahead(FRAC_PI_2));
        let (goal, attraction) =
            approach(ActionKind::Dock { x_m: 5.0, y_m: 6.0, direction_rad: 0.5, radius_cm: 400 });
        let at = Vec2::new(5.0, 6.0);
        let dock = Dock { at, direction_rad: 0.5 + FRAC_PI_2, radius_m: 4.0 };
        assert_eq!((goal, attraction), (at, Attraction::Dock(dock)));
    }
}
