//! The tick: turns percepts into commands.
//!
//! [`tick`] decides how the robot moves, in this order:
//!
//! | step | module | what it does |
//! |---|---|---|
//! | sense | [`sense`] | judges the sensors, estimates position and heading |
//! | arming | [`arming`] | checks what the robot needs before it may drive |
//! | listen | [`team`] | notes the news of mates, tracks the links to them |
//! | monitor, criticalities, switch, decompose | [`behave`] | lets the behaviours decide what to do |
//! | advise | [`guidance`] | looks up the plan, detects arrival and trouble |
//! | schemas, blend | `schemas` | computes vectors and sums them by their gains |
//! | detour | [`detour`] | turns the sum away from closed directions and out of dead ends |
//! | back out | [`back_out`] | drives astern where a car or a boat has no room to turn |
//! | drive | [`drive`] | turns the sum into speed and turn rate |
//! | edge | [`edge`] | slows down before the edge of the map |
//! | limit | [`limit`], [`brake`] | clamps both by operator, obstacles and vehicle |
//! | progress | [`stuck`] | notices that the robot does not get on |
//!
//! ```
//! use controller::{State, tick};
//! use math::{GeoPoint, Vec2};
//! use plan_format::{Blob, Origin, Parameters};
//! use robot_io::{Fix, Operator, Percepts, Reason};
//! // A robot without a map, 100 m west of its goal, that heads east.
//! let place = GeoPoint::from_degrees(45.0, 8.0).unwrap();
//! let origin = Origin { place, at_m: [0.0, 0.0], heading_rad: 0.0 };
//! let goal = Vec2::new(100.0, 0.0);
//! let blob = Blob::without_map(Parameters::default(), Some(origin), Some(goal));
//! let mut state = State::new(&blob);
//! let fix = Fix {
//!     time_us: 0, is_valid: true, place, accuracy_mm: 500, velocity_mmps: None, receiver_ms: None,
//! };
//! let mut percepts = Percepts { fix: Some(fix), heading_rad: Some(0.0), ..Percepts::default() };
//! assert_eq!(tick(&blob, &mut state, &percepts).reason, Reason::Disarmed);
//! percepts.operator = Operator { is_armed: true, ..Operator::default() };
//! let commands = tick(&blob, &mut state, &percepts);
//! assert!(commands.speed_mps > 1.0);
//! assert_eq!(commands.reason, Reason::NoPlan);
//! ```
//!
//! # Invariants
//! - Pure: the commands depend on the arguments only; time is in the percepts. Equal plan,
//!   state and percepts give equal commands and equal next state, on every target.
//! - Total: no percept, however wrong, causes a panic. Trouble is data: every stop has a
//!   [`Reason`].
//! - Commands are always finite and within the vehicle's limits.
//! - A plan is advice. Without a map, or with a planning gain of 0, the robot drives by its
//!   reactive schemas only, bit for bit as if it had never had a plan.
//!
//! # Glossary
//! One word for each idea, in code, files, help and docs. An example follows each definition.
//!
//! - **advice**: the step and the cost that an internalized plan gives in the robot's cell.
//!   Example: "north-east, 51.6 m to the gate".
//! - **applicability**: how well a production fits now, 0 ..= 1. Example: refuelling at the near
//!   station 0.9, at the far one 0.4.
//! - **approach**: how an intent is carried out: by the advice of a plan or straight to a point.
//!   Example: straight to (25.5, 15.5).
//! - **aspect of interest**: an input: a measured value that rules judge, mapped to 0 ..= 1.
//!   Example: a fuel level of 12 of 40 litres is 0.3.
//! - **atomic action**: a step that the robot carries out itself. Example: set output 3.
//! - **behaviour**: a task with a plan and a criticality. Example: plough the field.
//! - **blob**: the file that carries plans, mission and parameters to the robot. Example:
//!   `plans.bin`.
//! - **cell grid**: the map's cells, with their size and south-west corner. Example: 250 by 250
//!   cells of 1 m from (0, 0).
//! - **check**: a condition that must hold before the robot may be armed. Example: the battery is
//!   above 10.5 V.
//! - **commands**: the result of a tick: speed, turn rate, outputs, signal and the reason.
//!   Example: 1.4 m/s, 0.2 rad/s, `Driving`.
//! - **component**: a part of a live plan. Example: the second strip of the field.
//! - **criticality**: how much a behaviour needs the robot now, 0 ..= 1. Example: refuelling 0.8
//!   with the tank nearly empty.
//! - **drive**: to turn a vector into speed and turn rate. Example: a vector 0.5 rad to the left
//!   gives 1 rad/s.
//! - **errand**: the part of an intent that concerns the motors. Example: follow the plan `gate`.
//! - **fence**: a circle around the place where the robot was armed, which it may not leave.
//!   Example: 50 m.
//! - **fix**: one solution of the GPS receiver. Example: 51.4779 N, 0.0015 W, to 1.5 m.
//! - **gain**: the weight of a schema, or of a group of schemas, in the blend. Example: 0.66 for
//!   the advice.
//! - **guidance**: advice, goal and gains for one tick, once arrival and trouble are decided.
//!   Example: step north-east, goal (100, 40), 0.34 reactive and 0.66 advice.
//! - **hold**: the atomic action of standing still. Example: hold for 10 s while the tank fills.
//! - **intent**: what the behaviours want in one tick. Example: follow the plan `gate`, at 1 m/s
//!   at most.
//! - **layer**: one internalized plan: a goal and a set of constraints. Example: `gate/comms`.
//! - **link**: the radio link to the operator. Example: lost after 1 s of silence.
//! - **map frame**: the tangent plane that turns latitude and longitude into map metres. Example:
//!   45.0009 N is 100 m north of a reference at 45 N.
//! - **mate**: another robot of the team. Example: `left`, linked, 12 m away.
//! - **mission**: what the robot is to do, as a file or in the blob. Example:
//!   `plough.mission.toml`.
//! - **mixer**: turns speed and turn rate into the outputs of two motors. Example: 0.25 left and
//!   0.75 right.
//! - **motion**: the resource that every driving action needs, so that at most one drives.
//!   Example: ploughing and refuelling never drive at the same time.
//! - **news**: what a robot sends its mates: number, position, last signal. Example: robot 2, at
//!   (40, 12), signal 7.
//! - **observer**: watches ticks from outside and changes nothing. Example: the counter of
//!   instructions.
//! - **packet**: the bytes of one value on the link, with checksum and end mark. Example: 8 bytes
//!   for an emergency stop.
//! - **parallel plan**: layers with one goal, each more constrained than the one before. Example:
//!   `gate`, with the layers `physical` and `comms`.
//! - **percepts**: everything that one tick may use. Example: fix, ranges, heading, inputs,
//!   operator and time.
//! - **place**: a point on the globe. A *position* is in map metres. Example: 51.4779 N, 0.0015 W.
//! - **plan frame**: a task that one of its productions replaces. Example: `Strip`.
//! - **pose**: position and heading from another source than the GPS receiver. Example: (4.1, 7.3),
//!   0.2 rad, to 2 cm.
//! - **production**: a graph of components that can replace a plan frame. Example: lower the
//!   plough, drive, lift it.
//! - **protection interval**: the part of a plan during which a fact must hold. Example: the
//!   plough is down from the first to the last metre of a strip.
//! - **run**: the act of carrying out a mission, from its first tick to its last. Example: two
//!   runs with one trace hash.
//! - **scenario**: what a simulation simulates: world, robots, faults and seed. Example: two
//!   robots meet in a corridor.
//! - **schema**: turns percepts into a vector. Example: away from the obstacle ahead.
//! - **serial plan**: a production of follow actions, one after another. Example: first `gate`,
//!   then `depot`.
//! - **simulation**: a run of simulated robots through a scenario. Example: 4,000 ticks with a GPS
//!   error of 1 m.
//! - **situation grid**: what live plans assume, and whether it still holds. Example: "fuel is
//!   needed later, and no step provides it".
//! - **team**: robots with one mission file, each with its own part. Example: `left` and `right`.
//! - **tick**: one call of [`tick`]. Example: at 20 Hz, the one 50 ms after the last.
//! - **transport**: carries records to and from a robot in lockstep. Example: the two pipes to
//!   QEMU.
//!
//! Source: W (Wagner and Arkin, "Internalized Plans for Communication-Sensitive Robot Team
//! Behaviors"); the drive follows the values of its experiments.
//!
//! Deliberately absent: clocks, drivers, logging, allocation, and a filter that fuses sensors:
//! receivers and IMUs bring their own, and the tick uses a good fix unchanged.
#![no_std]

