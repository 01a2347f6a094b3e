//! Parses overlay tokens into statements and collects every mistake.
//!
//! After a mistake the parser continues at the next keyword, or at a word that begins a line and
//! may be a misspelt keyword. So one mistake gives one message and does not hide others.

use super::grammar::{Form, Part, Section, form_of, is_inner_word, nearest_keyword};
use super::lexer::{Kind, Lexed, Token};
use crate::problem::{MAX_PROBLEMS, Problem, Source};
use std::ops::Range;
use std::sync::Arc;

/// A coordinate as written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coordinate {
    pub(super) value: CoordinateValue,
    pub(super) span: Range<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CoordinateValue {
    /// x and y, metres before ORIGIN.
    Plain([f64; 2]),
    /// Latitude and longitude, degrees.
    Utm { lat: f64, lon: f64 },
}

/// A statement with all parts of its form.
#[derive(Clone, Debug)]
pub(super) struct Statement {
    pub(super) form: &'static Form,
    /// From the keyword to the last part.
    pub(super) span: Range<usize>,
    /// Its first name, without quotes.
    pub(super) name: String,
    pub(super) points: Vec<Coordinate>,
    /// Numbers and their bytes in the file.
    pub(super) numbers: Vec<(f64, Range<usize>)>,
    /// Index into the words of a choice.
    pub(super) choice: usize,
}

/// The statements of a file, in their order.
pub(super) fn parse(
    source: &Arc<Source>,
    lexed: &Lexed,
    problems: &mut Vec<Problem>,
) -> Vec<Statement> {
    let tokens = lexed.tokens.as_slice();
    let mut parser = Parser { source, tokens, next: 0, problems };
    let mut statements = Vec::new();
    // `None` until CONTROL MEASURES; its absence is reported once.
    let mut measures = None;
    while let Some(token) = parser.peek() {
        let word = parser.word(token);
        if word.eq_ignore_ascii_case("CONTROL") && token.kind == Kind::Word {
            parser.control_measures();
            measures = Some(());
            continue;
        }
        let form = if token.kind == Kind::Word { form_of(word) } else { None };
        let Some(form) = form else {
            parser.stray(token);
            continue;
        };
        if form.section == Section::Measures && measures.is_none() {
            parser.missing_section(token);
            measures = Some(());
        } else if form.section == Section::Information && measures.is_some() {
            parser.late_information(token);
        }
        match parser.statement(form) {
            Some(statement) => statements.push(statement),
            None => parser.resynchronise(),
        }
    }
    if measures.is_none() {
        let last = tokens.last().map_or(0..0, |token| token.span.clone());
        problems.push(
            Problem::error("CONTROL MEASURES: is missing")
                .at(source, last, "the file ends after this")
                .help("write CONTROL MEASURES: on a line of its own, then walls and points"),
        );
    }
    statements
}

struct Parser<'a> {
    source: &'a Arc<Source>,
    tokens: &'a [Token],
    next: usize,
    problems: &'a mut Vec<Problem>,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.next)
    }

    fn word(&self, token: &Token) -> &'a str {
        let source: &'a Source = self.source;
        &source.text[token.span.clone()]
    }

    fn take_if(&mut self, wanted: impl FnOnce(&Token) -> bool) -> Option<&'a Token> {
        let token = self.peek().filter(|token| wanted(token))?;
        self.next += 1;
        Some(token)
    }

    fn take_number(&mut self) -> Option<(f64, Range<usize>)> {
        let token = self.take_if(|token| matches!(token.kind, Kind::Number(_)))?;
        let Kind::Number(value) = token.kind else { return None };
        Some((value, token.span.clone()))
    }

    fn is_word(&self, token: &Token, wanted: &str) -> bool {
        token.kind == Kind::Word && self.word(token).eq_ignore_ascii_case(wanted)
    }

    fn take_word(&mut self, wanted: &str) -> Option<&'a Token> {
        let is_wanted = self.peek().is_some_and(|token| self.is_word(token, wanted));
        self.take_if(|_| is_wanted)
    }

    fn is_keyword(&self, token: &Token) -> bool {
        token.kind == Kind::Word
            && (form_of(self.word(token)).is_some() || self.is_word(token, "CONTROL"))
    }

    /// Skips to the next keyword, or to a word that begins a line: a misspelt keyword.
    fn resynchronise(&mut self) {
        while let Some(token) = self.peek() {
            let begins_line = token.kind == Kind::Word
                && self.begins_line(token)
                && !is_inner_word(self.word(token));
            if self.is_keyword(token) || begins_line {
                return;
            }
            self.next += 1;
        }
    }

    fn begins_line(&self, token: &Token) -> bool {
        let before = &self.source.text[..token.span.start];
        let blank = before.trim_end_matches([' ', '\t']);
        blank.is_empty() || blank.ends_with(['\n', '\r'])
    }

    /// Reports what is missing before the next token, unless the lexer reported that token.
    fn expected(&mut self, what: &str, statement: &str, usage: &str) {
        // Do not point at the next line for what this one lacks.
        let last = self.next.checked_sub(1).and_then(|last| self.tokens.get(last));
        let last = last.map_or(0..0, |token| token.span.clone());
        let (span, found) = match self.peek() {
            Some(Token { kind: Kind::Broken, .. }) => return,
            Some(token) if self.begins_line(token) => (last, "the end of the line".into()),
            Some(token) => (token.span.clone(), self.describe(token)),
            None => (last, "the end of the file".into()),
        };
        self.problems.push(
            Problem::error(format!("{statement} lacks its {what}"))
                .at(self.source, span, format!("expected the {what}, found {found}"))
                .help(format!("write {statement} {usage}")),
        );
    }

    fn describe(&self, token: &Token) -> String {
        let word = self.word(token);
        match token.kind {
            Kind::Word if self.is_keyword(token) => format!("the next statement, {word}"),
            Kind::Number(_) => format!("the number {word}"),
            _ => word.into(),
        }
    }
}

