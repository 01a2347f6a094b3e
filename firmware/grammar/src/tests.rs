//! Grammars as text in, the events of the live plan as text out. A grammar becomes a mission in the
//! notation of `fixtures`.

extern crate std;

use super::*;
use parts::Life;
use plan_format::limits::MAX_COMPONENTS;
use plan_format::mission::{
    Condition, Description, Interval, Mission, MissionDraft, Production, Symbol,
};
use proptest::prelude::*;
use std::{collections::BTreeMap, fmt::Write, format, string::String, vec, vec::Vec};

/// A grammar from text. A line is `FRAME = stage stage ... / stage ...`, with `/` between the
/// productions of the frame. A stage is a symbol, or parallel symbols joined by `|`. Upper-case names
/// are frames, others are actions. The frame of the first line is the root.
struct Grammar {
    bytes: Vec<u8>,
    names: BTreeMap<String, Symbol>,
}

impl Grammar {
    fn new(text: &str) -> Self {
        Self::with(text, |_| {})
    }

    fn with(text: &str, change: impl FnOnce(&mut MissionDraft)) -> Self {
        let lines: Vec<(&str, &str)> = text
            .lines()
            .filter_map(|line| line.split_once('='))
            .map(|(a, b)| (a.trim(), b.trim()))
            .collect();
        let mut names: BTreeMap<String, Symbol> = (0..)
            .zip(&lines)
            .map(|(number, (frame, _))| (String::from(*frame), Symbol::PlanFrame(number)))
            .collect();
        let mut actions = (0..).map(Symbol::Action);
        let mut mission = String::from("input time; of time\n");
        let symbols = lines.iter().flat_map(|(_, productions)| productions.split([' ', '|', '/']));
        for name in symbols.filter(|name| !name.is_empty()) {
            names.entry(name.into()).or_insert_with(|| {
                mission += &format!("action {name} hold 0\n");
                actions.next().expect("numbers do not end")
            });
        }
        for (frame, productions) in &lines {
            mission += &format!("frame {frame}; at-least 0.5\n");
            for stages in productions.split('/') {
                mission += &format!("= {stages}\n");
            }
        }
        mission += &format!("behaviour all {}; when always PS", lines[0].0);
        let mut draft = fixtures::mission(&mission);
        change(&mut draft);
        Self { bytes: draft.write().expect("the grammar is sound"), names }
    }

    fn mission(&self) -> Mission<'_> {
        Mission::parse(&self.bytes).expect("the grammar is sound")
    }
}

/// Runs a plan: each round decomposes or runs the next scheduled component. `action` returns
/// whether an action, by name, succeeds; `applicable` returns the applicability of a production.
struct Run<'g> {
    mission: Mission<'g>,
    forest: Forest,
    log: String,
}

impl<'g> Run<'g> {
    fn new(grammar: &'g Grammar) -> Self {
        let mut forest = Forest::default();
        forest.plant(0, 0, &mut |_, _| {});
        Self { mission: grammar.mission(), forest, log: String::new() }
    }

    fn go(
        &mut self,
        rounds: usize,
        mut action: impl FnMut(&str) -> bool,
        mut applicable: impl FnMut(u16) -> f32,
    ) -> &str {
        for _ in 0..rounds {
            let Some(id) = self.forest.scheduled(0) else { break };
            let component = *self.forest.get(id).expect("scheduled components live");
            let ended = match component.symbol {
                Symbol::Action(index) => {
                    let record = self.mission.actions().get(usize::from(index)).expect("it exists");
                    let name = self.mission.name(record.name);
                    self.forest.start(id, &mut |_, _| {});
                    if action(name) {
                        write!(self.log, " {name}").expect("strings take everything");
                        finish(&mut self.forest, &self.mission, id, &mut |_, _| {})
                    } else {
                        write!(self.log, " {name}!").expect("strings take everything");
                        self.forest.fail(id, &mut |_, _| {})
                    }
                }
                Symbol::PlanFrame(_) => {
                    let mut ask = |index, _: &Production| applicable(index);
                    match self.forest.decompose(&self.mission, id, &mut ask, &mut |_, _| {}) {
                        (_, Choice::Production(_)) => Ended::GoesOn,
                        (id, Choice::LoopEnded) => {
                            finish(&mut self.forest, &self.mission, id, &mut |_, _| {})
                        }
                        (id, _) => self.forest.fail(id, &mut |_, _| {}),
                    }
                }
            };
            match ended {
                Ended::RootFinished => self.log.push_str(" done"),
                Ended::RootFailed => self.log.push_str(" failed"),
                Ended::GoesOn | Ended::Completes(_) | Ended::FallsBack(_) => {}
            }
        }
        self.log.trim()
    }
}

