//! One internalized plan: the answer of every cell to "where to from here?".
//!
//! W, section 2: "the robot's current location is used as an index into the plan". Plane `terrain`
//! holds whether a cell is free and, if it is not, how to leave it. Plane `routes` gives each free
//! cell a *root*: another cell, which an optimal path reaches in as few steps as without obstacles.
//! So `cost = cost(root) + octile(cell, root)`, exactly, and the direction is towards the root. If
//! roots would take more space, a block holds the code and the cost of each cell instead.
//!
//! In a layer with *tolls*, a step costs a multiple, by the cell that it leaves. There a root has a
//! multiplier of its own, and plane `corrections` holds what a cell's cost differs from
//! `cost(root) + multiplier(root) * octile(cell, root)`, and the step if it is not towards the root. A
//! plane `limits` may limit the speed.
//!
//! In a plan with several goals, a route leads to the one that costs least, and plane `goals` holds
//! which one that is.

use crate::directory::{Counts, LayerRecord};
use crate::error::BlobError;
use crate::grid::{Cell, Direction};
use crate::layout::{
    CORRECTION_BITS, Correction, GOAL_BITS, GOALS_WORDS, LIMIT_BITS, NO_LIMIT, NO_ROUTE_ENTRY,
    NO_TABLE, OWN_GOAL, ROOT_WORDS, ROUTE_BITS, Root, TERRAIN_BITS, TOLL_WORDS, Terrain,
    TolledRoot, WORD_BYTES, first_step, superblocks, tolled_cost,
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
    /// Whether it has tolls: then [`crate::layout::TollHeader`] precedes the roots.
    pub(crate) has_tolls: bool,
    /// Costs count 1/2^unit of 1/5741 cell.
    pub(crate) unit: u8,
    /// Whether the plan has several goals: then [`GOALS_WORDS`] words precede the roots and the header
    /// of tolls.
    pub(crate) has_several_goals: bool,
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
            let has_equal_roots =
                (other.roots, other.root_count) == (record.roots, record.root_count);
            if other.routes == record.routes {
                fewest = fewest.min(other.root_count);
                routes &= !is_earlier;
            }
            if is_earlier {
                terrain &= other.terrain != record.terrain;
                let has_equal_headers = other.has_tolls() == record.has_tolls()
                    && other.has_several_goals() == record.has_several_goals();
                roots &= !(has_equal_roots && has_equal_headers);
            }
        }
        Self { terrain, roots, routes_of_roots: routes.then_some(fewest.into()) }
    }
}

/// What the planes hold for a cell.
enum Found {
    Root { number: u32, straight_first: bool, address: BlockAddress },
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

    /// Whether steps cost more in some cells than in others.
    pub fn has_tolls(&self) -> bool {
        self.has_tolls
    }

    /// Whether its plan has several goals.
    pub fn has_several_goals(&self) -> bool {
        self.has_several_goals
    }

    /// The unit of [`Layer::look_up_exact`]: costs count 1/2^unit of 1/5741 cell. 0 without tolls.
    pub fn unit(&self) -> u8 {
        self.unit
    }

    /// The speed limit in a cell, m/s; `None` if there is none, or off the map.
    pub fn speed_limit(&self, cell: Cell) -> Option<f32> {
        if !self.has_tolls || cell.column >= self.columns || cell.row >= self.rows {
            return None;
        }
        let table = self.toll_word(3).filter(|&table| table != NO_TABLE)?;
        let plane = Plane::<LIMIT_BITS> { section: self.section, table };
        match plane.get(BlockAddress::new(cell, superblocks(self.columns)))? {
            Stored::Entry(entry) if entry != NO_LIMIT => Some(entry as f32 / 100.0),
            _ => None,
        }
    }

    /// The number of the goal that following the advice from a cell reaches; see
    /// [`crate::ParallelPlan::goal_at`]. 0 if the plan has one goal. Any number for a cell without a
    /// route, and off the map. Constant time.
    #[inline(never)]
    pub fn goal_number(&self, cell: Cell) -> u8 {
        let number = || {
            if !self.has_several_goals || cell.column >= self.columns || cell.row >= self.rows {
                return None;
            }
            match self.goals()?.get(BlockAddress::new(cell, superblocks(self.columns)))? {
                Stored::Entry(number) => Some(number as u8),
                Stored::Own(_) => None,
            }
        };
        number().unwrap_or(0)
    }

    /// The answer for a cell. Constant time; never fails. Costs are rounded down to whole units of
    /// 1/5741 cell.
    pub fn look_up(&self, cell: Cell) -> Answer {
        match self.look_up_exact(cell) {
            Answer::Move { direction, cost } => Answer::Move { direction, cost: cost >> self.unit },
            other => other,
        }
    }