pub mod arc;
pub mod arming;
pub mod back_out;
pub mod behave;
pub mod brake;
mod clock;
pub mod closing;
mod compass;
pub mod detour;
pub mod drive;
pub mod edge;
pub mod guidance;
mod late;
mod leap;
pub mod limit;
pub mod obstacles;
mod odometry;
pub mod ranges;
pub mod scan;
pub mod sense;
mod slip;
mod source;
pub mod stuck;
pub mod team;

use behave::{Approach, Attraction, Intent};
use behaviour::Behaviours;
use drive::Twist;
use edge::Edge;
use math::{Vec2, vector};
use obstacles::Obstacles;
use plan_format::Blob;
use plan_format::parameters::{Parameters, Vehicle};
use robot_io::{Checks, Commands, Percepts, Reason};
use schemas::{Noise, Past, Vectors};

/// Everything that one tick passes to the next: plain data to store, compare and replay.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Position, heading and the data that they come from.
    pub track: sense::Track,
    /// The behaviours of the mission and their live plans.
    pub behaviours: Behaviours,
    /// The chosen layer, and whether the robot is at the goal.
    pub progress: guidance::Progress,
    /// The noise schema.
    pub noise: Noise,
    /// The avoid-past schema.
    pub past: Past,
    /// Speed and turn rate that the last tick commanded.
    pub commanded: limit::Commanded,
    /// Earlier scans, which show what moves.
    pub closing: closing::Closing,
    /// Progress towards the goal, and detours.
    pub detours: detour::Detours,
    /// Legs astern of a vehicle that cannot turn on the spot.
    pub backing_out: back_out::BackingOut,
    /// What the robot needs before it may drive.
    pub arming: arming::Arming,
    /// Whether the robot gets on.
    pub stuck: stuck::Progress,
    /// Links to mates, and the last signal for them.
    pub team: team::Team,
}

