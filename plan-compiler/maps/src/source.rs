//! Reads files and reports every failure with how to fix it.
//!
//! Text is UTF-8. Old maps have Latin-1 letters in comments and names, so text that is not UTF-8
//! is read as Latin-1 with a warning; binary files are refused.

use crate::problem::{Problem, Source};
use math::grid;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;

/// Largest input, bytes: at least twice the largest grid at one byte per cell.
pub const MAX_FILE_BYTES: u64 = 512 << 20;
const _: () = assert!(MAX_FILE_BYTES > (grid::MAX_SIDE_CELLS as u64).pow(2));

/// File names of a folder that are compared to suggest the intended one.
const MAX_NAMES_LOOKED_AT: usize = 10_000;

/// Reads a file as text, with warnings about its encoding.
pub fn read_text(path: &Path) -> Result<(Arc<Source>, Vec<Problem>), Problem> {
    decode(path, read_bytes(path)?)
}

/// Reads a file of at most [`MAX_FILE_BYTES`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    let name = path.display();
    let failed = |error: std::io::Error| cannot_read(path, &error);
    // On Unix a directory opens and fails only when read, with an unhelpful message.
    if std::fs::metadata(path).map_err(failed)?.is_dir() {
        return Err(
            Problem::error(format!("{name} is a directory")).help("name a file inside it instead")
        );
    }
    let mut bytes = Vec::new();
    // Reading one byte past the limit detects an oversized file without trusting its stated length.
    File::open(path)
        .and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes))
        .map_err(failed)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        let limit = MAX_FILE_BYTES >> 20;
        return Err(Problem::error(format!("{name} is larger than {limit} MiB"))
            .help("crop the map to the area that the robot uses"));
    }
    Ok(bytes)
}

/// Decodes bytes as text, with warnings about the encoding.
pub fn decode(path: &Path, bytes: Vec<u8>) -> Result<(Arc<Source>, Vec<Problem>), Problem> {
    let name = path.display().to_string();
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(Problem::error(format!("{name} is empty"))
            .help("check that it was saved, and that this is the file you mean"));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(
            Problem::error(format!("{name} is UTF-16 text")).help("save it as UTF-8 instead")
        );
    }
    if is_binary(&bytes) {
        return Err(Problem::error(format!("{name} is not a text file"))
            .help("name a map file; text maps hold readable characters only"));
    }
    let mut problems = Vec::new();
    let text = String::from_utf8(bytes).unwrap_or_else(|error| {
        problems.push(
            Problem::warning(format!("{name} is not UTF-8; it is read as Latin-1"))
                .help("save it as UTF-8, so that names with accents come out right"),
        );
        error.as_bytes().iter().map(|&byte| char::from(byte)).collect()
    });
    // A byte order mark has no meaning in UTF-8.
    let text = text.strip_prefix('\u{feff}').map(String::from).unwrap_or(text);
    Ok((Arc::new(Source { name, text }), problems))
}

/// Whether the bytes hold NULs or more than 1 % control characters (old editors leave a few).
fn is_binary(bytes: &[u8]) -> bool {
    let is_control = |byte: &&u8| byte.is_ascii_control() && !matches!(byte, 9..=13 | 0x1a);
    bytes.contains(&0) || bytes.iter().filter(is_control).count() > bytes.len() / 100
}

fn cannot_read(path: &Path, error: &std::io::Error) -> Problem {
    let name = path.display();
    match error.kind() {
        ErrorKind::NotFound => {
            let problem = Problem::error(format!("there is no file {name}"));
            match similar_name(path) {
                Some(other) => problem.help(format!("did you mean {other}?")),
                None => problem.help("check the path; it is relative to the current folder"),
            }
        }
        ErrorKind::PermissionDenied => Problem::error(format!("no permission to read {name}"))
            .help("make it readable, for example with chmod u+r"),
        _ => Problem::error(format!("cannot read {name}: {error}")),
    }
}

/// The file in the same folder whose name is most similar.
pub(crate) fn similar_name(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    entries
        .flatten()
        .take(MAX_NAMES_LOOKED_AT)
        .filter_map(|entry| entry.file_name().into_string().ok())
        .map(|name| (strsim::damerau_levenshtein(&name, wanted), name))
        .filter(|(distance, name)| distance * 3 <= name.len())
        .min()
        .map(|(_, name)| path.with_file_name(name).display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(bytes: &[u8], expected: &str) {
        let got = match decode(Path::new("a.ovl"), bytes.to_vec()) {
            Ok((source, problems)) => {
                let notes: String = problems.iter().map(|p| format!(" [{p}]")).collect();
                format!("{:?}{notes}", source.text)
            }
            Err(problem) => problem.message,
        };
        assert_eq!(got, expected);
    }

    #[test]
    fn bytes_become_text_or_a_reason() {
        check(b"ORIGIN 0 0\n", r#""ORIGIN 0 0\n""#);
        check(b"", "a.ovl is empty");
        check(b" \r\n\t", "a.ovl is empty");
        check(b"\xef\xbb\xbfPP", r#""PP""#);
        check("-- Stra\u{df}e".as_bytes(), "\"-- Stra\u{df}e\"");
        check(b"-- Stra\xdfe", "\"-- Stra\u{df}e\" [a.ovl is not UTF-8; it is read as Latin-1]");
        check(b"\xff\xfeP\0P\0", "a.ovl is UTF-16 text");
        check(b"\x7fELF\x02\x01\x01\0\0\0", "a.ovl is not a text file");
        check(b"\x01\x02\x03\x04garbage", "a.ovl is not a text file");
        // The end-of-file mark of old systems.
        check(b"PP\x1a", r#""PP\u{1a}""#);
    }

    #[test]
    fn what_cannot_be_read_is_explained() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("campus.ovl"), "ORIGIN 0 0").unwrap();
        let error = |name: &str| read_text(&folder.path().join(name)).unwrap_err();

        let missing = error("campsu.ovl");
        assert!(missing.message.starts_with("there is no file"), "{missing}");
        assert!(missing.help.unwrap().ends_with("campus.ovl?"));
        assert!(!error("nothing-alike.txt").help.unwrap().contains("did you mean"));
        assert!(error(".").message.ends_with("is a directory"));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_without_permission_is_explained() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("locked.ovl");
        std::fs::write(&path, "ORIGIN 0 0").unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
        match read_text(&path) {
            Err(problem) => assert!(problem.message.starts_with("no permission"), "{problem}"),
            // The superuser may read everything.
            Ok((source, _)) => assert_eq!(source.text, "ORIGIN 0 0"),
        }
    }

    #[test]
    fn a_file_beyond_the_limit_is_refused_without_reading_it_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("huge.ovl");
        // Sparse: it takes no room on the disc.
        File::create(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        assert!(read_bytes(&path).unwrap_err().message.ends_with("is larger than 512 MiB"));
    }
}
