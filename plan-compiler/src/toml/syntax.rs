//! Syntax errors of TOML.

use super::report::Report;
use toml_parser::Expected;
use toml_parser::parser::{RecursionGuard, parse_document};

impl Report<'_> {
    /// Reports every syntax error in the file; the document's parser reports only the first.
    pub(crate) fn syntax(&mut self, first: &toml_edit::TomlError) {
        /// A file that is not TOML has a mistake in every line; a few are enough.
        const MAX_LISTED: usize = 10;
        /// The recursion limit of the document's parser.
        const MAX_DEPTH: u32 = 80;
        const HELP: &str =
            "each line is `key = value`, `[section]` or `# comment`; put texts in \"quotes\"";
        let text = toml_parser::Source::new(&self.source.text);
        let mut errors: Vec<toml_parser::ParseError> = Vec::new();
        let mut nothing = ();
        let mut receiver = RecursionGuard::new(&mut nothing, MAX_DEPTH);
        parse_document(&text.lex().into_vec(), &mut receiver, &mut errors);
        for error in errors.iter().take(MAX_LISTED) {
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
            // The syntax is correct but the meaning is not, as with a duplicate key or a large
            // number.
            let span = first.span().unwrap_or(0..0);
            self.error("this is not TOML", &span, first.message(), HELP);
        }
        self.problems.sort_by_key(|problem| problem.place.as_ref().map(|place| place.span.start));
    }
}
