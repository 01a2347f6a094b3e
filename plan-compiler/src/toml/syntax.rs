//! What is not TOML at all.

use super::report::Report;
use toml_parser::Expected;
use toml_parser::parser::{RecursionGuard, parse_document};

impl Report<'_> {
    /// Every mistake in the grammar of the file, of which the document's parser names one.
    pub(crate) fn syntax(&mut self, first: &toml_edit::TomlError) {
        /// What is no TOML at all has one mistake a line; a few are enough.
        const SAID: usize = 10;
        /// As deep as the document's parser goes.
        const MAX_DEPTH: u32 = 80;
        const HELP: &str =
            "each line is `key = value`, `[section]` or `# comment`; texts stand in \"quotes\"";
        let text = toml_parser::Source::new(&self.source.text);
        let mut errors: Vec<toml_parser::ParseError> = Vec::new();
        let mut nothing = ();
        let mut receiver = RecursionGuard::new(&mut nothing, MAX_DEPTH);
        parse_document(&text.lex().into_vec(), &mut receiver, &mut errors);
        for error in errors.iter().take(SAID) {
            let span = error.unexpected().or(error.context());
            let span = span.map_or(0..0, |span| span.start()..span.end());
            let expected = match error.expected() {
                Some([Expected::Literal(text), ..]) => format!(", expected `{text}`"),
                Some([Expected::Description(text), ..]) => format!(", expected {text}"),
                _ => String::new(),
            };
            let label = format!("{}{expected}", error.description());
            self.error("this is not TOML", &span, &label, HELP);
        }
        if errors.is_empty() {
            // The grammar is right and the meaning is not: a key written twice, a number too large.
            let span = first.span().unwrap_or(0..0);
            self.error("this is not TOML", &span, first.message(), HELP);
        }
        self.problems.sort_by_key(|problem| problem.place.as_ref().map(|place| place.span.start));
    }
}
