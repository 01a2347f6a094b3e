//! One internalized plan: the answer of every cell to "where to from here?".
//!
//! W, section 2: "the robot's current location is used as an index into the plan". Plane `terrain`
//! holds whether a cell is free and, if it is not, how to leave it. Plane `routes` gives each free
//! cell a *root*: another cell, which an optimal path reaches in as few steps as without obstacles.
//! So `cost = cost(root) + octile(cell, root)`, exactly, and the direction is towards the root. If
//! roots would take more space, a block holds the code and the cost of each cell instead.

use crate::directory::{Counts, LayerRecord};
use crate::error::BlobError;
use crate::grid::{Cell, Direction};
use crate::layout::{
    NO_ROUTE_ENTRY, OWN_GOAL, ROOT_WORDS, ROUTE_BITS, Root, TERRAIN_BITS, Terrain, WORD_BYTES,
    first_step, superblocks,
};
use crate::names::Name;
use crate::plane::{BlockAddress, Own, Plane, Stored};
use crate::record::Table;
use crate::words::Words;
use crate::work::Work;

/// A layer's answer for a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Free, with a route.
    Move {
        /// An optimal first step.
        direction: Direction,
        /// Cost to the goal in units of 1/5741 cell; see [`crate::grid::cost_metres`].
        cost: u32,
    },
    /// The goal itself.
    Goal,
    /// Free, without a route to the goal.
    NoRoute,
    /// An obstacle of this layer.
    Blocked {
        /// First step towards the nearest free cell with a route; `None` if there is no such cell.
        escape: Option<Direction>,
    },
    /// Outside the map.
    OffMap,
}

/// A layer's answer for a cell, without the cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Free, with a route that begins with this optimal step.
    Move(Direction),
    /// The goal itself.
    Goal,
    /// Free, without a route to the goal.
    NoRoute,
    /// An obstacle of this layer.
    Blocked {
        /// First step towards the nearest free cell with a route; `None` if there is no such cell.
        escape: Option<Direction>,
    },
    /// Outside the map.
    OffMap,
}

/// One layer, read in place.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    /// Section `cells`; the offsets below count its words.
    pub(crate) section: Words<'a>,
    /// Where the table of plane `terrain` begins.
    pub(crate) terrain: u32,
    /// Where the table of plane `routes` begins.
    pub(crate) routes: u32,
    /// Where the roots begin.
    pub(crate) roots: u32,
    pub(crate) root_count: u32,
    pub(crate) bytes: u32,
    pub(crate) counts: Counts,
    pub(crate) names: &'a [u8],
    pub(crate) name: Name,
    pub(crate) rank: u8,
}

/// The parts of a layer that are not proved yet, because no earlier layer shares them.
#[derive(Clone, Copy)]
pub(crate) struct Unproved {
    /// Plane `terrain`.
    pub(crate) terrain: bool,
    /// The roots.
    pub(crate) roots: bool,
    /// The fewest roots of the layers that share plane `routes`; `None` if the plane is proved.
    pub(crate) routes_of_roots: Option<u32>,
}

impl Unproved {
    /// The unproved parts of a layer, from its number and all layer records of the blob.
    pub(crate) fn of(number: usize, record: &LayerRecord, layers: Table<'_, LayerRecord>) -> Self {
        let (mut terrain, mut roots, mut routes) = (true, true, true);
        let mut fewest = record.root_count;
        for (index, other) in layers.iter().enumerate() {
            let is_earlier = index < number;
            if other.routes == record.routes {
                fewest = fewest.min(other.root_count);
                routes &= !is_earlier;
            }
            if is_earlier {
                terrain &= other.terrain != record.terrain;
                roots &= (other.roots, other.root_count) != (record.roots, record.root_count);
            }
        }
        Self { terrain, roots, routes_of_roots: routes.then_some(fewest.into()) }
    }
}

/// What the planes hold for a cell.
enum Found {
    Root { number: u32, straight_first: bool },
    Own(Own),
    NoRoute,
    Blocked(Option<Direction>),
    OffMap,
}

