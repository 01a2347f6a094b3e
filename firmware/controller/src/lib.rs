//! The tick: what the robot perceives goes in, what it shall do comes out.
//!
//! [`tick`] decides everything about motion, in this order:
//!
//! | step | module | what happens |
//! |---|---|---|
//! | sense | [`sense`] | fixes are judged, position and heading are kept up |
//! | monitor, criticalities, switch, decompose | [`behave`] | behaviours decide what to do |
//! | advise | [`guidance`] | the plan is asked; arrival and trouble are told apart |
//! | schemas, blend | `schemas` | vectors are computed and summed by their gains |
//! | drive | [`drive`] | the sum becomes speed and turn rate |
//! | limit | [`limit`] | operator and obstacles have the last word |
//!
//! # Invariants
//! - Pure: the commands depend on the arguments only; time is in the percepts. Equal plan,
//!   state and percepts give equal commands and equal next state, on every target.
//! - Total: no percept, however wrong, causes a panic, and trouble is data: every stop has a
//!   [`Reason`].
//! - Commands are finite and within the vehicle's limits, always.
//! - A plan is advice. Without a map, and with a planning gain of 0, the robot drives by its
//!   reactive schemas alone, bit for bit as if there had never been a plan.
//!
//! # Glossary
//! One word for each idea, in code, files, help and docs. Each with an example.
//!
//! - **advice**: the step and the cost of an internalized plan in the robot's cell: "north-east,
//!   51.6 m to the gate".
//! - **applicability**: how well a production fits now, 0 ..= 1: refuelling at the near station
//!   0.9, at the far one 0.4.
//! - **aspect of interest**: an input that rules judge, mapped to 0 ..= 1: the fuel level.
//! - **atomic action**: a step that the robot carries out itself: follow a plan, hold, set an
//!   output.
//! - **behaviour**: a task with a plan and a criticality: plough the field.
//! - **blob**: the file that carries plans, mission and parameters to the robot: `plans.bin`.
//! - **cell grid**: the map's cells, their size and their corner: 250 by 250 cells of 1 m.
//! - **commands**: speed, turn rate, outputs and the reason for them; the result of a tick.
//! - **component**: a part of a live plan: the second strip that is being ploughed.
//! - **criticality**: how much a behaviour needs the robot now, 0 ..= 1: refuelling 0.8 with the
//!   tank nearly empty.
//! - **drive**: to turn a vector into speed and turn rate: 0.5 rad to the left gives 1 rad/s.
//! - **errand**: what an intent asks of the motors: follow a plan, go to a point, wander, nothing.
//! - **fix**: one solution of the GPS receiver: 51.4779 N, 0.0015 W, to 1.5 m.
//! - **gain**: weight of a schema or a group of schemas in the blend: 0.66 for the advice.
//! - **guidance**: advice, goal and gains for one tick, after arrival and trouble are decided.
//! - **hold**: to stand still on purpose, an atomic action: wait 10 s for the tank to fill. What a
//!   protection interval keeps is *held*.
//! - **intent**: what the behaviours want in one tick: follow the plan `gate`, at 1 m/s at most.
//! - **layer**: one internalized plan: a goal and a set of constraints: `gate/comms`.
//! - **link**: the radio link to the operator, and only that: lost after 1 s of silence.
//! - **map frame**: the tangent plane that turns latitude and longitude into the map's metres.
//! - **mixer**: turns speed and turn rate into the outputs of two motors.
//! - **motion**: a speed and a turn rate: 1.4 m/s straight ahead.
//! - **observer**: watches ticks from outside and changes nothing: the counter of instructions.
//! - **packet**: the bytes of one value on the link, with checksum and end mark.
//! - **parallel plan**: layers with one goal, each more constrained than the one before: `gate`.
//! - **percepts**: all that one tick may know: fix, ranges, heading, inputs, operator, time.
//! - **place**: a point of the globe, latitude and longitude. A *position* is in map metres.
//! - **plan frame**: a task that is replaced by one of its productions: `Strip`.
//! - **production**: a graph of components that can replace a plan frame: lower, drive, lift.
//! - **protection interval**: from where to where in a plan a fact must hold: the plough is down
//!   from the first to the last metre of a strip.
//! - **run**: to carry out a mission from its first tick to its last.
//! - **schema**: turns percepts into a vector: away from the obstacle ahead.
//! - **serial plan**: a production of follow actions, one after another: first `gate`, then
//!   `depot`.
//! - **situation grid**: what live plans assume, and whether it still holds: "fuel is needed
//!   later, and no step provides it".
//! - **steering**: of a vehicle, how it turns; of an intent, by a plan or straight to a goal.
//! - **tick**: one run of [`tick`], 20 a second by default.
//! - **transport**: carries records to and from a robot in lockstep: two pipes.
//!
//! Source: W (Wagner and Arkin, "Internalized Plans for Communication-Sensitive Robot Team
//! Behaviors"); the drive follows the values of its experiments.
//!
//! Deliberately absent: clocks, drivers, logging, allocation; a filter that fuses sensors
//! (receivers and IMUs bring their own; here a good fix is taken as it is).
#![no_std]