/// Finishes a component and every frame that it completes.
fn finish(forest: &mut Forest, mission: &Mission<'_>, id: Id, tell: &mut Tell<'_>) -> Ended {
    let mut ended = forest.finish(mission, id, tell);
    while let Ended::Completes(frame) = ended {
        ended = forest.finish(mission, frame, tell);
    }
    ended
}

/// Checks the log of a grammar whose actions all succeed and whose productions all apply.
#[track_caller]
fn check(grammar: &str, expected: &str) {
    let grammar = Grammar::new(grammar);
    let mut run = Run::new(&grammar);
    assert_eq!(run.go(1_000, |_| true, |_| 1.0), expected);
    assert!(run.forest.is_empty(), "the pool is not empty");
}

/// H03, H04: a frame is replaced by its production, and the parts run in the order of the graph.
#[test]
fn h04_replacement_keeps_the_order() {
    check("A = a b c", "a b c done");
    check("A = a B d\nB = b c", "a b c d done");
    check("A = B C\nB = a b\nC = c", "a b c done");
}

/// H05: parallel edges are scheduled together, and the next stage waits for all of them.
#[test]
fn h05_parallel_edges_join() {
    let grammar = Grammar::new("A = a|b|B d\nB = x y");
    let mut run = Run::new(&grammar);
    run.go(1, |_| true, |_| 1.0);
    let scheduled = run.forest.iter().filter(|(_, c)| c.life == Life::Scheduled).count();
    assert_eq!(scheduled, 3, "all parallel parts at once");
    let log = run.go(100, |_| true, |_| 1.0);
    assert!(log.ends_with("d done"), "{log}");
    for part in ["a", "b", "x y"] {
        assert!(log.find(part) < log.find('d'), "{log}");
    }
}

/// H06: the most applicable production is taken; of equal ones, the first.
#[test]
fn h06_the_best_production_is_chosen() {
    let grammar = Grammar::new("A = a / b / c");
    for (applicability, expected) in
        [([0.6, 0.9, 0.7], "b done"), ([0.7, 0.7, 0.7], "a done"), ([0.4, 0.4, 0.5], "c done")]
    {
        let mut run = Run::new(&grammar);
        assert_eq!(run.go(10, |_| true, |index| applicability[usize::from(index)]), expected);
    }
}

/// H24: a production below the threshold is not considered; if none remains, the frame fails.
#[test]
fn h24_nothing_applicable_fails() {
    let grammar = Grammar::new("A = a / b");
    assert_eq!(Run::new(&grammar).go(10, |_| true, |_| 0.49), "failed");
}

/// H08: a frame is decomposed only when it is due.
#[test]
fn h08_decomposition_is_lazy() {
    let grammar = Grammar::new("A = a B\nB = b");
    let mut run = Run::new(&grammar);
    run.go(1, |_| true, |_| 1.0);
    let frame =
        run.forest.iter().find(|(_, c)| c.symbol == grammar.names["B"]).expect("B is planned");
    assert_eq!((frame.1.life, frame.1.production), (Life::Planned, None));
}

/// H10: after a failure the next higher level chooses again; if the root fails, the plan does.
#[test]
fn h10_failure_falls_back_one_level() {
    let run = |text: &str, fails: &str| {
        let grammar = Grammar::new(text);
        let mut run = Run::new(&grammar);
        let log = String::from(run.go(100, |name| name != fails, |_| 1.0));
        assert!(run.forest.is_empty());
        log
    };
    assert_eq!(run("A = x B y\nB = a b / c", "b"), "x a b! c y done");
    assert_eq!(run("A = x B / z\nB = a / b a", "a"), "x a! b a! z done");
    assert_eq!(run("A = a b", "b"), "a b! failed");
    // A component that runs beside the failed one is abandoned with it.
    assert_eq!(run("A = B z\nB = b|a c / d", "b"), "b! d z done");
}

