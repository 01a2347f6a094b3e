//! Names: one section of text, and the records that point into it.

use crate::limits;
use crate::record::record;

record! {
    /// The position of a name in the text of all names.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Name {
        /// Offset of its first byte.
        pub offset: u16,
        /// Length, bytes.
        pub length: u8,
    }
}

impl Name {
    /// The text; `None` if it is out of range or not UTF-8.
    pub(crate) fn text(self, names: &[u8]) -> Option<&str> {
        let bytes = names.get(usize::from(self.offset)..)?.get(..usize::from(self.length))?;
        core::str::from_utf8(bytes).ok()
    }
}

/// Whether a text may name a plan or a layer: trimmed, not empty, short enough, without `/`
/// (which joins the two) and without control characters.
pub fn is_name(name: &str) -> bool {
    !name.is_empty()
        && name.len() <= limits::MAX_NAME_BYTES
        && name.trim().len() == name.len()
        && !name.chars().any(|character| character == '/' || character.is_control())
}
