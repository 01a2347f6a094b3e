//! The mission language: its compiled form, and the messages about mistakes and about missions that
//! would fail. The messages are in `tests/golden/behaviours`, one file per topic.

mod carried_out;
mod lints;
mod mistakes;
mod pictures;
mod plough;
mod rounds;
mod waits;

use maps::problem::{Problem, Source, draw};
use plan_compiler::behaviours::{PlanNames, Plans, compile};
use plan_compiler::mission::parse;
use plan_format::mission::MissionDraft;
use proptest::prelude::*;
use std::sync::Arc;

/// Compiles a mission's text for a map with two plans.
fn compiled(text: &str) -> (Option<MissionDraft>, Vec<Problem>) {
    let source = Arc::new(Source { name: "m.mission.toml".into(), text: text.into() });
    let (mission, mut problems) = parse(&source);
    let layers = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    let plans = Plans::Known(vec![
        PlanNames { name: "gate".into(), layers: layers(&["physical", "comms"]) },
        PlanNames { name: "depot".into(), layers: layers(&["physical"]) },
    ]);
    let draft = compile(&mission.behaviours, &plans, &mut problems);
    (draft, problems)
}

/// Compares all messages about a mission with `tests/golden/behaviours/NAME.snap`.
#[track_caller]
fn check(name: &str, text: &str) {
    let (draft, problems) = compiled(text);
    let outcome = match draft.map(|draft| draft.write()) {
        Some(Ok(section)) => format!("compiled to {} bytes\n", section.len()),
        Some(Err(error)) => panic!("{name}: the robot refuses what compiles: {error}"),
        None => "not compiled\n".into(),
    };
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(it::root().canonicalize().unwrap().join("tests/golden/behaviours"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, draw(&problems, false) + &outcome));
}

/// Pieces of missions, right and wrong, for texts of all kinds.
fn piece() -> impl Strategy<Value = String> {
    let line = prop_oneof![
        Just("[inputs.fuel]\nsource = 'fuel'\nmissing = { then = 0 }".to_owned()),
        Just("[inputs.a]\nrules = { b = 'NB NM NS ZO PS PM PB' }".to_owned()),
        Just("[inputs.b]\nrules = { a = 'NB NM NS ZO PS PM PB', fuel = 'NB NB NB' }".to_owned()),
        Just("[facts]\nx = true\ny = { near = [1, 2], within = 3 }\nz = { input = 'fuel', at_most = 1 }".to_owned()),
        Just("[actions.go]\ndo = 'go-to 1, 2'\ninitial = ['x', 'not y']\nadd = 'x'\ndelete = ['y']".to_owned()),
        Just("[actions.ride]\ndo = 'follow gate at 5:95'\ngoal = ['y']\ntimeout_s = 9".to_owned()),
        Just("[frames.f]\nproductions = ['entry -> go -> f -> exit', 'entry -> (go | g) -> exit']".to_owned()),
        Just("[frames.g]\nproductions = [{ graph = 'entry -> f -> ride -> exit', protect = ['x from f to ride'], applicable = { fuel = 'PB PB PB PB PB PB NB' } }]".to_owned()),
        Just("[behaviours.f]\ncriticality = { fuel = 'PB PB PM PM NB NB NB' }".to_owned()),
        Just("[behaviours.g]\ncriticality = { a = 'PB PB PM PM NB NB NB', fuel = 'NB NB NB NB NB NB NB' }\nstart_up = 'f'\nswitch = 'best'".to_owned()),
        "\\[(inputs|facts|actions|frames|behaviours)(\\.[a-z ]{1,3})?\\]\n[a-z_]{1,12} = ('[ -&(-~é]{0,30}'|-?[0-9]{1,3}|\\[1, 2\\]|\\{ x = 1 \\})",
    ];
    prop::collection::vec(line, 0..12).prop_map(|lines| lines.join("\n"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Any text gives a mission that the robot accepts, or an error; never a panic.
    #[test]
    fn any_text_compiles_or_is_refused_with_reasons(text in piece()) {
        let (draft, problems) = compiled(&text);
        match draft {
            Some(draft) => prop_assert!(draft.write().is_ok(), "{text}"),
            None => prop_assert!(problems.iter().any(|p| p.help.is_some()), "{text}"),
        }
        // Every place lies within the text.
        prop_assert!(!draw(&problems, false).contains("OutOfBounds"));
        for place in problems.iter().filter_map(|problem| problem.place.as_ref()) {
            prop_assert!(text.get(place.span.clone()).is_some(), "{place:?}\n{text}");
        }
    }

    /// Mission files are mostly right: what remains after a part is cut out of the shipped one.
    #[test]
    fn the_shipped_mission_with_a_part_cut_out_never_panics(from in 0_usize..6_000, length in 0_usize..60) {
        let text = plough::text();
        let cut = |at: usize| (at..text.len()).find(|&at| text.is_char_boundary(at)).unwrap_or(text.len());
        let (from, to) = (cut(from), cut(from + length));
        let (draft, problems) = compiled(&format!("{}{}", &text[..from], &text[to..]));
        prop_assert!(draft.is_some() || !problems.is_empty());
    }
}
