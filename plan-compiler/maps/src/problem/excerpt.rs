//! The lines around a mistake, as miette draws them.
//!
//! Offsets come from many parsers, and some count characters. Files may have any size. So
//! every offset moves to the nearest character boundary, long lines are cut, and the rest is copied
//! with control characters replaced. Nothing here fails.

use super::{Place, Source};
use crate::terminal::picture;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;
use std::sync::Arc;

/// Longest line shown whole. Programs put whole files into one line; it would wrap on screen and
/// misplace the mark.
const MAX_LINE_BYTES: usize = 200;
/// Bytes shown on either side of a mistake in a longer line.
const AROUND_BYTES: usize = 60;
/// Most lines shown of one mistake.
const MAX_LINES: usize = 40;

/// Where the lines of a file begin. Lines end in LF, CR LF or CR.
#[derive(Debug)]
pub(super) struct LineStarts {
    source: Arc<Source>,
    starts: Vec<usize>,
}

impl LineStarts {
    pub(super) fn of(source: &Arc<Source>) -> Self {
        let bytes = source.text.as_bytes();
        let ends_after = |&at: &usize| match bytes[at] {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        };
        let starts = (0..bytes.len()).filter(ends_after).map(|at| at + 1);
        Self { source: Arc::clone(source), starts: std::iter::once(0).chain(starts).collect() }
    }

    pub(super) fn are_of(&self, source: &Arc<Source>) -> bool {
        Arc::ptr_eq(&self.source, source)
    }

    /// Index of the line that holds a byte.
    fn line_of(&self, at: usize) -> usize {
        self.starts.partition_point(|start| *start <= at).saturating_sub(1)
    }

    /// The bytes of a line including its line end; empty beyond the last.
    fn line(&self, index: usize) -> Range<usize> {
        let end = self.source.text.len();
        let at = |index: usize| self.starts.get(index).copied().unwrap_or(end);
        at(index)..at(index + 1)
    }

    /// The bytes of a line without its line end.
    fn content(&self, index: usize) -> Range<usize> {
        let line = self.line(index);
        let content = self.source.text[line.clone()].trim_end_matches(['\r', '\n']);
        line.start..line.start + content.len()
    }
}

/// The part of a file around a mistake.
#[derive(Debug)]
pub(super) struct Excerpt {
    name: String,
    /// The shown text, safe to print.
    text: String,
    /// Index of its first line in the file.
    first_line: usize,
    /// The mistake, bytes of `text`.
    span: Range<usize>,
    /// Line and column of the mistake in the file, from 0; columns are bytes.
    at: [usize; 2],
}

impl Excerpt {
    pub(super) fn of(place: &Place, lines: &LineStarts) -> Self {
        let text = &place.source.text;
        let start = text.floor_char_boundary(place.span.start.min(text.len()));
        let end = text.ceil_char_boundary(place.span.end.clamp(start, text.len()));
        let line = lines.line_of(start);
        let last = lines.line_of(end.saturating_sub(1).max(start)).min(line + MAX_LINES);
        let around = line.saturating_sub(1)..(last + 2).min(lines.starts.len());
        let is_long = |line: usize| lines.content(line).len() > MAX_LINE_BYTES;
        let mut copy = Copy { text: String::new(), span: start..end, mapped: None..None };
        let first_line = if around.clone().any(is_long) {
            let content = lines.content(line);
            let until = end.clamp(start, start + MAX_LINE_BYTES).saturating_add(AROUND_BYTES);
            let from = text.ceil_char_boundary(start.saturating_sub(AROUND_BYTES));
            let until = text.floor_char_boundary(until.min(text.len()));
            copy.add(text, from.clamp(content.start, content.end)..until.min(content.end));
            line
        } else {
            for line in around.clone() {
                copy.add(text, lines.content(line));
                if lines.line(line).len() > lines.content(line).len() {
                    copy.text.push('\n');
                }
            }
            around.start
        };
        let span = copy.span();
        // A mark at the very end needs a character above it.
        if span.start == copy.text.len() {
            copy.text.push(' ');
        }
        let name = crate::terminal::safe_line(&place.source.name).into_owned();
        let at = [line, start - lines.line(line).start];
        Self { name, first_line, span, text: copy.text, at }
    }

    /// The mistake, bytes of the shown text.
    pub(super) fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

/// A part of a text, copied for a terminal, that tracks where its mistake moves.
struct Copy {
    text: String,
    /// The mistake, bytes of the file.
    span: Range<usize>,
    /// The mistake, bytes of the copy, as far as they are known.
    mapped: Range<Option<usize>>,
}

impl Copy {
    fn add(&mut self, text: &str, part: Range<usize>) {
        let part = part.start..part.end.max(part.start);
        for (at, character) in text[part.clone()].char_indices() {
            self.reach(part.start + at);
            let shown = if character == '\t' { None } else { picture(character) };
            self.text.push(shown.unwrap_or(character));
        }
        self.reach(part.end);
    }

    /// Maps a byte of the original to the current end of the copy.
    fn reach(&mut self, at: usize) {
        let here = Some(self.text.len());
        if at >= self.span.start {
            self.mapped.start = self.mapped.start.or(here);
        }
        if at >= self.span.end {
            self.mapped.end = self.mapped.end.or(here);
        }
    }

    fn span(&self) -> Range<usize> {
        let end = self.mapped.end.unwrap_or(self.text.len());
        self.mapped.start.unwrap_or(end).min(end)..end
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        _: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // Without surrounding lines, miette asks for the position of the mistake itself.
        let [line, column] =
            if lines_before + lines_after == 0 { self.at } else { [self.first_line, 0] };
        let (data, whole) = (self.text.as_bytes(), (0..self.text.len()).into());
        let count = self.text.lines().count();
        let name = self.name.clone();
        Ok(Box::new(MietteSpanContents::new_named(name, data, whole, line, column, count)))
    }
}
