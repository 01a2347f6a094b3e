//! MovingAI grid maps: four lines of header, then one character per cell, rows from the north.
//!
//! Source: Sturtevant, "Benchmarks for grid-based pathfinding" (2012), and the maps at
//! movingai.com. A cell is 1 m; the south-west corner of the map is the origin. Water is blocked,
//! because the format does not let agents enter it from land. Deliberately absent: scenario files.

use super::lines::Lines;
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Map, Unknown};
use crate::problem::{Problem, Source};
use math::Cell;
use math::grid;
use std::ops::Range;
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
MovingAI (.map) Cells of 1 m, the south-west corner at 0,0; rows come from the north. `.` and
         `G` are free, `S` (swamp) too; `@`, `O` and `T` are blocked, `W` (water) too, as
         it cannot be entered from land. No goals: give --goal. Published lengths hold
         with --corners forbid, the default.";

const FREE: &[u8] = b".GS";
const BLOCKED: &[u8] = b"@OTW";
/// Rows of wrong length or with unknown characters that are reported one by one.
const MAX_ROWS_REPORTED: usize = 20;

/// Whether a text looks like a MovingAI map: first line `type`, next lines `height` and `width`.
pub fn recognises(text: &str) -> bool {
    let mut keys = Lines::of(text).map(|line| split_key(&text[line]).0.to_ascii_lowercase());
    let mut next = || keys.next().unwrap_or_default();
    let (first, second, third) = (next(), next(), next());
    let is_size = |key: &str| matches!(key, "height" | "width");
    first == "type" && is_size(&second) && is_size(&third)
}

/// Reads a map: its cells as far as they could be understood, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut reader = Reader { source, problems: Vec::new() };
    let mut lines = Lines::of(&source.text);
    let size = reader.header(&mut lines);
    let map = size.map(|size| {
        let cells = Map::of_cells(reader.cells(size, lines));
        Map { is_for_points: true, ..cells }
    });
    (map, reader.problems)
}

/// `height 49` or `height: 49`.
fn split_key(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (key, value) =
        line.split_once(|c: char| c.is_whitespace() || c == ':').unwrap_or((line, ""));
    (key, value.trim_start_matches([' ', '\t', ':']).trim())
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: Vec<Problem>,
}

