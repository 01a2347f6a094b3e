//! The paper's ploughing field as shipped: its tables, its graph and its decisions.

use super::compiled;
use maps::problem::{Severity, Source as File};
use maps::{formats, source};
use plan_compiler::behaviours::{Plans, compile};
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::parse;
use plan_format::mission::Label::{NB, PB, PM, PS};
use plan_format::mission::{Label, Mission, MissionDraft, Source, Symbol};
use plan_format::{Blob, Layer};
use std::sync::Arc;

/// The shipped mission's text.
pub(super) fn text() -> String {
    let path = it::own_map("plough.mission.toml");
    source::read_text(&path).expect("the mission is readable").0.text.clone()
}

/// Its section of the blob; it names the gallon's plan first.
pub(super) fn section() -> Vec<u8> {
    let path = it::own_map("plough.mission.toml");
    let (mission, mut problems) = parse(&source::read_text(&path).expect("it is readable").0);
    let draft = compile(&mission.behaviours, &Plans::Any, &mut problems);
    draft.unwrap_or_else(|| panic!("{problems:?}")).write().expect("the robot takes it")
}

/// H39: the tables of the paper, and their bytes in the blob.
#[test]
fn h39_the_papers_tables_compile_to_the_golden_bytes() {
    const TABLE_4: [Label; 7] = [PS, PS, PS, PS, PS, PS, NB];
    const TABLE_5: [Label; 7] = [PB, PB, PM, PM, NB, NB, NB];
    const TABLE_6: [Label; 7] = [PS, PS, PS, PS, PS, NB, NB];
    let section = section();
    let mission = Mission::parse(&section).expect("a good mission");
    let rules = |base: u16| {
        let base = mission.rule_bases().get(base.into()).expect("checked");
        mission.rules_of(&base).map(|rule| rule.labels.labels()).collect::<Vec<_>>()
    };
    let behaviour = |index: usize| mission.behaviours().get(index).expect("checked");
    assert_eq!(rules(behaviour(0).rules), [TABLE_4]);
    assert_eq!(rules(behaviour(1).rules), [TABLE_5]);
    let root = mission.plan_frames().get(behaviour(0).root.into()).expect("checked");
    let strips = mission.productions_of(&root).next().expect("checked");
    assert_eq!(rules(strips.rules.expect("it has a table")), [TABLE_6]);

    // Input 1, then seven labels of three bits, NB = 0 to PB = 6, the lowest first.
    for golden in
        [[1, 0x24, 0x49, 0x02, 0x00], [0, 0x76, 0x0b, 0x00, 0x00], [1, 0x24, 0x49, 0x00, 0x00]]
    {
        let is_there = section.windows(golden.len()).any(|bytes| bytes == golden);
        assert!(is_there, "{golden:?} is missing");
    }
}

/// The recursive production and its interval, and their compiled form.
#[test]
fn h12_the_interval_is_where_the_paper_has_it() {
    let section = section();
    let mission = Mission::parse(&section).expect("a good mission");
    let root = mission.plan_frames().get(0).expect("checked");
    let production = mission.productions_of(&root).next().expect("checked");
    let names: Vec<&str> = mission
        .edges_of(&production)
        .map(|edge| match edge.symbol {
            Symbol::PlanFrame(index) => {
                mission.plan_frames().get(index.into()).expect("checked").name
            }
            Symbol::Action(index) => mission.actions().get(index.into()).expect("checked").name,
        })
        .map(|name| mission.name(name))
        .collect();
    assert_eq!(names, ["forward", "turn", "back", "plough field"]);
    let interval = mission.intervals_of(&production).next().expect("one by hand");
    let on_field = 1 << fact(&mission, "on field");
    assert_eq!((interval.from, interval.to, interval.is_derived), (0, 3, false));
    assert_eq!((interval.condition.must, interval.condition.must_not), (on_field, 0));

    // Refuelling drives off the field, so it endangers the interval.
    let refuel = mission.behaviours().get(1).expect("checked");
    let refuel = mission.plan_frames().get(refuel.root.into()).expect("checked");
    assert_ne!(refuel.may_delete & on_field, 0);
    assert_eq!(root.may_delete & on_field, 0);
}

