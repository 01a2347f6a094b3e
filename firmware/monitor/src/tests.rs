extern crate std;

use super::*;
use parts::{Event, Life, ProductionIndex};
use plan_format::mission::{Condition, Description, Edge, Facts, Mission, Symbol};
use proptest::prelude::*;
use std::{format, string::String, vec, vec::Vec};

const SILENT: Description = Description {
    initial: Condition { must: 0, must_not: 0 },
    transient: Condition { must: 0, must_not: 0 },
    goal: Condition { must: 0, must_not: 0 },
    add: 0,
    delete: 0,
    max_speed_mps: f32::INFINITY,
    min_distance_m: 0.0,
};

/// The bytes of a mission in the notation of `fixtures`: actions and frames over the facts `f0` to
/// `f3`, the bits 0 to 3. The root is the frame `R`.
fn mission(text: &str) -> Vec<u8> {
    let facts: String = (0..4).map(|bit| format!("fact f{bit} symbol\n")).collect();
    let text = format!("input time; of time\n{facts}{text}\nbehaviour all R; when always PS");
    fixtures::mission(&text).write().expect("the mission is sound")
}

/// A line for [`mission`]: an action with these needs and effects.
fn described(name: &str, description: &Description) -> String {
    let names = |facts: Facts, sign: &str| -> String {
        (0..4).filter(|bit| facts >> bit & 1 == 1).map(|bit| format!(" {sign}f{bit}")).collect()
    };
    let condition = |c: Condition| names(c.must, "") + &names(c.must_not, "!");
    let Description { initial, goal, add, delete, .. } = *description;
    let (needs, goal) = (condition(initial), condition(goal));
    let (adds, deletes) = (names(add, ""), names(delete, ""));
    format!("action {name} hold 0; needs{needs}; goal{goal}; adds{adds}; deletes{deletes}\n")
}

/// The stages of a production, from edges that are sorted by start vertex.
fn stages(edges: impl Iterator<Item = (u8, u8, String)>) -> String {
    let mut stages: Vec<Vec<String>> = vec![];
    for (from, to, name) in edges {
        stages.resize(stages.len().max(usize::from(from) + 1), vec![]);
        stages[usize::from(from)].push(format!("{name}@{to}"));
    }
    stages.iter().map(|parts| parts.join("|")).collect::<Vec<_>>().join(" ")
}

/// A pool, and the assumptions of the plans in it.
#[derive(Clone, Default)]
struct Live {
    pool: Pool,
    assumptions: Assumptions,
}

impl Live {
    fn apply(&mut self, mission: &Mission<'_>, event: &Event) {
        self.pool.apply(event);
        self.assumptions.apply(mission, &self.pool, event);
    }

    fn grid(&self) -> SituationGrid<'_> {
        SituationGrid::new(&self.pool, &self.assumptions)
    }
}

fn component(
    symbol: Symbol,
    owner: Owner,
    parent: Option<(Id, &Edge, u8)>,
    life: Life,
) -> Component {
    let (parent, from, to, edge) = match parent {
        Some((parent, edge, number)) => (Some(parent), edge.from, edge.to, number),
        None => (None, 0, 0, 0),
    };
    Component {
        symbol,
        owner,
        parent,
        edge,
        from,
        to,
        life,
        depth: 0,
        production: None,
        finished: 0,
    }
}

/// Applies the events of a frame that chose a production, whose parts take the slots from `first`
/// on.
fn decompose(
    live: &mut Live,
    mission: &Mission<'_>,
    frame: Id,
    production: ProductionIndex,
    first: Id,
) {
    let owner = live.grid().get(frame).expect("the frame is in the grid").owner;
    live.apply(mission, &Event::Became { id: frame, life: Life::Started });
    live.apply(mission, &Event::Decomposed { id: frame, production });
    let record = mission.productions().get(usize::from(production)).expect("it exists");
    for (number, edge) in (0..).zip(mission.edges_of(&record)) {
        let component = component(edge.symbol, owner, Some((frame, &edge, number)), Life::Planned);
        live.apply(mission, &Event::Planned { id: first + number, component });
    }
}

