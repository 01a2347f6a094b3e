//! MissionLab's plans, `.pcf`: the goals of a mission for a map in a file of its own.
//!
//! Source: files that MissionLab 7 wrote. Comments (`#`) describe the next line, but only the order
//! of the lines counts. Real files lack an end marker, so none is required.
//! Deliberately absent: the boundary and the progress boxes of RECONBUILDING.

use super::iplan::{CONTINGENCY, ELEMENTS, element_name};
use super::lines::Lines;
use super::{Format, MAX_PROBLEMS, ReadOptions};
use crate::model::{Map, NamedPoint};
use crate::problem::{Problem, Source};
use crate::source;
use std::iter::Peekable;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// This format in `--help`.
pub const CONVENTIONS: &str = "\
Pcf      (MissionLab .pcf) Goals for the map file that it names. That file must lie in the same
         folder; the folder in its name is ignored. Goals are in that map's metres, named by
         type and number, as moveto-1 (RECONBUILDING also -left and -right), and `contingency`;
         they replace the map's own.";

/// Suffixes of the goals that an element's first positions give.
fn goals_of(kind: &str) -> &'static [&'static str] {
    if kind == "RECONBUILDING" { &["", "-left", "-right"] } else { &[""] }
}

/// Whether a text looks like a plan, by its first line that is not a comment.
pub fn recognises(text: &str) -> bool {
    let first = Lines::of(text).map(|line| text[line].trim()).find(|line| !line.starts_with('#'));
    first == Some("BEGIN_PLAN")
}

/// Reads the map that a plan names, with the plan's goals, and every mistake in both.
pub fn read(
    path: &Path,
    source: &Arc<Source>,
    options: &ReadOptions,
) -> (Option<Map>, Vec<Problem>) {
    let text = source.text.as_str();
    let is_content = |line: &Range<usize>| !text[line.clone()].trim_start().starts_with('#');
    let content: Vec<Range<usize>> = Lines::of(text).filter(is_content).collect();
    let lines = content.into_iter().peekable();
    let mut reader = Reader { source, lines, problems: Vec::new() };
    let (map_file, points) = reader.plan();
    let mut problems = reader.problems;
    let map = map_file.and_then(|line| read_map(path, source, line, options, &mut problems));
    (map.map(|map| Map { points, ..map }), problems)
}

/// The map file that a plan names; `None` if the text is not a plan.
pub fn map_path(path: &Path, text: &str) -> Option<PathBuf> {
    let lines = Lines::of(text).map(|line| text[line].trim());
    let map_file = lines.filter(|line| !line.starts_with('#')).nth(2);
    map_file.filter(|_| recognises(text)).map(|name| beside(path, name))
}

/// The named file in the plan's folder. Folders in the name are those of the machine that wrote
/// the plan, perhaps Windows paths.
fn beside(path: &Path, name: &str) -> PathBuf {
    path.with_file_name(name.trim().rsplit(['/', '\\']).next().unwrap_or_default())
}

/// The map that a line of a plan names.
fn read_map(
    path: &Path,
    source: &Arc<Source>,
    line: Range<usize>,
    options: &ReadOptions,
    problems: &mut Vec<Problem>,
) -> Option<Map> {
    let map_path = beside(path, &source.text[line.clone()]);
    let bytes = match source::read_bytes(&map_path) {
        Ok(bytes) => bytes,
        Err(problem) => {
            let other = source::similar_name(&map_path);
            let other = other.as_deref().and_then(|path| Path::new(path).file_name());
            let help = match other.and_then(|other| other.to_str()) {
                Some(other) => format!("did you mean {other}, which lies beside the plan?"),
                None => "put the map that the plan is for beside it, under this name".into(),
            };
            let problem = Problem { help: Some(help), ..problem };
            problems.push(problem.at(source, line, "the map of this plan"));
            return None;
        }
    };
    if Format::detect(&map_path, &String::from_utf8_lossy(&bytes)) == Some(Format::Pcf) {
        problems.push(
            Problem::error(format!("{} is also a plan, not a map", map_path.display()))
                .at(source, line, "the map of this plan")
                .help("name the map that the plan is for"),
        );
        return None;
    }
    let options = ReadOptions { format: None, ..options.clone() };
    let loaded = super::read_bytes(&map_path, bytes, &options);
    problems.extend(loaded.problems.into_iter().map(|problem| match problem.place {
        None => problem.at(source, line.clone(), "named here"),
        Some(_) => problem,
    }));
    loaded.map
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    lines: Peekable<std::vec::IntoIter<Range<usize>>>,
    problems: Vec<Problem>,
}

