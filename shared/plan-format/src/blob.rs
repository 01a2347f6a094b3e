//! The blob as the robot uses it: parsed once at boot, then read every tick.

use crate::directory::{Directory, LayerRecord, Origin, PlanRecord, SCHEMA_HASH};
use crate::error::BlobError;
use crate::grid::{Cell, Grid};
use crate::layer::{Layer, Unproved};
use crate::layout::GOAL_WORDS;
use crate::mission::{ActionKind, Mission, MissionError, Source};
use crate::names::{Name, is_name};
use crate::parameters::Parameters;
use crate::record::Table;
use crate::words::Words;
use crate::work::Work;
use crate::{limits, seal};
use math::{MapFrame, Vec2};

/// The internalized plans, the mission and the robot's parameters.
///
/// A view of a few hundred bytes; the tables stay where the blob is stored.
#[derive(Clone, Copy, Debug)]
pub struct Blob<'a> {
    grid: Grid,
    single: SingleGrid,
    origin: Option<Origin>,
    map_frame: Option<MapFrame>,
    parameters: Parameters,
    goal: Option<Vec2>,
    sections: Sections<'a>,
    mission: Mission<'a>,
    bytes: usize,
}

/// The cell grid in single precision, for the look-up at control rate.
#[derive(Clone, Copy, Debug)]
struct SingleGrid {
    /// From map coordinates to grid coordinates. Never -0, so that no sum is -0.
    shift: Vec2,
    resolution_m: f32,
    /// The sides in cells, as bits of single precision; below 2^24, so they are exact.
    columns_bits: u32,
    rows_bits: u32,
}

impl SingleGrid {
    fn new(grid: &Grid) -> Self {
        Self {
            shift: Vec2::new(0.0 - grid.corner_m[0] as f32, 0.0 - grid.corner_m[1] as f32),
            resolution_m: grid.resolution_m as f32,
            columns_bits: (grid.columns as f32).to_bits(),
            rows_bits: (grid.rows as f32).to_bits(),
        }
    }
}

/// The sections that hold plans and layers.
#[derive(Clone, Copy, Debug)]
struct Sections<'a> {
    columns: u32,
    rows: u32,
    plans: Table<'a, PlanRecord>,
    layers: Table<'a, LayerRecord>,
    names: &'a [u8],
    cells: Words<'a>,
}

/// The cell grid of a blob without a map.
const NO_GRID: Grid = Grid { columns: 0, rows: 0, resolution_m: 1.0, corner_m: [0.0, 0.0] };

impl<'a> Blob<'a> {
    /// Reads the blob at the start of a region of memory and validates all of it.
    ///
    /// A region of flash is larger than its blob: bytes past the length in the header are ignored.
    /// For a file, which must end with its blob, see [`Blob::parse_exact`].
    pub fn parse(region: &'a [u8]) -> Result<Self, BlobError> {
        Self::parse_paced(region, || ())
    }

    /// As [`Blob::parse`], and calls `beat` at bounded intervals to feed a watchdog that already
    /// runs. The blob's length bounds the number of beats ([`limits::MAX_CHECKS_PER_WORD`]).
    pub fn parse_paced(region: &'a [u8], mut beat: impl FnMut()) -> Result<Self, BlobError> {
        let sealed = seal::open(region, SCHEMA_HASH, &mut beat)?;
        let (directory, rest) = postcard::take_from_bytes::<Directory<'a>>(sealed.payload)
            .map_err(|_| BlobError::Directory)?;
        if !rest.is_empty() {
            return Err(BlobError::Directory);
        }
        let sections = Sections::new(&directory).ok_or(BlobError::Cells)?;
        let origin = directory.origin.map(Origin::from);
        if !(directory.grid.is_valid() || directory.grid == NO_GRID && sections.plan_count() == 0) {
            return Err(BlobError::Grid);
        }
        if origin.is_some_and(|origin| !origin.is_valid()) {
            return Err(BlobError::Origin);
        }
        sections.validate(&directory.grid, &mut Work::new(beat))?;
        let parameters = directory.parameters;
        let chosen = usize::from(parameters.plan);
        if parameters.check().is_some() || chosen > 0 && chosen >= sections.plan_count() {
            return Err(BlobError::Parameters);
        }
        let goal = sections.plan(chosen).map(|plan| plan.goal());
        let mission = Mission::parse(directory.mission)
            .and_then(|mission| sections.check_references(&mission).map(|()| mission))
            .map_err(|error| BlobError::Mission { error })?;
        let bytes = sealed.blob.len();
        let blob = Self::new(directory.grid, origin, parameters, goal, sections, bytes);
        Ok(Self { mission, ..blob })
    }