/// H17: the relations of a plan of two levels as a matrix, rows to columns.
#[test]
fn h17_the_matrix_of_relations() {
    // R = a (B | c) d, B = x y or z.
    let bytes = mission(
        "action a hold 0
         frame R
         = a B|a a
         frame B
         = a a
         = a",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    live.apply(
        &mission,
        &Event::Planned {
            id: 0,
            component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled),
        },
    );
    decompose(&mut live, &mission, 0, 0, 1);
    decompose(&mut live, &mission, 2, 1, 5);
    // Another behaviour's plan.
    live.apply(
        &mission,
        &Event::Planned {
            id: 9,
            component: component(Symbol::PlanFrame(0), 1, None, Life::Scheduled),
        },
    );
    // An edge of the chosen production contains what it has become, and is ordered to its neighbours.
    let chosen = |edge| Node { id: 0, option: Some((0, edge)) };
    let relation = |x, y| live.grid().relation(&mission, x, y);
    assert_eq!(relation(chosen(1), Node::from(5)), Some(Relation::AO));
    assert_eq!(relation(chosen(0), Node::from(5)), Some(Relation::CB));
    assert_eq!(relation(chosen(3), Node::from(5)), Some(Relation::CA));
    assert_eq!(relation(chosen(2), Node::from(5)), Some(Relation::NE));
    assert_eq!(relation(Node::from(5), chosen(0)), Some(Relation::CA));
    // Possible components: the graph orders those of one production, others exclude each other.
    let option = |production, edge| Node { id: 2, option: Some((production, edge)) };
    assert_eq!(relation(option(1, 0), option(1, 1)), Some(Relation::CB));
    assert_eq!(relation(option(1, 1), option(1, 0)), Some(Relation::CA));
    assert_eq!(relation(option(1, 0), option(2, 0)), Some(Relation::OC));
    assert_eq!(relation(Node::from(2), option(1, 0)), Some(Relation::AO));
    assert_eq!(relation(option(1, 0), Node::from(2)), Some(Relation::DO));
    let names = ["R", "a", "B", "c", "d", "x", "y", "z?", "S"];
    let nodes: Vec<Node> = [0, 1, 2, 3, 4, 5, 6]
        .into_iter()
        .map(Node::from)
        .chain([Node { id: 2, option: Some((2, 0)) }, Node::from(9)])
        .collect();
    let mut matrix = format!("   {}\n", names.join("  "));
    for (x, name) in nodes.iter().zip(names) {
        matrix.push_str(&format!("{name:3}"));
        for y in &nodes {
            let relation = live.grid().relation(&mission, *x, *y);
            matrix.push_str(
                &relation.map_or(String::from("-- "), |relation| format!("{relation:?} ")),
            );
        }
        matrix.push('\n');
    }
    assert_eq!(
        matrix.replace(" \n", "\n"),
        "   R  a  B  c  d  x  y  z?  S
R  -- AO AO AO AO AO AO AO NE
a  DO -- CB CB CB CB CB CB NE
B  DO CA -- NE CB AO AO AO NE
c  DO CA NE -- CB NE NE NE NE
d  DO CA CA CA -- CA CA CA NE
x  DO CA DO NE CB -- CB OC NE
y  DO CA DO NE CB CA -- OC NE
z? DO CA DO NE CB OC OC -- NE
S  NE NE NE NE NE NE NE NE --
"
    );
}

