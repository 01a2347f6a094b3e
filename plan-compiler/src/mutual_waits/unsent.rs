//! Facts about a signal that the mate never sends.

use super::flow;
use super::robot::Robot;
use maps::problem::{Problem, Source};
use plan_format::mission::{
    Behaviour, Condition, FactKind, Facts, Source as InputSource, Symbol, effects,
};
use std::sync::Arc;

/// Warns of each fact that waits for a code which its mates cannot signal, at its place in the file.
pub(super) fn check(source: &Arc<Source>, robots: &[Robot]) -> Vec<Problem> {
    let sent: Vec<Option<Vec<u16>>> = robots.iter().map(sent).collect();
    let mut problems: Vec<Problem> = Vec::new();
    for robot in robots {
        let used = used(robot);
        let facts = (0_u32..).zip(&robot.draft.facts).zip(&robot.mission.behaviours.facts);
        for ((_, fact), written) in facts.filter(|((index, _), _)| used >> index & 1 == 1) {
            let FactKind::MateSignals { mates, code } = fact.kind else { continue };
            let named = (0..robots.len()).filter(|mate| mates.robots >> mate & 1 == 1);
            // A mate whose part has mistakes is not known.
            let never =
                |mate: &usize| sent[*mate].as_ref().is_some_and(|sent| !sent.contains(&code));
            let (silent, others): (Vec<usize>, Vec<usize>) = named.partition(never);
            let is_open = !silent.is_empty() && (mates.all || others.is_empty());
            let span = written.name.span.clone();
            let is_known =
                |problem: &Problem| problem.place.as_ref().is_some_and(|place| place.span == span);
            if !is_open || problems.iter().any(is_known) {
                continue;
            }
            let names = silent.iter().map(|&mate| format!("`{}`", robots[mate].name));
            let verb = if silent.len() == 1 { "signals" } else { "signal" };
            let message = format!(
                "fact `{}` can never hold: {} never {verb} {code}",
                written.name.as_str(),
                names.collect::<Vec<_>>().join(" and ")
            );
            let what = silent.iter().map(|&mate| {
                let codes = sent[mate].as_deref().unwrap_or_default();
                let codes: Vec<String> = codes.iter().map(u16::to_string).collect();
                let codes = if codes.is_empty() { "nothing".into() } else { codes.join(", ") };
                format!("{} signals {codes}", robots[mate].name)
            });
            let help = format!(
                "{}; give the mate an action that does \"signal {code}\" and runs in its plan, or \
                 correct the code",
                what.collect::<Vec<_>>().join("; ")
            );
            problems.push(Problem::warning(message).help(help).at(source, span, "this fact"));
        }
    }
    problems
}

/// The codes that a robot's plans can signal; `None` if its part has mistakes.
fn sent(robot: &Robot) -> Option<Vec<u16>> {
    let codes = live(robot).filter_map(|symbol| match symbol {
        Symbol::Action(action) => flow::signal_of(&robot.draft, action),
        Symbol::PlanFrame(_) => None,
    });
    let mut codes: Vec<u16> = codes.collect();
    codes.sort_unstable();
    codes.dedup();
    robot.is_sound.then_some(codes)
}

/// The facts that decide something in a robot's plans.
fn used(robot: &Robot) -> Facts {
    let draft = &robot.draft;
    let of = |condition: Condition| condition.must | condition.must_not;
    let components = live(robot).fold(0, |facts, symbol| {
        let until = match symbol {
            Symbol::Action(index) => draft.actions[usize::from(index)].until,
            Symbol::PlanFrame(index) => draft.frames[usize::from(index)].until,
        };
        let described = flow::described(draft, symbol).map_or(0, |description| {
            of(description.initial) | of(description.transient) | of(description.goal)
        });
        facts | of(until) | described
    });
    draft.inputs.iter().fold(components, |facts, input| match input.source {
        InputSource::Fact(fact) => facts | 1 << fact,
        _ => facts,
    })
}

/// The components that occur in a robot's plans; some more than once.
fn live(robot: &Robot) -> impl Iterator<Item = Symbol> {
    let roots = robot.draft.behaviours.iter().flat_map(Behaviour::plan_frames);
    roots.flat_map(|root| {
        let below = effects::all_below(&robot.draft, root.into());
        below.into_iter().chain([Symbol::PlanFrame(root)])
    })
}
