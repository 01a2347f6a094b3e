//! How much work a blob may cause before the robot drives, and a beat while it is done.
//!
//! A blob of a few kilobytes can name one table from hundreds of layers, or tables that lie on one
//! another. Each distinct table is checked once, and all checks together are bounded by the
//! blob's bytes, so that boot ends in a known time whatever the bytes say.

use crate::error::BlobError;
use crate::limits;

/// The checks that are left, and a beat to call while work goes on.
pub(crate) struct Work<F> {
    left: u32,
    until_beat: u32,
    beat: F,
}

impl<F: FnMut()> Work<F> {
    /// Nothing may be checked yet.
    pub(crate) fn new(beat: F) -> Self {
        Self { left: 0, until_beat: limits::CHECKS_PER_BEAT, beat }
    }

    /// Allows what a section of cells may take, from its number of words.
    pub(crate) fn allow(&mut self, words: usize) {
        self.left = (words as u32).saturating_mul(limits::MAX_CHECKS_PER_WORD);
    }

    /// Takes `checks` from what is left.
    #[inline(always)]
    pub(crate) fn spend(&mut self, checks: u32) -> Result<(), BlobError> {
        self.left = self.left.checked_sub(checks).ok_or(BlobError::Work)?;
        match self.until_beat.checked_sub(checks) {
            Some(more) => self.until_beat = more,
            None => self.beat(),
        }
        Ok(())
    }

    /// Calls the beat: work goes on.
    #[inline(never)]
    pub(crate) fn beat(&mut self) {
        self.until_beat = limits::CHECKS_PER_BEAT;
        (self.beat)();
    }
}