/// H07: tail recursion runs a million rounds in constant memory, and ends when its production is no
/// longer applicable.
#[test]
fn h07_a_million_rounds_in_constant_memory() {
    let grammar = Grammar::new("A = a A");
    let mut run = Run::new(&grammar);
    let (mut rounds, mut largest) = (0_u32, 0);
    while let Some(id) = run.forest.scheduled(0) {
        largest = largest.max(run.forest.len());
        let mut ask = |_, _: &Production| if rounds < 1_000_000 { 1.0 } else { 0.0 };
        match run.forest.get(id).expect("it lives").symbol {
            Symbol::Action(_) => {
                run.forest.start(id, &mut |_, _| {});
                finish(&mut run.forest, &run.mission, id, &mut |_, _| {});
                rounds += 1;
            }
            Symbol::PlanFrame(_) => {
                match run.forest.decompose(&run.mission, id, &mut ask, &mut |_, _| {}) {
                    (_, Choice::Production(_)) => {}
                    (id, choice) => {
                        assert_eq!(choice, Choice::LoopEnded);
                        assert_eq!(
                            finish(&mut run.forest, &run.mission, id, &mut |_, _| {}),
                            Ended::RootFinished
                        );
                    }
                }
            }
        }
    }
    assert_eq!((rounds, largest), (1_000_000, 3));
}

/// H07: a loop through another frame restarts too, and the frame above a loop continues after it.
#[test]
fn h07_indirect_loops_and_what_follows_them() {
    let grammar = Grammar::new("R = A z\nA = a B\nB = b A");
    let mut run = Run::new(&grammar);
    let mut turns = 0;
    let log = run.go(
        100,
        |_| true,
        |production| {
            turns += u32::from(production == 1);
            if production == 1 && turns > 3 { 0.0 } else { 1.0 }
        },
    );
    assert_eq!(log, "a b a b a b z done");
}

/// H10: a failure in a later round falls back to the loop's frame, not to the root.
#[test]
fn h10_a_failure_in_a_loop_falls_back_to_the_loop() {
    let grammar = Grammar::new("R = s A\nA = a b A / c A");
    let mut run = Run::new(&grammar);
    let mut count = 0;
    let log = run.go(
        14,
        |name| {
            count += u32::from(name == "b");
            !(name == "b" && count == 2)
        },
        |_| 1.0,
    );
    assert_eq!(log, "s a b a b! c a b");
}

/// The depth limit bounds recursion that is not tail recursion, and a production that is too large
/// for the pool is refused without harm.
#[test]
fn what_exceeds_the_limits_fails_and_leaves_nothing() {
    check("A = a A b", &format!("{}failed", "a ".repeat(7)));
    let wide = "A = a|b|c|d|e|f|g|h B B B\nB = a|b|c|d|e|f|g|h|i|j|k|l|m B";
    let grammar = Grammar::new(wide);
    let mut run = Run::new(&grammar);
    run.go(500, |_| true, |_| 1.0);
    assert!(run.forest.len() <= MAX_COMPONENTS);
}

/// A protection interval over the last edge prevents a restart: the interval ends only after it.
#[test]
fn an_interval_over_the_last_edge_forbids_coming_round() {
    let grammar = Grammar::with("A = a A", |draft| {
        draft.intervals.push(Interval {
            from: 0,
            to: 2,
            condition: Condition::default(),
            is_derived: false,
        });
        draft.productions[0].intervals = 1;
    });
    let mut run = Run::new(&grammar);
    run.go(4, |_| true, |_| 1.0);
    assert!(run.forest.iter().any(|(_, component)| component.depth == 2));
}

/// H28: a suspended plan stays as it is, and an interrupted action starts again.
#[test]
fn h28_a_plan_sleeps_and_wakes_as_it_was() {
    let grammar = Grammar::new("A = a b");
    let mut run = Run::new(&grammar);
    run.go(1, |_| true, |_| 1.0);
    let id = run.forest.scheduled(0).expect("a is scheduled");
    run.forest.start(id, &mut |_, _| {});
    run.forest.suspend(0, &mut |_, _| {});
    assert_eq!(run.forest.scheduled(0), None);
    run.forest.resume(0, &mut |_, _| {});
    assert_eq!(run.forest.get(id).map(|component| component.life), Some(Life::Scheduled));
    assert_eq!(run.go(10, |_| true, |_| 1.0), "a b done");
}

