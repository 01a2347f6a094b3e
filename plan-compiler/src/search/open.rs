//! Passable cells, 64 columns of a row at a time, and the moves between them.

use super::Corners;
use maps::Bitmap;

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

/// The passable cells of a map with an impassable border, so that every word has neighbours: one row
/// in the south, one word in the west, and at least as much in the north and east.
#[derive(Clone, Debug, Default)]
pub(crate) struct Passable {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Words from one row to the next.
    stride: usize,
    words: Vec<u64>,
    /// The westernmost and the easternmost column of each tile, by rows of tiles, as words with the
    /// southernmost cell in bit 0.
    sides: Vec<[u64; 2]>,
}

impl Passable {
    /// The cells of a set if `through` is true, otherwise all others.
    pub(crate) fn of(map: &Bitmap, through: bool) -> Self {
        let mut this = Self::default();
        this.fill(map, through);
        this
    }

    /// As [`Passable::of`], reusing the memory.
    pub(crate) fn fill(&mut self, map: &Bitmap, through: bool) {
        (self.columns, self.rows) = (map.columns() as usize, map.rows() as usize);
        let across = self.columns.div_ceil(SIDE);
        self.stride = across + 2;
        // Whole tiles, so that the last tile has a border too.
        self.words.resize((self.rows.next_multiple_of(SIDE) + 2) * self.stride, 0);
        let flip = if through { 0 } else { u64::MAX };
        let outside = (across * SIDE - self.columns) as u32;
        let (south, rest) = self.words.split_at_mut(self.stride);
        let (inside, north) = rest.split_at_mut(self.rows * self.stride);
        south.fill(0);
        north.fill(0);
        self.sides.clear();
        self.sides.resize(self.rows.div_ceil(SIDE) * across, [0; 2]);
        for (row, words) in (0..map.rows()).zip(inside.chunks_exact_mut(self.stride)) {
            for (word, map) in words[1..].iter_mut().zip(map.row(row)) {
                *word = map ^ flip;
            }
            words[across] &= u64::MAX.checked_shr(outside).unwrap_or(0);
            (words[0], words[across + 1]) = (0, 0);
            let row = row as usize;
            let sides = &mut self.sides[row / SIDE * across..][..across];
            for ([west, east], word) in sides.iter_mut().zip(&words[1..]) {
                *west |= (word & 1) << (row % SIDE);
                *east |= (word >> (SIDE - 1)) << (row % SIDE);
            }
        }
    }

    /// The passable cells of one word of a row. Both may lie one beyond the map.
    #[inline(always)]
    pub(crate) fn at(&self, word: usize, row: isize) -> Open {
        let start = (row + 1) as usize * self.stride + word;
        match self.words.get(start..).and_then(|words| words.first_chunk()) {
            Some(&[west, cells, east]) => Open { cells, west: west >> 63, east: east << 63 },
            None => Open::default(),
        }
    }

    /// The westernmost (`dx` = -1) or the easternmost (1) column of a tile, as if it were a row.
    #[inline(always)]
    pub(crate) fn side(&self, tile: usize, dx: isize) -> Open {
        let sides = self.sides.get(tile).copied().unwrap_or_default();
        Open { cells: sides[usize::from(dx > 0)], ..Open::default() }
    }

    /// The passable cells of a tile, counted from the west and from the south.
    #[inline(always)]
    pub(crate) fn tile(&self, across: usize, down: usize) -> TileOpen<'_> {
        TileOpen { map: self, word: across, row: (down * SIDE) as isize }
    }
}

/// The passable cells of a tile and around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileOpen<'a> {
    map: &'a Passable,
    word: usize,
    row: isize,
}

impl TileOpen<'_> {
    /// The passable cells of a row of the tile; rows -1 and 64 lie beside it.
    #[inline(always)]
    pub(crate) fn row(self, row: isize) -> Open {
        self.map.at(self.word, self.row + row)
    }
}

impl Open {
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

    /// The cells of this row that may be entered from the neighbouring row `there`: straight, from
    /// the west and from the east. Steps are reversible, so these are also the cells from which that
    /// row may be entered. Whether the cell beyond a diagonal step is open shows in its cost.
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

/// For each open cell of a word, a byte with one bit for each open direction.
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

/// Counts, in every fourth row, the passable cells and those that are the south-west corner of a
/// passable square of 2 x 2 cells.
pub(super) struct Texture<'a>(pub(super) &'a Passable);

impl pulp::WithSimd for Texture<'_> {
    type Output = (u64, u64);

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let Passable { words, stride, .. } = self.0;
        let (mut free, mut wide) = (0, 0);
        for two in words[*stride..].chunks(4 * stride) {
            let (here, rest) = two.split_at(*stride);
            for word in 1..here.len().min(rest.len()) {
                let low = here[word] & rest[word];
                let high = here.get(word + 1).zip(rest.get(word + 1)).map_or(0, |(a, b)| a & b);
                free += u64::from(here[word].count_ones());
                wide += u64::from((low & (low >> 1 | high << 63)).count_ones());
            }
        }
        (free, wide)
    }
}
