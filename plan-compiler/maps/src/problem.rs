//! Mistakes in the input: what is wrong, where, and how to fix it.

mod excerpt;

use crate::terminal::{safe, safe_line};
use excerpt::{Excerpt, LineStarts};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Most problems that are shown: a file with more is not of the expected format.
pub const MAX_PROBLEMS: usize = 1000;

/// A file that was read as text.
#[derive(Debug)]
pub struct Source {
    /// Its path as the user wrote it.
    pub name: String,
    /// Its whole text.
    pub text: String,
}

/// How bad a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Probably not meant; the result is usable.
    Warning,
    /// No result.
    Error,
}

/// One mistake.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, one line without a full stop.
    pub message: String,
    /// How to fix it.
    pub help: Option<String>,
    /// The bytes of the file that are wrong.
    pub place: Option<Place>,
}

/// A range of bytes in a file.
#[derive(Clone, Debug)]
pub struct Place {
    /// The file.
    pub source: Arc<Source>,
    /// Range of bytes.
    pub span: Range<usize>,
    /// Shown under the excerpt.
    pub label: String,
}

impl Problem {
    /// An error without a place.
    pub fn error(message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, message: message.into(), help: None, place: None }
    }

    /// A warning without a place.
    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    /// A note without a place.
    pub fn note(message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(message) }
    }

    /// Adds how to fix it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds the bytes that are wrong and a label for them.
    #[must_use]
    pub fn at(
        mut self,
        source: &Arc<Source>,
        span: Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        // Parsers count bytes and may point inside a character.
        let start = source.text.floor_char_boundary(span.start);
        let span = start..source.text.ceil_char_boundary(span.end).max(start);
        self.place = Some(Place { source: Arc::clone(source), span, label: label.into() });
        self
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Problem {}

/// Whether any of the problems is an error.
pub fn has_errors(problems: &[Problem]) -> bool {
    problems.iter().any(|problem| problem.severity == Severity::Error)
}

/// Keeps at most [`MAX_PROBLEMS`], errors first; the last one counts those left out.
pub fn limit(problems: &mut Vec<Problem>) {
    if problems.len() <= MAX_PROBLEMS {
        return;
    }
    // The last slot holds the count, so a list that was cut once is not cut again.
    let kept = MAX_PROBLEMS - 1;
    let more = problems.len() - kept;
    let mut worst_first: Vec<usize> = (0..problems.len()).collect();
    // A stable sort keeps the first of the file among equals.
    worst_first.sort_by_key(|&index| std::cmp::Reverse(problems[index].severity));
    let mut left_out = worst_first.split_off(kept);
    let worst = left_out.iter().map(|&index| problems[index].severity).max();
    left_out.sort_unstable();
    let mut index = 0;
    problems.retain(|_| {
        index += 1;
        left_out.binary_search(&(index - 1)).is_err()
    });
    let last = Problem::error(format!("{more} more mistakes are not shown"))
        .help("check that this is the file you mean, and fix the first ones");
    problems.push(Problem { severity: worst.unwrap_or(Severity::Error), ..last });
}

/// A problem as miette's `Diagnostic`, safe for a terminal.
#[derive(Debug)]
struct Drawn {
    severity: Severity,
    message: String,
    help: Option<String>,
    label: Option<String>,
    excerpt: Option<Excerpt>,
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Drawn {}

impl miette::Diagnostic for Drawn {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.excerpt.as_ref()?.span();
        let label = LabeledSpan::new(self.label.clone(), span.start, span.len());
        Some(Box::new(std::iter::once(label)))
    }
}

/// Cuts text that may quote an endless word.
fn short(text: &str) -> Cow<'_, str> {
    const MAX_BYTES: usize = 2000;
    if text.len() <= MAX_BYTES {
        return Cow::Borrowed(text);
    }
    Cow::Owned(format!("{} ...", &text[..text.floor_char_boundary(MAX_BYTES)]))
}

