//! MissionLab's internalized plans, `Iplan.dat`: a header, then a map of costs for each goal.
//!
//! Source: files that MissionLab 7 wrote. Values are one per line, column by column, each column
//! from the south. Costs are not kept: they follow from the obstacles and the goals and are planned
//! again. Deliberately absent: values written as FLOAT, and the progress boxes of RECONBUILDING.

use super::lines::Lines;
use super::{FARTHEST_M, MAX_PROBLEMS};
use crate::bitmap::Bitmap;
use crate::model::{CellMap, Map, NamedPoint, Unknown};
use crate::problem::{Problem, Source};
use math::grid;
use std::iter::Peekable;
use std::ops::Range;
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
Iplan    (MissionLab Iplan.dat, as TEXT) Cells are centred on multiples of the resolution, so
         the south-west corner is at minus half a cell. Values of 9998 are obstacles; all
         other cells are free, and their costs are planned again (--corners allow gives the
         same costs). Goals are in metres and named `contingency` or after the type and
         number of their element, as moveto-1; -1, -2 are added if an element has several
         maps. All maps must agree in size, resolution and obstacles.";

/// Value of an obstacle cell.
pub const OBSTACLE: f64 = 9998.0;
/// Value of a cell without a route.
pub const UNREACHED: f64 = 9999.0;
/// Goal of the map that every file has besides its elements.
pub const CONTINGENCY: &str = "contingency";

const ORDERINGS: [&str; 2] = ["ORDERED", "LEAST-COMMITMENT"];
const TETHERED: [&str; 2] = ["TRUE", "FALSE"];
const VALUES: [&str; 2] = ["TEXT", "FLOAT"];
/// Elements that a plan is made of.
pub(super) const ELEMENTS: [&str; 2] = ["MOVETO", "RECONBUILDING"];
/// The element with progress boxes between its maps.
const WITH_BOXES: &str = "RECONBUILDING";
/// Lines that end the part before them.
const KEYWORDS: [&str; 5] = ["BEGIN_MAP", "#Data", "END_MAP", "START_ELEMENT", "END_FILE"];
/// Wrong values of one map that are reported one by one.
const MAX_VALUES_REPORTED: usize = 20;

/// Whether a text looks like an Iplan.dat, by the third and fifth line of its header.
pub fn recognises(text: &str) -> bool {
    let mut lines = Lines::of(text).map(|line| text[line].trim());
    let (third, fifth) = (lines.nth(2), lines.nth(1));
    third.is_some_and(|line| ORDERINGS.contains(&line))
        && fifth.is_some_and(|line| VALUES.contains(&line))
}

/// Reads the maps of a file as one map with all goals, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let lines = Lines::of(&source.text).peekable();
    let mut reader = Reader { source, lines, problems: Vec::new(), first: None, is_cut: false };
    let map = reader.plan();
    (map, reader.problems)
}

/// The grid that all maps of a file share.
#[derive(Clone, Copy, PartialEq)]
struct Dimensions {
    columns: u32,
    rows: u32,
    resolution_m: f64,
}

impl Dimensions {
    fn cells(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Index of the value of the cell at a point, metres.
    fn index_at(&self, at: [f64; 2]) -> Option<usize> {
        let [x, y] = at.map(|along| (along / self.resolution_m + 0.5).floor());
        let is_inside =
            (0.0..f64::from(self.columns)).contains(&x) && (0.0..f64::from(self.rows)).contains(&y);
        is_inside.then(|| x as usize * self.rows as usize + y as usize)
    }
}

/// The first map of a file; the others must agree with it.
struct First {
    dimensions: Dimensions,
    /// Whether each value is an obstacle, in the order of the file.
    blocked: Vec<bool>,
}

/// A part of a plan with the goals of its maps.
struct Element {
    name: String,
    has_boxes: bool,
    goals: Vec<NamedPoint>,
}

impl Element {
    fn new(name: String, has_boxes: bool) -> Self {
        Self { name, has_boxes, goals: Vec::new() }
    }

