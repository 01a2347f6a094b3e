//! Chooses the roots that the cells of each block refer to: few, and shared with neighbouring
//! blocks.

use super::codes::Codes;
use super::encode::{Block, MAX_BLOCK_ENTRIES, OwnCells, index_class};
use super::moves::Bordered;
use super::roots::{NO_ROOT, Roots};
use super::serve::BlockCells;
use crate::field::{GOAL, NO_ROUTE, UNREACHED};
use plan_format::Cell;
use plan_format::layout::{
    BLOCK_CELLS, NO_ROUTE_ENTRY, OWN_4_4, OWN_GOAL, OWN_NO_ROUTE, ROOT_WORDS, Root, WORD_BYTES,
    data_words, own_words,
};

/// Root numbers from here on do not fit an entry.
const MAX_ROOTS: usize = (NO_ROUTE_ENTRY >> 1) as usize;

/// The routes of a field, block by block, and the roots that they refer to.
pub(crate) struct Routes {
    /// The blocks in row-major order.
    pub(crate) blocks: Vec<Block>,
    pub(crate) roots: Vec<Root>,
}

/// Blocks with more nearest roots than this get own cells without a search for the fewest roots; in
/// noise and mazes this saves time.
const MAX_NEAR_ROOTS: usize = 10;
/// Most roots of neighbouring blocks that are tried.
const MAX_HINTS: usize = 4;
/// Ancestors of each nearest root that are tried.
const ANCESTORS: usize = 1;

/// An entry before its root has its final number (twice the number, plus the order of steps), and
/// its cells.
type Draft = (u32, u64);
const NO_ROUTE_DRAFT: u32 = u32::MAX;

/// A block before its roots have their final numbers; `None` for own cells.
type Choice = Option<Vec<Draft>>;

/// The input of the search for entries.
pub(crate) struct Covering<'f> {
    /// The codes of each block in row-major order.
    pub(crate) codes: &'f [Codes],
    pub(crate) bordered: &'f Bordered,
    pub(crate) roots: &'f Roots,
    pub(crate) block_columns: usize,
}

impl Covering<'_> {
    /// Chooses the entries of all blocks.
    #[inline(always)]
    pub(crate) fn choose(&self) -> Routes {
        let mut choices: Vec<Choice> = Vec::with_capacity(self.codes.len());
        for index in 0..self.codes.len() {
            let beside = (index % self.block_columns > 0).then(|| &choices[index - 1]);
            let below = index.checked_sub(self.block_columns).map(|index| &choices[index]);
            let hints = [beside, below].into_iter().flatten().flat_map(roots_of);
            choices.push(self.cover(index, hints));
        }
        self.drop_costly(&mut choices);
        self.number(choices)
    }

    /// The south-west cell of a block.
    #[inline(always)]
    fn corner(&self, block: usize) -> Cell {
        let (column, row) = (block % self.block_columns, block / self.block_columns);
        Cell::new(8 * column as u32, 8 * row as u32)
    }

    /// Entries that serve every cell of a block with a route, as few as a greedy search finds.
    #[inline(always)]
    fn cover(&self, block: usize, hints: impl Iterator<Item = u32>) -> Choice {
        let codes = &self.codes[block];
        let routed = codes.up_to(GOAL);
        if routed != 0 && self.roots.roots.is_empty() {
            return None;
        }
        let no_route = codes.equal_to(NO_ROUTE);
        let mut entries =
            if routed == 0 { Vec::new() } else { self.fewest(self.corner(block), routed, hints)? };
        if no_route != 0 {
            entries.push((NO_ROUTE_DRAFT, no_route));
        }
        (entries.len() <= MAX_BLOCK_ENTRIES).then_some(entries)
    }

    #[inline(always)]
    fn fewest(&self, corner: Cell, routed: u64, hints: impl Iterator<Item = u32>) -> Choice {
        let near = self.near(corner, routed)?;
        let cells = BlockCells::new(self.bordered, corner, routed);
        let room = 2 * (MAX_HINTS + MAX_NEAR_ROOTS * (1 + ANCESTORS));
        let (tried, served) = (Vec::with_capacity(room), Vec::with_capacity(room));
        let mut candidates = Candidates { cells: &cells, tried, served };
        // Neighbours' roots come first, since the first of equals is chosen.
        let beyond = near.iter().flat_map(|&root| self.ancestors(root));
        for root in hints.take(MAX_HINTS).chain(near.iter().copied()).chain(beyond) {
            if let Some(entry) = candidates.add(root, self.roots) {
                return Some(vec![(entry, routed)]);
            }
        }
        candidates.greedy()
    }

    /// The ancestors of a root, on the way to the goal.
    fn ancestors(&self, root: u32) -> impl Iterator<Item = u32> {
        let parent = |&root: &u32| {
            Some(self.roots.parents[root as usize]).filter(|&parent| parent != NO_ROOT)
        };
        std::iter::successors(parent(&root), parent).take(ANCESTORS)
    }

    /// The nearest roots of a block's cells; `None` if there are too many or a cell has none.
    #[inline(always)]
    fn near(&self, corner: Cell, routed: u64) -> Option<Vec<u32>> {
        let mut near: Vec<u32> = Vec::with_capacity(MAX_NEAR_ROOTS);
        let mut last = NO_ROOT;
        for (y, mut left) in routed.to_le_bytes().into_iter().enumerate() {
            let start = self.bordered.index(corner.column as usize, corner.row as usize + y);
            while left != 0 {
                let root = self.roots.of_cell[start + left.trailing_zeros() as usize];
                left &= left - 1;
                if root == last || near.contains(&root) {
                    continue;
                }
                if root == NO_ROOT || near.len() == MAX_NEAR_ROOTS {
                    return None;
                }
                near.push(root);
                last = root;
            }
        }
        Some(near)
    }

    /// Gives a block own cells if its entries, with their share of the roots that they refer to,
    /// would take more bytes.
    fn drop_costly(&self, choices: &mut [Choice]) {
        let mut uses = vec![0u32; self.roots.roots.len()];
        for root in choices.iter().flat_map(roots_of) {
            uses[root as usize] += 1;
        }
        for choice in choices {
            let entries = choice.as_deref().unwrap_or_default();
            if entries.len() < 4 {
                continue;
            }
            let root_bytes = (ROOT_WORDS as usize * WORD_BYTES) as f32;
            let shares = roots_of(choice).map(|root| root_bytes / uses[root as usize] as f32);
            let indices = data_words(index_class(entries.len())) * WORD_BYTES;
            let bytes = (indices + 2 * entries.len()) as f32 + shares.sum::<f32>();
            let cells = entries.iter().map(|(_, cells)| cells.count_ones()).sum::<u32>();
            if bytes > (WORD_BYTES * own_words(OWN_4_4, cells as usize)) as f32 {
                *choice = None;
            }
        }
    }

    /// Keeps the roots that are still used, oldest first, and renumbers them.
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
        let entry = |(draft, cells): Draft| {
            if draft == NO_ROUTE_DRAFT {
                return Some((NO_ROUTE_ENTRY, cells));
            }
            let number = numbers[(draft >> 1) as usize];
            (number < MAX_ROOTS).then_some(((number << 1) as u32 | draft & 1, cells))
        };
        let block = |choice: Choice| {
            let entries = choice.and_then(|entries| entries.into_iter().map(entry).collect());
            entries.map_or(Block::Own, Block::Palette)
        };
        Routes { blocks: choices.into_iter().map(block).collect(), roots }
    }

    /// Writes the words of a block whose cells have their own code and cost. Returns the width of
    /// the costs.
    pub(crate) fn own(&self, block: usize, words: &mut Vec<u32>) -> u32 {
        struct Write<'c>(&'c Covering<'c>, usize, &'c mut Vec<u32>);
        impl pulp::WithSimd for Write<'_> {
            type Output = u32;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) -> u32 {
                let Self(covering, block, words) = self;
                let codes = &covering.codes[block];
                own_cells(covering.bordered, codes, covering.corner(block)).write(words)
            }
        }
        pulp::Arch::new().dispatch(Write(self, block, words))
    }
}