fn fact(mission: &Mission<'_>, name: &str) -> usize {
    let found = mission.facts().iter().position(|fact| mission.name(fact.name) == name);
    found.expect("the mission has this fact")
}

/// The shipped mission compiles with its map without a warning, and the gallon is reached from
/// wherever it drives to.
#[test]
fn the_shipped_mission_compiles_with_its_map() {
    let path = it::own_map("plough.mission.toml");
    let (mission, mut problems) = parse(&source::read_text(&path).expect("it is readable").0);
    let (map, found) = formats::read(&it::own_map("plough.ovl"), &Default::default());
    let map = map.unwrap_or_else(|| panic!("{found:?}"));
    let options = Options::default();
    let input = Input { map: &map, source: None, mission: &mission, options: &options };
    let blob = plan_compiler::compile::compile(&input, &|_, _| {}, &mut problems);
    let blob = blob.unwrap_or_else(|| panic!("{problems:?}"));
    assert!(problems.iter().all(|problem| problem.severity == Severity::Note), "{problems:?}");
    let plan = Blob::parse(&blob).expect("a good blob");
    assert_eq!(plan.mission().behaviours().len(), 2);
    // There is a route to the gallon from both ends of every strip.
    let layer: Layer<'_> = plan.find("gallon").and_then(|plan| plan.layer(0)).expect("a plan");
    for action in plan.mission().actions().iter() {
        if let plan_format::mission::ActionKind::GoTo { x_m, y_m } = action.kind {
            let cell = plan.cell_at(math::Vec2::new(x_m, y_m)).expect("on the map");
            let answer = layer.look_up(cell);
            assert!(matches!(answer, plan_format::Answer::Move { .. }), "{x_m} {y_m}: {answer:?}");
        }
    }
}

#[test]
fn sources_and_missing_values_are_as_written() {
    let (draft, problems) = compiled(
        "[inputs]\n\
         a = { source = 'battery', universe = [10, 14.5], missing = { hold_s = 0.5, then = 10 } }\n\
         b = { source = 'custom 5', missing = { then = 1 } }\n\
         c = { source = 'distance -1.5, 2', universe = [9, 0], missing = { then = 9 } }\n\
         d = { source = 'cost-to-goal depot', universe = [0, 99], missing = { then = 99 } }\n\
         e = { source = 'price gate/comms', universe = [0, 50], missing = { then = 50 } }\n\
         f = { source = 'output 3' }\n\
         g = { source = 'time', universe = [0, 600] }\n\
         h = { rules = { i = 'NB NM NS ZO PS PM PB' }, inference = 'product' }\n\
         i = { rules = { a = 'NB NM NS ZO PS PM PB' } }\n\
         j = { source = 'range-left depot', channel = 'custom 1', full = 400, universe = [0, 90], \
         missing = { then = 0 } }\n\
         k = { source = 'range-left gate', full = 0.5, universe = [0, 90], missing = { then = 0 } }\n\
         [actions]\nbeep = { do = 'signal 1' }\n[frames]\nwork = { productions = 'entry -> beep -> exit' }\n\
         [behaviours.work]\ncriticality = { h = 'PB PB PB PB PB PB NB' }\n",
    );
    let MissionDraft { inputs, rule_bases, .. } = draft.unwrap_or_else(|| panic!("{problems:?}"));
    let sources: Vec<Source> = inputs.iter().map(|input| input.source).collect();
    assert_eq!(
        sources,
        [
            Source::Channel(0),
            Source::Channel(7),
            Source::DistanceTo { x_m: -1.5, y_m: 2.0 },
            Source::CostToGoal { plan: 1 },
            Source::PriceOfConstraint { plan: 0, layer: 1 },
            Source::Output(3),
            Source::Time,
            // `h` builds on `i`, so that one comes first.
            Source::Rules(1),
            Source::Rules(0),
            Source::RangeLeft { plan: 1, channel: 3, full_m: 400.0 },
            Source::RangeLeft { plan: 0, channel: 1, full_m: 0.5 },
        ]
    );
    assert_eq!((inputs[0].low, inputs[0].high, inputs[0].hold_ms), (10.0, 14.5, 500));
    assert_eq!((inputs[2].low, inputs[2].high, inputs[2].missing), (9.0, 0.0, 9.0));
    assert_eq!(rule_bases.len(), 3);
}

