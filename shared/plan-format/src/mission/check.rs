//! The rules that a mission must keep before a robot may run it.

use super::{ActionKind, Edge, FactKind, Mission, Production, Source, Symbol, Table};
use crate::limits;
use crate::record::Record;
use core::fmt;

/// Why a mission is refused. `Display` gives the message; the variants' docs say which rule is
/// broken. The compiler reports each such mistake in the mission file, so a refused mission points
/// to a faulty writer: compile it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissionError {
    /// The section is not a postcard message of tables, the bytes of a table are not whole records,
    /// or a record has an unknown tag or unused bytes that are not 0.
    Tables,
    /// A table, or the facts about progress in it, exceed their constant in [`limits`]; shared
    /// records count once for each use.
    TooLarge,
    /// A name points outside the name table or to bytes that are not UTF-8. In a draft, it may have
    /// been too long: see [`limits::MAX_NAME_BYTES`] and [`limits::MAX_MISSION_NAMES_BYTES`].
    Name,
    /// An index points past the end of a table, a plan frame has no production, or a rule base
    /// builds on itself or on a later one.
    Reference,
    /// A coordinate, gain, threshold, time, channel or output is not finite or out of its range.
    Number,
    /// An edge or an interval does not lead to a later vertex, or a vertex has no edge in or out.
    Graph,
}

impl MissionError {
    /// Number and message of each error.
    const fn row(self) -> (u8, &'static str) {
        match self {
            Self::Tables => (1, "a table holds a partial or unknown record"),
            Self::TooLarge => (2, "a table is longer than this build's limits"),
            Self::Name => (3, "a name is out of range or not UTF-8"),
            Self::Reference => (4, "a record refers to another that does not exist"),
            Self::Number => (5, "a number is not finite or out of its range"),
            Self::Graph => (6, "a production is not a graph from one entry to one exit"),
        }
    }

    /// A number for logs, from 1; never reused for another meaning.
    pub const fn code(self) -> u8 {
        self.row().0
    }
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().1)
    }
}

impl core::error::Error for MissionError {}

#[cfg(all(feature = "defmt", target_os = "none"))]
impl defmt::Format for MissionError {
    fn format(&self, f: defmt::Formatter<'_>) {
        let (code, text) = self.row();
        defmt::write!(f, "code {=u8}, {=str}", code, text);
    }
}

type Checked = Result<(), MissionError>;

pub(super) fn check(mission: &Mission<'_>) -> Checked {
    tables(mission)?;
    names(mission)?;
    inputs_and_rules(mission)?;
    facts_and_descriptions(mission)?;
    components(mission)?;
    graphs(mission)?;
    behaviours(mission)
}

fn require(condition: bool, error: MissionError) -> Checked {
    if condition { Ok(()) } else { Err(error) }
}

fn exists<T: Record>(table: Table<'_, T>, index: impl Into<usize>) -> Checked {
    require(index.into() < table.len(), MissionError::Reference)
}

/// `first .. first + count` lies within a table.
fn spans<T: Record>(table: Table<'_, T>, first: u16, count: u8) -> Checked {
    let end = usize::from(first) + usize::from(count);
    require(end <= table.len(), MissionError::Reference)
}

/// A channel or an output exists on a robot.
fn below(number: u8, limit: usize) -> Checked {
    require(usize::from(number) < limit, MissionError::Number)
}

/// A set of robots of a team, one bit each, is not empty and names robots that can exist.
fn team(robots: u8) -> Checked {
    require(robots != 0 && usize::from(robots) < 1 << limits::MAX_ROBOTS, MissionError::Number)
}

/// The records that a table refers to, counted once for each reference, are within a limit.
fn referred(counts: impl Iterator<Item = u8>, limit: usize) -> Checked {
    require(counts.map(usize::from).sum::<usize>() <= limit, MissionError::TooLarge)
}

fn finite(numbers: &[f32]) -> Checked {
    require(numbers.iter().all(|number| number.is_finite()), MissionError::Number)
}

fn sound<T: Record>(table: Table<'_, T>, limit: usize) -> Checked {
    require(table.len() <= limit, MissionError::TooLarge)?;
    require(table.is_sound(), MissionError::Tables)
}

