//! Every key of a mission file.

pub use super::key::{Key, Kind};

use super::Mission;
use super::key::{counted, flag, number, ranged, text, word};
use crate::search::Corners;
use plan_format::parameters::{
    ArmingChecks, BackOut, Blend, Gains, LayerGains, OnLinkLoss, OnNoProgress, OnTrouble,
    Selection, Steering,
};
use plan_format::{Parameters, limits};

/// The tables of a mission file.
pub const SECTIONS: [&str; 17] = [
    "goals",
    "layers",
    "masks",
    "gains",
    "vehicle",
    "schemas",
    "fixes",
    "trouble",
    "link",
    "ranges",
    "progress",
    "arming",
    "fence",
    "battery",
    "team",
    "radio",
    "layer_gains",
];

/// Sets the weights, and the blend that they are meant for.
fn preset(mission: &mut Mission, gains: Gains, blend: Blend) {
    mission.parameters.gains = gains;
    mission.parameters.blend = blend;
}

/// Starts from the paper's values.
fn paper(mission: &mut Mission) {
    mission.parameters = Parameters::paper();
    if let Some(given) = &mut mission.given {
        given.set_paper();
    }
}

/// Every key, in the order of the documentation.
pub const KEYS: &[Key] = &[
    text(
        "map",
        "The map, relative to the mission file. Needed only to build the mission by its own name.",
    ),
    text(
        "plan",
        "Name of the parallel plan that the robot follows, which is the name of its goal; otherwise the first plan.",
    ),
    ranged(
        number(
            "",
            "resolution",
            "m",
            "",
            "Side of a cell; otherwise what the map asks for, otherwise 1 m.",
            |m, v| m.resolution_m = Some(v),
        ),
        limits::RESOLUTION_RANGE_M.0,
        limits::RESOLUTION_RANGE_M.1,
    ),
    ranged(
        number(
            "",
            "robot_radius",
            "m",
            "",
            "How far obstacles are grown, so that a round body of this radius does not touch them while its centre follows the advice; otherwise the vehicle's radius, and 0 in MovingAI maps and Iplan.dat.",
            |m, v| m.robot_radius_m = Some(v),
        ),
        0.0,
        100.0,
    ),
    word(
        "",
        "corners",
        "\"forbid\"",
        "Whether a diagonal step may pass a blocked cell beside it.",
        &[
            ("forbid", |m| m.corners = Some(Corners::Forbid)),
            ("allow", |m| m.corners = Some(Corners::Allow)),
        ],
    ),
    flag(
        "",
        "fill_walls",
        "false",
        "Whether the inside of a closed wall is blocked too.",
        |m, v| m.fill_walls = Some(v),
    ),
    Key {
        section: "",
        name: "block",
        meaning: "Tags of GeoJSON and OpenStreetMap whose objects are obstacles.",
        default: "",
        kind: Kind::Tags { set: |m, v| m.tags.block = v },
    },
    Key {
        section: "",
        name: "free",
        meaning: "Tags whose objects are free ground, although they are obstacles by default.",
        default: "",
        kind: Kind::Tags { set: |m, v| m.tags.free = v },
    },
    flag(
        "",
        "open_gates",
        "false",
        "Whether gates that are not locked are openings in their fence.",
        |m, v| m.tags.open_gates = v,
    ),
    Key {
        section: "",
        name: "origin",
        meaning: "Position of 0,0 in a GeoJSON or OpenStreetMap map; otherwise the centre of the file's contents, which moves when they change.",
        default: "",
        kind: Kind::Place { set: |m, v| m.origin = v },
    },
    word(
        "",
        "selection",
        "\"static\"",
        "How the robot chooses its layer: the most constrained one with a route from its position, once at the start or every tick; or the one with the lowest cost times its gain, every tick.",
        &[
            ("static", |m| m.parameters.selection = Selection::Static),
            ("dynamic", |m| m.parameters.selection = Selection::Dynamic),
            ("gains", |m| m.parameters.selection = Selection::Gains(LayerGains::default())),
        ],
    ),
    ranged(
        number(
            "",
            "selection_hysteresis",
            "",
            "0.02",
            "With `selection = \"gains\"`, another layer takes over if its weighted cost is lower by this share.",
            |m, v| m.selection_hysteresis = Some(v),
        ),
        0.0,
        1.0,
    ),
    counted(
        number("", "seed", "", "1", "Seed of the noise schema.", |m, v| {
            m.parameters.seed = v as u32
        }),
        0.0,
        4_294_967_295.0,
    ),
    word(
        "",
        "preset",
        "\"body\"",
        "Where values that the file does not set come from: from the body, or from the paper's experiments with MissionLab, which suit wide outdoor maps: the gains of `\"34:66\"`, `base_speed = 1.4`, `max_turn_rate = 1`, `stop_distance = 0.3`, `avoid_margin = 0.5`, `avoid_sphere = 5`.",
        &[("body", |_| ()), ("paper", paper)],
    ),
    word(
        "gains",
        "preset",
        "\"route\"",
        "Weights and their blend: the default, or reactive schemas and advice in percent, as in the paper's experiments, with `noise = 0.11` and `blend = \"paper\"`. The other keys of this table override parts of it.",
        &[
            ("route", |m| preset(m, Gains::ROUTE, Blend::Route)),
            ("100:0", |m| preset(m, Gains::REACTIVE_ONLY, Blend::Paper)),
            ("66:34", |m| preset(m, Gains::MOSTLY_REACTIVE, Blend::Paper)),
            ("34:66", |m| preset(m, Gains::MOSTLY_PLAN, Blend::Paper)),
            ("0:100", |m| preset(m, Gains::PLAN_ONLY, Blend::Paper)),
        ],
    ),
    number(
        "gains",
        "reactive",
        "",
        "0.5",
        "Weight of move-to-goal and avoid-static-obstacle together.",
        |m, v| m.parameters.gains.reactive = v as f32,
    ),
    number("gains", "plan", "", "1.0", "Weight of the advice.", |m, v| {
        m.parameters.gains.plan = v as f32
    }),
    number("gains", "noise", "", "0.05", "Weight of the noise schema.", |m, v| {
        m.parameters.gains.noise = v as f32
    }),
    word(
        "gains",
        "blend",
        "\"route\"",
        "What the weights apply to. `\"route\"`: the goal attracts only where there is no advice, the advice points to the route ahead, and detours lead out of dead ends that the map does not show. `\"paper\"`: goal and obstacles act beside the advice, which is one of eight directions.",
        &[
            ("route", |m| m.parameters.blend = Blend::Route),
            ("paper", |m| m.parameters.blend = Blend::Paper),
        ],
    ),
    word(
        "vehicle",
        "steering",
        "\"differential\"",
        "How the vehicle turns: on the spot; like a car; or like a boat, which turns only while it moves.",
        &[
            ("differential", |m| m.parameters.vehicle.steering = Steering::Differential),
            ("ackermann", |m| m.parameters.vehicle.steering = Steering::Ackermann),
            ("boat", |m| m.parameters.vehicle.steering = Steering::Boat),
        ],
    ),
    number(
        "vehicle",
        "radius",
        "m",
        "0.3",
        "Radius of a circle that contains the body; otherwise `robot_radius` if that is given.",
        |m, v| {
            m.parameters.vehicle.radius_m = v as f32;
            m.body_radius_given = true;
        },
    ),
    number(
        "vehicle",
        "base_speed",
        "m/s",
        "follows: `max_speed`",
        "Speed for a blended vector of length 1, above 0. It may not exceed `max_speed`.",
        |m, v| m.parameters.vehicle.base_speed_mps = v as f32,
    ),
    number("vehicle", "max_speed", "m/s", "1.6", "Highest speed, above 0.", |m, v| {
        m.parameters.vehicle.max_speed_mps = v as f32
    }),
    number(
        "vehicle",
        "cautious_speed",
        "m/s",
        "follows: 0.3, at most `base_speed`",
        "Speed where obstacles repel strongly; with 0 the robot stands there. It may not exceed `base_speed`.",
        |m, v| m.parameters.vehicle.cautious_speed_mps = v as f32,
    ),
    number(
        "vehicle",
        "max_turn_rate",
        "rad/s",
        "follows: `max_speed` / (2 `radius`), from 0.2 to 4",
        "Highest turn rate.",
        |m, v| m.parameters.vehicle.max_turn_rate_radps = v as f32,
    ),
    number(
        "vehicle",
        "min_turn_radius",
        "m",
        "0.0",
        "Radius of the smallest turning circle, for Ackermann steering.",
        |m, v| m.parameters.vehicle.min_turn_radius_m = v as f32,
    ),
    number(
        "vehicle",
        "braking",
        "m/s^2",
        "2.0",
        "Deceleration that the brakes give at least. The robot never drives faster than it can stop within what it sees.",
        |m, v| m.parameters.vehicle.braking_mps2 = v as f32,
    ),
    ranged(
        number(
            "vehicle",
            "latency",
            "s",
            "0.1",
            "Longest time from a range reading to the effect of the brakes. At least 0.1 counts: two ticks.",
            |m, v| m.parameters.vehicle.latency_us = (v * 1e6).round() as u32,
        ),
        0.0,
        2.0,
    ),
    number(
        "vehicle",
        "reach",
        "m",
        "10.0",
        "Distance from the robot's centre at which its range sensors see obstacles reliably.",
        |m, v| m.parameters.vehicle.reach_m = v as f32,
    ),
    number(
        "vehicle",
        "stop_distance",
        "m",
        "follows: `radius` / 15, at least 0.02, at most a given `avoid_margin`",
        "Distance that the robot keeps between its body and what it sees ahead.",
        |m, v| m.parameters.vehicle.stop_distance_m = v as f32,
    ),
    flag(
        "vehicle",
        "may_creep",
        "true",
        "Whether the robot creeps straight ahead, at 0.6 m/s or at a lower `max_speed`, until its heading is known. Without a compass the heading is the course of the fixes, which counts above 0.5 m/s.",
        |m, v| m.parameters.vehicle.may_creep = v,
    ),
    word(
        "vehicle",
        "back_out",
        "\"seen\"",
        "When a car or a boat drives astern to make room for a turn: never; once its range sensors have seen something astern since the start; or always, because they look all around.",
        &[
            ("never", |m| m.parameters.vehicle.back_out = BackOut::Never),
            ("seen", |m| m.parameters.vehicle.back_out = BackOut::Seen),
            ("always", |m| m.parameters.vehicle.back_out = BackOut::Always),
        ],
    ),
    number(
        "schemas",
        "goal_gain",
        "",
        "1.0",
        "Gain of move-to-goal within the reactive part.",
        |m, v| m.parameters.schemas.goal_gain = v as f32,
    ),
    number(
        "schemas",
        "avoid_gain",
        "",
        "1.0",
        "Gain of avoid-static-obstacle within the reactive part.",
        |m, v| m.parameters.schemas.avoid_gain = v as f32,
    ),
    number(
        "schemas",
        "avoid_sphere",
        "m",
        "follows: the stopping distance from `max_speed`, at least `avoid_margin`",
        "Obstacles repel up to this distance beyond the margin.",
        |m, v| m.parameters.schemas.avoid_sphere_m = v as f32,
    ),
    number(
        "schemas",
        "avoid_margin",
        "m",
        "follows: `stop_distance`",
        "Obstacles this close to the body repel at full strength.",
        |m, v| m.parameters.schemas.avoid_margin_m = v as f32,
    ),
    number(
        "schemas",
        "past_gain",
        "",
        "0.0",
        "Gain of avoid-past within the reactive part: the places of the last 24 s repel. With 3, the robot leaves dead ends of some metres without a plan.",
        |m, v| m.parameters.schemas.past_gain = v as f32,
    ),
    number(
        "schemas",
        "past_sphere",
        "m",
        "8.0",
        "Places where the robot has just been repel up to this distance.",
        |m, v| m.parameters.schemas.past_sphere_m = v as f32,
    ),
    number(
        "schemas",
        "look_ahead",
        "m",
        "follows: 1.6 `radius`, or 2 `radius`",
        "With `blend = \"route\"`, the advice points to the route this far ahead.",
        |m, v| m.parameters.schemas.look_ahead_m = v as f32,
    ),
    number(
        "schemas",
        "detour_after",
        "s",
        "4.0",
        "With `blend = \"route\"`, a robot behind an obstacle begins a detour after this time without progress.",
        |m, v| m.parameters.schemas.detour_after_us = (v * 1e6).round() as u32,
    ),
    number(
        "schemas",
        "goal_tolerance",
        "m",
        "1.0",
        "The goal is reached within this distance, and anywhere in its cell.",
        |m, v| m.parameters.schemas.goal_tolerance_m = v as f32,
    ),
    counted(
        number(
            "schemas",
            "noise_persistence",
            "ticks",
            "10",
            "How long the noise schema keeps a direction.",
            |m, v| m.parameters.schemas.noise_persistence_ticks = v as u16,
        ),
        1.0,
        65_535.0,
    ),
    ranged(
        number("fixes", "stale_after", "s", "2.0", "A fix older than this is stale.", |m, v| {
            m.parameters.fixes.stale_after_us = (v * 1e6).round() as u32
        }),
        0.05,
        3_600.0,
    ),
    ranged(
        number(
            "fixes",
            "max_accuracy",
            "m",
            "5.0",
            "A fix less accurate than this is refused.",
            |m, v| m.parameters.fixes.max_accuracy_mm = (v * 1e3).round() as u32,
        ),
        0.001,
        1_000.0,
    ),
    number(
        "fixes",
        "max_jump",
        "m/s",
        "15.0",
        "A fix that implies a higher speed than this is refused. The default is at least twice `max_speed`.",
        |m, v| m.parameters.fixes.max_jump_mps = v as f32,
    ),
    word(
        "trouble",
        "off_map",
        "\"stop\"",
        "What to do off the map, farther from its edge than `vehicle.radius`: stand still, or drive by the reactive schemas only.",
        &[
            ("stop", |m| m.parameters.trouble.off_map = OnTrouble::Stop),
            ("reactive", |m| m.parameters.trouble.off_map = OnTrouble::Reactive),
        ],
    ),
    word(
        "trouble",
        "no_route",
        "\"stop\"",
        "What to do where no layer has a route: stand still, or drive by the reactive schemas only.",
        &[
            ("stop", |m| m.parameters.trouble.no_route = OnTrouble::Stop),
            ("reactive", |m| m.parameters.trouble.no_route = OnTrouble::Reactive),
        ],
    ),
    number(
        "link",
        "timeout",
        "s",
        "1.0",
        "The link to the operator counts as lost after this time without a message.",
        |m, v| m.parameters.link.timeout_us = (v * 1e6).round() as u32,
    ),
    word(
        "link",
        "on_loss",
        "\"disarm\"",
        "What to do when the link is lost while the robot is armed: disarm and stand still, or continue the mission, for plans that lead out of radio range. Manual driving always ends.",
        &[
            ("disarm", |m| m.parameters.link.on_loss = OnLinkLoss::Disarm),
            ("continue", |m| m.parameters.link.on_loss = OnLinkLoss::Continue),
        ],
    ),
    number(
        "ranges",
        "stale_after",
        "s",
        "0.5",
        "A range finder that has worked counts as silent after this time without a scan; the robot then stops.",
        |m, v| m.parameters.ranges.stale_after_us = (v * 1e6).round() as u32,
    ),
    flag(
        "ranges",
        "required",
        "false",
        "Whether a robot whose range finder has never reported stands still.",
        |m, v| m.parameters.ranges.is_required = v,
    ),
    number(
        "progress",
        "after",
        "s",
        "60.0",
        "The robot makes no progress if it drives for this time without leaving a circle. A slow robot gets more: twice the circle's radius at its highest speed.",
        |m, v| m.parameters.progress.after_us = (v * 1e6).round() as u32,
    ),
    number(
        "progress",
        "within",
        "m",
        "1.0",
        "Radius of that circle. Three times the accuracy of the position is added.",
        |m, v| m.parameters.progress.within_m = v as f32,
    ),
    word(
        "progress",
        "on_none",
        "\"stop\"",
        "What to do without progress: stop until the operator arms the robot anew, or drive on.",
        &[
            ("stop", |m| m.parameters.progress.on_none = OnNoProgress::Stop),
            ("continue", |m| m.parameters.progress.on_none = OnNoProgress::Continue),
        ],
    ),
    word(
        "arming",
        "checks",
        "\"all\"",
        "Which checks must pass before the robot may be armed: all, or none. Telemetry reports failing checks in either case.",
        &[
            ("all", |m| m.parameters.safety.checks = ArmingChecks::All),
            ("none", |m| m.parameters.safety.checks = ArmingChecks::None),
        ],
    ),
    number(
        "fence",
        "radius",
        "m",
        "0.0",
        "Radius of the fence around the place where the robot was armed; 0 for none. It needs no map. Outside, the robot stops, or drives at most at cautious speed by hand.",
        |m, v| m.parameters.safety.fence_radius_m = v as f32,
    ),
    number(
        "battery",
        "low",
        "",
        "0.0",
        "The robot stops if its battery, the first input channel, is below this, in the unit of the channel; 0 for never. A battery with a threshold must be read before the robot may be armed.",
        |m, v| m.parameters.safety.battery_low = v as f32,
    ),
    number(
        "team",
        "lost_after",
        "s",
        "0.75",
        "The link to a mate is lost after this time without news of it. Mates send news 5 times per second.",
        |m, v| m.parameters.team.lost_after_us = (v * 1e6).round() as u32,
    ),
    number(
        "team",
        "regained_after",
        "s",
        "0.75",
        "The link to a mate is regained once news have arrived for this time.",
        |m, v| m.parameters.team.regained_after_us = (v * 1e6).round() as u32,
    ),
    number(
        "team",
        "min_quality",
        "",
        "0.0",
        "News over a link of a lower quality, from 0 to 1, count as lost.",
        |m, v| m.parameters.team.min_quality = v as f32,
    ),
    number(
        "team",
        "avoid_gain",
        "",
        "1.0",
        "Gain of avoid-robot within the reactive part: mates repel by the positions in their news.",
        |m, v| m.parameters.team.avoid_gain = v as f32,
    ),
    number(
        "team",
        "avoid_sphere",
        "m",
        "2.0",
        "Mates repel up to this distance beyond the margin between the bodies.",
        |m, v| m.parameters.team.avoid_sphere_m = v as f32,
    ),
    number(
        "team",
        "tether_length",
        "m",
        "20.0",
        "Length of the tether: farther away from the mate that `tether` names, the robot is drawn back to it.",
        |m, v| m.parameters.team.tether_m = v as f32,
    ),
];
