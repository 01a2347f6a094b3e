//! MissionLab overlays: the overlay description language.
//!
//! Text becomes tokens, tokens become statements, statements become the map; each step collects
//! mistakes and continues. Statements that are drawn for people only (GAP, AXIS, ROOM, ...) are
//! checked and then ignored.
//!
//! Two rules are surprising. ORIGIN is added to plain coordinates and subtracted from UTM ones.
//! UTM is WGS-84 here; the historic program used Clarke 1866 and was wrong west of Greenwich. Each
//! difference is some hundred metres.
//!
//! Source: MissionLab 7 (Georgia Tech) and its example overlays.

mod grammar;
mod lexer;
mod meaning;
mod parser;
#[cfg(test)]
mod tests;

use crate::model::Map;
use crate::problem::{Problem, Source};
use std::sync::Arc;

/// Words that begin a line only in overlays.
const TELLTALES: [&str; 11] = [
    "CONTROL",
    "MISSION-AREA",
    "SCENARIO",
    "SITE",
    "ORIGIN",
    "GLOBAL_REF_POINT",
    "LOAD-MAP",
    "HEIGHTMAP",
    "OBSTACLE",
    "WALL",
    "PP",
];

/// Whether a text looks like an overlay: outside comments, a line begins with one of its keywords.
pub fn recognises(text: &str) -> bool {
    text.split(['\n', '\r']).any(|line| {
        let line = line.split("--").next().unwrap_or(line);
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or("");
        // A keyword alone may be a title or separator of another format; a statement continues.
        words.next().is_some() && TELLTALES.iter().any(|word| word.eq_ignore_ascii_case(first))
    })
}

/// Reads an overlay: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut problems = Vec::new();
    let lexed = lexer::lex(source, &mut problems);
    let statements = parser::parse(source, &lexed, &mut problems);
    let map = meaning::interpret(source, &statements, lexed.resolution_m, &mut problems);
    // In the order of the file.
    problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |place| place.span.start));
    (Some(map), problems)
}