    /// As [`Blob::parse`], for a file: refuses bytes after the end of the blob.
    pub fn parse_exact(file: &'a [u8]) -> Result<Self, BlobError> {
        let blob = Self::parse(file)?;
        if blob.bytes == file.len() { Ok(blob) } else { Err(BlobError::TrailingBytes) }
    }

    fn new(
        grid: Grid,
        origin: Option<Origin>,
        parameters: Parameters,
        goal: Option<Vec2>,
        sections: Sections<'a>,
        bytes: usize,
    ) -> Self {
        let single = SingleGrid::new(&grid);
        let map_frame = origin.map(|o| MapFrame::new(o.place, o.at_m, o.heading_rad));
        let mission = Mission::default();
        Self { grid, single, origin, map_frame, parameters, goal, sections, mission, bytes }
    }

    /// The same blob with another seed of the noise schema: the robots of a team share a blob, and
    /// a simulation runs one blob many times.
    #[must_use]
    pub fn with_seed(self, seed: u32) -> Self {
        Self { parameters: Parameters { seed, ..self.parameters }, ..self }
    }

    /// The robot's parameters; all in range.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The cell grid; 0 x 0 cells without a map.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Where the map lies on the globe, if it is known.
    pub fn origin(&self) -> Option<Origin> {
        self.origin
    }

    /// The transform from GPS fixes to the map's metres, if the origin is known.
    pub fn map_frame(&self) -> Option<&MapFrame> {
        self.map_frame.as_ref()
    }

    /// The goal of the plan [`Parameters::plan`], map metres; `None` without plans.
    pub fn goal(&self) -> Option<Vec2> {
        self.goal
    }

    /// Bytes of the whole blob, header included; 0 without a map.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// The cell of a point (map metres), in single precision; `None` off the map.
    #[inline]
    pub fn cell_at(&self, point: Vec2) -> Option<Cell> {
        let SingleGrid { shift, resolution_m, columns_bits, rows_bits } = self.single;
        let column = (point.x + shift.x) / resolution_m;
        let row = (point.y + shift.y) / resolution_m;
        // As bits, non-negative numbers compare in order, and negative numbers and NaN compare
        // above them. So one comparison accepts only numbers that truncate to a cell.
        let inside = column.to_bits() < columns_bits && row.to_bits() < rows_bits;
        inside.then_some(Cell::new(column as u32, row as u32))
    }

    /// The behaviours; empty if the robot only follows the plan [`Parameters::plan`].
    pub fn mission(&self) -> Mission<'a> {
        self.mission
    }

    /// Number of parallel plans.
    pub fn plan_count(&self) -> usize {
        self.sections.plan_count()
    }

    /// A parallel plan by its index, from 0.
    pub fn parallel_plan(&self, index: usize) -> Option<ParallelPlan<'a>> {
        self.sections.plan(index)
    }

    /// A parallel plan by its name.
    pub fn find(&self, name: &str) -> Option<ParallelPlan<'a>> {
        self.parallel_plans().find(|plan| plan.name() == name)
    }

    /// All parallel plans, in the order of their indices.
    pub fn parallel_plans(&self) -> impl Iterator<Item = ParallelPlan<'a>> + use<'a> {
        let sections = self.sections;
        (0..sections.plan_count()).map_while(move |index| sections.plan(index))
    }
}

impl Blob<'static> {
    /// A blob without a map: the robot drives by its reactive schemas alone.
    ///
    /// It keeps the invariants of a parsed blob: if a parameter is out of its range, all take their
    /// defaults; an origin or a goal beyond its limits is left out.
    pub fn without_map(parameters: Parameters, origin: Option<Origin>, goal: Option<Vec2>) -> Self {
        let parameters =
            if parameters.check().is_none() { parameters } else { Parameters::default() };
        let near = |metres: f32| metres.abs() <= limits::MAX_ORIGIN_M as f32;
        let sections = Sections {
            columns: 0,
            rows: 0,
            plans: Table::new(&[]),
            layers: Table::new(&[]),
            names: &[],
            cells: Words::default(),
        };
        Self::new(
            NO_GRID,
            origin.filter(Origin::is_valid),
            parameters,
            goal.filter(|goal| near(goal.x) && near(goal.y)),
            sections,
            0,
        )
    }
}

impl<'a> Sections<'a> {
    /// `None` if the cells are not whole words.
    fn new(directory: &Directory<'a>) -> Option<Self> {
        Some(Self {
            columns: directory.grid.columns,
            rows: directory.grid.rows,
            plans: Table::new(directory.plans),
            layers: Table::new(directory.layers),
            names: directory.names,
            cells: Words::new(directory.cells)?,
        })
    }