fn tables(mission: &Mission<'_>) -> Checked {
    sound(mission.inputs(), limits::MAX_INPUTS)?;
    sound(mission.rules(), limits::MAX_RULES)?;
    sound(mission.rule_bases(), limits::MAX_RULE_BASES)?;
    sound(mission.facts(), limits::MAX_FACTS)?;
    sound(mission.descriptions(), limits::MAX_DESCRIPTIONS)?;
    sound(mission.actions(), limits::MAX_ACTIONS)?;
    sound(mission.plan_frames(), limits::MAX_FRAMES)?;
    sound(mission.productions(), limits::MAX_PRODUCTIONS)?;
    sound(mission.edges(), limits::MAX_EDGES)?;
    sound(mission.intervals(), limits::MAX_INTERVALS)?;
    sound(mission.behaviours(), limits::MAX_BEHAVIOURS)
}

fn names(mission: &Mission<'_>) -> Checked {
    let all = mission
        .inputs()
        .iter()
        .map(|input| input.name)
        .chain(mission.facts().iter().map(|fact| fact.name))
        .chain(mission.actions().iter().map(|action| action.name))
        .chain(mission.plan_frames().iter().map(|frame| frame.name))
        .chain(mission.productions().iter().map(|production| production.name))
        .chain(mission.behaviours().iter().map(|behaviour| behaviour.name));
    for name in all {
        require(mission.name(name).len() == usize::from(name.length), MissionError::Name)?;
    }
    Ok(())
}

fn inputs_and_rules(mission: &Mission<'_>) -> Checked {
    for input in mission.inputs().iter() {
        finite(&[input.low, input.high, input.missing])?;
        require(input.low != input.high, MissionError::Number)?;
        match input.source {
            Source::DistanceTo { x_m, y_m } => finite(&[x_m, y_m])?,
            Source::Rules(index) => exists(mission.rule_bases(), index)?,
            Source::Channel(channel) => below(channel, limits::MAX_CHANNELS)?,
            Source::Output(output) => below(output, limits::MAX_OUTPUTS)?,
            Source::DistanceToMate(robots) => team(robots)?,
            Source::LinkToMate(robot) => below(robot, limits::MAX_ROBOTS)?,
            Source::Fact(fact) => exists(mission.facts(), fact)?,
            Source::RangeLeft { channel, full_m, .. } => {
                below(channel, limits::MAX_CHANNELS)?;
                require(full_m.is_finite() && full_m > 0.0, MissionError::Number)?;
            }
            // The blob checks references to parallel plans and layers.
            Source::Time
            | Source::CostToGoal { .. }
            | Source::PriceOfConstraint { .. }
            | Source::MatesLinked
            | Source::OldestNews => {}
        }
    }
    for rule in mission.rules().iter() {
        exists(mission.inputs(), rule.input)?;
    }
    // A row that several rule bases share is evaluated for each, so it counts for each.
    referred(mission.rule_bases().iter().map(|base| base.count), limits::MAX_RULES)?;
    for (index, base) in mission.rule_bases().iter().enumerate() {
        require(base.count > 0, MissionError::Number)?;
        spans(mission.rules(), base.first, base.count)?;
        // Rule bases are evaluated in order, so each may use earlier results only.
        for rule in mission.rules_of(&base) {
            let input = mission.inputs().get(usize::from(rule.input));
            if let Some(Source::Rules(earlier)) = input.map(|input| input.source) {
                require(usize::from(earlier) < index, MissionError::Reference)?;
            }
        }
    }
    Ok(())
}

fn facts_and_descriptions(mission: &Mission<'_>) -> Checked {
    let kinds = mission.facts().iter().map(|fact| fact.kind);
    let progress = kinds.filter(|kind| matches!(kind, FactKind::NoProgress { .. })).count();
    require(progress <= limits::MAX_PROGRESS_FACTS, MissionError::TooLarge)?;
    for fact in mission.facts().iter() {
        match fact.kind {
            FactKind::Symbol { .. } => {}
            FactKind::Level { input, low, high } => {
                exists(mission.inputs(), input)?;
                require(low <= high, MissionError::Number)?;
            }
            FactKind::Near { x_m, y_m, radius_m } => {
                finite(&[x_m, y_m, radius_m])?;
                require(radius_m > 0.0, MissionError::Number)?;
            }
            FactKind::Inside { west_m, south_m, east_m, north_m } => {
                finite(&[west_m, south_m, east_m, north_m])?;
                require(west_m < east_m && south_m < north_m, MissionError::Number)?;
            }
            FactKind::Linked(mates) | FactKind::MateSignals { mates, .. } => team(mates.robots)?,
            FactKind::MateNear { mates, radius_m } => {
                team(mates.robots)?;
                finite(&[radius_m])?;
                require(radius_m > 0.0, MissionError::Number)?;
            }
            FactKind::MateAt { mates, x_m, y_m, radius_m } => {
                team(mates.robots)?;
                finite(&[x_m, y_m, radius_m])?;
                require(radius_m > 0.0, MissionError::Number)?;
            }
            FactKind::NoProgress { distance_m, within_ms } => {
                finite(&[distance_m])?;
                require(distance_m > 0.0 && within_ms > 0, MissionError::Number)?;
            }
        }
    }
    for description in mission.descriptions().iter() {
        require(description.max_speed_mps >= 0.0, MissionError::Number)?;
        finite(&[description.min_distance_m])?;
        require(description.min_distance_m >= 0.0, MissionError::Number)?;
    }
    Ok(())
}