/// H17: only paths order components, not the numbers of their vertices.
#[test]
fn h17_branches_do_not_order_each_other() {
    let bytes = mission("action a hold 0\nframe R\n= a@1|a@2 a@4 a@3 a@4");
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    let root = component(Symbol::PlanFrame(0), 0, None, Life::Scheduled);
    live.apply(&mission, &Event::Planned { id: 0, component: root });
    decompose(&mut live, &mission, 0, 0, 1);
    let relation = |x: Id, y: Id| live.grid().relation(&mission, Node::from(x), Node::from(y));
    assert_eq!(relation(2, 5), Some(Relation::CB));
    assert_eq!(relation(1, 3), Some(Relation::CB));
    assert_eq!([relation(1, 5), relation(3, 4)], [Some(Relation::NE); 2]);
}

/// H14, H15: each description is checked at its time; constraints are inherited downwards.
#[test]
fn h14_initial_transient_goal_and_inherited_constraints() {
    let bytes = mission(
        "action a hold 0; needs f0; keeps !f1; goal f2; speed 1
         frame R; speed 0.5; distance 2
         = a",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    live.apply(
        &mission,
        &Event::Planned {
            id: 0,
            component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled),
        },
    );
    decompose(&mut live, &mission, 0, 0, 1);
    assert_eq!(live.grid().constraints(&mission, 1), (0.5, 2.0));
    let evident = |id, what, facts| Some(Signal::Evident { id, what, facts });
    assert_eq!(live.grid().initial(&mission, 1, 0), evident(1, Violation::Initial, 1));
    assert_eq!(live.grid().initial(&mission, 1, 1), None);
    assert_eq!(live.grid().goal(&mission, 1, 1), evident(1, Violation::Goal, 4));
    assert_eq!(live.grid().goal(&mission, 1, 4), None);
    let transients = |live: &Live| live.grid().evident(0, 2).collect::<Vec<_>>();
    assert_eq!(transients(&live), [], "a component that does not run is not checked");
    live.apply(&mission, &Event::Became { id: 1, life: Life::Started });
    assert_eq!(
        transients(&live),
        evident(1, Violation::Transient, 2).into_iter().collect::<Vec<_>>()
    );
}

/// H13: an interval begins when the last edge into its first vertex is finished, and ends with the last
/// one into its last vertex.
#[test]
fn h13_intervals_begin_and_end_where_branches_join() {
    let bytes = mission(
        "action a hold 0
         frame R
         = a|a a|a a; protect f0 1 2",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    let root = component(Symbol::PlanFrame(0), 0, None, Life::Scheduled);
    live.apply(&mission, &Event::Planned { id: 0, component: root });
    decompose(&mut live, &mission, 0, 0, 1);
    let is_held = |live: &Live| live.grid().held(0).next().is_some();
    assert!(!is_held(&live));
    let mut story = vec![];
    for id in 1..=5 {
        live.apply(&mission, &Event::Became { id, life: Life::Finished });
        story.push(is_held(&live));
    }
    assert_eq!(story, [false, true, true, false, false]);
}

/// H13, H22, H26: an interval is in force from its first vertex to its last, in the view of its own
/// behaviour and, while that sleeps, of all others; the points of figure 4 show where it ends.
#[test]
fn h26_intervals_and_the_points_of_figure_4() {
    // forward, back, plough again; "on field" from the entry until back is done.
    let bytes = mission(
        "action a hold 0
         frame R
         = a:10 a:20 R; protect f0 0 2",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    live.apply(
        &mission,
        &Event::Planned {
            id: 0,
            component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled),
        },
    );
    decompose(&mut live, &mission, 0, 0, 1);
    let points = |live: &Live| {
        let mut all = vec![];
        live.grid().points(&mission, 0, &mut |p| all.push((p.vertex, p.held.must, p.lost_work)));
        all
    };
    let violations = |live: &Live, owner| live.grid().evident(owner, 0).collect::<Vec<_>>();
    assert_eq!(points(&live), [(1, 1, 10), (2, 0, 20)], "point 1 is protected, point 2 is not");
    let own = Signal::Evident { id: 0, what: Violation::Interval, facts: 1 };
    assert_eq!(violations(&live, 0), [own]);
    assert_eq!(violations(&live, 1), [], "in no other view while its behaviour runs");
    let (frame, held) = live.grid().held(0).next().expect("it is in force");
    let foreign = Signal::Evident { id: 0, what: Violation::Foreign, facts: 1 };
    assert_eq!(Signal::foreign(frame, held, 0), Some(foreign));
    assert_eq!(Signal::foreign(frame, held, 1), None);
    for part in [1, 2] {
        live.apply(&mission, &Event::Became { id: part, life: Life::Scheduled });
        live.apply(&mission, &Event::Became { id: part, life: Life::Started });
        live.apply(&mission, &Event::Became { id: part, life: Life::Finished });
        live.apply(&mission, &Event::Deleted { id: part });
    }
    assert_eq!(points(&live), []);
    assert_eq!(violations(&live, 0), [], "the interval has ended");
}