/// An interval that ends before the last edge does not prevent a restart.
#[test]
fn an_interval_before_the_last_edge_lets_the_loop_come_round() {
    let grammar = Grammar::with("A = a b A", |draft| {
        draft.intervals.push(Interval {
            from: 0,
            to: 2,
            condition: Condition::default(),
            is_derived: false,
        });
        draft.productions[0].intervals = 1;
    });
    let mut run = Run::new(&grammar);
    run.go(12, |_| true, |_| 1.0);
    assert!(run.forest.iter().all(|(_, component)| component.depth < 2));
}

/// The plans of several owners share the pool and nothing else.
#[test]
fn owners_do_not_touch_each_other() {
    let grammar = Grammar::new("A = a b");
    let mission = grammar.mission();
    let (mut forest, mut tell) = (Forest::default(), |_: &_, _: &_| {});
    assert!(forest.is_empty());
    let roots = [7, 2].map(|owner| forest.plant(owner, 0, &mut tell).expect("there is room"));
    assert!(!forest.is_empty());
    assert_eq!([7, 2, 0].map(|owner| forest.root(owner)), [Some(roots[0]), Some(roots[1]), None]);
    for root in roots {
        forest.decompose(&mission, root, &mut |_, _| 1.0, &mut tell);
    }
    let [first, second] = [7, 2].map(|owner| forest.scheduled(owner).expect("a is due"));
    forest.start(first, &mut tell);
    forest.start(second, &mut tell);
    assert!(forest.running().eq([first, second]));
    forest.suspend(2, &mut tell);
    assert!(forest.running().eq([first]));
    assert_eq!(forest.get(second).map(|component| component.life), Some(Life::Suspended));
    forest.uproot(7, &mut tell);
    assert_eq!((forest.root(7), forest.root(2), forest.len()), (None, Some(roots[1]), 3));
    forest.uproot(2, &mut tell);
    assert!(forest.is_empty());
}

/// A frame is started by its decomposition only.
#[test]
fn a_frame_cannot_be_started() {
    let grammar = Grammar::new("A = a");
    let mut run = Run::new(&grammar);
    run.forest.start(0, &mut |_, _| {});
    assert_eq!(run.forest.get(0).map(|component| component.life), Some(Life::Scheduled));
    assert_eq!(run.go(10, |_| true, |_| 1.0), "a done");
}

/// A frame that begins anew may try every production again; one that falls back may not.
#[test]
fn beginning_anew_forgets_what_was_tried() {
    let grammar = Grammar::new("A = a / b");
    for (anew, expected) in [(true, "a a! b done"), (false, "a b done")] {
        let mut run = Run::new(&grammar);
        assert!(run.forest.is_new(0));
        run.go(1, |_| true, |_| 1.0);
        assert!(!run.forest.is_new(0));
        let action = run.forest.scheduled(0).expect("a is due");
        run.forest.start(action, &mut |_, _| {});
        run.log.push('a');
        if anew {
            run.forest.begin_anew(0, &mut |_, _| {});
        } else {
            run.forest.fall_back(0, &mut |_, _| {});
        }
        assert_eq!(run.forest.is_new(0), anew);
        assert_eq!(run.go(10, |name| name != "a", |_| 1.0), expected);
    }
}

/// A production that fills the last slot of the pool is accepted; one more component is not.
#[test]
fn the_pool_can_be_filled_to_the_last_slot() {
    let parallel = |name: char, count: usize| vec![String::from(name); count].join("|");
    for (beside, expected) in
        [(14, (Choice::Production(2), MAX_COMPONENTS)), (15, (Choice::NoRoom, 33))]
    {
        let (first, second) = (parallel('a', beside), parallel('a', 15));
        let text = format!("A = B|{first}\nB = C|{second}\nC = {}", parallel('a', 16));
        let grammar = Grammar::new(&text);
        let mut run = Run::new(&grammar);
        run.go(1, |_| true, |_| 1.0);
        let mut choice = Choice::NotScheduled;
        for name in ["B", "C"] {
            let inner = run.forest.iter().find(|(_, c)| c.symbol == grammar.names[name]);
            let (inner, _) = inner.expect("it is due");
            (_, choice) =
                run.forest.decompose(&run.mission, inner, &mut |_, _| 1.0, &mut |_, _| {});
        }
        assert_eq!((choice, run.forest.len()), expected);
        let root = run.forest.plant(5, 0, &mut |_, _| {});
        assert_eq!(root.is_some(), choice == Choice::NoRoom, "a full pool takes no root");
    }
    assert_eq!(MAX_COMPONENTS, 48);
}