    fn plan_count(&self) -> usize {
        self.plans.len()
    }

    fn plan(&self, index: usize) -> Option<ParallelPlan<'a>> {
        let record = self.plans.get(index)?;
        Some(ParallelPlan { sections: *self, record })
    }

    /// Proves once that every plan, layer and name can be read and is within its limits.
    fn validate(&self, grid: &Grid, work: &mut Work<impl FnMut()>) -> Result<(), BlobError> {
        if self.layers.len() > limits::MAX_BLOB_LAYERS {
            return Err(BlobError::Layers);
        }
        work.allow(self.cells.len());
        let plans = self.plan_count();
        if plans > limits::MAX_PLANS || !self.plans.is_whole() {
            return Err(BlobError::Plans);
        }
        let mut next_layer = 0;
        for index in 0..plans {
            let record = self.plans.get(index).ok_or(BlobError::Plans)?;
            let count = usize::from(record.layer_count());
            // Layers are in the order of their plans, so that each belongs to exactly one.
            if usize::from(record.first_layer) != next_layer
                || !(1..=limits::MAX_LAYERS).contains(&count)
            {
                return Err(BlobError::Plans);
            }
            next_layer += count;
            self.check_name(record.name, (0..index).map(|earlier| self.plan_name(earlier)))?;
            if grid.cell_at(record.goal_m[0], record.goal_m[1]).is_none() {
                return Err(BlobError::Goal);
            }
            let plan = self.plan(index).ok_or(BlobError::Name)?;
            plan.validate_goals().ok_or(BlobError::Goal)?;
            for layer in 0..count {
                plan.validate_layer(layer, work)?;
            }
        }
        let all = next_layer == self.layers.len() && self.layers.is_whole();
        if all { Ok(()) } else { Err(BlobError::Layers) }
    }

    /// Checks that the parallel plans and layers that a mission refers to exist.
    fn check_references(&self, mission: &Mission<'_>) -> Result<(), MissionError> {
        let has = |plan: u16, layer: u8| {
            self.plan(usize::from(plan)).is_some_and(|plan| plan.layer_count() > usize::from(layer))
        };
        let inputs = mission.inputs().iter().all(|input| match input.source {
            Source::CostToGoal { plan } | Source::RangeLeft { plan, .. } => has(plan, 0),
            Source::PriceOfConstraint { plan, layer } => has(plan, layer),
            _ => true,
        });
        let actions = mission.actions().iter().all(|action| match action.kind {
            ActionKind::Follow { plan, .. } => has(plan, 0),
            _ => true,
        });
        if inputs && actions { Ok(()) } else { Err(MissionError::Reference) }
    }

    fn plan_name(&self, index: usize) -> Option<&'a str> {
        self.plans.get(index)?.name.text(self.names)
    }

    fn check_name(
        &self,
        name: Name,
        mut earlier: impl Iterator<Item = Option<&'a str>>,
    ) -> Result<(), BlobError> {
        let name = name.text(self.names).ok_or(BlobError::Name)?;
        let used = earlier.any(|other| other == Some(name));
        if is_name(name) && !used { Ok(()) } else { Err(BlobError::Name) }
    }
}

/// Map metres in single precision.
fn single(at_m: [f64; 2]) -> Vec2 {
    Vec2::new(at_m[0] as f32, at_m[1] as f32)
}

/// Layers with the same goals, mostly one, each more constrained than the one before.
#[derive(Clone, Copy, Debug)]
pub struct ParallelPlan<'a> {
    sections: Sections<'a>,
    record: PlanRecord,
}

