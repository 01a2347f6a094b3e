//! `explain`: how the robot decided one tick of a recorded run, or how its behaviours took turns in
//! the whole run.

use super::{Failure, print_text, tell};
use crate::cli::Explain;
use behaviour::{Behaviours, Phase};
use controller::detour::Rule;
use controller::ranges::RangeTrust;
use controller::{Blend, Explanation, State};
use maps::problem::Problem;
use maps::source;
use maps::terminal::quoted;
use math::Vec2;
use plan_compiler::goals;
use plan_compiler::trace::fold::{self, Line};
use plan_compiler::trace::story::{self, Turn, decided, facts};
use plan_compiler::trace::{Trace, TraceError};
use plan_format::grid::cost_metres;
use plan_format::mission::{Label, Mission, RuleBase};
use plan_format::{Answer, Blob, MAGIC};
use robot_io::Percepts;
use std::fmt::Write as _;

pub(super) fn run(args: &Explain, quiet: bool) -> Result<(), Failure> {
    let bytes = source::read_bytes(&args.trace)?;
    let trace = Trace::from_bytes(&bytes).map_err(|error| refused(args, &bytes, error))?;
    let blob = Blob::parse_exact(&trace.blob)
        .map_err(|error| Problem::error(format!("the plans in the trace are refused: {error}")))?;
    let text = match args.tick {
        Some(_) if trace.percepts.is_empty() => {
            let message = format!("{}: the trace has no ticks", args.trace.display());
            return Err(Problem::error(message).help(RECORD).into());
        }
        Some(tick) => one_tick(&blob, &trace, tick.index(trace.percepts.len()))?,
        None => turns(&blob, &trace),
    };
    if trace.replayed_hash(&blob) != trace.hash {
        let message = "repeating the run gives other decisions: the trace was changed or cut off, or \
                       another build recorded it";
        let warning = Problem::warning(message).help("what follows is how this build decides");
        tell(&[warning], quiet);
    }
    print_text(&text)
}

const RECORD: &str = "record a trace with `cargo mission MAP --trace FILE`";

/// Why a file is not a trace, and how to record one.
fn refused(args: &Explain, bytes: &[u8], error: TraceError) -> Failure {
    let name = args.trace.display();
    if bytes.starts_with(&MAGIC) {
        return Problem::error(format!("{name} is a blob of plans, not a trace"))
            .help(format!(
                "show it with `plan-compiler inspect {}`, or {RECORD}",
                quoted(&args.trace)
            ))
            .into();
    }
    Problem::error(format!("{name}: {error}")).help(RECORD).into()
}

/// One line per turn and per step of the run, with where the robot was; what comes again and again is
/// shown once.
fn turns(blob: &Blob<'_>, trace: &Trace) -> String {
    let mut text = format!("{} ticks\n", trace.percepts.len());
    let story = story::of(blob, &trace.percepts);
    let mut lines = story.turns;
    lines.extend(story.steps);
    // In each tick the turns come first.
    lines.sort_by_key(|turn| turn.tick);
    for line in fold::folded(&lines) {
        let _ = match line {
            Line::Turn(Turn { tick, time_s, at, text: what, .. }) => {
                let at =
                    at.map_or("at ?".to_owned(), |at| format!("at ({:.1}, {:.1})", at.x, at.y));
                writeln!(text, "tick {tick:>6} {time_s:>8.2} s  {at:<16}  {what}")
            }
            Line::Again(again) => writeln!(text, "     ...  {again}"),
        };
    }
    text
}

fn one_tick(blob: &Blob<'_>, trace: &Trace, tick: usize) -> Result<String, Failure> {
    let Some((before, [percepts, ..])) = trace.percepts.split_at_checked(tick) else {
        let message =
            format!("the trace has {} ticks; there is no tick {tick}", trace.percepts.len());
        return Err(Problem::error(message).help("ticks are counted from 0").into());
    };
    let mut state = State::new(blob);
    for earlier in before {
        controller::tick(blob, &mut state, earlier);
    }
    let explanation = controller::explain(blob, &mut state, percepts);
    let mut text = format!("tick {tick} at {:.2} s\n", percepts.time_us as f64 / 1e6);
    // Writing to a string does not fail.
    let _ = write_all(&mut text, blob, &state, percepts, &explanation);
    Ok(text)
}