#[test]
fn each_behaviour_and_its_activities_can_own_a_plan() {
    let mut forest = Forest::default();
    let planted = (0..40).filter_map(|owner| forest.plant(owner, 0, &mut |_, _| {}));
    assert!(planted.eq(0..32), "16 behaviours, and the activities of each");
    let roots = (0..40).filter_map(|owner| forest.root(owner));
    assert!(roots.eq(0..32));
}

/// H16: the life cycle allows exactly the transitions of this table.
#[test]
fn h16_the_life_cycle_is_the_table() {
    use Life::{Abandoned, Failed, Finished, Planned, Scheduled, Started, Suspended};
    let all = [Planned, Scheduled, Started, Suspended, Finished, Failed, Abandoned];
    let mut table = String::new();
    for from in all {
        for to in all {
            table.push(if from.may_become(to) { 'x' } else { '.' });
        }
        table.push('\n');
    }
    assert_eq!(
        table,
        ".x....x\n\
         ..xxxxx\n\
         .x.xxxx\n\
         .xx..xx\n\
         .......\n\
         .......\n\
         .......\n"
    );
}

fn random_grammar() -> impl Strategy<Value = String> {
    let stage =
        prop::collection::vec(prop::sample::select(vec!["a", "b", "c", "A", "B", "C"]), 1..4)
            .prop_map(|parts| parts.join("|"));
    let production = prop::collection::vec(stage, 1..4).prop_map(|stages| stages.join(" "));
    let frame = prop::collection::vec(production, 1..4).prop_map(|all| all.join(" / "));
    (frame.clone(), frame.clone(), frame).prop_map(|(a, b, c)| format!("A = {a}\nB = {b}\nC = {c}"))
}

proptest! {
    /// For any grammar and any failures: the pool's trees are connected, each change has an event,
    /// and only legal transitions happen.
    #[test]
    fn random_plans_keep_the_invariants(text in random_grammar(), chance in prop::collection::vec(any::<u8>(), 64)) {
        let grammar = Grammar::new(&text);
        let mission = grammar.mission();
        let mut forest = Forest::default();
        let mut mirror: BTreeMap<Id, Life> = BTreeMap::new();
        let mut wrong = String::new();
        let mut tell = |_: &Pool, event: &Event| match *event {
            Event::Planned { id, component } => {
                if mirror.insert(id, component.life).is_some() { wrong.push_str("planned twice;"); }
            }
            Event::Became { id, life } => match mirror.insert(id, life) {
                Some(before) if before.may_become(life) => {}
                before => wrong.push_str(&format!("{before:?} became {life:?};")),
            },
            Event::Deleted { id } => {
                if mirror.remove(&id).is_none() { wrong.push_str("deleted an empty slot;"); }
            }
            Event::Decomposed { .. } | Event::Restarted { .. } => {}
        };
        forest.plant(0, 0, &mut tell);
        for round in 0..400_usize {
            let luck = chance[round % chance.len()];
            if luck == 1 {
                forest.suspend(0, &mut tell);
                forest.resume(0, &mut tell);
            }
            let Some(id) = forest.scheduled(0) else { break };
            match forest.get(id).map(|component| component.symbol) {
                Some(Symbol::Action(_)) if luck < 64 => { forest.fail(id, &mut tell); }
                Some(Symbol::Action(_)) => {
                    forest.start(id, &mut tell);
                    finish(&mut forest, &mission, id, &mut tell);
                }
                _ => {
                    let mut ask = |index, _: &Production| f32::from(u8::from((luck >> (index % 8)) & 1 == 1));
                    match forest.decompose(&mission, id, &mut ask, &mut tell) {
                        (_, Choice::Production(_)) => {}
                        (id, Choice::LoopEnded) => { finish(&mut forest, &mission, id, &mut tell); }
                        (id, _) => { forest.fail(id, &mut tell); }
                    }
                }
            }
            for (id, component) in forest.iter() {
                let parent = component.parent.and_then(|parent| forest.get(parent));
                prop_assert!(component.parent.is_some() == parent.is_some(), "{id} has lost its parent");
                prop_assert_eq!(component.depth, parent.map_or(0, |parent| parent.depth + 1));
            }
            prop_assert!(forest.is_empty() || forest.scheduled(0).is_some(), "a dead plan");
        }
        prop_assert_eq!(&wrong, "");
        let lives: BTreeMap<Id, Life> = forest.iter().map(|(id, component)| (id, component.life)).collect();
        prop_assert_eq!(lives, mirror);
    }
}