    /// As [`Layer::look_up`], with the cost in the layer's own [unit](Layer::unit).
    #[inline(always)]
    pub fn look_up_exact(&self, cell: Cell) -> Answer {
        // The planes were validated, so each read succeeds.
        match self.find(cell) {
            Found::Root { number, straight_first, address } if self.has_tolls => {
                self.tolled_answer(number, straight_first, address, cell).unwrap_or(Answer::NoRoute)
            }
            Found::Root { number, straight_first, .. } => {
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
            Found::Root { number, straight_first, address } => match self.root_cell(number) {
                Some(root) => self
                    .corrected_step(address)
                    .or_else(|| first_step(cell, root, straight_first))
                    .map_or(Step::Goal, Step::Move),
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
                Found::Root { number: entry >> 1, straight_first: entry & 1 == 1, address }
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
        let word = self.section.get(self.roots.wrapping_add(number * ROOT_WORDS))?;
        // Without tolls, the bits of the multiplier are 0.
        Some(if self.has_tolls { TolledRoot::cell_of(word) } else { Cell::of_word(word) })
    }

    /// Plane `goals`, if the plan has several goals.
    fn goals(&self) -> Option<Plane<'a, GOAL_BITS>> {
        let table = self.goals_word(0)?;
        Some(Plane { section: self.section, table })
    }

    /// A word of the header of several goals, which precedes the roots and the header of tolls.
    fn goals_word(&self, index: u32) -> Option<u32> {
        let before = GOALS_WORDS + if self.has_tolls { TOLL_WORDS } else { 0 };
        self.section.get(self.roots.wrapping_sub(before).wrapping_add(index))
    }

    /// Where the list of the plan's goals begins: their number, then the goals; `None` if there is one
    /// goal.
    pub(crate) fn goal_list(&self) -> Option<u32> {
        if self.has_several_goals { self.goals_word(1) } else { None }
    }

    /// A word of the toll header, which precedes the roots.
    #[inline(always)]
    fn toll_word(&self, index: u32) -> Option<u32> {
        self.section.get(self.roots.wrapping_sub(TOLL_WORDS).wrapping_add(index))
    }

    /// The answer for a cell with a root in a layer with tolls.
    #[inline(always)]
    fn tolled_answer(
        &self,
        number: u32,
        straight_first: bool,
        address: BlockAddress,
        cell: Cell,
    ) -> Option<Answer> {
        let word = self.section.get(self.roots.wrapping_add(number * ROOT_WORDS))?;
        let root_cost = self.section.get(self.roots.wrapping_add(number * ROOT_WORDS + 1))?;
        let (root, index) = (TolledRoot::cell_of(word), TolledRoot::multiplier_of(word));
        let correction = self.correction(address)?;
        let step = correction.step().or_else(|| first_step(cell, root, straight_first));
        // A root that is not the goal refers to another root or has a corrected step.
        let Some(direction) = step else { return Some(Answer::Goal) };
        let multiplier = (self.toll_word(4 + index / 4)?.rotate_right(8 * index) & 0xff) + 1;
        let cost = tolled_cost(root, root_cost, multiplier, cell);
        Some(Answer::Move { direction, cost: cost.wrapping_add(correction.cost()) })
    }

    #[inline(always)]
    fn correction(&self, address: BlockAddress) -> Option<Correction> {
        let table = self.toll_word(0)?;
        let plane = Plane::<CORRECTION_BITS> { section: self.section, table };
        match plane.get(address)? {
            Stored::Entry(entry) => {
                let word = self.section.get(self.toll_word(1)?.wrapping_add(entry))?;
                Some(Correction::of_word(word))
            }
            Stored::Own(_) => None,
        }
    }

    #[inline(always)]
    fn corrected_step(&self, address: BlockAddress) -> Option<Direction> {
        if self.has_tolls { self.correction(address)?.step() } else { None }
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
            if self.has_tolls {
                self.validate_tolls(count, work)?;
            }
            if self.has_several_goals {
                self.validate_goals(count, work)?;
            }
        }
        if unproved.terrain {
            self.terrain().validate(count, false, below(Terrain::ENTRIES), work)?;
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
            let mut cell = Cell::new(
                u32::from(u16::from_le_bytes([x0, x1])),
                u32::from(u16::from_le_bytes([y0, y1])),
            );
            if self.has_tolls {
                cell = TolledRoot::cell_of(u32::from_le_bytes(*root));
            }
            cell.column < self.columns && cell.row < self.rows
        });
        fit.then_some(())
    }

    /// Proves that every goal to which advice may lead is in the list of goals.
    fn validate_goals(
        &self,
        superblocks: u32,
        work: &mut Work<impl FnMut()>,
    ) -> Result<(), BlobError> {
        let goals = self.goals().ok_or(BlobError::Cells)?;
        let count = self.goal_list().and_then(|list| self.section.get(list));
        let count = count.ok_or(BlobError::Cells)?;
        goals.validate(superblocks, false, below(count), work)
    }

    /// Proves the header before the roots, and the planes that it names.
    fn validate_tolls(
        &self,
        superblocks: u32,
        work: &mut Work<impl FnMut()>,
    ) -> Result<(), BlobError> {
        let word = |index| self.toll_word(index).ok_or(BlobError::Cells);
        let (corrections, values, count, limits) = (word(0)?, word(1)?, word(2)?, word(3)?);
        // The multipliers are the last words; any number is one.
        word(TOLL_WORDS - 1)?;
        self.section.range(values, count).ok_or(BlobError::Cells)?;
        let corrections = Plane::<CORRECTION_BITS> { section: self.section, table: corrections };
        corrections.validate(superblocks, false, below(count), work)?;
        if limits == NO_TABLE {
            return Ok(());
        }
        let limits = Plane::<LIMIT_BITS> { section: self.section, table: limits };
        limits.validate(superblocks, false, below(1 << LIMIT_BITS), work)
    }
}

/// Whether an entry is below a number. Planes whose entries are so share the code of their validation.
fn below(count: u32) -> impl Fn(u32) -> bool {
    move |entry| entry < count
}

/// The answer for a cell with this root.
#[inline(always)]
fn answer(root: Root, cell: Cell, straight_first: bool) -> Answer {
    match first_step(cell, root.cell, straight_first) {
        Some(direction) => Answer::Move { direction, cost: root.cost_from(cell) },
        None => Answer::Goal,
    }
}