/// H12: an interval is derived if exactly one component produces a fact and exactly one needs it.
#[test]
fn h12_derived_intervals() {
    let derived = |actions: &str, graph: &str| -> Vec<(u8, u8, u64, u64)> {
        let text = format!(
            "[inputs.fuel]\nsource = 'fuel'\nmissing = {{ then = 0 }}\n[facts]\nf = false\n[actions]\n{actions}\n\
             [frames]\nwork = {{ productions = '{graph}' }}\n\
             [behaviours.work]\ncriticality = {{ fuel = 'PB PB PB PB PB PB NB' }}\n"
        );
        let (draft, problems) = compiled(&text);
        let draft = draft.unwrap_or_else(|| panic!("{problems:?}"));
        assert!(draft.intervals.iter().all(|interval| interval.is_derived));
        let plain = |i: &plan_format::mission::Interval| {
            (i.from, i.to, i.condition.must, i.condition.must_not)
        };
        draft.intervals.iter().map(plain).collect()
    };
    let make = "make = { do = 'signal 1', add = ['f'] }";
    let need = "need = { do = 'signal 2', initial = ['f'] }";
    let keep = "need = { do = 'signal 2', transient = ['f'] }";
    let beep = "beep = { do = 'signal 3' }";
    let clear = "beep = { do = 'signal 3', delete = ['f'] }";
    let unmake = "make = { do = 'signal 1', delete = ['f'] }";
    let lack = "need = { do = 'signal 2', initial = ['not f'] }";
    let graph = "entry -> make -> beep -> need -> exit";
    let all = |parts: [&str; 3]| parts.join("\n");
    assert_eq!(derived(&all([make, beep, need]), graph), [(1, 2, 1, 0)]);
    // Needed throughout: protected until it ends.
    assert_eq!(derived(&all([make, beep, keep]), graph), [(1, 3, 1, 0)]);
    // The absence of a fact can be produced and needed, too.
    assert_eq!(derived(&all([unmake, beep, lack]), graph), [(1, 2, 0, 1)]);
    // No component is between them.
    assert_eq!(derived(&all([make, beep, need]), "entry -> beep -> make -> need -> exit"), []);
    // Two producers, two consumers, or one that destroys it in between.
    assert_eq!(
        derived(&all([make, beep, need]), "entry -> make -> make -> beep -> need -> exit"),
        []
    );
    assert_eq!(
        derived(&all([make, beep, need]), "entry -> make -> need -> beep -> need -> exit"),
        []
    );
    assert_eq!(derived(&all([make, clear, need]), graph), []);
    // Destroyed afterwards, or before, is not in between.
    let after = "entry -> make -> wait -> need -> beep -> exit";
    let wait = format!("{}\nwait = {{ do = 'hold 1 s' }}", all([make, clear, need]));
    assert_eq!(derived(&wait, after), [(1, 2, 1, 0)]);
}