impl<'a> ParallelPlan<'a> {
    /// Its name, unique within the blob.
    pub fn name(&self) -> &'a str {
        // Names were validated.
        self.record.name.text(self.sections.names).unwrap_or_default()
    }

    /// The goal, map metres; of several, the first one on the map.
    pub fn goal(&self) -> Vec2 {
        single(self.record.goal_m)
    }

    /// As [`Self::goal`], in the compiler's precision.
    pub fn goal_m(&self) -> [f64; 2] {
        self.record.goal_m
    }

    /// Whether there are several goals.
    #[inline(always)]
    pub fn has_several_goals(&self) -> bool {
        self.record.has_several_goals()
    }

    /// Number of goals, at least 1.
    pub fn goal_count(&self) -> usize {
        self.goal_list().and_then(|list| self.sections.cells.get(list)).unwrap_or(1) as usize
    }

    /// The goal with a number, from 0 in the order of the mission, map metres. A plan with one goal
    /// answers it for any number, and one with several [`Self::goal`] for a number that none has.
    pub fn goal_at(&self, number: u8) -> Vec2 {
        // Most plans have one goal.
        let numbered = if self.has_several_goals() { self.numbered(number) } else { None };
        single(numbered.unwrap_or(self.record.goal_m))
    }

    /// All goals, in the order of their numbers, map metres in the compiler's precision. Of several,
    /// some may be off the map or where a layer is blocked: routes do not lead to them.
    pub fn goals_m(&self) -> impl Iterator<Item = [f64; 2]> + use<'a> {
        let plan = *self;
        (0..self.goal_count())
            .map(move |number| plan.numbered(number as u8).unwrap_or(plan.goal_m()))
    }

    /// Where the list of several goals begins: their number, then the goals. `None` if there is one.
    #[inline(never)]
    fn goal_list(&self) -> Option<u32> {
        if self.record.has_several_goals() { self.layer(0)?.goal_list() } else { None }
    }

    /// One of several goals.
    #[inline(never)]
    fn numbered(&self, number: u8) -> Option<[f64; 2]> {
        let list = self.goal_list()?;
        let cells = self.sections.cells;
        if u32::from(number) >= cells.get(list)? {
            return None;
        }
        let first = list.wrapping_add(1 + GOAL_WORDS * u32::from(number));
        let coordinate = |at: u32| {
            let [low, high] = [cells.get(at)?, cells.get(at.wrapping_add(1))?].map(u64::from);
            Some(f64::from_bits(high << 32 | low))
        };
        Some([coordinate(first)?, coordinate(first.wrapping_add(2))?])
    }

    /// Proves once that all layers name the same goals, and that these can be read and are within their
    /// limits.
    fn validate_goals(&self) -> Option<()> {
        let has_several = self.record.has_several_goals();
        let list = self.goal_list();
        let has_same =
            |layer: Layer<'a>| layer.has_several_goals == has_several && layer.goal_list() == list;
        if !self.layers().all(has_same) {
            return None;
        }
        if !has_several {
            return Some(());
        }
        let list = list?;
        let count = self.sections.cells.get(list)?;
        if !(2..=limits::MAX_GOALS as u32).contains(&count) {
            return None;
        }
        let is_near = |goal: [f64; 2]| goal.iter().all(|at| at.abs() <= limits::MAX_ORIGIN_M);
        let mut found = false;
        for number in 0..count {
            let goal = self.numbered(number as u8).filter(|&goal| is_near(goal))?;
            found |= goal == self.record.goal_m;
        }
        found.then_some(())
    }

    /// Number of layers, at least 1.
    pub fn layer_count(&self) -> usize {
        usize::from(self.record.layer_count())
    }

    /// A layer by its index; 0 is the least constrained.
    pub fn layer(&self, index: usize) -> Option<Layer<'a>> {
        let record = self.layer_record(index)?;
        Some(Layer {
            columns: self.sections.columns,
            rows: self.sections.rows,
            section: self.sections.cells,
            terrain: record.terrain,
            routes: record.routes,
            roots: record.roots.wrapping_add(record.header_words()),
            root_count: record.root_count.into(),
            bytes: record.bytes,
            counts: record.counts,
            names: self.sections.names,
            name: record.name,
            rank: record.rank(),
            has_tolls: record.has_tolls(),
            unit: record.unit(),
            has_several_goals: record.has_several_goals(),
        })
    }

    /// All layers, the least constrained first.
    pub fn layers(&self) -> impl Iterator<Item = Layer<'a>> + use<'a> {
        let plan = *self;
        (0..plan.layer_count()).map_while(move |index| plan.layer(index))
    }

    fn layer_record(&self, index: usize) -> Option<LayerRecord> {
        if index >= self.layer_count() {
            return None;
        }
        let first = usize::from(self.record.first_layer);
        self.sections.layers.get(first.checked_add(index)?)
    }

    fn validate_layer(&self, index: usize, work: &mut Work<impl FnMut()>) -> Result<(), BlobError> {
        let record = self.layer_record(index).ok_or(BlobError::Layers)?;
        let earlier = (0..index)
            .map(|other| self.layer_record(other).and_then(|r| r.name.text(self.sections.names)));
        self.sections.check_name(record.name, earlier)?;
        if !record.is_valid() {
            return Err(BlobError::Layers);
        }
        let number = usize::from(self.record.first_layer) + index;
        let unproved = Unproved::of(number, &record, self.sections.layers);
        self.layer(index).ok_or(BlobError::Cells)?.validate(unproved, work)
    }
}