/// Boards keep the state in static memory; its budget is 8 KB.
const _: () = assert!(size_of::<State>() <= 8 * 1024);

impl State {
    /// The state before the first tick.
    pub fn new(blob: &Blob<'_>) -> Self {
        Self {
            track: sense::Track::default(),
            behaviours: Behaviours::new(&blob.mission()),
            progress: guidance::Progress::default(),
            noise: Noise::new(blob.parameters().seed),
            past: Past::default(),
            commanded: limit::Commanded::default(),
            closing: closing::Closing::default(),
            detours: detour::Detours::default(),
            backing_out: back_out::BackingOut::default(),
            arming: arming::Arming::default(),
            stuck: stuck::Progress::default(),
            team: team::Team::default(),
        }
    }

    /// Of a plan with several goals, the number of the one that the robot approaches or has reached;
    /// `None` if the plan that it followed last has one.
    pub const fn goal(&self) -> Option<u8> {
        self.progress.goal
    }

    /// The checks before arming that failed in the last tick.
    pub const fn checks(&self) -> Checks {
        self.arming.checks()
    }
}

/// Advances the controller by one tick. Pure: the result depends on the arguments only.
/// Total: never panics, never fails.
pub fn tick(blob: &Blob<'_>, state: &mut State, percepts: &Percepts) -> Commands {
    explain(blob, state, percepts).commands
}

/// A tick with everything that led to its commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The result.
    pub commands: Commands,
    /// The estimate of position and heading.
    pub sensed: sense::Sensed,
    /// What the behaviours decided.
    pub report: behaviour::Report,
    /// How the schemas were blended; `None` if the tick stopped or crept before the blend.
    pub blend: Option<Blend>,
}

/// How the schemas of one tick were blended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Advice, goal and gains.
    pub guidance: guidance::Guidance,
    /// The schemas' vectors, map axes.
    pub vectors: Vectors,
    /// The weighted sum of the vectors; length 1 is the base speed.
    pub sum: Vec2,
    /// The rule that turned the sum into the direction that the robot drives.
    pub rule: detour::Rule,
}

