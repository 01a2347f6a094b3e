//! Which roots the cells of each block refer to: as few as possible, the same as next door.

use super::blocks::{Block, MAX_BLOCK_ENTRIES, ones, own_length};
use super::moves::Bordered;
use super::roots::{NO_ROOT, Roots, ways};
use crate::blocks::{BLOCK_CELLS, index_bytes};
use crate::field::{Field, GOAL, MOVES, NO_ROUTE};
use crate::grid::Cell;
use crate::layer::{NO_ROUTE_ENTRY, OWN_GOAL, OWN_NO_ROUTE, ROOT_BYTES, Root};

/// Root numbers from here on do not fit an entry.
const MAX_ROOTS: usize = (NO_ROUTE_ENTRY >> 1) as usize;

/// The routes of a field, block by block, and the roots that they refer to.
pub(crate) struct Routes {
    /// In the order of the grid of blocks.
    pub(crate) blocks: Vec<Block>,
    pub(crate) roots: Vec<Root>,
}

/// A block whose cells were given more roots than this, besides those of its neighbours, is not
/// worth a search for the fewest.
const MAX_OWN_ROOTS: usize = 32;
/// Most roots that are taken over from neighbouring blocks to be tried.
const MAX_HINTS: usize = 8;

/// An entry whose root has not got its final number: twice the number, plus the way.
type Draft = (u64, u64);
const NO_ROUTE_DRAFT: u64 = u64::MAX;

/// A block before its roots have their final numbers.
enum Choice {
    Entries(Vec<Draft>),
    Own,
}

/// A field as it is looked at here.
pub(crate) struct Covering<'f> {
    pub(crate) field: &'f Field,
    pub(crate) bordered: &'f Bordered,
    pub(crate) roots: &'f Roots,
    pub(crate) block_columns: usize,
    pub(crate) block_rows: usize,
}

