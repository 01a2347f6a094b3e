//! The budget of checks for validating a blob, and the beat during that work.
//!
//! A blob of a few kilobytes can refer to one table from hundreds of layers, or have tables that
//! overlap. Each distinct table is checked once, and the blob's length bounds the number of checks,
//! so boot takes a known time for any input.

use crate::error::BlobError;
use crate::limits;

/// The remaining checks, and the beat.
pub(crate) struct Work<F> {
    left: u32,
    until_beat: u32,
    beat: F,
}

impl<F: FnMut()> Work<F> {
    /// A budget of 0 checks.
    pub(crate) fn new(beat: F) -> Self {
        Self { left: 0, until_beat: limits::CHECKS_PER_BEAT, beat }
    }

    /// Sets the budget, from the number of words in section `cells`.
    pub(crate) fn allow(&mut self, words: usize) {
        self.left = (words as u32).saturating_mul(limits::MAX_CHECKS_PER_WORD);
    }

    /// Takes `checks` from the budget; calls the beat if one is due.
    #[inline(always)]
    pub(crate) fn spend(&mut self, checks: u32) -> Result<(), BlobError> {
        self.left = self.left.checked_sub(checks).ok_or(BlobError::Work)?;
        match self.until_beat.checked_sub(checks) {
            Some(more) => self.until_beat = more,
            None => self.beat(),
        }
        Ok(())
    }

    /// Calls the beat.
    #[inline(never)]
    pub(crate) fn beat(&mut self) {
        self.until_beat = limits::CHECKS_PER_BEAT;
        (self.beat)();
    }
}
