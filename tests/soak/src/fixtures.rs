//! Missions for particular measurements, and blobs with missions.

use behaviour::World;
use math::{Vec2, vector};
use plan_compiler::field::{Field, GOAL};
use plan_compiler::pack::pack;
use plan_format::grid::octile;
use plan_format::mission::MissionDraft;
use plan_format::{
    Direction, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft, TeamPolicy, WriteError,
    write,
};

/// Cells along each side of the map.
const SIDE: u32 = 20;

/// The blob of a mission on an open map of 20 m by 20 m with two parallel plans, of two layers and
/// of one.
pub fn blob(mission: MissionDraft) -> Result<Vec<u8>, WriteError> {
    blob_with(mission, Parameters::default())
}

/// The same for a robot of a team of three.
pub fn blob_of_team(mission: MissionDraft) -> Result<Vec<u8>, WriteError> {
    let team = TeamPolicy { robot: 1, robots: 3, tether_to: Some(0), ..TeamPolicy::default() };
    blob_with(mission, Parameters { team, ..Parameters::default() })
}

fn blob_with(mission: MissionDraft, parameters: Parameters) -> Result<Vec<u8>, WriteError> {
    let grid = Grid { columns: SIDE, rows: SIDE, resolution_m: 1.0, corner_m: [0.0, 0.0] };
    let origin = Origin {
        place: math::GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 },
        at_m: [0.0, 0.0],
        heading_rad: 0.0,
    };
    let plan = |name: &str, column: u32, row: u32, layers: usize| PlanDraft {
        name: name.into(),
        goals_m: vec![[f64::from(column) + 0.5, f64::from(row) + 0.5]],
        layers: (0..layers)
            .map(|index| LayerDraft {
                rank: 0,
                name: format!("layer {index}"),
                packed: pack(&open_field(column, row)),
            })
            .collect(),
    };
    write(&Draft {
        grid,
        origin: Some(origin),
        parameters,
        plans: vec![plan("middle", 10, 10, 2), plan("corner", 19, 19, 1)],
        mission,
    })
}

/// The field of an open map, in which every cell leads straight to the goal.
fn open_field(column: u32, row: u32) -> Field {
    let cells = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let sign = |from: u32, to: u32| (i64::from(to) - i64::from(from)).signum() as i32;
    let code =
        |(x, y)| Direction::from_signs(sign(x, column), sign(y, row)).map_or(GOAL, Direction::code);
    Field {
        columns: SIDE,
        rows: SIDE,
        unit: None,
        cost: cells().map(|(x, y)| octile(x.abs_diff(column), y.abs_diff(row))).collect(),
        code: cells().map(code).collect(),
    }
}

/// An input channel that rises and falls between 0 and 1, once in 64 ticks.
pub fn wave(tick: u32) -> f32 {
    let phase = (tick % 64) as f32 / 32.0;
    if phase < 1.0 { phase } else { 2.0 - phase }
}

/// A behaviour that switches an output on in an endless loop. An iteration takes no time, so a tick
/// runs several.
pub fn endless_loop() -> MissionDraft {
    ::fixtures::mission(
        "input time; of time; hold 500; missing 0.5
         action set set 0 on
         frame round; at-least 0
         = set:1 round:1
         behaviour work round; when always PS; hysteresis 0.02",
    )
}

/// Sixteen behaviours that share a resource and loop in steps of 100 ms. The criticality of
/// behaviour `i` rises with channel `i` modulo 8; for the upper eight it falls.
pub fn sixteen() -> MissionDraft {
    let mut text = String::new();
    for channel in 0..8 {
        text += &format!("input c{channel}; hold 500; missing 0.5\n");
    }
    text += "action step hold 100
             frame round; at-least 0
             = step:1 round:1\n";
    for index in 0..16 {
        let labels = if index < 8 { "NM NM NS ZO PS PM PM" } else { "PM PM PS ZO NS NM NM" };
        let rules = format!("when c{} {labels}; by product", index % 8);
        text += &format!("behaviour b{index} round; {rules}; hysteresis 0.02\n");
    }
    ::fixtures::mission(&text)
}

/// The mission of the instruction budget. Two pairs of behaviours share a resource each, and each
/// pair alternates as the channels 1 and 3 rise and fall. There are sixteen rows of one input each,
/// not all of them used; at least twelve components when all behaviours have plans; every kind of
/// fact; descriptions that use all facts; and protection intervals. An action drives in every tick.
///
/// Most actions need the fact `on`: `wander` deletes it, and `set` adds it again in time. The robot
/// of the measurement stands still, so the fact `stuck` ends `follow`.
pub fn budget() -> MissionDraft {
    const WATCHED: &str = "level near inside";
    let limits = format!("keeps {WATCHED}; goal {WATCHED}; speed 1; distance 0.2");
    let (needs, needs_on) = (format!("needs {WATCHED}"), format!("needs on {WATCHED}"));
    let mut text = String::new();
    for channel in 0..4 {
        text += &format!("input c{channel}; hold 500; missing 0.5\n");
    }
    for row in 0..16 {
        let labels = match row {
            0 | 2 => "ZO ZO PS PS PS ZO ZO",
            1 | 3 => "NM NS ZO PS PM PM PB",
            _ => "PB PM PS ZO PS PM PB",
        };
        text += &format!("rules r{row} c{} {labels}\n", row % 4);
    }
    text += &format!(
        "fact on set
         fact level level c0 -1 2
         fact near near 10 10 50
         fact inside inside -90 -90 90 90
         fact stuck stuck 0.5 99
         action hold hold 100; {needs}; {limits}
         action follow follow 0 0.5 0.5 0.1; {needs_on}; {limits}; until stuck
         action wander wander 50; {needs_on}; deletes on; {limits}
         action set set 1 on; {needs}; adds on; {limits}
         action other wander 50; {needs}; {limits}
         frame holding; at-least 0; {needs}; {limits}
         = hold:1 hold:1 hold:1; when r4; derived {WATCHED} 0 3
         frame start; at-least 0; {needs}; {limits}
         = round:1; when r5; derived {WATCHED} 0 1
         frame round; at-least 0; {needs_on}; {limits}
         = follow:1|set:1 wander:1 set:1 round:1; when r6; derived {WATCHED} 0 2
         frame turning; at-least 0; {needs}; {limits}
         = other:1 other:1 other:1; when r7; derived {WATCHED} 0 3
         behaviour b0 holding; when r0; resources 2; hysteresis 0.02
         behaviour b1 holding; when r1; resources 2; hysteresis 0.02
         behaviour b2 start; when r2; resources 1; hysteresis 0.02
         behaviour b3 turning; when r3; resources 1; hysteresis 0.02",
    );
    ::fixtures::mission(&text)
}

/// A world without plans, in which the robot is at a position, or at none that counts.
pub struct Open(pub Option<Vec2>);

impl World for Open {
    fn cost_to_goal(&self, _: u16) -> Option<f32> {
        None
    }
    fn price(&self, _: u16, _: u8) -> Option<f32> {
        None
    }
    fn is_at_goal(&self, _: u16) -> bool {
        false
    }
    fn is_at(&self, point: Vec2) -> bool {
        self.0.is_some_and(|at| vector::length(point - at) < 0.5)
    }
    fn is_docked(&self, point: Vec2, _: f32) -> bool {
        self.is_at(point)
    }
}
