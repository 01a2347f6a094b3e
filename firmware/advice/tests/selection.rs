//! Which layer the advice follows, and what it is, on layers drawn as text.
//!
//! A drawing has one character per cell, the northern row first: `> ^ < v` and `9 7 1 3` (as on
//! a numeric keypad) are moves, `G` the goal, `?` free without a route, `#` blocked without an
//! escape, `e n w s` blocked with an escape in that direction.

use advice::{Advice, Choice, Kind, advise};
use plan_compiler::field::{ESCAPE, Field, GOAL, NO_ESCAPE, NO_ROUTE, UNREACHED};
use plan_format::mission::MissionDraft;
use plan_format::parameters::Selection::{self, Dynamic, Static};
use plan_format::{
    Blob, Cell, Direction, Draft, Grid, LayerDraft, ParallelPlan, Parameters, PlanDraft,
};

const FREE: &str = "
    >>>3v
    >>>>G
    >>>9^";
/// Cut in two by its second column.
const CUT: &str = "
    ?e>3v
    ?e>>G
    ?e>9^";
/// Free beside the goal only.
const SHUT: &str = "
    ?eeev
    ?eeeG
    ?eee^";

#[test]
fn w22_the_most_constrained_layer_with_a_route_is_followed() {
    let table: [(&[&str], _, _, _); 8] = [
        (&[FREE], (0, 1), 0, Kind::Move),
        (&[FREE, CUT], (2, 1), 1, Kind::Move),
        (&[FREE, CUT], (0, 1), 0, Kind::Move),
        (&[FREE, CUT], (1, 1), 0, Kind::Move),
        (&[FREE, CUT, SHUT], (2, 1), 1, Kind::Move),
        (&[FREE, CUT, SHUT], (0, 1), 0, Kind::Move),
        (&[FREE, CUT, SHUT], (4, 0), 2, Kind::Move),
        (&[FREE, CUT, SHUT], (4, 1), 2, Kind::Goal),
    ];
    for (layers, cell, layer, kind) in table {
        for selection in [Static, Dynamic] {
            let advice = with_plan(layers, |plan| {
                advise(plan, Some(at(cell)), selection, &mut Choice::default())
            });
            let case = format!("{cell:?} of {} layers, {selection:?}", layers.len());
            assert_eq!((advice.layer, advice.kind), (Some(layer), kind), "{case}");
        }
    }
}

/// W19: one tick compares eight layers. W25: every tick compares them again.
#[test]
fn w25_dynamic_selection_switches_at_that_tick_and_back() {
    let layers = [FREE, FREE, FREE, FREE, FREE, FREE, FREE, CUT];
    let walk = [(2, 1), (1, 1), (0, 1), (1, 1), (2, 1)];
    assert_eq!(layers_along(&layers, Dynamic, &walk), [7, 6, 6, 6, 7]);
}

#[test]
fn w24_static_selection_keeps_its_first_choice() {
    assert_eq!(layers_along(&[FREE, CUT], Static, &[(0, 1), (2, 1), (4, 1)]), [0, 0, 0]);
    assert_eq!(layers_along(&[FREE, CUT], Static, &[(2, 1), (3, 0), (4, 1)]), [1, 1, 1]);
}

#[test]
fn w24_a_static_choice_without_a_route_says_so_instead_of_changing() {
    with_plan(&[FREE, CUT], |plan| {
        let mut choice = chosen(plan, (2, 1));
        let pushed = advise(plan, Some(at((0, 1))), Static, &mut choice);
        let expected = Advice { kind: Kind::NoRoute, direction: None, layer: Some(1), cost: None };
        assert_eq!(pushed, expected);
        let back = advise(plan, Some(at((3, 1))), Static, &mut choice);
        let move_east = Some(Direction::E);
        let expected =
            Advice { kind: Kind::Move, direction: move_east, layer: Some(1), cost: Some(5741) };
        assert_eq!(back, expected);
    });
}

/// W29: what a check before the start reports.
#[test]
fn w29_nothing_is_chosen_before_there_is_a_route() {
    with_plan(&["e>>>G"], |plan| {
        let mut choice = Choice::default();
        for cell in [None, Some(at((0, 0))), Some(at((9, 9)))] {
            advise(plan, cell, Static, &mut choice);
            assert_eq!(choice.layer(), None, "{cell:?}");
        }
        advise(plan, Some(at((1, 0))), Static, &mut choice);
        assert_eq!(choice.layer(), Some(0));
    });
}

#[test]
fn w23_no_route_blocked_and_off_the_map_are_answers() {
    let table = [
        ((0, 0), Kind::NoRoute, None),
        ((1, 0), Kind::NoRoute, None),
        ((2, 0), Kind::NoRoute, None),
        ((3, 0), Kind::Escape, Some(Direction::E)),
        ((4, 0), Kind::Move, Some(Direction::E)),
        ((5, 0), Kind::Goal, None),
        ((6, 0), Kind::OffMap, None),
        ((0, 1), Kind::OffMap, None),
    ];
    for (cell, kind, direction) in table {
        for layers in [&["?#?e>G"][..], &["?#?e>G", "?#?e>G"]] {
            with_plan(layers, |plan| {
                let advice = advise(plan, Some(at(cell)), Dynamic, &mut Choice::default());
                assert_eq!((advice.kind, advice.direction), (kind, direction), "{cell:?}");
                let advice = advise(plan, Some(at(cell)), Static, &mut chosen(plan, (5, 0)));
                assert_eq!((advice.kind, advice.direction), (kind, direction), "{cell:?} static");
            });
        }
    }
}