/// H12: an interval is derived across frames, if what needs the fact is below another frame.
#[test]
fn h12_intervals_are_derived_across_frames() {
    let derived = |frames: &str| -> Vec<(u8, u8)> {
        let text = format!(
            "[inputs.fuel]\nsource = 'fuel'\nmissing = {{ then = 0 }}\n[facts]\nf = false\n[actions]\n\
             make = {{ do = 'signal 1', add = ['f'] }}\n\
             need = {{ do = 'signal 2', initial = ['f'] }}\n\
             clear = {{ do = 'signal 3', delete = ['f'] }}\n\
             beep = {{ do = 'signal 4' }}\n[frames]\n{frames}\n\
             [behaviours.work]\ncriticality = {{ fuel = 'PB PB PB PB PB PB NB' }}\n"
        );
        let (draft, problems) = compiled(&text);
        let draft = draft.unwrap_or_else(|| panic!("{problems:?}"));
        // The first frame's.
        let all = draft.intervals.iter().take(draft.productions[0].intervals.into());
        all.map(|interval| (interval.from, interval.to)).collect()
    };
    let work = "work = { productions = 'entry -> make -> beep -> use -> exit' }";
    let below = |production: &str| format!("{work}\nuse = {{ productions = '{production}' }}");
    // The fact is needed somewhere below the frame, so it is protected until the frame ends.
    assert_eq!(derived(&below("entry -> beep -> need -> exit")), [(1, 3)]);
    // Below the frame it is also destroyed, so it is protected until the frame begins.
    assert_eq!(derived(&below("entry -> need -> clear -> exit")), [(1, 2)]);
    // The frame makes it true itself before it needs it, or does not need it.
    assert_eq!(derived(&below("entry -> make -> need -> exit")), []);
    assert_eq!(derived(&below("entry -> beep -> exit")), []);
    // Two levels below, and below one production of two.
    let deep = "use = { productions = ['entry -> beep -> exit', 'entry -> inner -> exit'] }\n\
                inner = { productions = 'entry -> need -> exit' }";
    assert_eq!(derived(&format!("{work}\n{deep}")), [(1, 3)]);
    // An interval over a loop would grow.
    let looped = "work = { productions = ['entry -> need -> make -> again -> exit', 'entry -> beep -> exit'] }\n\
                  again = { productions = ['entry -> beep -> work -> exit'] }";
    assert_eq!(derived(looped), []);
}

/// The example in the documentation compiles without a warning.
#[test]
fn the_documented_example_compiles() {
    let documentation = std::fs::read_to_string(it::root().join("plan-compiler/BEHAVIOURS.md"));
    let documentation = documentation.expect("it is readable");
    let example = documentation.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let text = example.expect("there is an example").to_owned();
    let (mission, mut problems) = parse(&Arc::new(File { name: "example".into(), text }));
    let draft = compile(&mission.behaviours, &Plans::Any, &mut problems);
    assert!(problems.iter().all(|problem| problem.severity == Severity::Note), "{problems:?}");
    assert!(draft.is_some_and(|draft| draft.behaviours.len() == 2));
}