/// The two sections of a file, and tokens that belong to neither.
impl Parser<'_> {
    fn control_measures(&mut self) {
        self.next += 1;
        if self.take_word("MEASURES").is_none() {
            return self.expected("word MEASURES:", "CONTROL", "MEASURES:");
        }
        // The language requires the colon, but its absence is harmless.
        self.take_if(|token| token.kind == Kind::Colon);
    }

    fn missing_section(&mut self, token: &Token) {
        let word = self.word(token);
        self.problems.push(
            Problem::error(format!("{word} stands before CONTROL MEASURES:"))
                .at(self.source, token.span.clone(), "the first control measure")
                .help("write CONTROL MEASURES: on the line above it"),
        );
    }

    fn late_information(&mut self, token: &Token) {
        let word = self.word(token);
        self.problems.push(
            Problem::error(format!("{word} stands after CONTROL MEASURES:"))
                .at(self.source, token.span.clone(), "describes the whole map")
                .help(format!("move {word} above CONTROL MEASURES:")),
        );
    }

    /// Reports a token where a statement should begin, and skips to the next keyword.
    fn stray(&mut self, token: &Token) {
        let word = self.word(token);
        let problem = match token.kind {
            Kind::Broken | Kind::Colon => None,
            Kind::Word => {
                // Searching takes time; do not search for problems beyond the shown ones.
                let is_shown = self.problems.len() < MAX_PROBLEMS;
                let meant = if is_shown { nearest_keyword(word) } else { None };
                let help = match meant {
                    Some(keyword) => format!("did you mean {keyword}?"),
                    None => "remove it, or put -- in front to make it a comment".into(),
                };
                Some((format!("{word} is not a keyword"), help))
            }
            Kind::Quoted | Kind::Number(_) => Some((
                format!("{word} is not part of a statement"),
                "the statement before it is complete: remove it, or add the keyword it lacks"
                    .into(),
            )),
        };
        if let Some((message, help)) = problem {
            let label = "expected a keyword such as WALL or PP";
            self.problems.push(
                Problem::error(message).at(self.source, token.span.clone(), label).help(help),
            );
        }
        self.next += 1;
        self.resynchronise();
    }
}

