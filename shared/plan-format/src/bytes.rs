//! Little-endian numbers at any offset, read without alignment and without panics.

use crate::layout::WORD_BYTES;

/// `N` bytes at an offset; `None` past the end.
pub(crate) fn array_at<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..)?.first_chunk::<N>().copied()
}

/// A `u16` at an offset.
pub(crate) fn u16_at(bytes: &[u8], offset: usize) -> Option<u16> {
    array_at(bytes, offset).map(u16::from_le_bytes)
}

/// A `u32` at an offset.
pub(crate) fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    array_at(bytes, offset).map(u32::from_le_bytes)
}

/// An `f64` at an offset.
pub(crate) fn f64_at(bytes: &[u8], offset: usize) -> Option<f64> {
    array_at(bytes, offset).map(f64::from_le_bytes)
}

/// A section of words of 4 bytes. Counting in words makes a read one comparison and one load.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Words<'a>(&'a [[u8; WORD_BYTES]]);

impl<'a> Words<'a> {
    /// The words of a section; `None` if it is not a whole number of them.
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

    /// So many words from an index, if they lie within the section.
    pub(crate) fn range(self, from: u32, count: u32) -> Option<&'a [[u8; WORD_BYTES]]> {
        self.0.get(from as usize..)?.get(..count as usize)
    }
}