impl Reader<'_> {
    fn error(&mut self, message: String, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    /// Reads the header: columns and rows.
    fn header(&mut self, lines: &mut Lines<'_>) -> Option<(u32, u32)> {
        let text = &self.source.text;
        let (mut columns, mut rows) = (None, None);
        let mut last = 0..0;
        for line in lines.by_ref() {
            last = line.clone();
            let (key, value) = split_key(&text[line.clone()]);
            match key.to_ascii_lowercase().as_str() {
                "type" => {
                    if !matches!(value.to_ascii_lowercase().as_str(), "octile" | "tile") {
                        self.problems.push(
                            Problem::warning(format!("the type of this map is `{value}`"))
                                .at(self.source, line, "it is read as an octile grid")
                                .help(
                                    "the map is usable if its characters are those of type octile",
                                ),
                        );
                    }
                }
                "height" => rows = Some(self.side("height", value, line)),
                "width" => columns = Some(self.side("width", value, line)),
                "map" => {
                    for (given, name) in [(columns, "width"), (rows, "height")] {
                        if given.is_none() {
                            let help = format!("add a line `{name} N` before `map`");
                            self.error(
                                format!("the header gives no {name}"),
                                last.clone(),
                                "the cells begin after this",
                                &help,
                            );
                        }
                    }
                    return Some((columns??, rows??));
                }
                _ => {
                    self.error(
                        format!("`{key}` is not part of the header"),
                        line,
                        "expected type, height, width or map",
                        "the header is: type octile, height N, width N, map; a line each",
                    );
                    return None;
                }
            }
        }
        self.error(
            "the file ends before its cells".into(),
            last,
            "nothing follows this",
            "add a line `map` and then the rows of cells",
        );
        None
    }

    fn side(&mut self, name: &str, value: &str, line: Range<usize>) -> Option<u32> {
        let limit = grid::MAX_SIDE_CELLS;
        let side = value.parse::<u32>().ok().filter(|side| (1..=limit).contains(side));
        if side.is_none() {
            self.error(
                format!("the {name} is `{value}`"),
                line,
                "expected a number of cells",
                &format!("write {name} and a whole number from 1 to {limit}"),
            );
        }
        side
    }

    fn cells(&mut self, (columns, rows): (u32, u32), lines: Lines<'_>) -> CellMap {
        let source = Arc::clone(self.source);
        let mut occupied = Bitmap::new(columns, rows);
        let (mut count, mut reported) = (0, 0);
        let (mut swamp, mut water) = (0_usize, 0_usize);
        let mut last = source.text.len()..source.text.len();
        for line in lines {
            let symbols = &source.text.as_bytes()[line.clone()];
            let fault = self.row_fault(symbols, columns, &line, count);
            if let Some(problem) = fault.filter(|_| reported < MAX_ROWS_REPORTED) {
                self.problems.push(problem);
                reported += 1;
            }
            if let Some(row) = rows.checked_sub(count + 1) {
                for (column, &symbol) in (0..columns).zip(symbols) {
                    occupied.set(Cell::new(column, row), !FREE.contains(&symbol));
                    swamp += usize::from(symbol == b'S');
                    water += usize::from(symbol == b'W');
                }
            }
            count = count.saturating_add(1);
            last = line;
        }
        if count != rows {
            self.error(
                format!("{count} rows of cells, but the height is {rows}"),
                last,
                "the last row",
                "correct the height, or the rows",
            );
        }
        for (cells, what) in [(swamp, "swamp, which is free"), (water, "water, which is blocked")] {
            if cells > 0 {
                let are = if cells == 1 { "cell is" } else { "cells are" };
                self.problems.push(Problem::note(format!("{cells} {are} {what}")));
            }
        }
        let unknown = Bitmap::new(columns, rows);
        let unknown_as = Unknown::default();
        CellMap {
            resolution_m: 1.0,
            corner: [0.0; 2],
            occupied,
            unknown,
            unknown_as,
            turned_from: None,
        }
    }

    /// What is wrong with a row, if anything.
    fn row_fault(
        &self,
        symbols: &[u8],
        columns: u32,
        line: &Range<usize>,
        count: u32,
    ) -> Option<Problem> {
        let row = u64::from(count) + 1;
        let is_known = |symbol: &u8| FREE.contains(symbol) || BLOCKED.contains(symbol);
        if let Some(place) = symbols.iter().position(|symbol| !is_known(symbol)) {
            // Everything before it is ASCII, so a whole character begins here.
            let start = line.start + place;
            let symbol = self.source.text[start..].chars().next()?;
            return Some(
                Problem::error(format!("`{symbol}` is not a valid cell"))
                    .at(
                        self.source,
                        start..start + symbol.len_utf8(),
                        format!("row {row} from the north"),
                    )
                    .help("cells are . G S (free) and @ O T W (blocked)"),
            );
        }
        let (length, columns) = (symbols.len(), columns as usize);
        (length != columns).then(|| {
            Problem::error(format!("row {row} has {length} cells, but the width is {columns}"))
                .at(
                    self.source,
                    line.start + length.min(columns)..line.end,
                    if length < columns { "the row ends here" } else { "too many cells" },
                )
                .help("correct the width, or the row")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::dump::outcome;
    use insta::assert_snapshot;
    use proptest::prelude::*;

    fn check(text: &str) -> String {
        let source = Arc::new(Source { name: "a.map".into(), text: text.into() });
        outcome(&read(&source))
    }

    #[test]
    fn rows_come_from_the_north() {
        assert_snapshot!(check("type octile\nheight 3\nwidth 4\nmap\n..@.\nTG.O\n....\n"), @"
        extent 0,0 + 4,3
        resolution 1
        cells 4 x 3 of 1 from 0,0
          ..#.
          #..#
          ....
        ");
    }

    #[test]
    fn line_ends_blank_lines_and_spellings_change_nothing() {
        let plain = check("type octile\nheight 2\nwidth 3\nmap\n.@.\nT..\n");
        for text in [
            "type octile\r\nheight 2\r\nwidth 3\r\nmap\r\n.@.\r\nT..\r\n\r\n",
            "type octile\nwidth 3\nheight 2\nmap\n.@.\nT..",
            "type octile\rheight 2\rwidth 3\rmap\r.@.\rT..\r",
            "type octile\nheight 2\r\nwidth 3\rmap\n\r.@.\r\r\nT..",
            "\n TYPE\tOctile \n HEIGHT  2\n\nWIDTH 3 \nmap \n.@.  \nT..\t\n",
            "Type: octile\nHeight: 2\nWidth:3\nMAP\n.@.\nT..\n\n\n  \n",
        ] {
            assert!(recognises(text), "{text}");
            assert_eq!(check(text), plain, "{text}");
        }
    }

    #[test]
    fn terrain_is_decided_and_reported() {
        assert_snapshot!(check("type octile\nheight 1\nwidth 4\nmap\nSWW.\n"), @"
          ☞ 1 cell is swamp, which is free

          ☞ 2 cells are water, which is blocked

        extent 0,0 + 4,1
        resolution 1
        cells 4 x 1 of 1 from 0,0
          .##.
        ");
    }

    #[test]
    fn every_mistake_is_reported() {
        assert_snapshot!(check("type octile\nheight 3\nwidth 4\nmap\n..x.\n..\n.....\n....\n"), @"
          × `x` is not a valid cell
           ╭─[a.map:5:3]
         4 │ map
         5 │ ..x.
           ·   ┬
           ·   ╰── row 1 from the north
         6 │ ..
           ╰────
          help: cells are . G S (free) and @ O T W (blocked)

          × row 2 has 2 cells, but the width is 4
           ╭─[a.map:6:3]
         5 │ ..x.
         6 │ ..
           ·   ▲
           ·   ╰── the row ends here
         7 │ .....
           ╰────
          help: correct the width, or the row

          × row 3 has 5 cells, but the width is 4
           ╭─[a.map:7:5]
         6 │ ..
         7 │ .....
           ·     ┬
           ·     ╰── too many cells
         8 │ ....
           ╰────
          help: correct the width, or the row

          × 4 rows of cells, but the height is 3
           ╭─[a.map:8:1]
         7 │ .....
         8 │ ....
           · ──┬─
           ·   ╰── the last row
           ╰────
          help: correct the height, or the rows

        extent 0,0 + 4,3
        resolution 1
        cells 4 x 3 of 1 from 0,0
          ..#.
          ....
          ....
        ");
        assert_snapshot!(check("type octile\nheight -3\nwidth a\nmap\n....\n"), @"
          × the height is `-3`
           ╭─[a.map:2:1]
         1 │ type octile
         2 │ height -3
           · ────┬────
           ·     ╰── expected a number of cells
         3 │ width a
           ╰────
          help: write height and a whole number from 1 to 16384

          × the width is `a`
           ╭─[a.map:3:1]
         2 │ height -3
         3 │ width a
           · ───┬───
           ·    ╰── expected a number of cells
         4 │ map
           ╰────
          help: write width and a whole number from 1 to 16384

        no map
        ");
        assert_snapshot!(check("type hex\nheight 3\ncells\n"), @"
          ⚠ the type of this map is `hex`
           ╭─[a.map:1:1]
         1 │ type hex
           · ────┬───
           ·     ╰── it is read as an octile grid
         2 │ height 3
           ╰────
          help: the map is usable if its characters are those of type octile

          × `cells` is not part of the header
           ╭─[a.map:3:1]
         2 │ height 3
         3 │ cells
           · ──┬──
           ·   ╰── expected type, height, width or map
           ╰────
          help: the header is: type octile, height N, width N, map; a line each

        no map
        ");
        assert_snapshot!(check("type octile\nmap\n"), @"
          × the header gives no width
           ╭─[a.map:2:1]
         1 │ type octile
         2 │ map
           · ─┬─
           ·  ╰── the cells begin after this
           ╰────
          help: add a line `width N` before `map`

          × the header gives no height
           ╭─[a.map:2:1]
         1 │ type octile
         2 │ map
           · ─┬─
           ·  ╰── the cells begin after this
           ╰────
          help: add a line `height N` before `map`

        no map
        ");
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "(type|height|width|map|[.@W]{0,4}|[ :\n\r0-9]|\\PC){0,40}") {
            recognises(&text);
            check(&text);
        }
    }
}