/// H26: at the points inside a frame, what the frames above protect there counts too. The points of
/// one behaviour's plan are not those of another.
#[test]
fn h26_points_inside_a_frame_know_what_is_protected_around_it() {
    let bytes = mission(
        "action a hold 0
         frame R
         = a B a a; protect f0 0 2; protect f1 0 1; protect f2 2 3; protect f3 1 2
         frame B
         = a a",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    for (owner, root) in [(0, 0), (1, 16)] {
        let frame = component(Symbol::PlanFrame(0), owner, None, Life::Scheduled);
        live.apply(&mission, &Event::Planned { id: root, component: frame });
        decompose(&mut live, &mission, root, 0, root + 1);
        live.apply(&mission, &Event::Became { id: root + 1, life: Life::Finished });
    }
    decompose(&mut live, &mission, 2, 1, 8);
    let points = |live: &Live, owner| {
        let mut all = vec![];
        live.grid().points(&mission, owner, &mut |p| all.push((p.frame, p.vertex, p.held.must)));
        all
    };
    assert_eq!(points(&live, 0), [(2, 1, 0b1001), (0, 2, 0b100), (0, 3, 0)]);
    assert_eq!(points(&live, 1), [(16, 2, 0b100), (16, 3, 0)]);
    // A frame that will choose again has no points; one that sleeps has.
    live.apply(&mission, &Event::Became { id: 16, life: Life::Suspended });
    assert_eq!(points(&live, 1).len(), 2);
    live.apply(&mission, &Event::Became { id: 16, life: Life::Scheduled });
    assert_eq!(points(&live, 1), []);
}

/// A frame that falls back or restarts protects nothing until it has chosen again, and one that is
/// deleted nothing more; other frames keep what they protect.
#[test]
fn a_frame_that_gives_up_its_production_protects_nothing() {
    let bytes = mission("action a hold 0; keeps f1\nframe R\n= a a; protect f0 0 2\n= a");
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    for (owner, root) in [(0, 0), (1, 16)] {
        let frame = component(Symbol::PlanFrame(0), owner, None, Life::Scheduled);
        live.apply(&mission, &Event::Planned { id: root, component: frame });
        decompose(&mut live, &mission, root, 0, root + 1);
        live.apply(&mission, &Event::Became { id: root + 1, life: Life::Started });
    }
    let protects = |live: &Live| [0, 1].map(|owner| live.grid().held(owner).count());
    let watches = |live: &Live| [0, 1].map(|owner| live.grid().evident(owner, 1).count());
    assert_eq!((protects(&live), watches(&live)), ([1, 1], [1, 1]));
    for gives_up in [
        Event::Restarted { id: 0 },
        Event::Became { id: 0, life: Life::Scheduled },
        Event::Deleted { id: 0 },
    ] {
        let mut live = live.clone();
        live.apply(&mission, &gives_up);
        assert_eq!(protects(&live), [0, 1], "{gives_up:?}");
        assert_eq!(live.grid().get(0).and_then(|frame| frame.production), None);
        assert_eq!(live.grid().get(16).and_then(|frame| frame.production), Some(0));
        live.apply(&mission, &Event::Deleted { id: 1 });
        assert_eq!((protects(&live), watches(&live)), ([0, 1], [0, 1]));
        assert!(
            live.grid().iter().any(|(id, _)| id == 17) && live.grid().iter().all(|(id, _)| id != 1)
        );
    }
}