impl<'a> Reader<'a> {
    fn error(&mut self, message: String, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    fn text(&self, line: &Range<usize>) -> &'a str {
        self.source.text[line.clone()].trim()
    }

    /// The next line, unless it begins an element.
    fn field(&mut self, what: &str) -> Option<Range<usize>> {
        let next = self.lines.peek().cloned();
        if let Some(line) = next.clone().filter(|line| !ELEMENTS.contains(&self.text(line))) {
            self.lines.next();
            return Some(line);
        }
        let end = self.source.text.trim_end().len();
        let span = next.unwrap_or(end..end);
        self.error(format!("{what} is missing"), span, "expected before this", "add a line for it");
        None
    }

    /// A line that must be one of these words.
    fn word(&mut self, what: &str, words: &[&str]) {
        let Some(line) = self.field(what) else { return };
        let word = self.text(&line);
        if !words.contains(&word) {
            let help = format!("write {}", words.join(" or "));
            self.error(format!("{what} is `{word}`"), line, "unknown word", &help);
        }
    }

    fn number(&mut self, what: &str) -> Option<usize> {
        let line = self.field(what)?;
        let number = self.text(&line).parse().ok();
        if number.is_none() {
            let message = format!("{what} is `{}`", self.text(&line));
            self.error(message, line, "expected a whole number", "write 1, 2 and so on");
        }
        number
    }

    fn position(&mut self, what: &str) -> Option<NamedPoint> {
        let line = self.field(what)?;
        let at = position(self.text(&line));
        if at.is_none() {
            let message = format!("{what} is `{}`", self.text(&line));
            self.error(message, line.clone(), "expected a position", "write <x,y> in metres");
        }
        at.map(|at| NamedPoint { name: String::new(), at, span: line })
    }

    /// The line that names the map, and the goals.
    fn plan(&mut self) -> (Option<Range<usize>>, Vec<NamedPoint>) {
        self.word("the first line", &["BEGIN_PLAN"]);
        self.field("the name of the plan");
        let map_file = self.field("the name of the map file");
        self.word("the ordering", &["ORDERED", "LEAST-COMMITMENT"]);
        self.word("whether the robots are tethered", &["TRUE", "FALSE"]);
        let contingency = self.position("the contingency location");
        let count_line = self.lines.peek().cloned();
        let count = self.number("the number of elements");
        let mut points = Vec::new();
        let mut found = 0;
        while let Some(line) = self.lines.next().filter(|_| self.problems.len() <= MAX_PROBLEMS) {
            let text = self.text(&line);
            if let Some(kind) = ELEMENTS.into_iter().find(|kind| *kind == text) {
                found += 1;
                self.element(kind, &mut points);
            } else if !text.starts_with("END") {
                let help = format!("an element begins with {}", ELEMENTS.join(" or "));
                self.error(format!("`{text}` is not an element of a plan"), line, "here", &help);
                self.skip();
            }
        }
        if let (Some(count), Some(line)) = (count.filter(|count| *count != found), count_line) {
            let message = format!("the number of elements is {count}, but the file has {found}");
            self.error(message, line, "this number", "correct it, or add what was cut off");
        }
        // The robot follows the first goal.
        let contingency = contingency.map(|at| NamedPoint { name: CONTINGENCY.into(), ..at });
        points.extend(contingency);
        (map_file, points)
    }

    fn element(&mut self, kind: &str, points: &mut Vec<NamedPoint>) {
        let Some(number) = self.number("the number of the element") else { return self.skip() };
        for suffix in goals_of(kind) {
            let what = format!("goal {}{suffix}", element_name(kind, number));
            let Some(at) = self.position(&what) else { return self.skip() };
            points
                .push(NamedPoint { name: format!("{}{suffix}", element_name(kind, number)), ..at });
        }
        // After a RECONBUILDING's goals come details of driving, not positions.
        if goals_of(kind).len() > 1 {
            self.skip();
        }
    }

    /// Skips to the next element.
    fn skip(&mut self) {
        while self.lines.peek().is_some_and(|line| {
            let text = self.source.text[line.clone()].trim();
            !ELEMENTS.contains(&text)
        }) {
            self.lines.next();
        }
    }
}

/// `<x,y>`, metres.
fn position(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.strip_prefix('<')?.strip_suffix('>')?.split_once(',')?;
    let number = |text: &str| {
        let number = text.trim().parse::<f64>().ok();
        number.filter(|number| number.abs() <= super::FARTHEST_M)
    };
    Some([number(x)?, number(y)?])
}

#[cfg(test)]
mod tests;