/// An escape is the shortest path through blocked cells of one layer, regardless of other layers;
/// the advice must still not lead into their obstacles.
#[test]
fn w21_no_way_out_leads_into_a_less_constrained_obstacle() {
    let physical = "
        >>>>G
        >>>9^
        ^n99^";
    let comms = "
        >>>>G
        ^nnn^
        ^wwe^";
    let table = [
        // In an obstacle of the comms layer only; its escape is free of physical obstacles.
        ((2, 1), 1, Kind::Escape, Direction::N),
        ((3, 0), 1, Kind::Escape, Direction::E),
        // The escape west is a physical obstacle: the physical layer gives the advice.
        ((2, 0), 0, Kind::Move, Direction::NE),
        // In a physical obstacle: leave that first.
        ((1, 0), 0, Kind::Escape, Direction::N),
    ];
    for (cell, layer, kind, direction) in table {
        with_plan(&[physical, comms], |plan| {
            let advice = advise(plan, Some(at(cell)), Static, &mut chosen(plan, (0, 2)));
            let expected = (Some(layer), kind, Some(direction));
            assert_eq!((advice.layer, advice.kind, advice.direction), expected, "{cell:?}");
        });
    }
}

fn layers_along(layers: &[&str], selection: Selection, walk: &[(u32, u32)]) -> Vec<u8> {
    with_plan(layers, |plan| {
        let mut choice = Choice::default();
        let layer = |&cell| advise(plan, Some(at(cell)), selection, &mut choice).layer;
        walk.iter().map(layer).map(|layer| layer.expect("a layer answers")).collect()
    })
}

/// The static choice after a start in `cell`: the most constrained layer.
fn chosen(plan: &ParallelPlan<'_>, cell: (u32, u32)) -> Choice {
    let mut choice = Choice::default();
    advise(plan, Some(at(cell)), Static, &mut choice);
    assert_eq!(choice.layer(), Some(plan.layer_count() as u8 - 1));
    choice
}

fn at((column, row): (u32, u32)) -> Cell {
    Cell::new(column, row)
}

fn with_plan<T>(layers: &[&str], test: impl FnOnce(&ParallelPlan<'_>) -> T) -> T {
    let fields: Vec<(Field, Cell)> = layers.iter().map(|layer| drawn(layer)).collect();
    let (first, goal) = &fields[0];
    let grid =
        Grid { columns: first.columns, rows: first.rows, resolution_m: 1.0, corner_m: [0.0, 0.0] };
    let layer = |(index, (field, _)): (usize, &(Field, Cell))| LayerDraft {
        name: format!("layer {index}"),
        rank: index as u8,
        packed: plan_compiler::pack::pack(field),
    };
    let blob = PlanDraft {
        name: "plan".into(),
        goals_m: vec![grid.centre(*goal)],
        layers: fields.iter().enumerate().map(layer).collect(),
    };
    let draft = Draft {
        grid,
        origin: None,
        parameters: Parameters::default(),
        plans: vec![blob],
        mission: MissionDraft::default(),
    };
    let blob = plan_format::write(&draft).expect("the draft is valid");
    let blob = Blob::parse(&blob).expect("the blob is valid");
    test(&blob.parallel_plan(0).expect("there is one plan"))
}

/// The field of a drawing, and its goal. Costs follow the drawn routes.
fn drawn(drawing: &str) -> (Field, Cell) {
    let lines: Vec<Vec<char>> =
        drawing.split_whitespace().rev().map(|line| line.chars().collect()).collect();
    let (columns, rows) = (lines[0].len() as u32, lines.len() as u32);
    let code: Vec<u8> = lines.iter().flatten().map(|&character| code_of(character)).collect();
    assert_eq!(code.len(), (columns * rows) as usize, "ragged drawing");
    let index = |cell: Cell| (cell.row * columns + cell.column) as usize;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| Cell::new(column, row)));
    let cost_of = |mut cell: Cell| {
        let mut cost = 0;
        while code[index(cell)] < GOAL {
            let direction = Direction::from_code(code[index(cell)]);
            cost += direction.step_cost();
            cell = cell.neighbour(direction, columns, rows).expect("the drawn route stays inside");
        }
        if code[index(cell)] == GOAL { cost } else { UNREACHED }
    };
    let cost = cells.clone().map(cost_of).collect();
    let goal = cells.clone().find(|&cell| code[index(cell)] == GOAL).expect("a goal is drawn");
    (Field { columns, rows, unit: None, cost, code }, goal)
}

fn code_of(character: char) -> u8 {
    match character {
        '>' => 0,
        '9' => 1,
        '^' => 2,
        '7' => 3,
        '<' => 4,
        '1' => 5,
        'v' => 6,
        '3' => 7,
        'G' => GOAL,
        '?' => NO_ROUTE,
        '#' => NO_ESCAPE,
        'e' => ESCAPE,
        'n' => ESCAPE + 2,
        'w' => ESCAPE + 4,
        's' => ESCAPE + 6,
        _ => panic!("{character:?} draws nothing"),
    }
}