pub mod behave;
pub mod drive;
pub mod guidance;
pub mod limit;
pub mod sense;

use behave::Intent;
use behaviour::Behaviours;
use plan_format::Blob;
use plan_format::parameters::Vehicle;
use robot_io::{Commands, Percepts, Reason};
use schemas::{Noise, Vectors};

/// All that one tick leaves to the next: plain data that can be kept, compared and replayed.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Position, heading and what they rest on.
    pub track: sense::Track,
    /// The behaviours of the mission and their live plans.
    pub behaviours: Behaviours,
    /// The chosen layer, and whether the goal is reached.
    pub progress: guidance::Progress,
    /// The noise schema.
    pub noise: Noise,
}

/// The state is kept in static memory; its budget is 8 KB.
const _: () = assert!(size_of::<State>() <= 8 * 1024);

impl State {
    /// The state before the first tick.
    pub fn new(blob: &Blob<'_>) -> Self {
        Self {
            track: sense::Track::default(),
            behaviours: Behaviours::new(&blob.mission()),
            progress: guidance::Progress::default(),
            noise: Noise::new(blob.parameters().seed),
        }
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
    /// Where the robot believes to be.
    pub sensed: sense::Sensed,
    /// What the behaviours decided.
    pub report: behaviour::Report,
    /// How the schemas were blended; `None` where the robot stood still before it came to that.
    pub blend: Option<Blend>,
}

/// How the schemas of one tick were blended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Advice, goal and gains.
    pub guidance: guidance::Guidance,
    /// The schemas' vectors, map axes.
    pub vectors: Vectors,
    /// Their weighted sum; length 1 is the base speed.
    pub sum: math::Vec2,
}

/// As [`tick`], which is this without the explanation.
#[inline]
pub fn explain(blob: &Blob<'_>, state: &mut State, percepts: &Percepts) -> Explanation {
    let percepts = percepts.sanitised();
    let sensed = sense::sense(blob, &mut state.track, &percepts);
    let mut report = behaviour::Report::default();
    let position = sensed.position.ok();
    let intent = behave::behave(blob, &mut state.behaviours, &percepts, position, &mut report);
    let vehicle = intent.constrained(&blob.parameters().vehicle);
    let decided = decide(blob, &vehicle, state, &percepts, &sensed, &intent);
    let (wanted, blend) = decided.unwrap_or_else(|reason| (Commands::stop(reason), None));
    let commands = limit::limit(&vehicle, &percepts, intent.with_outputs(wanted));
    state.track.commanded(&commands);
    Explanation { commands, sensed, report, blend }
}

/// What the robot would do if neither operator nor obstacles objected; an error says why it
/// stands still.
fn decide(
    blob: &Blob<'_>,
    vehicle: &Vehicle,
    state: &mut State,
    percepts: &Percepts,
    sensed: &sense::Sensed,
    intent: &Intent,
) -> Result<(Commands, Option<Blend>), Reason> {
    let schema = &blob.parameters().schemas;
    let position = sensed.position?;
    let is_armed = percepts.operator.is_armed;
    let guidance = match intent.target(position)? {
        behave::Steering::Plan(target) => {
            guidance::guide(blob, &target, &mut state.progress, position, is_armed)?
        }
        behave::Steering::Straight(guidance) => guidance,
    };
    let Some(heading_rad) = sensed.heading_rad else {
        return drive::creep(vehicle, percepts).map(|commands| (commands, None));
    };

    let repulsion = schemas::avoid_static_obstacle(
        &percepts.ranges,
        vehicle.radius_m,
        schema.avoid_margin_m,
        schema.avoid_sphere_m,
    );
    let vectors = Vectors {
        goal: schemas::move_to_goal(position, guidance.goal, schema.goal_tolerance_m),
        avoid: math::vector::rotated(repulsion.vector, heading_rad),
        advice: schemas::follow_plan(guidance.step),
        noise: state.noise.next(schema.noise_persistence_ticks),
    };
    let sum = schemas::blend(&guidance.gains, schema, &vectors);
    let is_repelled = guidance.gains.reactive * schema.avoid_gain > 0.0 && repulsion.is_saturated;
    let commands = drive::drive(vehicle, sum, heading_rad, is_repelled).because(guidance.reason);
    Ok((commands, Some(Blend { guidance, vectors, sum })))
}
