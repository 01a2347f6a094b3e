//! A section of words, read without alignment and without panics.

use crate::layout::WORD_BYTES;

/// A section of words of 4 bytes. Counting in words makes a read one comparison and one load.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Words<'a>(&'a [[u8; WORD_BYTES]]);

impl<'a> Words<'a> {
    /// The words of a section; `None` if its length is not a multiple of 4.
    pub(crate) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (words, rest) = bytes.as_chunks();
        rest.is_empty().then_some(Self(words))
    }

    /// Number of words.
    pub(crate) fn len(self) -> usize {
        self.0.len()
    }

    /// A word; `None` past the end.
    #[inline(always)]
    pub(crate) fn get(self, index: u32) -> Option<u32> {
        self.0.get(index as usize).copied().map(u32::from_le_bytes)
    }

    /// `count` words from an index on; `None` if they exceed the section.
    pub(crate) fn range(self, from: u32, count: u32) -> Option<&'a [[u8; WORD_BYTES]]> {
        self.0.get(from as usize..)?.get(..count as usize)
    }
}