/// Draws problems as text for a person, in the given order.
///
/// Beyond [`MAX_PROBLEMS`] it cuts as [`limit`] does. Control characters in quoted text are
/// replaced.
pub fn draw(problems: &[Problem], colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(100).with_links(false);
    let mut out = String::new();
    // Neighbours nearly always share a file, so its lines are counted once.
    let mut lines: Option<LineStarts> = None;
    let mut shown = Cow::Borrowed(problems);
    if problems.len() > MAX_PROBLEMS {
        limit(shown.to_mut());
    }
    for problem in shown.iter() {
        let excerpt = problem.place.as_ref().map(|place| {
            let known = lines.take().filter(|known| known.are_of(&place.source));
            let known = lines.insert(known.unwrap_or_else(|| LineStarts::of(&place.source)));
            Excerpt::of(place, known)
        });
        let label = problem.place.as_ref().map(|place| place.label.as_str());
        let drawn = Drawn {
            severity: problem.severity,
            message: safe_line(&short(&problem.message)).into_owned(),
            help: problem.help.as_deref().map(|help| safe(&short(help)).into_owned()),
            label: label.filter(|label| !label.is_empty()).map(|l| safe(&short(l)).into_owned()),
            excerpt,
        };
        // Writing to a string does not fail.
        let _ = handler.render_report(&mut out, &drawn);
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_problem_is_drawn_with_file_line_column_excerpt_and_help() {
        let source =
            Arc::new(Source { name: "map.ovl".into(), text: "ORIGIN 0 0\nOBSTACLE 1 x\n".into() });
        let problem = Problem::error("a number is missing")
            .at(&source, 22..23, "expected the radius, found a name")
            .help("write OBSTACLE x y radius");
        let text = draw(&[problem], false);
        for part in ["map.ovl:2:12", "OBSTACLE 1 x", "expected the radius", "write OBSTACLE"] {
            assert!(text.contains(part), "{part} missing in\n{text}");
        }
    }

    #[test]
    fn a_long_line_is_shown_in_part() {
        let mut text = "short\n".to_owned();
        text += &"\u{e9}".repeat(5_000);
        let at = text.len();
        text += "WRONG";
        text += &"\u{fc}".repeat(5_000);
        let source = Arc::new(Source { name: "map.json".into(), text });
        let problem = Problem::error("not a number").at(&source, at..at + 5, "this");
        let drawn = draw(&[problem], false);
        // Columns are counted in bytes.
        for part in ["map.json:2:10001", "2 \u{2502}", "\u{e9}WRONG\u{fc}", "this"] {
            assert!(drawn.contains(part), "{part} missing in\n{drawn}");
        }
        assert!(drawn.len() < 1_000, "{drawn}");
    }
    #[test]
    fn a_flood_of_mistakes_is_cut_and_its_errors_are_kept() {
        let mut problems = vec![Problem::note("a"); MAX_PROBLEMS];
        limit(&mut problems);
        assert_eq!(problems.len(), MAX_PROBLEMS);
        problems.push(Problem::error("b"));
        problems.push(Problem::warning("c"));
        let drawn = draw(&problems, false);
        assert!(drawn.contains("3 more mistakes are not shown"), "{drawn}");
        limit(&mut problems);
        assert_eq!(problems.len(), MAX_PROBLEMS);
        let [.., note, error, warning, more] = &problems[..] else { panic!("{problems:?}") };
        let kept = [note, error, warning].map(|problem| problem.message.as_str());
        assert_eq!(kept, ["a", "b", "c"]);
        assert_eq!(more.message, "3 more mistakes are not shown");
        assert_eq!(more.severity, Severity::Note);
    }

    #[test]
    fn nothing_that_is_quoted_reaches_the_terminal_as_a_control() {
        let evil = "\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}\u{8}";
        let text = format!("PP a 1 2\n{evil}PP {evil} x\r\n{evil}");
        let source = Arc::new(Source { name: format!("{evil}.ovl"), text });
        let at = source.text.find('x').unwrap();
        let problem = Problem::error(format!("`{evil}` is not a name"))
            .at(&source, at..at + 1, evil)
            .help(format!("not {evil}"));
        let drawn = draw(&[problem], false);
        let is_bad = |c: char| c != '\n' && crate::terminal::picture(c).is_some();
        assert!(!drawn.contains(is_bad), "{drawn:?}");
        assert!(drawn.contains("␛]0;owned␇"), "{drawn}");
        let line = drawn.lines().find(|line| line.contains("PP ␛")).unwrap();
        let below = drawn.lines().skip_while(|other| *other != line).nth(1).unwrap();
        // The mark stands under the letter even after replacements before it.
        let column = |line: &str, mark: char| line.chars().position(|c| c == mark).unwrap();
        assert_eq!(column(line, 'x'), column(below, '┬'), "{drawn}");
    }

    #[test]
    fn a_word_without_end_is_cut() {
        let word = "\u{fc}".repeat(1_000_000);
        let source = Arc::new(Source { name: "a.ovl".into(), text: word.clone() });
        let problem = Problem::error(format!("{word} is not a keyword"))
            .at(&source, 0..word.len(), word.clone())
            .help(word.clone());
        assert!(draw(&[problem], false).len() < 20_000);
    }

    proptest! {
        #[test]
        fn any_bytes_of_any_text_can_be_drawn(
            text in "(\\PC|é|東|🚜|\u{1b}|\u{202e}|\t|\r|\n|\r\n|[a-z ]{150,400}){0,20}",
            start in 0usize..600, length in 0usize..600, far in prop::bool::ANY,
        ) {
            let source = Arc::new(Source { name: "a".into(), text });
            let start = if far { usize::MAX - start } else { start };
            let span = start..start.saturating_add(length);
            let drawn = draw(&[Problem::error("e").at(&source, span.clone(), "here")], false);
            prop_assert!(drawn.contains("here"), "{}", drawn);
            // A reversed span is a parser's bug and must not panic.
            let back = Range { start: span.end, end: span.start };
            let drawn = draw(&[Problem::error("e").at(&source, back, "here")], true);
            prop_assert!(drawn.contains("here"), "{}", drawn);
        }
    }
}
