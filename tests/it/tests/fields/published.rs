//! Fields, compared with published results: lengths of MovingAI scenarios, and MissionLab's Iplan.dat.

use super::{cells, solve};
use it::real_data;
use maps::Bitmap;
use maps::formats::{ReadOptions, read};
use maps::problem::draw;
use plan_compiler::field;
use plan_compiler::search::{Corners, Query, Solver};
use plan_compiler::terrain::Terrain;
use plan_format::Cell;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use std::path::Path;

/// The blocked cells of a MovingAI map.
fn movingai_map(path: &Path) -> Bitmap {
    let (map, problems) = read(path, &ReadOptions::default());
    let cells = map.and_then(|map| map.cells);
    cells.unwrap_or_else(|| panic!("{}", draw(&problems, false))).blocked()
}

/// One line of a MovingAI scenario; rows are counted from the north.
#[derive(Debug, PartialEq)]
struct Entry {
    map: String,
    start: [u32; 2],
    goal: [u32; 2],
    /// Length of the path, cells; a diagonal step counts as the square root of two.
    length: f64,
}

/// All entries of a scenario file.
fn scenario(text: &str) -> Vec<Entry> {
    let mut lines = text.lines();
    let header = lines.next().expect("a header");
    assert!(["version 1", "version 1.0"].contains(&header.trim()), "{header}");
    let entry = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, map, _, _, x, y, goal_x, goal_y, length] = words[..] else { panic!("{line}") };
        let number = |word: &str| word.parse::<u32>().expect("a coordinate");
        // Some files name the map with its folder.
        let map = map.rsplit('/').next().expect("a name").to_owned();
        let (start, goal) = ([x, y].map(number), [goal_x, goal_y].map(number));
        Entry { map, start, goal, length: length.parse().expect("a length") }
    };
    lines.filter(|line| !line.trim().is_empty()).map(entry).collect()
}

#[test]
fn both_spellings_of_a_scenarios_header_are_read() {
    let entry = "16\tmaps/dao/a.map\t32\t32\t15\t2\t1\t27\t64.31370850";
    let expected =
        [Entry { map: "a.map".into(), start: [15, 2], goal: [1, 27], length: 64.313_708_5 }];
    for (header, end) in [("version 1", "\n"), ("version 1.0", "\r\n")] {
        assert_eq!(scenario(&format!("{header}{end}{entry}{end}{end}")), expected);
    }
}

#[test]
fn every_published_movingai_length_is_reproduced() {
    let Some(folder) = real_data("movingai") else { return };
    let mut solver = Solver::new();
    let (mut compared, mut files) = (0, 0);
    for file in std::fs::read_dir(&folder).expect("a folder") {
        let path = file.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "scen") {
            continue;
        }
        files += 1;
        let entries = scenario(&std::fs::read_to_string(&path).expect("text"));
        let map = movingai_map(&folder.join(&entries[0].map));
        let cell = |[x, y]: [u32; 2]| Cell::new(x, map.rows() - 1 - y);
        let mut field = solve(&Bitmap::new(0, 0), Cell::new(0, 0), Corners::Forbid);
        let terrain = Terrain::new(map.clone());
        for entry in entries {
            let goal = cell(entry.goal);
            let query = Query { terrain: &terrain, goals: &[goal], corners: Corners::Forbid };
            solver.solve_into(&query, &mut field);
            let start = cell(entry.start);
            let cost = field.cost[(start.row * map.columns() + start.column) as usize];
            let got = f64::from(cost) / f64::from(STRAIGHT_STEP);
            // Some files print six significant digits; the convergent adds 1.5e-8.
            let tolerance = entry.length * 6e-6 + 1e-8;
            assert!((got - entry.length).abs() <= tolerance, "{path:?}: {entry:?}: {got}");
            compared += 1;
        }
    }
    // The folder has at least six files with 3,743 lines.
    assert!(files >= 6 && compared >= 3_743, "{files} files, {compared} lengths");
}

/// The fields of an `Iplan.dat`: size, goal and values, x outer and y inner.
fn iplan_fields(text: &str) -> Vec<((u32, u32), Cell, Vec<f64>)> {
    let mut fields = Vec::new();
    let mut lines = text.lines().map(str::trim);
    while lines.any(|line| line == "BEGIN_MAP") {
        let header: Vec<&str> = lines.by_ref().take_while(|&line| line != "#Data").collect();
        let number = |index: usize| header[index].parse::<u32>().expect("a number");
        let values: Vec<f64> = lines
            .by_ref()
            .take_while(|&line| line != "END_MAP")
            .map(|line| line.parse().expect("a value"))
            .collect();
        fields.push(((number(1), number(2)), Cell::new(number(4), number(5)), values));
    }
    fields
}

/// A cost in the units of the historic generator, where a diagonal is 1.414.
fn in_iplan_units(cost: u32) -> f64 {
    let diagonals = (0..STRAIGHT_STEP)
        .find(|diagonals| (cost - diagonals * DIAGONAL_STEP).is_multiple_of(STRAIGHT_STEP))
        .expect("a sum of steps");
    let straights = (cost - diagonals * DIAGONAL_STEP) / STRAIGHT_STEP;
    f64::from(straights) + 1.414 * f64::from(diagonals)
}

#[test]
fn the_historic_plans_are_reproduced_except_for_their_generators_errors() {
    const OBSTACLE: f64 = 9998.0;
    const UNREACHED: f64 = 9999.0;
    let Some(folder) = real_data("missionlab") else { return };
    let text = std::fs::read_to_string(folder.join("Iplan.dat")).expect("text");
    let fields = iplan_fields(&text);
    assert_eq!(fields.len(), 2);
    for ((columns, rows), goal, values) in fields {
        let value = |cell: Cell| values[(cell.column * rows + cell.row) as usize];
        let blocked =
            Bitmap::from_fn(columns, rows, |cell| value(cell).total_cmp(&OBSTACLE).is_eq());
        let field = solve(&blocked, goal, Corners::Allow);
        let mut worse = 0;
        for cell in cells((columns, rows)).filter(|&cell| !blocked.get(cell)) {
            let cost = field.cost[(cell.row * columns + cell.column) as usize];
            assert_eq!(
                cost == field::UNREACHED,
                value(cell).total_cmp(&UNREACHED).is_eq(),
                "{cell:?}"
            );
            if cost != field::UNREACHED {
                let above = value(cell) - in_iplan_units(cost);
                assert!((-0.002..0.4).contains(&above), "{cell:?} {above}");
                worse += usize::from(above > 0.002);
            }
        }
        assert!(worse <= 7, "{worse} cells differ");
    }
}
