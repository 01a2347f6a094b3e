//! Passable cells, 64 columns of a row at a time, and the moves between them.

use super::Corners;
use crate::bitmap::Bitmap;

/// Columns in a word.
pub(crate) const SIDE: usize = 64;

/// The passable cells of 64 columns of a row and of the columns beside them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Open {
    /// Columns 0 to 63.
    pub(crate) cells: u64,
    /// Column -1 in bit 0.
    pub(crate) west: u64,
    /// Column 64 in bit 63.
    pub(crate) east: u64,
}

impl Open {
    /// The cells of a row, in word `word`, whose bit in the map equals `through`. Off the map
    /// nothing is passable.
    #[inline(always)]
    pub(crate) fn of(map: &Bitmap, through: bool, word: usize, row: i64) -> Self {
        if row < 0 || row >= i64::from(map.rows()) {
            return Self::default();
        }
        let words = map.row(row as u32);
        let columns = map.columns() as usize;
        let flip = if through { 0 } else { u64::MAX };
        let at = |word: usize| {
            let used = columns.saturating_sub(word * SIDE);
            let inside = if used >= SIDE { u64::MAX } else { (1 << used) - 1 };
            (words.get(word).copied().unwrap_or(0) ^ flip) & inside
        };
        Self {
            cells: at(word),
            west: if word > 0 { at(word - 1) >> 63 } else { 0 },
            east: at(word + 1) << 63,
        }
    }

    /// Bit x: whether column x - 1 is open.
    #[inline(always)]
    pub(crate) fn west_open(self) -> u64 {
        self.cells << 1 | self.west
    }

    /// Bit x: whether column x + 1 is open.
    #[inline(always)]
    pub(crate) fn east_open(self) -> u64 {
        self.cells >> 1 | self.east
    }

    /// The cells of this row that may be entered from the row `there` beside it: straight,
    /// from the west and from the east. Steps being reversible, these are also the cells from
    /// which that row may be entered. Whether the cell beyond a diagonal step is open is left
    /// to its cost.
    #[inline(always)]
    pub(super) fn passes(self, there: Self, corners: Corners) -> [u64; 3] {
        match corners {
            Corners::Allow => [self.cells; 3],
            Corners::Forbid => {
                let both = self.cells & there.cells;
                [self.cells, both & self.west_open(), both & self.east_open()]
            }
        }
    }
}

/// For each open cell of a word a byte with a bit for each direction that may be taken.
#[inline(always)]
pub(super) fn moves(south: Open, here: Open, north: Open, corners: Corners) -> [u8; SIDE] {
    let [_, south_west, south_east] = here.passes(south, corners);
    let [_, north_west, north_east] = here.passes(north, corners);
    let directions = [
        here.cells & here.east_open(),
        north_east & north.east_open(),
        here.cells & north.cells,
        north_west & north.west_open(),
        here.cells & here.west_open(),
        south_west & south.west_open(),
        here.cells & south.cells,
        south_east & south.east_open(),
    ];
    let mut moves = [0; SIDE];
    for (byte, moves) in moves.chunks_exact_mut(8).enumerate() {
        for (bit, moves) in moves.iter_mut().enumerate() {
            for (code, open) in directions.iter().enumerate() {
                *moves |= ((open >> (8 * byte + bit) & 1) as u8) << code;
            }
        }
    }
    moves
}

/// How many of the map's free cells there are, and how many of them are the south-western
/// corner of four that are free.
pub(super) fn texture(blocked: &Bitmap) -> (u64, u64) {
    let (mut free, mut wide) = (0, 0);
    for word in 0..blocked.columns().div_ceil(SIDE as u32) as usize {
        let mut here = Open::of(blocked, false, word, 0);
        for row in 1..=i64::from(blocked.rows()) {
            let north = Open::of(blocked, false, word, row);
            let square = here.cells & here.east_open() & north.cells & north.east_open();
            free += u64::from(here.cells.count_ones());
            wide += u64::from(square.count_ones());
            here = north;
        }
    }
    (free, wide)
}