fn write_all(
    text: &mut String,
    blob: &Blob<'_>,
    state: &State,
    percepts: &Percepts,
    explanation: &Explanation,
) -> std::fmt::Result {
    let commands = &explanation.commands;
    writeln!(
        text,
        "commands   {:.2} m/s, {:.2} rad/s, because: {:?}",
        commands.speed_mps, commands.turn_rate_radps, commands.reason
    )?;
    if let Some(goal) = story::goal(blob, state) {
        writeln!(text, "goal       {goal}")?;
    }
    if commands.outputs != 0 || commands.signal != 0 {
        writeln!(text, "           outputs {:016b}, signal {}", commands.outputs, commands.signal)?;
    }
    match explanation.sensed.position {
        Ok(at) => write!(text, "position   {}", vector(at))?,
        Err(reason) => write!(text, "position   unknown: {reason:?}")?,
    }
    match explanation.sensed.heading_rad {
        Some(heading_rad) => writeln!(text, ", heading {heading_rad:.2} rad")?,
        None => writeln!(text, ", heading unknown")?,
    }
    write_sensors(text, state, percepts, explanation)?;
    let mission = blob.mission();
    if !mission.behaviours().is_empty() {
        write_behaviours(text, &mission, &state.behaviours, explanation)?;
    }
    if let Ok(at) = explanation.sensed.position {
        write_layers(text, blob, at)?;
    }
    if let Some(blend) = &explanation.blend {
        write_blend(text, blend)?;
    }
    for range in &percepts.ranges {
        writeln!(text, "range      {:.2} m at {:.2} rad", range.distance_m, range.bearing_rad)?;
    }
    Ok(())
}

/// State of the receiver and the range finder, and what is wrong.
fn write_sensors(
    text: &mut String,
    state: &State,
    percepts: &Percepts,
    explanation: &Explanation,
) -> std::fmt::Result {
    let sensed = &explanation.sensed;
    write!(text, "sensors    receiver {:?}", percepts.receiver)?;
    match sensed.ranges {
        RangeTrust::Absent => write!(text, ", no range finder")?,
        RangeTrust::Fresh { age_us } => write!(text, ", ranges {} ms old", age_us / 1_000)?,
        RangeTrust::Silent => write!(text, ", ranges silent")?,
        RangeTrust::Faulty => write!(text, ", ranges faulty")?,
    }
    let troubles = [
        (sensed.is_compass_wrong, "compass wrong"),
        (sensed.is_clock_stopped, "clock stopped"),
        (sensed.is_stuck, "stuck"),
        (state.stuck.is_none(), "no progress"),
        (percepts.is_link_lost, "link lost"),
    ];
    for (_, trouble) in troubles.into_iter().filter(|(is_so, _)| *is_so) {
        write!(text, ", {trouble}")?;
    }
    text.push('\n');
    let failing: Vec<&str> = state.checks().names().collect();
    if !failing.is_empty() {
        writeln!(text, "checks     failing: {}", failing.join(", "))?;
    }
    Ok(())
}

fn write_behaviours(
    text: &mut String,
    mission: &Mission<'_>,
    behaviours: &Behaviours,
    explanation: &Explanation,
) -> std::fmt::Result {
    let report = &explanation.report;
    for (index, behaviour) in mission.behaviours().iter().enumerate() {
        let criticality = report.criticalities.get(index).copied().unwrap_or(0.0);
        let phase = match behaviours.phase(index) {
            Phase::Idle if criticality <= behaviour.dormant => "dormant",
            Phase::Idle => "idle",
            Phase::StartingUp => "starting up",
            Phase::Active => "active",
            Phase::ShuttingDown => "shutting down",
            Phase::Sleeping => "sleeping",
        };
        writeln!(
            text,
            "behaviour  {}: {phase}, criticality {criticality:.4} (dormant up to {:.4}, unconditional from {:.4})",
            mission.name(behaviour.name),
            behaviour.dormant,
            behaviour.unconditional
        )?;
        if let Some(base) = mission.rule_bases().get(behaviour.rules.into()) {
            write_rules(text, mission, behaviours, &base)?;
        }
        write_points(text, mission, behaviours, index as u8)?;
    }
    writeln!(text, "facts      {}", facts(mission, report.facts))?;
    for decision in &report.decisions {
        writeln!(text, "decision   {}", decided(mission, decision))?;
    }
    if report.omitted > 0 {
        writeln!(text, "           and {} more", report.omitted)?;
    }
    Ok(())
}

