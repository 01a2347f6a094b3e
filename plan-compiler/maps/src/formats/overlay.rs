//! MissionLab overlays: the overlay description language.
//!
//! Text becomes tokens, tokens statements, statements the map; each step gathers what is
//! wrong and goes on. What the language draws for people only (GAP, AXIS, ROOM, ...) is
//! checked and then left out.
//!
//! Two rules surprise. ORIGIN is added to plain coordinates and subtracted from UTM ones.
//! UTM is WGS-84 here, where the historic program used Clarke 1866 and went wrong west
//! of Greenwich; both are as large as some hundred metres.
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

/// Words with which only an overlay begins a line.
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

/// Whether a text reads like an overlay: outside comments, a line begins with one of its keywords.
pub fn recognises(text: &str) -> bool {
    text.split(['\n', '\r']).any(|line| {
        let line = line.split("--").next().unwrap_or(line);
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or("");
        // A keyword alone could be a title or a separator of another format; a statement
        // continues.
        words.next().is_some() && TELLTALES.iter().any(|word| word.eq_ignore_ascii_case(first))
    })
}

/// Reads an overlay: the map as far as it could be understood, and every mistake.
pub fn read(source: &Arc<Source>) -> (Option<Map>, Vec<Problem>) {
    let mut problems = Vec::new();
    let lexed = lexer::lex(source, &mut problems);
    let statements = parser::parse(source, &lexed, &mut problems);
    let map = meaning::interpret(source, &statements, lexed.resolution_m, &mut problems);
    // In the order of the file, whichever step found them.
    problems
        .sort_by_key(|problem| problem.place.as_ref().map_or(usize::MAX, |place| place.span.start));
    (Some(map), problems)
}
