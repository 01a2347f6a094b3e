//! Chooses roots and corrections for the cells of each block of a field with tolls: few of both, and
//! shared with neighbouring blocks.
//!
//! A cell's root decides its correction. A greedy search takes the pair of a root and a correction that
//! serves the most remaining cells for what it adds to the palettes.

use super::codes::Codes;
use super::encode::{Block, MAX_BLOCK_ENTRIES, index_class, ones, too_many};
use super::moves::Bordered;
use super::roots::{NO_ROOT, directions};
use super::tolled::{Site, Sites};
use crate::field::{GOAL, NO_ROUTE};
use plan_format::Cell;
use plan_format::layout::{
    BLOCK_CELLS, BLOCKS, CORRECTION_BITS, Correction, NO_ROUTE_ENTRY, OWN_24, WORD_BYTES,
    data_words, own_words,
};
use std::collections::HashMap;

/// Root numbers from here on do not fit an entry.
const MAX_ROOTS: usize = (NO_ROUTE_ENTRY >> 1) as usize;
/// Numbers of corrections from here on do not fit an entry.
const MAX_CORRECTIONS: usize = 1 << CORRECTION_BITS;
/// Most nearest roots of a block that are tried.
const MAX_NEAR_ROOTS: usize = 24;
/// Most roots of each neighbouring block that are tried.
const MAX_HINTS: usize = 6;
/// What a further root costs in the search, against 1 for a pair of known ones.
const ROOT_PRICE: f32 = 3.0;
/// What a further correction costs in the search.
const CORRECTION_PRICE: f32 = 2.0;
/// The same for one that a neighbouring block has.
const KNOWN_CORRECTION_PRICE: f32 = 1.5;

/// A set of entries, each with its cells.
type Entries = Vec<(u32, u64)>;

/// A block before numbers are final; `None` for own cells.
type Choice = Option<Pair>;

/// The entries of a block in both planes: roots (twice the number, plus the order) and corrections.
#[derive(Clone, Default)]
struct Pair {
    roots: Entries,
    corrections: Entries,
}

/// The packed parts of a field with tolls.
pub(crate) struct Packed {
    pub(crate) routes: Vec<Block>,
    pub(crate) corrections: Vec<Block>,
    pub(crate) roots: Vec<u32>,
    pub(crate) values: Vec<u32>,
}

/// The input of the search.
pub(crate) struct Search<'f> {
    pub(crate) codes: &'f [Codes],
    pub(crate) bordered: &'f Bordered,
    pub(crate) sites: &'f Sites,
    pub(crate) block_columns: usize,
}

const NO_ROUTE_DRAFT: u32 = u32::MAX;