/// H19: a production that may violate a protected fact is signalled before it is chosen.
#[test]
fn h19_a_doubtful_choice_is_named() {
    let bytes = mission(
        "action a hold 0
         action leave hold 0; deletes f0
         action open hold 0; adds f1
         action other hold 0; adds f0 f2; deletes f1 f3
         frame R
         = a B; protect f0 0 2
         frame B
         = a
         = leave leave
         = open|leave
         = other
         = open open",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    live.apply(
        &mission,
        &Event::Planned {
            id: 0,
            component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled),
        },
    );
    decompose(&mut live, &mission, 0, 0, 1);
    let mut all = vec![];
    let foreign = Condition { must: 0, must_not: 2 };
    live.grid().choices(&mission, 2, foreign, &mut |signal| all.push(signal));
    let doubt =
        |production, facts| Signal::Possible { id: 2, why: Doubt::Choice(production), facts };
    assert_eq!(all, [doubt(2, 1), doubt(3, 3), doubt(5, 2)]);
}

/// H20, H21: if the producer of a need is deleted, the need is in doubt before its consumer starts.
#[test]
fn h21_a_lost_producer_is_flagged_before_the_consumer_starts() {
    let bytes = mission(
        "action make hold 0; adds f0
         action use hold 0; needs f0
         frame R
         = make use",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    live.apply(
        &mission,
        &Event::Planned {
            id: 0,
            component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled),
        },
    );
    decompose(&mut live, &mission, 0, 0, 1);
    let doubts = |live: &Live, facts| {
        let mut all = vec![];
        live.grid().possible(&mission, 2, facts, &mut |signal| all.push(signal));
        all
    };
    assert_eq!(doubts(&live, 0), []);
    let doubt = Signal::Possible { id: 2, why: Doubt::NoProducer, facts: 1 };
    for life in [Life::Finished, Life::Failed, Life::Abandoned] {
        let mut live = live.clone();
        live.apply(&mission, &Event::Became { id: 1, life });
        assert_eq!(doubts(&live, 0), [doubt], "{life:?}: it produces nothing any more");
        live.apply(&mission, &Event::Became { id: 2, life: Life::Started });
        assert_eq!(doubts(&live, 0), [], "what has started is not in doubt");
    }
    live.apply(&mission, &Event::Deleted { id: 1 });
    assert_eq!(doubts(&live, 0), [doubt]);
    assert_eq!(doubts(&live, 1), [], "it holds already");
}

/// H21: what takes a fact away provides it no more than what comes too late.
#[test]
fn h21_a_component_that_destroys_a_fact_is_not_its_producer() {
    let bytes = mission(
        "action spoil hold 0; deletes f0
         action use hold 0; needs f0
         action make hold 0; adds f0
         frame R
         = spoil use make",
    );
    let mission = Mission::parse(&bytes).expect("it is sound");
    let mut live = Live::default();
    let root = component(Symbol::PlanFrame(0), 0, None, Life::Scheduled);
    live.apply(&mission, &Event::Planned { id: 0, component: root });
    decompose(&mut live, &mission, 0, 0, 1);
    let mut all = vec![];
    live.grid().possible(&mission, 2, 0, &mut |signal| all.push(signal));
    let doubt = |why| Signal::Possible { id: 2, why, facts: 1 };
    assert_eq!(all, [doubt(Doubt::Clobberer(1)), doubt(Doubt::NoProducer)]);
}

