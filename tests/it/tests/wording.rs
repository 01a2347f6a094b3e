//! Comments, documentation and messages avoid phrases that a reader has to read twice.
//!
//! [`PHRASES`] is the table. Only phrases that are almost always wrong are in it; the test lists the
//! file and line of each hit.

use it::root;

/// A phrase to avoid.
struct Phrase {
    /// Lower-case words, separated by spaces.
    words: &'static str,
    /// Words that make the phrase right if one of them comes before it.
    unless_after: &'static [&'static str],
    /// Words that make the phrase right if one of them follows it.
    unless_before: &'static [&'static str],
    instead: &'static str,
}

const fn phrase(words: &'static str, instead: &'static str) -> Phrase {
    Phrase { words, unless_after: &[], unless_before: &[], instead }
}

const REPORTED: &str = "\"is reported\", or name the component that reports it";
const CLAUSE: &str = "split the sentence: subject, verb, object";
const REPAIR: &str = "\"fix\", \"repair\" or \"help\"";
const NEGATION: &str = "\"is not a ...\"";

const PHRASES: &[Phrase] = &[
    Phrase {
        words: "is no",
        unless_after: &["there", "it's"],
        unless_before: &[
            "longer", "more", "later", "less", "worse", "better", "larger", "lower", "deeper",
        ],
        instead: NEGATION,
    },
    Phrase {
        words: "are no",
        unless_after: &["there"],
        unless_before: &["longer", "more", "larger", "lower"],
        instead: "\"are not ...\"",
    },
    phrase("for ever", "\"without end\", or the condition that ends it"),
    phrase("so many", "name the count"),
    phrase("every so many", "name the interval"),
    phrase("whoever", "\"the caller\", \"the user\", or the imperative"),
    phrase("nobody", "name the component: \"no behaviour\", \"no caller\""),
    phrase("of which", CLAUSE),
    phrase("by which", CLAUSE),
    phrase("mend", REPAIR),
    phrase("mends", REPAIR),
    phrase("mended", REPAIR),
    phrase("parted", "\"separated\""),
    phrase("no matter", "\"regardless of\", \"for any\""),
    phrase("nothing but", "\"only\""),
    phrase("one likes", "name the user's choice"),
    phrase("is told", REPORTED),
    phrase("are told", REPORTED),
    phrase("was told", REPORTED),
    Phrase { words: "be told", unless_after: &[], unless_before: &["apart"], instead: REPORTED },
    phrase("is said", REPORTED),
    phrase("are said", REPORTED),
    phrase("was said", REPORTED),
    phrase("be said", REPORTED),
    phrase("had enough", "\"a closed pipe\""),
    phrase("as the paper has it", "\"as in the paper\""),
    phrase("goes on as if", "name the policy"),
    phrase("go on as if", "name the policy"),
    phrase("weightiest", "\"highest priority\""),
    phrase("by whatever", "\"by any\""),
    phrase("no way to", "\"cannot\""),
    phrase("to its right", "name the direction"),
    phrase("came of it", "\"the result\""),
    phrase("what came of", "\"the result of\""),
    phrase("which see", "link to it"),
    phrase("upon", "\"on\", \"when\""),
    phrase("thereof", CLAUSE),
    phrase("wherein", CLAUSE),
];

/// Files that are not checked: histories, and the tables of phrases and names to avoid.
const EXCEPT: &[&str] =
    &["CHANGELOG.md", "SECURITY.md", "tests/it/tests/glossary.rs", "tests/it/tests/wording.rs"];

/// A word or a punctuation mark of a text, and its line. `None` separates texts.
type Token = (Option<String>, usize);

/// Splits prose into lower-case words and punctuation marks.
fn tokens(prose: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for (line, text) in (1..).zip(prose.split('\n')) {
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '\'';
            let length = match rest.find(|c| !is_word(c)) {
                Some(0) => first.len_utf8(),
                Some(length) => length,
                None => rest.len(),
            };
            match first {
                SEPARATOR => tokens.push((None, line)),
                first if first.is_whitespace() => {}
                _ => tokens.push((Some(rest[..length].to_lowercase()), line)),
            }
            rest = &rest[length..];
        }
    }
    tokens
}

/// Stands between two comments or strings in the result of [`prose`].
const SEPARATOR: char = '\0';