impl Search<'_> {
    /// Chooses the entries of all blocks.
    pub(crate) fn choose(&self) -> Packed {
        let mut choices: Vec<Choice> = Vec::with_capacity(self.codes.len());
        for index in 0..self.codes.len() {
            let beside = (index % self.block_columns > 0).then(|| &choices[index - 1]);
            let below = index.checked_sub(self.block_columns).map(|index| &choices[index]);
            let known: Vec<&Pair> = [beside, below].into_iter().flatten().flatten().collect();
            let choice = self.block(index, &known);
            choices.push(choice);
        }
        self.drop_costly(&mut choices);
        self.number(choices)
    }

    fn block(&self, block: usize, known: &[&Pair]) -> Choice {
        let codes = &self.codes[block];
        let (routed, no_route) = (codes.up_to(GOAL), codes.equal_to(NO_ROUTE));
        let mut pair =
            if routed == 0 { Pair::default() } else { self.cover(block, routed, known)? };
        if no_route != 0 {
            pair.roots.push((NO_ROUTE_DRAFT, no_route));
        }
        let fits = pair.roots.len().max(pair.corrections.len()) <= MAX_BLOCK_ENTRIES;
        fits.then_some(pair)
    }

    /// Entries that serve every cell of a block with a route; `None` if there are too many.
    fn cover(&self, block: usize, routed: u64, known: &[&Pair]) -> Choice {
        let (column, row) = (block % self.block_columns, block / self.block_columns);
        let cells = Cells::new(self.bordered, Cell::new(8 * column as u32, 8 * row as u32), routed);
        let near = self.near(&cells)?;
        let hints = known.iter().flat_map(|pair| {
            let roots = pair.roots.iter().filter(|entry| entry.0 != NO_ROUTE_DRAFT);
            roots.take(MAX_HINTS).map(|entry| entry.0 >> 1)
        });
        let beyond = near.iter().map(|&root| self.sites.parents[root as usize]);
        let mut candidates: Vec<u32> = Vec::with_capacity(2 * MAX_NEAR_ROOTS + 2 * MAX_HINTS);
        let mut groups = Vec::with_capacity(256);
        for root in hints.chain(near.iter().copied()).chain(beyond) {
            if root == NO_ROOT || candidates.contains(&root) {
                continue;
            }
            candidates.push(root);
            if let Some(all) = cells.groups(root, &self.sites.roots[root as usize], &mut groups) {
                let corrections = vec![(all.correction, routed)];
                return Some(Pair { roots: vec![(all.entry, routed)], corrections });
            }
        }
        let corrections: Vec<u32> =
            known.iter().flat_map(|pair| &pair.corrections).map(|entry| entry.0).collect();
        greedy(groups, routed, &corrections)
    }

    /// The roots of a block's cells; `None` if there are too many or a cell has none.
    fn near(&self, cells: &Cells) -> Option<Vec<u32>> {
        let mut near: Vec<u32> = Vec::with_capacity(MAX_NEAR_ROOTS);
        for at in ones(cells.routed) {
            let root = self.sites.of_cell[cells.index[at]];
            if near.contains(&root) {
                continue;
            }
            if root == NO_ROOT || near.len() == MAX_NEAR_ROOTS {
                return None;
            }
            near.push(root);
        }
        Some(near)
    }

    /// Gives a block own cells if its entries would take more bytes.
    fn drop_costly(&self, choices: &mut [Choice]) {
        let mut uses = vec![0u32; self.sites.roots.len()];
        for root in choices.iter().flatten().flat_map(roots_of) {
            uses[root as usize] += 1;
        }
        for choice in choices {
            let Some(pair) = choice.as_ref() else { continue };
            let shares = roots_of(pair).map(|root| 8.0 / uses[root as usize] as f32);
            let plane = |entries: usize| {
                (data_words(index_class(entries)) * WORD_BYTES + 2 * entries) as f32
            };
            let bytes =
                plane(pair.roots.len()) + plane(pair.corrections.len()) + shares.sum::<f32>();
            let cells = pair.roots.iter().map(|(_, cells)| cells.count_ones()).sum::<u32>();
            if bytes > (WORD_BYTES * own_words(OWN_24, cells as usize)) as f32 {
                *choice = None;
            }
        }
    }

    /// Numbers the roots and the corrections that are used.
    fn number(&self, choices: Vec<Choice>) -> Packed {
        let mut used = vec![false; self.sites.roots.len()];
        for root in choices.iter().flatten().flat_map(roots_of) {
            used[root as usize] = true;
        }
        let mut numbers = vec![usize::MAX; used.len()];
        let mut roots = Vec::new();
        for (old, _) in used.iter().enumerate().filter(|&(_, &used)| used).take(MAX_ROOTS) {
            numbers[old] = roots.len();
            roots.push(self.sites.roots[old].stored());
        }
        let values = values(&choices);
        let places: HashMap<u32, u32> = values.iter().copied().zip(0..).collect();
        let root = |&(draft, cells): &(u32, u64)| {
            if draft == NO_ROUTE_DRAFT {
                return Some((NO_ROUTE_ENTRY, cells));
            }
            let number = numbers[(draft >> 1) as usize];
            (number < MAX_ROOTS).then_some(((number << 1) as u32 | draft & 1, cells))
        };
        let correction = |&(value, cells): &(u32, u64)| Some((*places.get(&value)?, cells));
        let (mut routes, mut corrections) = (Vec::new(), Vec::new());
        for choice in &choices {
            let entries = choice.as_ref().and_then(|pair| {
                let roots: Option<Entries> = pair.roots.iter().map(root).collect();
                let corrections: Option<Entries> =
                    pair.corrections.iter().map(correction).collect();
                Some((roots?, corrections?))
            });
            let (own, nothing) = (Block::Own, Block::Palette(Vec::new()));
            let (route, rest) = entries.map_or((own, nothing), |(roots, corrections)| {
                (Block::Palette(roots), Block::Palette(corrections))
            });
            routes.push(route);
            corrections.push(rest);
        }
        self.make_room(&mut routes, &mut corrections);
        let roots = roots.into_iter().flat_map(|root| root.words()).collect();
        Packed { routes, corrections, roots, values }
    }

    /// Gives own cells to blocks whose corrections do not fit the palettes of their superblocks.
    fn make_room(&self, routes: &mut [Block], corrections: &mut [Block]) {
        let columns = self.block_columns;
        let block_rows = corrections.len().checked_div(columns).unwrap_or(0);
        for row in (0..block_rows).step_by(4) {
            for column in (0..columns).step_by(4) {
                let index = |at: usize| (row + at / 4) * columns + column + at % 4;
                let sixteen: [&Block; BLOCKS] = std::array::from_fn(|at| &corrections[index(at)]);
                for at in too_many(&sixteen) {
                    routes[index(at)] = Block::Own;
                    corrections[index(at)] = Block::Palette(Vec::new());
                }
            }
        }
    }
}

