//! Missions for particular measurements, and the blobs that carry missions.

use crate::missions::close_effects;
use plan_compiler::field::{Field, GOAL};
use plan_compiler::pack::pack;
use plan_format::grid::octile;
use plan_format::mission::{
    Action, ActionKind, Behaviour, Condition, Description, Edge, Fact, FactKind, Inference, Input,
    Interval, Label, MissionDraft, PlanFrame, Production, Rule, RuleBase, Source, SwitchPoint,
    Symbol,
};
use plan_format::{
    Direction, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft, WriteError, write,
};

/// Cells along each side of the map.
const SIDE: u32 = 20;

/// The blob of a mission on an open map of 20 m by 20 m with two parallel plans, the first of two
/// layers.
pub fn blob(mission: MissionDraft) -> Result<Vec<u8>, WriteError> {
    let grid = Grid { columns: SIDE, rows: SIDE, resolution_m: 1.0, corner_m: [0.0, 0.0] };
    let origin = Origin {
        place: math::GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 },
        at_m: [0.0, 0.0],
        heading_rad: 0.0,
    };
    let plan = |name: &str, column: u32, row: u32, layers: usize| PlanDraft {
        name: name.into(),
        goal_m: [f64::from(column) + 0.5, f64::from(row) + 0.5],
        layers: (0..layers)
            .map(|index| LayerDraft {
                name: format!("layer {index}"),
                packed: pack(&open_field(column, row)),
            })
            .collect(),
    };
    write(&Draft {
        grid,
        origin: Some(origin),
        parameters: Parameters::default(),
        plans: vec![plan("middle", 10, 10, 2), plan("corner", 19, 19, 1)],
        mission,
    })
}

/// Every cell of an open map leads straight to the goal.
fn open_field(column: u32, row: u32) -> Field {
    let cells = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let sign = |from: u32, to: u32| (i64::from(to) - i64::from(from)).signum() as i32;
    let code =
        |(x, y)| Direction::from_signs(sign(x, column), sign(y, row)).map_or(GOAL, Direction::code);
    Field {
        columns: SIDE,
        rows: SIDE,
        cost: cells().map(|(x, y)| octile(x.abs_diff(column), y.abs_diff(row))).collect(),
        code: cells().map(code).collect(),
    }
}

/// An input channel that rises and falls between 0 and 1, once in 64 ticks.
pub fn wave(tick: u32) -> f32 {
    let phase = (tick % 64) as f32 / 32.0;
    if phase < 1.0 { phase } else { 2.0 - phase }
}

/// A behaviour that switches an output on and itself round, for ever: an iteration takes no time,
/// so several fit into a tick.
pub fn endless_loop() -> MissionDraft {
    let mut draft = MissionDraft::default();
    let rules = always(&mut draft, Label::PS);
    let description = silent(&mut draft);
    action(&mut draft, ActionKind::SetOutput { output: 0, is_on: true }, description);
    let edges = [(0, 1, Symbol::Action(0)), (1, 2, Symbol::Frame(0))];
    frame(&mut draft, &edges, &[], description);
    behaviour(&mut draft, 0, rules, 1);
    draft
}

/// Sixteen behaviours that want the same and do it in steps of 100 ms, round and round; behaviour
/// `i` is as critical as channel `i` modulo 8 says, the upper eight the other way round.
pub fn sixteen() -> MissionDraft {
    use Label::{NM, NS, PM, PS, ZO};
    let mut draft = MissionDraft::default();
    let name = draft.name("");
    for channel in 0..8 {
        let source = Source::Channel(channel);
        draft.inputs.push(input(name, source));
    }
    let description = silent(&mut draft);
    action(&mut draft, ActionKind::Hold { for_ms: 100 }, description);
    let edges = [(0, 1, Symbol::Action(0)), (1, 2, Symbol::Frame(0))];
    frame(&mut draft, &edges, &[], description);
    for index in 0..16_u8 {
        let up = [NM, NM, NS, ZO, PS, PM, PM];
        let down = [PM, PM, PS, ZO, NS, NM, NM];
        let labels = if index < 8 { up } else { down };
        let first = draft.rules.len() as u16;
        draft.rules.push(Rule { input: index % 8, labels: labels.into() });
        draft.rule_bases.push(RuleBase { first, count: 1, inference: Inference::Product });
        behaviour(&mut draft, 0, u16::from(index), 1);
    }
    draft
}