/// Does what [`tick`] does and returns the explanation too.
#[inline]
pub fn explain(blob: &Blob<'_>, state: &mut State, percepts: &Percepts) -> Explanation {
    let mut percepts = percepts.sanitised();
    let sensed = sense::sense(blob, &mut state.track, &percepts);
    state.track.correct(&mut percepts);
    state.arming.update(blob, &percepts, &sensed);
    let mut report = behaviour::Report::default();
    let position = sensed.position.ok();
    let mates = state.team.listen(&blob.parameters().team, &percepts);
    let is_armed = state.arming.is_armed();
    let situation =
        behave::Situation { percepts: &percepts, sensed: &sensed, mates: &mates, is_armed };
    let intent = behave::behave(blob, &mut state.behaviours, &situation, &mut report);
    let vehicle = intent.constrained(&blob.parameters().vehicle);
    let now = state.commanded.now(&percepts, sensed.ranges.age_s(), &vehicle);
    let points = scan::points(&percepts.ranges);
    state.closing.update(&percepts, &points, &now.twist, sensed.elapsed_s);
    let within_m = brake::within_m(&vehicle, &now);
    let coming_m = brake::coming_m(&vehicle, &now);
    let coming = state.closing.compared();
    let near = Obstacles::near(&percepts.ranges, &points, within_m, &coming, coming_m);
    let seen = Seen {
        percepts: &percepts,
        sensed: &sensed,
        points: &points,
        near: &near,
        now: &now,
        mates: &mates,
    };
    let decided = decide(blob, &vehicle, state, &seen, &intent);
    let (wanted, blend) = decided.unwrap_or_else(|reason| (Commands::stop(reason), None));
    let wanted = intent.with_outputs(wanted);
    let vehicle = state.arming.limited(&vehicle);
    let limited = limit::limit(&vehicle, &percepts, &near, &now, wanted);
    let commands = state.arming.explained(limited, &wanted, &percepts);
    state.track.commanded(&commands);
    state.backing_out.commanded(&commands);
    state.commanded.commanded(percepts.time_us, &commands, &now);
    state.stuck.update(&sensed, &commands, blob.parameters(), &mut state.detours);
    state.team.speak(&blob.parameters().team, position, &commands);
    Explanation { commands, sensed, report, blend }
}

/// The twist, or a slower one that does not lead off the map. An error if only standing is left.
fn kept_on_map(
    edge: &Edge<'_>,
    vehicle: &Vehicle,
    now: &brake::Moving,
    twist: Twist,
) -> Result<Twist, Reason> {
    let kept = edge.stay(vehicle, now, twist);
    let turns = kept.turn_rate_radps != 0.0 && drive::circle_m(vehicle) == 0.0;
    let stands = twist.speed_mps != 0.0 && kept.speed_mps == 0.0 && !turns;
    if stands { Err(Reason::OffMap) } else { Ok(kept) }
}

/// What the robot perceives in a tick, judged.
struct Seen<'s> {
    percepts: &'s Percepts,
    sensed: &'s sense::Sensed,
    points: &'s scan::Points,
    near: &'s Obstacles,
    now: &'s brake::Moving,
    mates: &'s team::Mates,
}

/// The commands before operator and obstacles limit them. The error is the reason to stand
/// still.
fn decide(
    blob: &Blob<'_>,
    vehicle: &Vehicle,
    state: &mut State,
    seen: &Seen<'_>,
    intent: &Intent,
) -> Result<(Commands, Option<Blend>), Reason> {
    let &Seen { percepts, sensed, .. } = seen;
    let parameters = blob.parameters();
    if sensed.is_clock_stopped {
        return Err(Reason::ClockStopped);
    }
    let position = sensed.position?;
    let is_armed = state.arming.is_armed();
    let (guidance, attraction) = match intent.approach(position, behave::north_rad(blob))? {
        Approach::Straight(..) if edge::is_lost(blob, position) => return Err(Reason::OffMap),
        Approach::ByPlan(target) => {
            let (progress, inputs) = (&mut state.progress, &percepts.inputs);
            let guidance = guidance::guide(blob, &target, progress, position, inputs, is_armed)?;
            (guidance, Attraction::Goal)
        }
        Approach::Straight(guidance, attraction) => (guidance, attraction),
    };
    let trouble = state.arming.reason().or(sensed.ranges.reason()).or(sensed.heading_reason());
    if let Some(reason) = trouble.or(state.stuck.reason(&parameters.progress)) {
        return Err(reason);
    }
    let limit_mps = guidance::speed_limit(blob, &state.progress, guidance.layer, position);
    let vehicle = &limit::in_speed_zone(vehicle, limit_mps);
    let Some(heading_rad) = sensed.heading_rad else {
        return drive::creep(vehicle, percepts).map(|commands| (commands, None));
    };
    let edge = &Edge::around(blob, position, heading_rad);
    let aim = &Aim { vehicle, position, heading_rad, guidance: &guidance, attraction, edge };
    let (vectors, is_repelled) = perceive(parameters, state, seen, aim);
    let sum = schemas::blend(&guidance.gains, &parameters.schemas, &vectors);
    let (twist, rule) = steer(parameters, state, seen, aim, sum, is_repelled)?;
    Ok((twist.because(guidance.reason), Some(Blend { guidance, vectors, sum, rule })))
}