/// Code and cost of each cell of a block, from its codes and its south-west cell.
#[inline(always)]
pub(crate) fn own_cells(bordered: &Bordered, codes: &Codes, corner: Cell) -> OwnCells {
    let mut own = OwnCells::new();
    for (row, codes) in (corner.row as usize..).zip(codes.0.chunks(8)) {
        let costs = bordered.cost.get(bordered.index(corner.column as usize, row)..);
        let costs = costs.unwrap_or_default();
        for (column, &code) in codes.iter().enumerate() {
            let cost = costs.get(column).copied().unwrap_or(UNREACHED);
            own.add(row % 8 * 8 + column, code <= NO_ROUTE, code, cost);
        }
    }
    own
}

const _: () = assert!(OWN_GOAL == GOAL && OWN_NO_ROUTE == NO_ROUTE, "codes are stored as they are");

/// Roots that are tried on a block.
struct Candidates<'c> {
    cells: &'c BlockCells,
    tried: Vec<u32>,
    /// Entries, each with the cells that it serves.
    served: Vec<Draft>,
}

impl Candidates<'_> {
    /// Tries a root. Returns an entry if it serves all cells.
    #[inline(always)]
    fn add(&mut self, root: u32, roots: &Roots) -> Option<u32> {
        if self.tried.contains(&root) {
            return None;
        }
        self.tried.push(root);
        for (way, cells) in self.cells.served_by(roots.roots[root as usize]).into_iter().enumerate()
        {
            let entry = root << 1 | way as u32;
            if cells == self.cells.routed {
                return Some(entry);
            }
            if cells != 0 {
                self.served.push((entry, cells));
            }
        }
        None
    }

    /// A greedy cover: repeatedly takes the entry that serves the most remaining cells. `None` if a
    /// cell remains, which its nearest root should prevent, or if there are too many entries.
    #[inline(always)]
    fn greedy(mut self) -> Choice {
        let mut left = self.cells.routed;
        let mut entries: Vec<Draft> = Vec::with_capacity(MAX_BLOCK_ENTRIES);
        while left != 0 {
            // The first of the best, since neighbours' roots come first.
            let (mut best, mut most) = ((0, 0), 0);
            self.served.retain_mut(|(entry, cells)| {
                *cells &= left;
                let count = cells.count_ones();
                (best, most) = if count > most { ((*entry, *cells), count) } else { (best, most) };
                count > 0
            });
            if most == 0 || entries.len() == MAX_BLOCK_ENTRIES {
                return None;
            }
            entries.push(best);
            left &= !best.1;
        }
        Some(entries)
    }
}

/// The roots that a block refers to. A root with both orders of steps occurs twice.
fn roots_of(choice: &Choice) -> impl Iterator<Item = u32> {
    let entries = choice.as_deref().unwrap_or_default();
    entries.iter().filter(|&&(draft, _)| draft != NO_ROUTE_DRAFT).map(|&(draft, _)| draft >> 1)
}

const _: () = assert!(BLOCK_CELLS == u64::BITS as usize);