/// A definition with parameters stands for one component for each pair of values with which it is
/// named. The mission compiles to the same records as one that writes every component out.
#[test]
fn h14_parametrised_components_are_the_components_written_out() {
    const COMMON: &str = r#"
[inputs]
"field ready" = { source = "custom 1", missing = { then = 1 } }
[behaviours.plough]
criticality = { "field ready" = "PS PS PS PS PS PS NB" }
[facts]
"on field" = { inside = [4, 4, 66, 76] }
"#;
    let short = format!(
        "{COMMON}{}",
        r#"
[frames]
plough = { productions = ["entry -> strip(10, 12, 68) -> strip(20,68,12) -> exit"] }
"strip(x, from, to)" = { productions = [{ graph = "entry -> to({x}, {from}) -> cut({x}, {to}) -> exit", protect = ["on field from to({x}, {from}) to cut({x}, {to})"], work = { "to({x},{from})" = 2 } }] }
[actions]
"to(x, y)" = { do = "go-to {x}, {y}", goal = ["at( {x},{y})"] }
"cut(x, y)" = { do = "go-to {x}, {y}", max_speed = 1.2 }
[facts."at(x, y)"]
near = ["{x}", "{y}"]
within = 1.5
"#
    );
    let long = format!(
        "{COMMON}{}",
        r#"
"at(20, 68)" = { near = [20, 68], within = 1.5 }
"at(10, 12)" = { near = [10, 12], within = 1.5 }
[frames]
plough = { productions = ["entry -> 'strip(10, 12, 68)' -> 'strip(20, 68, 12)' -> exit"] }
"strip(20, 68, 12)" = { productions = [{ graph = "entry -> 'to(20, 68)' -> 'cut(20, 12)' -> exit", protect = ["on field from 'to(20, 68)' to 'cut(20, 12)'"], work = { "to(20, 68)" = 2 } }] }
"strip(10, 12, 68)" = { productions = [{ graph = "entry -> 'to(10, 12)' -> 'cut(10, 68)' -> exit", protect = ["on field from 'to(10, 12)' to 'cut(10, 68)'"], work = { "to(10, 12)" = 2 } }] }
[actions]
"cut(20, 12)" = { do = "go-to 20, 12", max_speed = 1.2 }
"to(20, 68)" = { do = "go-to 20, 68", goal = ["at(20, 68)"] }
"cut(10, 68)" = { do = "go-to 10, 68", max_speed = 1.2 }
"to(10, 12)" = { do = "go-to 10, 12", goal = ["at(10, 12)"] }
"#
    );
    let records = |text: &str| {
        let (draft, problems) = compiled(text);
        let draft = draft.unwrap_or_else(|| panic!("{problems:#?}"));
        let section = draft.write().expect("it fits");
        let mission = Mission::parse(&section).expect("it is sound");
        let name = |name| mission.name(name).to_owned();
        let mut actions: Vec<String> = mission
            .actions()
            .iter()
            .map(|action| format!("{} {:?}", name(action.name), action.kind))
            .collect();
        actions.sort();
        let mut facts: Vec<String> = mission
            .facts()
            .iter()
            .map(|fact| format!("{} {:?}", name(fact.name), fact.kind))
            .collect();
        facts.sort();
        (actions, facts, mission.intervals().len(), mission.edges().len())
    };
    assert_eq!(records(&short), records(&long));
}

/// Mistakes in definitions with parameters are reported where they are written.
#[test]
fn parameters_are_checked() {
    super::check(
        "mistakes_in_parameters",
        r#"
[inputs]
clock = { source = "time", universe = [0, 60] }
[behaviours.work]
criticality = { clock = "PS PS PS PS PS PS NB" }
[frames]
work = { productions = ["entry -> to(10) -> to(10, east) -> go -> exit"] }
[actions]
"to(x, y)" = { do = "go-to {x}, {y}" }
"wait(x)" = { do = "hold {x} s" }
go = { do = "hold 2 s", timeout_s = -5 }
"#,
    );
}

/// H14, figure 3: one definition for all strips takes at most half the lines, and the actions and
/// facts are those of the mission that writes every strip out.
#[test]
fn h14_one_definition_for_all_strips() {
    let read = |name: &str| {
        let source = source::read_text(&it::own_map(name)).expect("the mission is readable").0;
        let (mission, mut problems) = parse(&source);
        let draft = compile(&mission.behaviours, &Plans::Any, &mut problems);
        let section = draft.unwrap_or_else(|| panic!("{problems:?}")).write().expect("it fits");
        let mission = Mission::parse(&section).expect("it is sound");
        let mut kinds: Vec<String> =
            mission.actions().iter().map(|action| format!("{:?}", action.kind)).collect();
        kinds.extend(mission.facts().iter().map(|fact| format!("{:?}", fact.kind)));
        kinds.sort();
        (source.text.lines().count(), kinds)
    };
    let (long, written_out) = read("plough.mission.toml");
    let (short, by_definition) = read("strips.mission.toml");
    assert!(2 * short <= long, "{short} and {long} lines");
    assert_eq!(by_definition, written_out);
}