/// The comments and strings of a Rust source, on their lines. Code becomes a [`SEPARATOR`], white
/// space stays, and the marks of comments are removed.
fn prose(source: &str) -> String {
    let mut out = String::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let hashes = raw_string_hashes(rest);
        let (length, text) = if rest.starts_with("//") {
            let length = rest.find('\n').unwrap_or(rest.len());
            (length, rest[..length].trim_start_matches(['/', '!']))
        } else if rest.starts_with("/*") {
            let length = rest.find("*/").map_or(rest.len(), |end| end + 2);
            (length, &rest[..length])
        } else if let Some(hashes) = hashes {
            let start = hashes + 2;
            let end = format!("\"{}", "#".repeat(hashes));
            let length = rest[start..].find(&end).map_or(rest.len(), |at| start + at + end.len());
            out.push(SEPARATOR);
            (length, &rest[start..length])
        } else if first == '"' {
            let length = string_length(rest);
            out.push(SEPARATOR);
            (length, &rest[1..length])
        } else if rest.starts_with("'\"'") || rest.starts_with("b'\"'") {
            (rest.find('"').map_or(1, |at| at + 2), "\0")
        } else if first == '\'' && rest[1..].starts_with('\\') {
            (rest[3..].find('\'').map_or(rest.len(), |at| at + 4), "\0")
        } else if first.is_whitespace() {
            (first.len_utf8(), &rest[..first.len_utf8()])
        } else if first.is_alphanumeric() || first == '_' {
            // A whole name at once, so that an `r` at its end does not begin a raw string.
            let is_name = |c: char| c.is_alphanumeric() || c == '_';
            (rest.find(|c| !is_name(c)).unwrap_or(rest.len()), "\0")
        } else {
            (first.len_utf8(), "\0")
        };
        // A line that ends in a backslash goes on; other escapes are marks.
        out.push_str(&text.replace("\\\n", " \n"));
        rest = &rest[length..];
    }
    out
}

/// Number of `#` of a raw string at the start of a source; `None` if there is no raw string.
fn raw_string_hashes(source: &str) -> Option<usize> {
    let after = source.strip_prefix('r')?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    after[hashes..].starts_with('"').then_some(hashes)
}

/// Length of the string literal at the start of a source, quotes included.
fn string_length(source: &str) -> usize {
    let mut is_escaped = true;
    for (at, c) in source.char_indices() {
        match c {
            '"' if !is_escaped => return at + 1,
            '\\' => is_escaped = !is_escaped,
            _ => is_escaped = false,
        }
    }
    source.len()
}

/// The lines of a file with a phrase of the table, and what is wrong there.
fn hits(file: &str, text: &str) -> Vec<String> {
    let is_rust = file.ends_with(".rs");
    let tokens = if is_rust { tokens(&prose(text)) } else { tokens(text) };
    let word = |at: usize| tokens.get(at).and_then(|(word, _)| word.as_deref()).unwrap_or("");
    let mut found = Vec::new();
    for (at, (_, line)) in tokens.iter().enumerate() {
        for phrase in PHRASES {
            let count = phrase.words.split(' ').count();
            let is_here =
                (at..).zip(phrase.words.split(' ')).all(|(at, wanted)| word(at) == wanted);
            let before = if at > 0 { word(at - 1) } else { "" };
            let is_right = phrase.unless_after.contains(&before)
                || phrase.unless_before.contains(&word(at + count));
            if is_here && !is_right {
                let Phrase { words, instead, .. } = phrase;
                found.push(format!("{file}:{line}: \"{words}\": better {instead}"));
            }
        }
    }
    let docs = text.lines().map(|line| line.trim().strip_prefix("///").map(str::trim));
    for (line, doc) in (1..).zip(docs).filter(|_| is_rust) {
        if doc.is_some_and(|doc| doc.starts_with("...") || doc.ends_with(" ...")) {
            found.push(format!("{file}:{line}: each doc comment is a sentence of its own"));
        }
    }
    found
}

#[test]
fn comments_and_messages_are_plain() {
    let mut found = Vec::new();
    super::layering::visit(root(), &mut |path| {
        let file = path.strip_prefix(root()).expect("below the root").to_string_lossy();
        let file = file.replace('\\', "/");
        if [".rs", ".md"].iter().any(|ending| file.ends_with(ending))
            && !EXCEPT.contains(&file.as_str())
        {
            let text = std::fs::read_to_string(path).expect("a file is readable");
            found.extend(hits(&file, &text));
        }
    });
    found.sort();
    assert!(found.is_empty(), "{} hits:\n{}", found.len(), found.join("\n"));
}

#[test]
fn phrases_are_found_in_comments_strings_and_markdown() {
    let check = |file: &str, text: &str, expected: &[usize]| {
        let found = hits(file, text);
        let lines: Vec<usize> =
            found.iter().map(|hit| hit.split(':').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(lines, expected, "{text}\n{found:?}");
    };
    check("a.rs", "/// This is no map, but\n/// there is no map either.\nfn a() {}", &[1]);
    check("a.rs", "// It runs for\n// ever.\nlet nobody = 1;", &[1]);
    check("a.rs", "// so\nlet x = 1; // many", &[]);
    check(
        "a.rs",
        "let a = '\"'; let s = \"a \\\" so many\"; let for_ever = r#\"of\nwhich\"#;",
        &[1, 1],
    );
    check("a.rs", "let s = \"so \\\n     many\"; let c = '\\''; // whoever", &[1, 2]);
    check("a.rs", "fn f<'a>(x: &'a str) {} // nobody", &[1]);
    check("a.rs", "/// When it grows ...\na: u8,\n/// ... and when it shrinks.\nb: u8,", &[1, 3]);
    check("a.md", "One\nis told that it\nis no longer so.", &[2]);
}
