//! Tiles that wait for a visit, those with the lowest costs first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Why a tile waits for a visit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pending {
    /// Rows to relax from the row south of them, one bit each.
    pub(super) from_south: u64,
    /// Rows to relax from the row north of them, one bit each.
    pub(super) from_north: u64,
    /// The lowest waiting cost, if the tile is in the queue.
    pub(super) key: Option<u32>,
}

/// The waiting tiles, by their numbers; reused from search to search.
#[derive(Debug, Default)]
pub(super) struct Queue {
    pending: Vec<Pending>,
    /// Tiles by their keys. An entry whose key was lowered later is skipped.
    by_key: BinaryHeap<Reverse<(u32, u32)>>,
}

impl Queue {
    /// An empty queue for this many tiles.
    pub(super) fn reset(&mut self, tiles: usize) {
        self.pending.clear();
        self.pending.resize(tiles, Pending::default());
        self.by_key.clear();
    }

    /// Puts a tile in the queue or moves it forward.
    #[inline(always)]
    pub(super) fn wake(&mut self, at: usize, offer: Pending) {
        let pending = &mut self.pending[at];
        pending.from_south |= offer.from_south;
        pending.from_north |= offer.from_north;
        if let Some(key) = offer.key
            && pending.key.is_none_or(|old| key < old)
        {
            pending.key = Some(key);
            self.by_key.push(Reverse((key, at as u32)));
        }
    }

    /// Takes out the tile with the lowest key, and why it waits.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<(usize, Pending)> {
        loop {
            let Reverse((key, at)) = self.by_key.pop()?;
            let pending = &mut self.pending[at as usize];
            if pending.key == Some(key) {
                return Some((at as usize, std::mem::take(pending)));
            }
        }
    }
}
