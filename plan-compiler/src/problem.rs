//! Mistakes in the input: what, where, why, and how to mend it.

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, SourceCode};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

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
    /// How to mend it.
    pub mend: Option<String>,
    /// The file and the bytes in it that are wrong, with a word on each.
    pub place: Option<Place>,
}

/// A range of bytes in a file.
#[derive(Clone, Debug)]
pub struct Place {
    /// The file.
    pub source: Arc<Source>,
    /// Bytes.
    pub span: Range<usize>,
    /// What is there; shown under the excerpt.
    pub label: String,
}

impl Problem {
    /// An error without a place.
    pub fn error(message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, message: message.into(), mend: None, place: None }
    }

    /// A warning without a place.
    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    /// A note without a place.
    pub fn note(message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(message) }
    }

    /// With advice on how to mend it.
    #[must_use]
    pub fn mend(mut self, mend: impl Into<String>) -> Self {
        self.mend = Some(mend.into());
        self
    }

    /// With the bytes that are wrong and a word on them.
    #[must_use]
    pub fn at(
        mut self,
        source: &Arc<Source>,
        span: Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        // Libraries count bytes, and may point into a character.
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

/// Lets miette draw the excerpt with the file's name.
#[derive(Debug)]
struct Excerpt(Arc<Source>);

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &miette::SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn miette::SpanContents<'a> + 'a>, miette::MietteError> {
        let mut inner = self.0.text.read_span(span, before, after)?;
        if inner.data().split(|byte| *byte == b'\n').any(|line| line.len() > MAX_LINE_BYTES) {
            let [line, column] = {
                let exact = self.0.text.read_span(span, 0, 0)?;
                [exact.line(), exact.column()]
            };
            let part = part_of_line(&self.0.text, span.offset()..span.offset() + span.len());
            let (data, at) = (&self.0.text.as_bytes()[part.clone()], part.into());
            inner = Box::new(miette::MietteSpanContents::new(data, at, line, column, 1));
        }
        Ok(Box::new(miette::MietteSpanContents::new_named(
            self.0.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line(),
            inner.column(),
            inner.line_count(),
        )))
    }
}

/// A longer line is none that a person wrote, and breaks on any screen, so that what points into
/// it points elsewhere: programs put whole files into one.
const MAX_LINE_BYTES: usize = 200;
/// What is shown on either side of a mistake in such a line, bytes.
const AROUND_BYTES: usize = 60;

/// What an excerpt shows of a line too long to be shown.
fn part_of_line(text: &str, span: Range<usize>) -> Range<usize> {
    let start = text[..span.start].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[span.end..].find('\n').map_or(text.len(), |newline| span.end + newline);
    let before = text.ceil_char_boundary(span.start.saturating_sub(AROUND_BYTES));
    let after = text.floor_char_boundary(span.end + AROUND_BYTES);
    start.max(before)..end.min(after)
}

/// What miette asks for, borrowed from a problem.
#[derive(Debug)]
struct Drawn<'p> {
    problem: &'p Problem,
    excerpt: Option<Excerpt>,
}

impl fmt::Display for Drawn<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.fmt(f)
    }
}

impl std::error::Error for Drawn<'_> {}

impl miette::Diagnostic for Drawn<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.problem.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.mend.as_ref().map(|mend| Box::new(mend) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.problem.place.as_ref()?;
        let span = (place.span.start, place.span.len());
        let label = (!place.label.is_empty()).then(|| place.label.clone());
        Some(Box::new(std::iter::once(LabeledSpan::new(label, span.0, span.1))))
    }
}

/// All problems as text for a person, in the order given.
pub fn draw(problems: &[Problem], colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(100).with_links(false);
    let mut out = String::new();
    for problem in problems {
        let excerpt = problem.place.as_ref().map(|place| Excerpt(Arc::clone(&place.source)));
        // Writing to a string does not fail.
        let _ = handler.render_report(&mut out, &Drawn { problem, excerpt });
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_is_drawn_with_file_line_column_excerpt_and_mend() {
        let source =
            Arc::new(Source { name: "map.ovl".into(), text: "ORIGIN 0 0\nOBSTACLE 1 x\n".into() });
        let problem = Problem::error("a number is missing")
            .at(&source, 22..23, "expected the radius, found a name")
            .mend("write OBSTACLE x y radius");
        let text = draw(&[problem], false);
        for part in ["map.ovl:2:12", "OBSTACLE 1 x", "expected the radius", "write OBSTACLE"] {
            assert!(text.contains(part), "{part} missing in\n{text}");
        }
    }

    #[test]
    fn of_a_line_too_long_to_be_shown_a_part_is() {
        let mut text = "short\n".to_owned();
        text += &"\u{e9}".repeat(5_000);
        let at = text.len();
        text += "WRONG";
        text += &"\u{fc}".repeat(5_000);
        let source = Arc::new(Source { name: "map.json".into(), text });
        let problem = Problem::error("no number").at(&source, at..at + 5, "this");
        let drawn = draw(&[problem], false);
        // Columns are counted in bytes.
        for part in ["map.json:2:10001", "2 \u{2502}", "\u{e9}WRONG\u{fc}", "this"] {
            assert!(drawn.contains(part), "{part} missing in\n{drawn}");
        }
        assert!(drawn.len() < 1_000, "{drawn}");
    }
}