    /// Its goals, numbered if there are several.
    fn into_points(self) -> impl Iterator<Item = NamedPoint> {
        let is_one = self.goals.len() == 1;
        self.goals.into_iter().zip(1..).map(move |(goal, number)| {
            let number = if is_one { String::new() } else { format!("-{number}") };
            NamedPoint { name: format!("{}{number}", self.name), ..goal }
        })
    }
}

/// Name of an element's goal, from its type and its number (from 1).
pub(super) fn element_name(kind: &str, number: usize) -> String {
    format!("{}-{number}", kind.to_ascii_lowercase())
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    lines: Peekable<Lines<'a>>,
    problems: Vec<Problem>,
    first: Option<First>,
    /// Whether the file ends within a map: what follows from that is not reported again.
    is_cut: bool,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: impl Into<String>, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    fn text(&self, line: &Range<usize>) -> &'a str {
        self.source.text[line.clone()].trim()
    }

    fn is_keyword(&self, line: &Range<usize>) -> bool {
        KEYWORDS.contains(&self.text(line))
    }

    fn end(&self) -> Range<usize> {
        let end = self.source.text.trim_end().len();
        end..end
    }

    /// The next line, unless it begins another part of the file.
    fn field(&mut self, what: &str) -> Option<Range<usize>> {
        let next = self.lines.peek().cloned();
        if let Some(line) = next.clone().filter(|line| !self.is_keyword(line)) {
            self.lines.next();
            return Some(line);
        }
        let span = next.unwrap_or_else(|| self.end());
        let message = format!("{what} is missing");
        self.error(message, span, "expected before this", "add a line with it");
        None
    }