/// A random production of up to six actions over three facts.
fn random_plan() -> impl Strategy<Value = (Vec<Description>, Vec<(u8, u8)>)> {
    let facts = || 0_u64..8;
    let condition =
        || (facts(), facts()).prop_map(|(must, not)| Condition { must, must_not: not & !must });
    let description =
        (condition(), condition(), facts(), facts()).prop_map(|(initial, goal, add, delete)| {
            // The goal holds after the effects.
            let goal = Condition { must: goal.must & !delete, must_not: goal.must_not & !add };
            Description { initial, goal, add, delete, ..SILENT }
        });
    // Edges between ascending vertices; the chain keeps every edge on a path.
    let edges = (2_u8..5).prop_flat_map(|vertices| {
        let chain: Vec<(u8, u8)> = (0..vertices - 1).map(|v| (v, v + 1)).collect();
        let extra = (0..vertices - 1, 1..vertices)
            .prop_map(|(a, b)| if a < b { (a, b) } else { (b - 1, a + 1) });
        prop::collection::vec(extra, 0..3).prop_map(move |more| {
            let mut all = [chain.clone(), more].concat();
            all.sort_unstable();
            all
        })
    });
    edges.prop_flat_map(move |edges| {
        (prop::collection::vec(description.clone(), edges.len()), Just(edges))
    })
}

/// The facts that a component makes true, and false, unless it also makes them true.
fn effects(description: &Description) -> (Facts, Facts) {
    let Description { add, delete, goal, .. } = *description;
    (add | goal.must, (delete | goal.must_not) & !(add | goal.must))
}

/// The needs of `consumer` that fail in at least one order of the components allowed by the graph.
fn may_fail(
    live: &Live,
    mission: &Mission<'_>,
    descriptions: &[Description],
    consumer: usize,
    done: u32,
    facts: Facts,
) -> Facts {
    let all = descriptions.len();
    let comes_before = |x: usize, y: usize| {
        live.grid().relation(mission, Node::from(x as Id + 1), Node::from(y as Id + 1))
            == Some(Relation::CB)
    };
    let mut failing = 0;
    for next in (0..all).filter(|next| done & 1 << next == 0) {
        if (0..all)
            .any(|other| done & 1 << other == 0 && other != next && comes_before(other, next))
        {
            continue;
        }
        if next == consumer {
            failing |= descriptions[next].initial.violated(facts);
            continue;
        }
        let (adds, deletes) = effects(&descriptions[next]);
        let after = facts & !deletes | adds;
        failing |= may_fail(live, mission, descriptions, consumer, done | 1 << next, after);
    }
    failing
}