/// H07: frames of a loop that have something to check stay in the plan, which grows no further once
/// each of them is there.
#[test]
fn h07_a_frame_with_constraints_stays_in_the_loop() {
    type Change = fn(&mut MissionDraft, usize);
    fn describe(draft: &mut MissionDraft, frame: usize, change: fn(&mut Description)) {
        let mut description = draft.descriptions[usize::from(draft.frames[frame].description)];
        change(&mut description);
        draft.frames[frame].description = draft.descriptions.len() as u16;
        draft.descriptions.push(description);
    }
    let constraints: [Change; 7] = [
        |draft, frame| describe(draft, frame, |of| of.max_speed_mps = 1.0),
        |draft, frame| describe(draft, frame, |of| of.min_distance_m = 1.0),
        |draft, frame| describe(draft, frame, |of| of.transient.must = 1),
        |draft, frame| describe(draft, frame, |of| of.goal.must_not = 1),
        |draft, frame| describe(draft, frame, |of| of.add = 1),
        |draft, frame| draft.frames[frame].timeout_ms = 5_000,
        |draft, frame| draft.frames[frame].until.must = 1,
    ];
    for (number, change) in constraints.iter().enumerate() {
        // Of no frame, of the one at which the loop begins, of one or two others, and of all.
        for (frames, most) in [(0..0, 4), (0..1, 4), (1..2, 6), (1..3, 7), (0..3, 7)] {
            let grammar = Grammar::with("A = a B\nB = b C\nC = A", |draft| {
                frames.clone().for_each(|frame| change(draft, frame));
            });
            let mut run = Run::new(&grammar);
            let mut largest = 0;
            for step in 0..5_000 {
                run.go(1, |_| true, |_| 1.0);
                largest = largest.max(run.forest.len());
                // From the second round on, all constraints are in force.
                for frame in frames.clone().filter(|_| step >= 5) {
                    let symbol = Symbol::PlanFrame(frame as u16);
                    let is_in_force =
                        |part: &Component| part.symbol == symbol && part.life != Life::Planned;
                    let is_there = run.forest.iter().any(|(_, part)| is_in_force(part));
                    assert!(is_there, "constraint {number} of {frame}, step {step}");
                }
            }
            // A round is two actions and three decompositions.
            assert_eq!(run.log.len(), 4 * 1_000, "constraint {number} of {frames:?}");
            assert_eq!(largest, most, "constraint {number} of {frames:?}");
        }
    }
}

/// H07: such a loop ends in every round, the first below the frame with constraints included.
#[test]
fn h07_a_loop_with_constraints_ends_in_every_round() {
    let grammar = Grammar::with("R = A z\nA = a B\nB = b A", |draft| {
        draft.frames[2].timeout_ms = 5_000;
    });
    for last in 1..8 {
        let mut rounds = 0;
        let log = String::from(Run::new(&grammar).go(
            100,
            |_| true,
            |production| {
                rounds += i32::from(production == 1);
                if production == 1 && rounds > last { 0.0 } else { 1.0 }
            },
        ));
        assert_eq!(log, format!("{}z done", "a b ".repeat(last as usize)));
    }
    // Before the first round there is not yet a loop: without a production the frame fails.
    let log = String::from(Run::new(&grammar).go(
        100,
        |_| true,
        |production| if production == 1 { 0.0 } else { 1.0 },
    ));
    assert_eq!(log, "failed");
}