/// The mission of the instruction budget: four behaviours, two and two for the same resource, each
/// pair changing places as the channels 1 and 3 rise and fall; sixteen rows of one input each;
/// twelve components and more when all have plans; every kind of fact, descriptions that ask for all of them,
/// protection intervals. Something drives in every tick.
pub fn budget() -> MissionDraft {
    use Label::{NM, NS, PB, PM, PS, ZO};
    let mut draft = MissionDraft::default();
    let name = draft.name("");
    for channel in 0..4 {
        draft.inputs.push(input(name, Source::Channel(channel)));
    }
    let facts = [
        FactKind::Symbol { is_set: true },
        FactKind::Level { input: 0, low: -1.0, high: 2.0 },
        FactKind::Near { x_m: 10.0, y_m: 10.0, radius_m: 50.0 },
        FactKind::Inside { west_m: -90.0, south_m: -90.0, east_m: 90.0, north_m: 90.0 },
        FactKind::NoProgress { distance_m: 0.5, within_ms: 99 },
    ];
    draft.facts.extend(facts.map(|kind| Fact { name, kind }));
    // Four criticalities, and applicabilities of which not all are needed.
    for row in 0..16_u8 {
        let labels = match row {
            0 | 2 => [ZO, ZO, PS, PS, PS, ZO, ZO],
            1 | 3 => [NM, NS, ZO, PS, PM, PM, PB],
            _ => [PB, PM, PS, ZO, PS, PM, PB],
        };
        draft.rules.push(Rule { input: row % 4, labels: labels.into() });
        let base = RuleBase { first: u16::from(row), count: 1, inference: Inference::Min };
        draft.rule_bases.push(base);
    }
    let watched = Condition { must: 0b01110, must_not: 0 };
    let needed = Condition { must: 0b01111, must_not: 0 };
    // Most need the symbol; one takes it away, and another brings it back before the next needs it.
    for (initial, add, delete) in
        [(needed, 0, 0), (needed, 0, 0b00001), (watched, 0b00001, 0), (watched, 0, 0)]
    {
        draft.descriptions.push(Description {
            initial,
            transient: watched,
            goal: watched,
            add,
            delete,
            max_speed_mps: 1.0,
            min_distance_m: 0.2,
        });
    }
    let follow = ActionKind::Follow { plan: 0, reactive: 0.5, advice: 0.5, noise: 0.1 };
    for (kind, description) in [
        (ActionKind::Hold { for_ms: 100 }, 3),
        (follow, 0),
        (ActionKind::Wander { for_ms: 50 }, 1),
        (ActionKind::SetOutput { output: 1, is_on: true }, 2),
        (ActionKind::Wander { for_ms: 50 }, 3),
    ] {
        action(&mut draft, kind, description);
    }
    // The robot of the measurement stands still, so the fact ends what would last.
    draft.actions[1].until = Condition { must: 0b10000, must_not: 0 };
    let whole = |to| Interval { from: 0, to, condition: watched, is_derived: true };
    let (hold, follow, wander) = (Symbol::Action(0), Symbol::Action(1), Symbol::Action(2));
    frame(&mut draft, &[(0, 1, hold), (1, 2, hold), (2, 3, hold)], &[whole(3)], 3);
    frame(&mut draft, &[(0, 1, Symbol::Frame(2))], &[whole(1)], 3);
    let (set, other) = (Symbol::Action(3), Symbol::Action(4));
    let round =
        [(0, 1, follow), (0, 1, set), (1, 2, wander), (2, 3, set), (3, 4, Symbol::Frame(2))];
    frame(&mut draft, &round, &[whole(2)], 0);
    frame(&mut draft, &[(0, 1, other), (1, 2, other), (2, 3, other)], &[whole(3)], 3);
    for (number, production) in (4..).zip(&mut draft.productions) {
        production.rules = Some(number);
    }
    for (rules, (root, resources)) in (0..).zip([(0, 2), (0, 2), (1, 1), (3, 1)]) {
        behaviour(&mut draft, root, rules, resources);
    }
    close_effects(&mut draft);
    draft
}

fn input(name: plan_format::mission::Name, source: Source) -> Input {
    Input { name, source, low: 0.0, high: 1.0, hold_ms: 500, missing: 0.5 }
}

/// A rule base with the same result whatever happens.
fn always(draft: &mut MissionDraft, label: Label) -> u16 {
    let name = draft.name("");
    draft.inputs.push(input(name, Source::Time));
    draft.rules.push(Rule { input: 0, labels: [label; 7].into() });
    draft.rule_bases.push(RuleBase { first: 0, count: 1, inference: Inference::Min });
    0
}

/// A description that asks for nothing.
fn silent(draft: &mut MissionDraft) -> u16 {
    draft.descriptions.push(Description {
        initial: Condition::default(),
        transient: Condition::default(),
        goal: Condition::default(),
        add: 0,
        delete: 0,
        max_speed_mps: f32::INFINITY,
        min_distance_m: 0.0,
    });
    0
}

fn action(draft: &mut MissionDraft, kind: ActionKind, description: u16) {
    let name = draft.name("");
    draft.actions.push(Action {
        name,
        kind,
        description,
        until: Condition::default(),
        timeout_ms: 3_600_000,
        resources: 1,
    });
}

/// A frame with one production.
fn frame(
    draft: &mut MissionDraft,
    edges: &[(u8, u8, Symbol)],
    intervals: &[Interval],
    description: u16,
) {
    let name = draft.name("");
    let (first_edge, first_interval) = (draft.edges.len() as u16, draft.intervals.len() as u16);
    let edge = |&(from, to, symbol): &(u8, u8, Symbol)| Edge { from, to, symbol, work: 1 };
    draft.edges.extend(edges.iter().map(edge));
    draft.intervals.extend(intervals);
    draft.productions.push(Production {
        name,
        rules: None,
        first_edge,
        edges: edges.len() as u8,
        vertices: edges.iter().map(|&(_, to, _)| to).max().unwrap_or(0) + 1,
        first_interval,
        intervals: intervals.len() as u8,
    });
    draft.frames.push(PlanFrame {
        name,
        first: draft.productions.len() as u16 - 1,
        count: 1,
        description,
        threshold: 0.0,
        may_add: 0,
        may_delete: 0,
        resources: 1,
    });
}

fn behaviour(draft: &mut MissionDraft, root: u16, rules: u16, resources: u16) {
    let name = draft.name("");
    draft.behaviours.push(Behaviour {
        name,
        root,
        start_up: None,
        shut_down: None,
        rules,
        dormant: 1.0 / 12.0,
        unconditional: 0.9,
        hysteresis: 0.02,
        dwell_ms: 0,
        switch_point: SwitchPoint::Earliest,
        resources,
    });
}