impl<'a> Layer<'a> {
    /// Its name, unique within its plan.
    pub fn name(&self) -> &'a str {
        // Names were validated.
        self.name.text(self.names).unwrap_or_default()
    }

    /// Position of its constraints in the mission's order, 0 for obstacles only. Layers of one name
    /// have the same rank in all plans; a plan may lack some of them.
    pub fn rank(&self) -> usize {
        usize::from(self.rank)
    }

    /// Bytes that the layer added to the blob. Bytes that it shares count for the earliest layer.
    pub fn bytes(&self) -> usize {
        self.bytes as usize
    }

    /// Bytes of the layer as plain arrays: 4 bits of advice and 32 bits of cost per cell.
    pub fn raw_bytes(&self) -> usize {
        let cells = self.columns as usize * self.rows as usize;
        cells.div_ceil(2) + 4 * cells
    }

    /// The number of cells of each kind.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The answer for a cell. Constant time; never fails.
    pub fn look_up(&self, cell: Cell) -> Answer {
        // Both planes were validated, so each read succeeds.
        match self.find(cell) {
            Found::Root { number, straight_first } => {
                self.root(number).map_or(Answer::NoRoute, |root| answer(root, cell, straight_first))
            }
            Found::Own(own) => match (own.code(self.section), own.cost(self.section)) {
                (Some(code @ 0..=7), Some(cost)) => {
                    Answer::Move { direction: Direction::from_code(code as u8), cost }
                }
                (Some(code), _) if code == OWN_GOAL.into() => Answer::Goal,
                _ => Answer::NoRoute,
            },
            Found::NoRoute => Answer::NoRoute,
            Found::Blocked(escape) => Answer::Blocked { escape },
            Found::OffMap => Answer::OffMap,
        }
    }

    /// As [`Layer::look_up`], without the cost and in a sixth less time.
    pub fn step(&self, cell: Cell) -> Step {
        match self.find(cell) {
            Found::Root { number, straight_first } => match self.root_cell(number) {
                Some(root) => first_step(cell, root, straight_first).map_or(Step::Goal, Step::Move),
                None => Step::NoRoute,
            },
            Found::Own(own) => match own.code(self.section) {
                Some(code @ 0..=7) => Step::Move(Direction::from_code(code as u8)),
                Some(code) if code == OWN_GOAL.into() => Step::Goal,
                _ => Step::NoRoute,
            },
            Found::NoRoute => Step::NoRoute,
            Found::Blocked(escape) => Step::Blocked { escape },
            Found::OffMap => Step::OffMap,
        }
    }

    #[inline(always)]
    fn find(&self, cell: Cell) -> Found {
        if cell.column >= self.columns || cell.row >= self.rows {
            return Found::OffMap;
        }
        let address = BlockAddress::new(cell, superblocks(self.columns));
        match self.terrain_at(address) {
            Terrain::Free => {}
            Terrain::NoEscape => return Found::Blocked(None),
            Terrain::Escape(direction) => return Found::Blocked(Some(direction)),
        }
        match self.routes().get(address) {
            Some(Stored::Entry(entry)) if entry != NO_ROUTE_ENTRY => {
                Found::Root { number: entry >> 1, straight_first: entry & 1 == 1 }
            }
            Some(Stored::Own(own)) => Found::Own(own),
            _ => Found::NoRoute,
        }
    }

    #[inline(always)]
    fn terrain_at(&self, address: BlockAddress) -> Terrain {
        match self.terrain().get(address) {
            Some(Stored::Entry(entry)) => Terrain::of_entry(entry),
            _ => Terrain::NoEscape,
        }
    }

    #[inline(always)]
    fn terrain(&self) -> Plane<'a, TERRAIN_BITS> {
        Plane { section: self.section, table: self.terrain }
    }

    #[inline(always)]
    fn routes(&self) -> Plane<'a, ROUTE_BITS> {
        Plane { section: self.section, table: self.routes }
    }

    #[inline(always)]
    fn root_cell(&self, number: u32) -> Option<Cell> {
        self.section.get(self.roots.wrapping_add(number * ROOT_WORDS)).map(Cell::of_word)
    }

    #[inline(always)]
    fn root(&self, number: u32) -> Option<Root> {
        let cost = self.section.get(self.roots.wrapping_add(number * ROOT_WORDS + 1))?;
        Some(Root { cell: self.root_cell(number)?, cost })
    }

    /// Proves once that no look-up can fail. The parts that are not `unproved` were proved with an
    /// earlier layer.
    pub(crate) fn validate(
        &self,
        unproved: Unproved,
        work: &mut Work<impl FnMut()>,
    ) -> Result<(), BlobError> {
        let count = superblocks(self.columns) * superblocks(self.rows);
        let counted = u64::from(self.counts.free)
            + u64::from(self.counts.blocked)
            + u64::from(self.counts.unreachable);
        if counted != u64::from(self.columns) * u64::from(self.rows) {
            return Err(BlobError::Cells);
        }
        if unproved.roots {
            work.spend(self.root_count)?;
            self.validate_roots().ok_or(BlobError::Cells)?;
        }
        if unproved.terrain {
            self.terrain().validate(count, false, Terrain::is_entry, work)?;
        }
        if let Some(roots) = unproved.routes_of_roots {
            let is_route = |entry: u32| entry == NO_ROUTE_ENTRY || entry >> 1 < roots;
            self.routes().validate(count, true, is_route, work)?;
        }
        Ok(())
    }

    fn validate_roots(&self) -> Option<()> {
        let roots = self.section.range(self.roots, self.root_count * ROOT_WORDS)?;
        let mut roots = roots.iter().step_by(ROOT_WORDS as usize);
        let fit = roots.all(|root| {
            let [x0, x1, y0, y1]: [u8; WORD_BYTES] = *root;
            u32::from(u16::from_le_bytes([x0, x1])) < self.columns
                && u32::from(u16::from_le_bytes([y0, y1])) < self.rows
        });
        fit.then_some(())
    }
}

/// The answer for a cell with this root.
#[inline(always)]
fn answer(root: Root, cell: Cell, straight_first: bool) -> Answer {
    match first_step(cell, root.cell, straight_first) {
        Some(direction) => Answer::Move { direction, cost: root.cost_from(cell) },
        None => Answer::Goal,
    }
}