/// The points ahead in a behaviour's plan at which it could be interrupted.
fn write_points(
    text: &mut String,
    mission: &Mission<'_>,
    behaviours: &Behaviours,
    behaviour: u8,
) -> std::fmt::Result {
    let mut lines = String::new();
    behaviours.grid().points(mission, behaviour, &mut |point| {
        let production = behaviours.grid().get(point.frame).and_then(|entry| entry.production);
        let record = production.and_then(|index| mission.productions().get(index.into()));
        let name = record.map_or("?", |record| mission.name(record.name));
        let protected = facts(mission, point.held.must | point.held.must_not);
        let _ = writeln!(
            lines,
            "  point    vertex {} of `{name}`: protects {protected}, {} of work lost",
            point.vertex, point.lost_work
        );
    });
    text.push_str(&lines);
    Ok(())
}

/// The degree of each rule that fires: input label, degree, consequence.
fn write_rules(
    text: &mut String,
    mission: &Mission<'_>,
    behaviours: &Behaviours,
    base: &RuleBase,
) -> std::fmt::Result {
    for rule in mission.rules_of(base) {
        let Some(input) = mission.inputs().get(rule.input.into()) else { continue };
        let value = behaviours.value_of(rule.input.into());
        let (lower, upper_degree) = fuzzy::fuzzify(fuzzy::position(value, input.low, input.high));
        write!(text, "  rule     {} = {value:.3}:", mission.name(input.name))?;
        for (label, degree) in [(lower, 1.0 - upper_degree), (lower + 1, upper_degree)] {
            if degree > 0.0 {
                let is = Label::from_index(label as u8);
                let then = rule.labels.get(label);
                write!(text, " {is:?} to {degree:.2}, so {then:?};")?;
            }
        }
        text.push('\n');
    }
    Ok(())
}

/// The answer of every layer for the robot's cell.
fn write_layers(text: &mut String, blob: &Blob<'_>, at: Vec2) -> std::fmt::Result {
    let Some(cell) = blob.cell_at(at) else { return writeln!(text, "cell       off the map") };
    writeln!(text, "cell       column {}, row {}", cell.column, cell.row)?;
    for parallel in blob.parallel_plans() {
        for layer in parallel.layers() {
            write!(text, "  advice   {}/{}: ", parallel.name(), layer.name())?;
            let goal = match layer.has_several_goals() {
                true => format!(", {}", goals::numbered(&parallel, layer.goal_number(cell))),
                false => String::new(),
            };
            match layer.look_up(cell) {
                Answer::Move { direction, cost } => {
                    let cost_m = cost_metres(cost, blob.grid().resolution_m);
                    writeln!(text, "{}, {cost_m:.2} m to go{goal}", direction.name())?;
                }
                Answer::Goal => writeln!(text, "the goal{goal}")?,
                Answer::NoRoute => writeln!(text, "no route")?,
                Answer::Blocked { escape: Some(escape) } => {
                    writeln!(text, "blocked, escape {}", escape.name())?;
                }
                Answer::Blocked { escape: None } => writeln!(text, "blocked, no escape")?,
                Answer::OffMap => writeln!(text, "off the map")?,
            }
        }
    }
    Ok(())
}

fn write_blend(text: &mut String, blend: &Blend) -> std::fmt::Result {
    let gains = &blend.guidance.gains;
    for (name, gain, of) in [
        ("goal", gains.reactive, blend.vectors.goal),
        ("avoid", gains.reactive, blend.vectors.avoid),
        ("past", gains.reactive, blend.vectors.past),
        ("advice", gains.plan, blend.vectors.advice),
        ("noise", gains.noise, blend.vectors.noise),
    ] {
        writeln!(text, "schema     {name:<6} {gain:.2} x {}", vector(of))?;
    }
    writeln!(text, "sum        {}", vector(blend.sum))?;
    let rule = match blend.rule {
        Rule::None => return Ok(()),
        Rule::Swirl => "swirl: the direction of the sum is closed, so an open one beside it",
        Rule::Detour => "detour: along an obstacle, after a time without progress",
        Rule::BackOut => "back out: astern, for want of room to turn ahead",
    };
    writeln!(text, "rule       {rule}")
}

fn vector(of: Vec2) -> String {
    format!("({:.3}, {:.3})", of.x, of.y)
}