fn components(mission: &Mission<'_>) -> Checked {
    for action in mission.actions().iter() {
        exists(mission.descriptions(), action.description)?;
        require(action.timeout_ms > 0, MissionError::Number)?;
        match action.kind {
            ActionKind::Follow { reactive, advice, noise, .. } => {
                let gains = [reactive, advice, noise];
                require(gains.iter().all(|gain| (0.0..=1.0).contains(gain)), MissionError::Number)?;
            }
            ActionKind::GoTo { x_m, y_m } => finite(&[x_m, y_m])?,
            ActionKind::MoveAhead { direction_rad, .. } => finite(&[direction_rad])?,
            ActionKind::Dock { x_m, y_m, direction_rad, radius_cm } => {
                finite(&[x_m, y_m, direction_rad])?;
                require(radius_cm > 0, MissionError::Number)?;
            }
            ActionKind::SetOutput { output, .. } => below(output, limits::MAX_OUTPUTS)?,
            ActionKind::Hold { .. }
            | ActionKind::Wander { .. }
            | ActionKind::Signal { .. }
            | ActionKind::Return => {}
        }
    }
    referred(mission.plan_frames().iter().map(|frame| frame.count), limits::MAX_PRODUCTIONS)?;
    for frame in mission.plan_frames().iter() {
        exists(mission.descriptions(), frame.description)?;
        require(frame.count > 0, MissionError::Reference)?;
        require(usize::from(frame.count) <= limits::MAX_ALTERNATIVES, MissionError::TooLarge)?;
        spans(mission.productions(), frame.first, frame.count)?;
        require((0.0..=1.0).contains(&frame.threshold), MissionError::Number)?;
    }
    Ok(())
}

fn graphs(mission: &Mission<'_>) -> Checked {
    let productions = || mission.productions().iter();
    referred(productions().map(|production| production.edges), limits::MAX_EDGES)?;
    referred(productions().map(|production| production.intervals), limits::MAX_INTERVALS)?;
    for production in mission.productions().iter() {
        if let Some(rules) = production.rules {
            exists(mission.rule_bases(), rules)?;
        }
        let edges = usize::from(production.edges);
        require(edges <= limits::MAX_PRODUCTION_EDGES, MissionError::TooLarge)?;
        spans(mission.edges(), production.first_edge, production.edges)?;
        spans(mission.intervals(), production.first_interval, production.intervals)?;
        graph(mission, &production)?;
    }
    Ok(())
}

/// Edges lead upwards, so the graph has no cycle; then every edge lies on a path from entry to
/// exit exactly when every inner vertex has an edge in and an edge out.
fn graph(mission: &Mission<'_>, production: &Production) -> Checked {
    let vertices = production.vertices;
    require(vertices >= 2 && usize::from(vertices) <= limits::MAX_VERTICES, MissionError::Graph)?;
    let (mut entered, mut left) = (1_u32, 1_u32 << (vertices - 1));
    for Edge { from, to, symbol, .. } in mission.edges_of(production) {
        require(from < to && to < vertices, MissionError::Graph)?;
        entered |= 1 << to;
        left |= 1 << from;
        match symbol {
            Symbol::PlanFrame(index) => exists(mission.plan_frames(), index)?,
            Symbol::Action(index) => exists(mission.actions(), index)?,
        }
    }
    let all = u32::MAX >> (32 - u32::from(vertices));
    require(entered == all && left == all, MissionError::Graph)?;
    for interval in mission.intervals_of(production) {
        require(interval.from < interval.to && interval.to < vertices, MissionError::Graph)?;
    }
    Ok(())
}

fn behaviours(mission: &Mission<'_>) -> Checked {
    for behaviour in mission.behaviours().iter() {
        for frame in behaviour.plan_frames() {
            exists(mission.plan_frames(), frame)?;
        }
        exists(mission.rule_bases(), behaviour.rules)?;
        let unit = 0.0..=1.0;
        require(
            unit.contains(&behaviour.dormant)
                && unit.contains(&behaviour.unconditional)
                && unit.contains(&behaviour.hysteresis),
            MissionError::Number,
        )?;
    }
    Ok(())
}