    /// A line that must be one of these words.
    fn word(&mut self, what: &str, words: &[&str]) -> Option<&'a str> {
        let line = self.field(what)?;
        let word = self.text(&line);
        if !words.contains(&word) {
            let message = format!("{what} is `{word}`");
            let help = format!("write {}", words.join(" or "));
            self.error(message, line, "unknown word", &help);
        }
        Some(word)
    }

    /// A line that must be a number within a range.
    fn number(&mut self, what: &str, (least, most): (f64, f64)) -> Option<f64> {
        let line = self.field(what)?;
        let text = self.text(&line);
        let number = text.parse::<f64>().ok().filter(|number| (least..=most).contains(number));
        if number.is_none() {
            let message = format!("{what} is `{text}`");
            let help = format!("write a number from {least} to {most}");
            self.error(message, line, "not a number in this range", &help);
        }
        number
    }

    fn side(&mut self, what: &str) -> Option<u32> {
        let line = self.field(what)?;
        let (text, limit) = (self.text(&line), grid::MAX_SIDE_CELLS);
        let side = text.parse::<u32>().ok().filter(|side| (1..=limit).contains(side));
        if side.is_none() {
            let message = format!("{what} is `{text}`");
            let help = format!("write a whole number from 1 to {limit}");
            self.error(message, line, "expected a number of cells", &help);
        }
        side
    }

    fn plan(&mut self) -> Option<Map> {
        let title = self.field("the name of the plan");
        let map_file = self.field("the name of the map file");
        self.word("the ordering", &ORDERINGS);
        self.word("whether the robots are tethered", &TETHERED);
        let values = self.lines.peek().cloned();
        if self.word("the kind of values", &VALUES) == Some("FLOAT") {
            let help = "have MissionLab write the plan as TEXT; FLOAT cannot be read";
            let message = "the values of this file are written as FLOAT";
            self.error(message, values.unwrap_or_else(|| self.end()), "binary values", help);
            return None;
        }
        let count_line = self.field("the number of elements");
        let points = self.maps(count_line);
        let first = self.first.take()?;
        let dimensions = first.dimensions;
        let occupied = Bitmap::from_fn(dimensions.columns, dimensions.rows, |cell| {
            let index = cell.column as usize * dimensions.rows as usize + cell.row as usize;
            first.blocked.get(index).copied().unwrap_or_default()
        });
        let map = Map::of_cells(CellMap {
            resolution_m: dimensions.resolution_m,
            corner: [-dimensions.resolution_m / 2.0; 2],
            unknown: Bitmap::new(dimensions.columns, dimensions.rows),
            occupied,
            unknown_as: Unknown::default(),
            turned_from: None,
        });
        let title = title.map(|line| self.text(&line).to_owned());
        let remarks = map_file.map(|line| format!("map-file {}", self.text(&line)));
        let remarks = remarks.into_iter().collect();
        Some(Map { points, title, remarks, is_for_points: true, ..map })
    }

    /// The goals of all maps, those of the elements first, because the robot follows the first
    /// goal.
    fn maps(&mut self, count_line: Option<Range<usize>>) -> Vec<NamedPoint> {
        let mut elements: Vec<Element> = Vec::new();
        let mut contingency = Element::new(CONTINGENCY.into(), false);
        let mut is_ended = false;
        // A file with more mistakes is not an Iplan.dat.
        while self.problems.len() <= MAX_PROBLEMS {
            let Some(line) = self.lines.next() else { break };
            match self.text(&line) {
                "BEGIN_MAP" => {
                    let goal = self.map(&line);
                    elements.last_mut().unwrap_or(&mut contingency).goals.extend(goal);
                }
                "START_ELEMENT" => {
                    let kind = self.word("the type of the element", &ELEMENTS).unwrap_or_default();
                    let name = element_name(kind, elements.len() + 1);
                    elements.push(Element::new(name, kind == WITH_BOXES));
                }
                "END_FILE" => {
                    is_ended = true;
                    break;
                }
                _ if elements.last().is_some_and(|element| element.has_boxes) => {}
                _ => self.unexpected(line),
            }
        }
        let is_cut = self.is_cut;
        if !is_ended && !is_cut && self.problems.len() <= MAX_PROBLEMS {
            let (end, help) = (self.end(), "add a line END_FILE, if nothing else was cut off");
            let problem = Problem::warning("the file does not end with END_FILE");
            self.problems.push(problem.at(self.source, end, "it ends here").help(help));
        }
        if !is_cut {
            self.check_count(count_line, elements.len());
        }
        let parts = elements.into_iter().chain([contingency]);
        parts.flat_map(Element::into_points).collect()
    }

    /// Reports an unknown line and skips to the next keyword.
    fn unexpected(&mut self, line: Range<usize>) {
        let help = "maps lie between BEGIN_MAP and END_MAP, elements after START_ELEMENT";
        self.error(
            format!("`{}` is not part of a plan", self.text(&line)),
            line,
            "expected BEGIN_MAP, START_ELEMENT or END_FILE",
            help,
        );
        while let Some(line) = self.lines.peek().cloned() {
            if self.is_keyword(&line) {
                break;
            }
            self.lines.next();
        }
    }

    fn check_count(&mut self, line: Option<Range<usize>>, found: usize) {
        let Some(line) = line else { return };
        let text = self.text(&line);
        if text.parse() != Ok(found) {
            self.error(
                format!("the number of elements is `{text}`, but the file has {found}"),
                line,
                "this number",
                "correct it, or add what was cut off",
            );
        }
    }

    /// Reads one map and returns its goal, still without a name.
    fn map(&mut self, begin: &Range<usize>) -> Option<NamedPoint> {
        let id = self.field("the name of the map");
        let (columns, rows) = (self.side("the size along x"), self.side("the size along y"));
        let resolution = self.number("the resolution", grid::RESOLUTION_RANGE_M);
        let span = self.lines.peek().cloned();
        let goal_range = (-FARTHEST_M, FARTHEST_M);
        let goal =
            [self.number("the goal's x", goal_range), self.number("the goal's y", goal_range)];
        let span = id.or(span).unwrap_or_else(|| begin.clone());
        if self.lines.peek().is_some_and(|line| self.source.text[line.clone()].trim() == "#Data") {
            self.lines.next();
        } else {
            let at = self.lines.peek().cloned().unwrap_or_else(|| self.end());
            let help = "a map begins with its name, two sizes, resolution and the goal's x and y";
            self.error("#Data is missing", at, "expected here", help);
        }
        let dimensions = match (columns, rows, resolution) {
            (Some(columns), Some(rows), Some(resolution_m)) => {
                Some(Dimensions { columns, rows, resolution_m })
            }
            _ => None,
        };
        let goal = match goal {
            [Some(x), Some(y)] => Some([x, y]),
            _ => None,
        };
        self.values(dimensions, goal, &span);
        goal.map(|at| NamedPoint { name: String::new(), at, span })
    }

    /// Reports that the file ends within a map.
    fn cut(
        &mut self,
        name: &str,
        blocked: &[bool],
        dimensions: Option<Dimensions>,
        last: Range<usize>,
    ) {
        self.is_cut = true;
        let count = match dimensions.map(|own| own.cells()) {
            Some(cells) => format!("after {} of {cells} values", blocked.len()),
            None => format!("after {} values", blocked.len()),
        };
        let message = format!("the file ends within map `{name}`, {count}");
        let help = "copy the file again, or have MissionLab write it again: it was cut off";
        self.error(message, last, "its last line", help);
    }

    /// Reads the values of the map that is named at `span`.
    fn values(
        &mut self,
        dimensions: Option<Dimensions>,
        goal: Option<[f64; 2]>,
        span: &Range<usize>,
    ) {
        let name = self.text(span);
        let alike =
            self.first.as_ref().zip(dimensions).is_some_and(|(first, own)| first.dimensions == own);
        let goal_index =
            dimensions.zip(goal).and_then(|(dimensions, goal)| dimensions.index_at(goal));
        let mut blocked = Vec::new();
        let (mut wrong, mut differing) = (0_usize, 0_usize);
        let mut first_differing = None;
        let mut last = span.clone();
        while let Some(line) = self.lines.peek().cloned().filter(|line| !self.is_keyword(line)) {
            self.lines.next();
            let text = self.text(&line);
            let value = text.parse::<f64>().ok().filter(|value| (0.0..f64::MAX).contains(value));
            if value.is_none() {
                wrong += 1;
                if wrong <= MAX_VALUES_REPORTED {
                    let help = "write a cost in metres, 9998 (obstacle) or 9999 (unreached)";
                    let message = format!("`{text}` is not a valid cell value");
                    self.error(message, line.clone(), "here", help);
                }
            }
            if goal_index == Some(blocked.len()) && value.is_some_and(|value| value > 0.0) {
                let message = format!("the goal of map `{name}` costs `{text}`, not 0");
                let help = "check that the goal is in metres; the costs are planned again";
                let problem = Problem::warning(message).at(self.source, line.clone(), "its cell");
                self.problems.push(problem.help(help));
            }
            let is_blocked = value == Some(OBSTACLE);
            let other = self.first.as_ref().filter(|_| alike);
            let other = other.and_then(|first| first.blocked.get(blocked.len()));
            if value.is_some() && other.is_some_and(|&other| other != is_blocked) {
                differing += 1;
                first_differing.get_or_insert(line.clone());
            }
            blocked.push(is_blocked);
            last = line;
        }
        if wrong > MAX_VALUES_REPORTED {
            let more = wrong - MAX_VALUES_REPORTED;
            self.problems.push(Problem::error(format!(
                "{more} more of its lines are not valid cell values"
            )));
        }
        match self.lines.peek().cloned().filter(|line| self.text(line) == "END_MAP") {
            Some(_) => {
                self.lines.next();
            }
            None if self.lines.peek().is_none() => {
                self.cut(name, &blocked, dimensions, last.clone())
            }
            None => {
                let message = format!("map `{name}` does not end with END_MAP");
                let help = "add a line END_MAP after it, if no value was cut off";
                self.error(message, last.clone(), "its last line", help);
            }
        }
        let Some(dimensions) = dimensions else { return };
        if self.is_cut {
            return;
        }
        if blocked.len() != dimensions.cells() {
            let (count, cells) = (blocked.len(), dimensions.cells());
            let message = format!("map `{name}` has {count} values, but its sizes make {cells}");
            self.error(message, last, "its last line", "correct the sizes, or the values");
            return;
        }
        let Some(first) = &self.first else {
            self.first = Some(First { dimensions, blocked });
            return;
        };
        let describe = |dimensions: Dimensions| {
            format!(
                "{} x {} cells of {} m",
                dimensions.columns, dimensions.rows, dimensions.resolution_m
            )
        };
        let help = "plan for all goals on one grid, or split the file: a blob has one grid";
        if first.dimensions != dimensions {
            let (own, other) = (describe(dimensions), describe(first.dimensions));
            let message = format!("map `{name}` has {own}, but the first map {other}");
            self.error(message, span.clone(), "this map", help);
        } else if let Some(line) = first_differing {
            let cells = dimensions.cells();
            let message = format!(
                "map `{name}` and the first map differ in their obstacles: {differing} of {cells} cells"
            );
            self.error(message, line, "the first such cell", help);
        }
    }
}

#[cfg(test)]
mod tests;