impl Covering<'_> {
    /// Chooses for all blocks.
    pub(crate) fn choose(&self) -> Routes {
        let mut choices: Vec<Choice> = Vec::with_capacity(self.block_columns * self.block_rows);
        for index in 0..self.block_columns * self.block_rows {
            let beside = (index % self.block_columns > 0).then(|| &choices[index - 1]);
            let below = index.checked_sub(self.block_columns).map(|index| &choices[index]);
            let hints = [beside, below].into_iter().flatten().flat_map(roots_of);
            choices.push(self.cover(index, hints));
        }
        self.drop_costly(&mut choices);
        self.number(choices)
    }

    /// The cells of a block that lie on the map: number in the block, column, row.
    fn cells(&self, block: usize) -> impl Iterator<Item = (usize, usize, usize)> {
        let (columns, rows) = (self.field.columns as usize, self.field.rows as usize);
        let (column, row) = (block % self.block_columns * 8, block / self.block_columns * 8);
        (0..BLOCK_CELLS)
            .map(move |cell| (cell, column + cell % 8, row + cell / 8))
            .filter(move |&(_, column, row)| column < columns && row < rows)
    }

    fn code(&self, column: usize, row: usize) -> u8 {
        let code = self.field.code.get(row * self.field.columns as usize + column);
        code.copied().unwrap_or(NO_ROUTE)
    }

    /// Few entries that serve every cell of a block that has a route.
    fn cover(&self, block: usize, hints: impl Iterator<Item = u32>) -> Choice {
        let (mut routed, mut no_route) = (0u64, 0u64);
        let mut candidates: Vec<u32> = Vec::with_capacity(2 * MAX_OWN_ROOTS);
        for root in hints {
            if candidates.len() < MAX_HINTS && !candidates.contains(&root) {
                candidates.push(root);
            }
        }
        let hints = candidates.len();
        for (cell, column, row) in self.cells(block) {
            match self.code(column, row) {
                0..=GOAL => {
                    let root = self.roots.of_cell[self.bordered.index(column, row)];
                    if root == NO_ROOT {
                        return Choice::Own;
                    }
                    routed |= 1 << cell;
                    if candidates.last() != Some(&root) && !candidates.contains(&root) {
                        candidates.push(root);
                    }
                    // Noise and mazes fall back early: so many roots never pay.
                    if candidates.len() - hints > MAX_OWN_ROOTS {
                        return Choice::Own;
                    }
                }
                NO_ROUTE => no_route |= 1 << cell,
                _ => {}
            }
        }
        let Some(mut entries) = self.fewest(block, &candidates, routed) else {
            return Choice::Own;
        };
        if no_route != 0 {
            entries.push((NO_ROUTE_DRAFT, no_route));
        }
        if entries.len() > MAX_BLOCK_ENTRIES { Choice::Own } else { Choice::Entries(entries) }
    }

    /// A greedy cover: always the entry that serves the most cells still without one. `None` if
    /// some cell has none, which its own root should prevent.
    fn fewest(&self, block: usize, candidates: &[u32], routed: u64) -> Option<Vec<Draft>> {
        let mut served: Vec<Draft> = Vec::with_capacity(2 * candidates.len());
        for &root in candidates {
            for (way, cells) in self.served_by(block, root, routed).into_iter().enumerate() {
                let entry = u64::from(root) << 1 | way as u64;
                if cells == routed && routed != 0 {
                    return Some(vec![(entry, routed)]);
                }
                served.push((entry, cells));
            }
        }
        let mut left = routed;
        let mut entries = Vec::new();
        while left != 0 {
            // The first of the best: neighbours' roots stand at the front.
            let best = served.iter().rev().max_by_key(|(_, cells)| (cells & left).count_ones());
            let &(entry, cells) = best.filter(|(_, cells)| cells & left != 0)?;
            entries.push((entry, cells & left));
            left &= !cells;
        }
        Some(entries)
    }

    /// The cells that may refer to a root, diagonal steps first and straight steps first.
    fn served_by(&self, block: usize, root: u32, routed: u64) -> [u64; 2] {
        let root = self.roots.roots[root as usize];
        let (column, row) = (block % self.block_columns * 8, block / self.block_columns * 8);
        let mut served = [0; 2];
        for cell in ones(routed) {
            let (column, row) = (column + cell % 8, row + cell / 8);
            let index = self.bordered.index(column, row);
            let at = Cell::new(column as u32, row as u32);
            let ways = ways(root, at, self.bordered.cost[index], self.bordered.moves[index]);
            served[0] |= u64::from(ways & 1) << cell;
            served[1] |= u64::from(ways >> 1) << cell;
        }
        served
    }

    /// Gives blocks their own costs where entries, with their share of the roots they refer to,
    /// would take more bytes.
    fn drop_costly(&self, choices: &mut [Choice]) {
        let mut uses = vec![0u32; self.roots.roots.len()];
        for root in choices.iter().flat_map(roots_of) {
            uses[root as usize] += 1;
        }
        for (block, choice) in choices.iter_mut().enumerate() {
            let Choice::Entries(entries) = &*choice else { continue };
            if entries.len() < 4 {
                continue;
            }
            let bits = entries.len().next_power_of_two().trailing_zeros() as usize;
            let shares =
                roots_of(choice).map(|root| ROOT_BYTES as f32 / uses[root as usize] as f32);
            let bytes = (1 + index_bytes(bits) + 2 * entries.len()) as f32 + shares.sum::<f32>();
            if bytes > own_length(&self.own(block)) as f32 {
                *choice = Choice::Own;
            }
        }
    }

    /// Keeps the roots that are still referred to, oldest first.
    fn number(&self, choices: Vec<Choice>) -> Routes {
        let mut used = vec![false; self.roots.roots.len()];
        for root in choices.iter().flat_map(roots_of) {
            used[root as usize] = true;
        }
        let mut numbers = vec![usize::MAX; used.len()];
        let mut roots = Vec::new();
        for (old, _) in used.iter().enumerate().filter(|&(_, &used)| used).take(MAX_ROOTS) {
            numbers[old] = roots.len();
            roots.push(self.roots.roots[old]);
        }
        let entry = |&(draft, cells): &Draft| {
            if draft == NO_ROUTE_DRAFT {
                return Some((NO_ROUTE_ENTRY, cells));
            }
            let number = numbers[(draft >> 1) as usize];
            (number < MAX_ROOTS).then_some(((number << 1) as u16 | (draft & 1) as u16, cells))
        };
        let blocks = choices.iter().enumerate().map(|(block, choice)| match choice {
            Choice::Own => Block::Own(Box::new(self.own(block))),
            Choice::Entries(entries) => match entries.iter().map(entry).collect() {
                Some(entries) => Block::Palette(entries),
                None => Block::Own(Box::new(self.own(block))),
            },
        });
        Routes { blocks: blocks.collect(), roots }
    }

    /// Code and cost of each cell of a block.
    pub(crate) fn own(&self, block: usize) -> [Option<(u8, u32)>; BLOCK_CELLS] {
        let mut cells = [None; BLOCK_CELLS];
        for (cell, column, row) in self.cells(block) {
            let code = match self.code(column, row) {
                code @ 0..MOVES => code,
                GOAL => OWN_GOAL,
                NO_ROUTE => OWN_NO_ROUTE,
                _ => continue,
            };
            cells[cell] = Some((code, self.bordered.cost[self.bordered.index(column, row)]));
        }
        cells
    }
}

/// The roots that a block refers to; one that it refers to in two ways comes twice.
fn roots_of(choice: &Choice) -> impl Iterator<Item = u32> {
    let entries: &[Draft] = match choice {
        Choice::Entries(entries) => entries,
        Choice::Own => &[],
    };
    entries
        .iter()
        .filter(|&&(draft, _)| draft != NO_ROUTE_DRAFT)
        .map(|&(draft, _)| (draft >> 1) as u32)
}
