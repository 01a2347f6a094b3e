//! The non-blank lines of a file. Lines end in LF, CR LF, or CR as on old Macs.

use std::ops::Range;

/// Non-blank lines without their line ends, as ranges of bytes.
pub(super) struct Lines<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        Self { text, at: 0 }
    }
}

impl Iterator for Lines<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        while self.at < self.text.len() {
            let rest = &self.text[self.at..];
            let start = self.at;
            let length = rest.find(['\n', '\r']).unwrap_or(rest.len());
            self.at += length + 1;
            let line = rest[..length].trim_end();
            if !line.is_empty() {
                return Some(start..start + line.len());
            }
        }
        None
    }
}