proptest! {
    /// H21: the doubts are exactly the needs that fail in at least one order of the components.
    #[test]
    fn h21_doubts_equal_brute_force((descriptions, edges) in random_plan(), facts in 0_u64..8) {
        let actions = (0..).zip(&descriptions);
        let actions: String = actions.map(|(n, d)| described(&format!("a{n}"), d)).collect();
        let parts = (0..).zip(&edges).map(|(n, &(from, to))| (from, to, format!("a{n}")));
        let bytes = mission(&format!("{actions}frame R\n= {}", stages(parts)));
        let mission = Mission::parse(&bytes).expect("it is sound");
        let mut live = Live::default();
        live.apply(&mission, &Event::Planned { id: 0, component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled) });
        decompose(&mut live, &mission, 0, 0, 1);
        let all = |of: fn(&Description) -> Facts| descriptions.iter().fold(0, |all, d| all | of(d));
        let (added, deleted) = (all(|d| effects(d).0), all(|d| effects(d).1));
        // The compiler refuses an action that adds and deletes a fact.
        let unclear = all(|d| (d.add | d.goal.must) & (d.delete | d.goal.must_not));
        for (consumer, description) in descriptions.iter().enumerate() {
            let (mut doubted, mut lacking, mut destroyed) = (0, 0, 0);
            let mut repeated = false;
            live.grid().possible(&mission, consumer as Id + 1, facts, &mut |signal| {
                if let Signal::Possible { facts, why, .. } = signal {
                    // Each fact is in doubt once for its producer and once for what destroys it.
                    let is_known = why != Doubt::NoProducer && destroyed & facts != 0;
                    repeated |= is_known || why == Doubt::NoProducer && lacking != 0;
                    destroyed |= if why == Doubt::NoProducer { 0 } else { facts };
                    doubted |= facts;
                    lacking |= if why == Doubt::NoProducer { facts } else { 0 };
                }
            });
            let failing = may_fail(&live, &mission, &descriptions, consumer, 0, facts);
            // The grid ignores facts that no component of the plan changes.
            let needs = description.initial;
            let ours = needs.must & (added | deleted & facts)
                | needs.must_not & (deleted | added & !facts) & !unclear;
            prop_assert_eq!(doubted & ours, failing & ours, "consumer {}", consumer);
            prop_assert_eq!(doubted & !(needs.must | needs.must_not), 0);
            prop_assert!(!repeated, "a fact is in doubt twice");
            let producible = needs.must & all(|d| d.add | d.goal.must)
                | needs.must_not & all(|d| d.delete | d.goal.must_not);
            prop_assert_eq!(lacking & !producible, 0, "the world provides the others");
        }
    }

    /// H17: exactly one relation for each pair, inverses agree, CB is transitive, and decomposing a
    /// frame changes no relation between old components.
    #[test]
    fn h17_properties_of_the_relations((descriptions, edges) in random_plan()) {
        let first = core::iter::once("B").chain(core::iter::repeat("a"));
        let parts = edges.iter().zip(first).map(|(&(from, to), name)| (from, to, name.into()));
        let action = described("a", &descriptions[0]);
        let outer = stages(parts);
        let bytes = mission(&format!("{action}frame R\n= {outer}\nframe B\n= a|a a\n= a"));
        let mission = Mission::parse(&bytes).expect("it is sound");
        let mut live = Live::default();
        live.apply(&mission, &Event::Planned { id: 0, component: component(Symbol::PlanFrame(0), 0, None, Life::Scheduled) });
        decompose(&mut live, &mission, 0, 0, 1);
        let relations = |live: &Live| {
            let ids: Vec<Id> = live.grid().iter().map(|(id, _)| id).collect();
            let mut all = vec![];
            for &x in &ids {
                for &y in &ids {
                    all.push(((x, y), live.grid().relation(&mission, Node::from(x), Node::from(y))));
                }
            }
            all
        };
        let before = relations(&live);
        decompose(&mut live, &mission, 1, 1, 20);
        let after = relations(&live);
        for pair in &before {
            prop_assert!(after.contains(pair), "{:?} changed", pair);
        }
        let of = |x: Id, y: Id| live.grid().relation(&mission, Node::from(x), Node::from(y));
        for &((x, y), relation) in &after {
            prop_assert_eq!(relation.is_none(), x == y);
            prop_assert_eq!(relation.map(Relation::inverse), of(y, x));
            for (z, _) in live.grid().iter() {
                if relation == Some(Relation::CB) && of(y, z) == Some(Relation::CB) {
                    prop_assert_eq!(of(x, z), Some(Relation::CB));
                }
            }
        }
    }
}

/// The transient description of a component is checked while it runs, and no longer.
#[test]
fn h14_a_transient_is_not_watched_after_its_component_has_stopped() {
    let bytes = mission("action a hold 0; keeps f0\nframe R\n= a");
    let mission = Mission::parse(&bytes).expect("the mission is sound");
    for life in [Life::Suspended, Life::Finished, Life::Failed, Life::Abandoned] {
        let mut live = Live::default();
        let part = component(Symbol::Action(0), 0, None, Life::Scheduled);
        live.apply(&mission, &Event::Planned { id: 3, component: part });
        assert_eq!(live.grid().evident(0, 0).next(), None);
        live.apply(&mission, &Event::Became { id: 3, life: Life::Started });
        assert!(live.grid().evident(0, 0).next().is_some());
        live.apply(&mission, &Event::Became { id: 3, life });
        assert_eq!(live.grid().evident(0, 0).next(), None, "{life:?}");
    }
}