/// One statement, part by part.
impl Parser<'_> {
    fn statement(&mut self, form: &'static Form) -> Option<Statement> {
        let keyword = self.peek()?;
        let written = self.word(keyword).to_ascii_uppercase();
        self.next += 1;
        let mut statement = Statement {
            form,
            span: keyword.span.clone(),
            name: String::new(),
            points: Vec::new(),
            numbers: Vec::new(),
            choice: 0,
        };
        for part in form.parts {
            self.part(*part, &written, &mut statement)?;
        }
        statement.span.end = self.tokens.get(self.next - 1)?.span.end;
        Some(statement)
    }

    /// Reads one part into the statement; `None` after a report.
    fn part(&mut self, part: Part, written: &str, statement: &mut Statement) -> Option<()> {
        let usage = statement.form.usage;
        match part {
            Part::Name => statement.name = self.name(written, usage)?,
            Part::OptionalName(what) => self.optional_name(what, written),
            Part::Point => statement.points.push(self.point(written, usage)?),
            Part::Points { then } => self.points(then, written, statement)?,
            Part::Number(what) => match self.take_number() {
                Some(number) => statement.numbers.push(number),
                None => return self.fail(what, written, usage),
            },
            Part::OptionalNumber => statement.numbers.extend(self.take_number()),
            Part::Literal(word) => {
                if self.take_word(word).is_none() {
                    return self.fail(&format!("word {word}"), written, usage);
                }
            }
            Part::Choice(words) => {
                let Some(at) = words.iter().position(|word| self.take_word(word).is_some()) else {
                    return self.fail(&words.join(" or "), written, usage);
                };
                statement.choice = at;
            }
        }
        Some(())
    }

    fn fail<T>(&mut self, what: &str, written: &str, usage: &str) -> Option<T> {
        self.expected(what, written, usage);
        None
    }

    fn name(&mut self, written: &str, usage: &str) -> Option<String> {
        let Some(token) = self.peek() else { return self.fail("name", written, usage) };
        let text = self.word(token);
        let following = self.tokens.get(self.next + 1);
        match token.kind {
            Kind::Quoted => {
                self.next += 1;
                Some(text.trim_matches('"').into())
            }
            Kind::Word if !self.is_keyword(token) => {
                self.next += 1;
                Some(text.into())
            }
            // A keyword followed by a coordinate is a name that needs quotes.
            Kind::Word if following.is_some_and(|next| matches!(next.kind, Kind::Number(_))) => {
                self.problems.push(
                    Problem::error(format!("{text} is a keyword and cannot be a bare name"))
                        .at(self.source, token.span.clone(), format!("the name of {written}"))
                        .help(format!("put it in quotes: \"{text}\"")),
                );
                self.next += 1;
                Some(text.into())
            }
            Kind::Number(_) => {
                let adjacent = following
                    .filter(|next| next.kind == Kind::Word && next.span.start == token.span.end);
                let Some(rest) = adjacent else { return self.fail("name", written, usage) };
                let span = token.span.start..rest.span.end;
                let whole = &self.source.text[span.clone()];
                self.problems.push(
                    Problem::error(format!("{whole} is not a name"))
                        .at(self.source, span, "a bare name begins with a letter")
                        .help(format!("put it in quotes: \"{whole}\"")),
                );
                None
            }
            _ => self.fail("name", written, usage),
        }
    }

    fn optional_name(&mut self, what: &str, written: &str) {
        let is_name = |token: &Token| match token.kind {
            Kind::Quoted | Kind::Broken => true,
            Kind::Word => !self.is_keyword(token),
            Kind::Number(_) | Kind::Colon => false,
        };
        let found = self.peek().is_some_and(is_name);
        if self.take_if(|_| found).is_none() {
            let last = self.tokens.get(self.next - 1).map_or(0..0, |token| token.span.clone());
            self.problems.push(
                Problem::warning(format!("{written} lacks its {what}"))
                    .at(self.source, last, format!("expected the {what} after this"))
                    .help(format!(
                        "add a {what}; MissionLab requires it, planning does not use it"
                    )),
            );
        }
    }

    /// A pair of numbers, or `UTM LAT number LON number` in either order.
    fn point(&mut self, written: &str, usage: &str) -> Option<Coordinate> {
        if let Some(utm) = self.take_word("UTM") {
            return self.utm(utm.span.start);
        }
        let Some((x, start)) = self.take_number() else {
            return self.fail("coordinates", written, usage);
        };
        let Some((y, end)) = self.take_number() else {
            return self.fail("y coordinate", written, usage);
        };
        Some(Coordinate { value: CoordinateValue::Plain([x, y]), span: start.start..end.end })
    }

    fn utm(&mut self, start: usize) -> Option<Coordinate> {
        let usage = "LAT latitude LON longitude";
        let lat_first = self.peek().is_none_or(|token| !self.is_word(token, "LON"));
        let order = if lat_first { ["LAT", "LON"] } else { ["LON", "LAT"] };
        let mut values = [0.0; 2];
        let mut end = start;
        for (value, word) in values.iter_mut().zip(order) {
            if self.take_word(word).is_none() {
                return self.fail(&format!("word {word}"), "UTM", usage);
            }
            let Some((number, span)) = self.take_number() else {
                return self.fail(
                    if word == "LAT" { "latitude" } else { "longitude" },
                    "UTM",
                    usage,
                );
            };
            (*value, end) = (number, span.end);
        }
        let [lat, lon] = if lat_first { values } else { [values[1], values[0]] };
        Some(Coordinate { value: CoordinateValue::Utm { lat, lon }, span: start..end })
    }

    /// At least one coordinate. Numbers pair up; an odd last one is the number `then`, or a mistake
    /// if the form has none.
    fn points(
        &mut self,
        then: Option<&str>,
        written: &str,
        statement: &mut Statement,
    ) -> Option<()> {
        let usage = statement.form.usage;
        statement.points.push(self.point(written, usage)?);
        loop {
            if let Some(utm) = self.take_word("UTM") {
                statement.points.push(self.utm(utm.span.start)?);
                continue;
            }
            let Some((x, start)) = self.take_number() else { return Some(()) };
            if let Some((y, end)) = self.take_number() {
                let span = start.start..end.end;
                let value = CoordinateValue::Plain([x, y]);
                statement.points.push(Coordinate { value, span });
                continue;
            }
            let at_end = self.peek().is_none_or(|token| !self.is_word(token, "UTM"));
            if then.is_some() && at_end {
                statement.numbers.push((x, start));
                return Some(());
            }
            let broken = self.peek().is_some_and(|token| token.kind == Kind::Broken);
            if !broken {
                self.problems.push(
                    Problem::error(format!("{written} has an odd number of coordinates"))
                        .at(self.source, start, "this x has no y")
                        .help(format!("write {written} {usage}")),
                );
            }
            return None;
        }
    }
}