/// Where the robot is and where it is to go, once nothing stops it.
struct Aim<'a> {
    /// The vehicle, with the limits that hold here.
    vehicle: &'a Vehicle,
    position: Vec2,
    heading_rad: f32,
    guidance: &'a guidance::Guidance,
    attraction: Attraction,
    edge: &'a Edge<'a>,
}

/// The vectors of the schemas, map axes, and whether an obstacle is within the margin.
// As functions of their own, this one and `steer` cost a sixth of a tick's stack.
#[inline(always)]
fn perceive(
    parameters: &Parameters,
    state: &mut State,
    seen: &Seen<'_>,
    aim: &Aim<'_>,
) -> (Vectors, bool) {
    use plan_format::parameters::Blend::Paper;
    let (schema, guidance, position) = (&parameters.schemas, aim.guidance, aim.position);
    let repulsion = schemas::avoid_static_obstacle(
        &seen.percepts.ranges,
        aim.vehicle.radius_m,
        schema.avoid_margin_m,
        schema.avoid_sphere_m,
    );
    let goal_attracts = parameters.blend == Paper || guidance.step.is_none();
    let vectors = Vectors {
        goal: match aim.attraction {
            _ if !goal_attracts => Vec2::zeros(),
            Attraction::Goal => {
                schemas::move_to_goal(position, guidance.goal, schema.goal_tolerance_m)
            }
            Attraction::Ahead(direction_rad) => schemas::move_ahead(direction_rad),
            Attraction::Dock(dock) => schemas::docking(position, &dock),
        },
        avoid: vector::rotated(repulsion.vector, aim.heading_rad),
        robots: team::steer(parameters, seen.mates, position),
        past: if schema.past_gain > 0.0 {
            state.past.repel(position, seen.sensed.passed_us, schema.past_sphere_m)
        } else {
            Vec2::zeros()
        },
        advice: guidance.ahead,
        noise: state.noise.next(schema.noise_persistence_ticks),
    };
    let counts = guidance.gains.reactive * schema.avoid_gain > 0.0;
    (vectors, counts && repulsion.is_saturated)
}

/// The twist along the sum of the vectors, and the rule that turned it. The paper's mixes are left as
/// they are, except off the map. The error is the reason to stand still.
#[inline(always)]
fn steer(
    parameters: &Parameters,
    state: &mut State,
    seen: &Seen<'_>,
    aim: &Aim<'_>,
    sum: Vec2,
    is_repelled: bool,
) -> Result<(Twist, detour::Rule), Reason> {
    use plan_format::parameters::Blend::Route;
    let &Seen { sensed, points, near, now, .. } = seen;
    let &Aim { vehicle, edge, guidance, .. } = aim;
    let is_led = parameters.blend == Route;
    let on_map = if is_led || edge.is_beyond() { edge.along(vehicle, sum) } else { sum };
    let ahead = vector::rotated(on_map, -aim.heading_rad);
    let (ahead, rule) = if is_led {
        let situation = detour::Situation {
            elapsed_s: sensed.elapsed_s,
            turn_rate_radps: now.twist.turn_rate_radps,
            destination: guidance.destination,
            way_m: guidance.way_m,
            layer: guidance.layer,
            vehicle,
            near,
            patience_us: parameters.schemas.detour_after_us,
        };
        state.detours.choose(&situation, ahead)
    } else {
        (ahead, detour::Rule::None)
    };
    state.backing_out.look(points);
    let may_go_astern = state.backing_out.may_go_astern(vehicle);
    let situation = back_out::Situation { vehicle, near, edge, now };
    let backing = if is_led { state.backing_out.choose(&situation, ahead) } else { None };
    let (twist, rule) = match backing {
        Some(twist) => (twist, detour::Rule::BackOut),
        None => (drive::drive(vehicle, ahead, is_repelled, may_go_astern), rule),
    };
    Ok((kept_on_map(edge, vehicle, now, twist)?, rule))
}
