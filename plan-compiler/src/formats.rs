//! Every map format that is read: which one a file is in, and its reader.
//!
//! A new format is one file beside this one, with `recognises` and `read`, and one arm in
//! each `match` of [`Format`]. A file's content decides what it is; its extension decides
//! only where the content does not.

pub mod opar;
pub mod overlay;
pub mod utm;

pub use opar::OparOptions;

use crate::map::Map;
use crate::problem::{Problem, Severity, Source};
use crate::source;
use std::path::Path;
use std::sync::Arc;

/// No shape lies or reaches farther from a map's origin, metres: UTM northings fit, and
/// geometry stays far from overflow.
pub const FARTHEST_M: f64 = 1e9;

/// Mistakes in one file that are shown: a file with more is not what its name says.
pub const MAX_PROBLEMS: usize = 1000;

/// A format that maps are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// MissionLab overlay.
    Overlay,
    /// OPNET Path Attenuation Routine.
    Opar,
}

/// What a user may say about how to read a map.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The format, where the file does not tell.
    pub format: Option<Format>,
    /// What OPAR files leave open.
    pub opar: OparOptions,
}

impl Format {
    /// All of them, the more easily recognised first.
    pub const ALL: [Self; 2] = [Self::Overlay, Self::Opar];

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overlay => "MissionLab overlay",
            Self::Opar => "OPAR",
        }
    }

    /// Extensions of its files, in lower case.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Overlay => &["ovl", "odl"],
            Self::Opar => &["opar"],
        }
    }

    fn recognises(self, text: &str) -> bool {
        match self {
            Self::Overlay => overlay::recognises(text),
            Self::Opar => opar::recognises(text),
        }
    }

    fn read(self, text: &Arc<Source>, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
        match self {
            Self::Overlay => overlay::read(text),
            Self::Opar => opar::read(text, &options.opar),
        }
    }

    /// The format of a file: by its content, else by its extension.
    fn detect(path: &Path, text: &str) -> Option<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let extension = extension.unwrap_or("").to_ascii_lowercase();
        let by_content = Self::ALL.into_iter().find(|format| format.recognises(text));
        let by_name = |format: &Self| format.extensions().contains(&extension.as_str());
        by_content.or_else(|| Self::ALL.into_iter().find(by_name))
    }
}

/// Reads a map: what could be understood of it, and every mistake in the order of the file.
/// There is no map where the file cannot be read or is in no known format; a map that comes
/// with an error is incomplete.
pub fn read(path: &Path, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
    let (text, mut problems) = match source::read_text(path) {
        Ok(read) => read,
        Err(problem) => return (None, vec![problem]),
    };
    let Some(format) = options.format.or_else(|| Format::detect(path, &text.text)) else {
        problems.push(unknown_format(path));
        return (None, problems);
    };
    let (map, more) = format.read(&text, options);
    problems.extend(more);
    limit(&mut problems);
    (map, problems)
}

/// Keeps what a person can read, and an error among it if there was one.
fn limit(problems: &mut Vec<Problem>) {
    let Some(more @ 1..) = problems.len().checked_sub(MAX_PROBLEMS) else { return };
    let worst = problems.drain(MAX_PROBLEMS..).map(|problem| problem.severity).max();
    let last = Problem::error(format!("{more} more mistakes are not shown"))
        .mend("check that this is the file you mean, and mend the first ones");
    problems.push(Problem { severity: worst.unwrap_or(Severity::Error), ..last });
}

fn unknown_format(path: &Path) -> Problem {
    let known: Vec<String> = Format::ALL
        .iter()
        .map(|format| format!("{} (.{})", format.name(), format.extensions()[0]))
        .collect();
    Problem::error(format!("{} is no map in a known format", path.display()))
        .mend(format!("the formats are: {}", known.join(", ")))
}

/// A map as short text, the expectation of the readers' tests.
#[cfg(test)]
pub(crate) mod dump;

#[cfg(test)]
mod tests {
    use super::*;

    fn check(name: &str, text: &str, expected: Option<Format>) {
        assert_eq!(Format::detect(Path::new(name), text), expected, "{name} {text:?}");
    }

    #[test]
    fn content_decides_and_the_extension_helps() {
        let overlay = "ORIGIN 0 0\nCONTROL MEASURES:\nPP a 1 2\n";
        let opar = "Farm\n51.0\n7.0\n3\n0\n0\n10\n0\n0\n10\n1\n1\n14\n0.45\n0.284\n1\n1.33\n0.284\n0.588\n";
        check("a.ovl", overlay, Some(Format::Overlay));
        check("a.opar", opar, Some(Format::Opar));
        check("a.opar", overlay, Some(Format::Overlay));
        check("a.ovl", opar, Some(Format::Opar));
        check("a", opar, Some(Format::Opar));
        check("a.OVL", "-- nothing yet", Some(Format::Overlay));
        check("a.opar", "nothing yet", Some(Format::Opar));
        check("a.txt", "Dear reader,\n", None);
        check("a", "", None);
    }

    #[test]
    fn a_flood_of_mistakes_is_cut_with_its_severity_kept() {
        let mut problems = vec![Problem::note("a"); MAX_PROBLEMS];
        limit(&mut problems);
        assert_eq!(problems.len(), MAX_PROBLEMS);
        problems.push(Problem::error("b"));
        problems.push(Problem::warning("c"));
        limit(&mut problems);
        let last = problems.last().unwrap();
        assert_eq!(last.message, "2 more mistakes are not shown");
        assert_eq!(last.severity, Severity::Error);
    }

    #[test]
    fn a_file_in_no_known_format_is_refused_with_the_list() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("letter.txt");
        std::fs::write(&path, "Dear reader,\n").unwrap();
        let (map, problems) = read(&path, &ReadOptions::default());
        assert!(map.is_none());
        assert!(problems[0].message.ends_with("letter.txt is no map in a known format"));
        assert!(problems[0].mend.as_ref().unwrap().contains("MissionLab overlay (.ovl)"));
    }
}