/// The corrections in use, the most frequent first, as many as can be numbered; at least one.
fn values(choices: &[Choice]) -> Vec<u32> {
    let mut uses: HashMap<u32, u32> = HashMap::new();
    for &(value, _) in choices.iter().flatten().flat_map(|pair| &pair.corrections) {
        *uses.entry(value).or_default() += 1;
    }
    uses.entry(Correction::NONE.word()).or_default();
    let mut values: Vec<(u32, u32)> = uses.into_iter().map(|(value, uses)| (uses, value)).collect();
    values.sort_unstable_by_key(|&(uses, value)| (std::cmp::Reverse(uses), value));
    values.into_iter().map(|(_, value)| value).take(MAX_CORRECTIONS).collect()
}

/// The roots that a block refers to. A root with both orders of steps occurs twice.
fn roots_of(pair: &Pair) -> impl Iterator<Item = u32> {
    pair.roots.iter().filter(|entry| entry.0 != NO_ROUTE_DRAFT).map(|entry| entry.0 >> 1)
}

/// The cells of a block that have a route.
struct Cells {
    routed: u64,
    corner: Cell,
    cost: [u32; BLOCK_CELLS],
    moves: [u8; BLOCK_CELLS],
    /// Of each cell in [`Bordered`].
    index: [usize; BLOCK_CELLS],
}

/// Cells that a root serves with one correction.
#[derive(Clone, Copy)]
struct Group {
    entry: u32,
    /// The word of the correction.
    correction: u32,
    cells: u64,
}

impl Cells {
    fn new(bordered: &Bordered, corner: Cell, routed: u64) -> Self {
        let mut this = Self {
            routed,
            corner,
            cost: [0; BLOCK_CELLS],
            moves: [0; BLOCK_CELLS],
            index: [0; BLOCK_CELLS],
        };
        for at in ones(routed) {
            let index = bordered.index_of(this.cell(at));
            (this.cost[at], this.moves[at]) = (bordered.cost[index], bordered.moves[index]);
            this.index[at] = index;
        }
        this
    }

    fn cell(&self, at: usize) -> Cell {
        Cell::new(self.corner.column + at as u32 % 8, self.corner.row + at as u32 / 8)
    }

    /// Adds the cells that a root serves, by correction and order of steps. Returns a group that has all
    /// cells, if there is one.
    fn groups(&self, number: u32, root: &Site, groups: &mut Vec<Group>) -> Option<Group> {
        let first = groups.len();
        for at in ones(self.routed) {
            let cell = self.cell(at);
            let excess = root.excess(cell, self.cost[at]);
            let mut add = |order, step| {
                let Some(correction) = Correction::new(excess, step) else { return };
                let (entry, correction) = (number << 1 | order, correction.word());
                let is_it =
                    |group: &&mut Group| group.entry == entry && group.correction == correction;
                match groups[first..].iter_mut().find(is_it) {
                    Some(group) => group.cells |= 1 << at,
                    None => groups.push(Group { entry, correction, cells: 1 << at }),
                }
            };
            let leads = root.leads(cell, self.moves[at]);
            for (order, _) in (0..).zip(leads).filter(|&(_, leads)| leads) {
                add(order, None);
            }
            for direction in directions(self.moves[at]) {
                for order in 0..2 {
                    add(order, Some(direction));
                }
            }
        }
        groups[first..].iter().find(|group| group.cells == self.routed).copied()
    }
}

/// Repeatedly takes the group that serves the most remaining cells for its price. `None` if a cell
/// remains, which its own root should prevent, or if there are too many entries.
fn greedy(mut groups: Vec<Group>, routed: u64, hints: &[u32]) -> Choice {
    let mut pair = Pair::default();
    let mut left = routed;
    while left != 0 {
        let mut best: Option<(f32, Group)> = None;
        groups.retain_mut(|group| {
            group.cells &= left;
            if group.cells == 0 {
                return false;
            }
            let has = |entries: &Entries, wanted| entries.iter().any(|entry| entry.0 == wanted);
            let mut price = 1.0;
            if !has(&pair.roots, group.entry) {
                price += ROOT_PRICE;
            }
            if !has(&pair.corrections, group.correction) {
                let is_hint = group.correction == Correction::NONE.word()
                    || hints.contains(&group.correction);
                price += if is_hint { KNOWN_CORRECTION_PRICE } else { CORRECTION_PRICE };
            }
            let worth = group.cells.count_ones() as f32 / price;
            // The first of equals, since neighbours' roots come first.
            if best.is_none_or(|(most, _)| worth > most) {
                best = Some((worth, *group));
            }
            true
        });
        let (_, group) = best?;
        left &= !group.cells;
        add(&mut pair.roots, group.entry, group.cells);
        add(&mut pair.corrections, group.correction, group.cells);
        if pair.roots.len().max(pair.corrections.len()) > MAX_BLOCK_ENTRIES {
            return None;
        }
    }
    Some(pair)
}

fn add(entries: &mut Entries, wanted: u32, cells: u64) {
    match entries.iter_mut().find(|entry| entry.0 == wanted) {
        Some(entry) => entry.1 |= cells,
        None => entries.push((wanted, cells)),
    }
}
