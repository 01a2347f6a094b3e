//! The writer: a draft in, bytes out. The same draft gives the same bytes.

use crate::blob::Blob;
use crate::directory::{Directory, LayerRecord, Origin, PlanRecord, SCHEMA_HASH};
use crate::error::BlobError;
use crate::grid::Grid;
use crate::layout::{NO_TABLE, ROOT_WORDS, TollHeader, UNIFORM, WORD_BYTES};
use crate::mission::MissionDraft;
use crate::names::{Name, is_name};
use crate::packed::{PackedLayer, PackedPlane, PackedTolls, Superblock};
use crate::parameters::Parameters;
use crate::record::Record;
use crate::{limits, seal};
use std::collections::HashMap;

/// The content of a blob.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The cell grid.
    pub grid: Grid,
    /// Where the map lies on the globe, if it is known.
    pub origin: Option<Origin>,
    /// The robot's parameters.
    pub parameters: Parameters,
    /// Parallel plans, in the order of their indices.
    pub plans: Vec<PlanDraft>,
    /// The mission; empty without behaviours.
    pub mission: MissionDraft,
}

/// One parallel plan.
#[derive(Clone, Debug)]
pub struct PlanDraft {
    /// Unique within the blob; see [`is_name`].
    pub name: String,
    /// The goals, map metres: at least one, at most [`limits::MAX_GOALS`]. Of several, at least one is
    /// on the grid.
    pub goals_m: Vec<[f64; 2]>,
    /// From the least to the most constrained.
    pub layers: Vec<LayerDraft>,
}

/// One layer.
#[derive(Clone, Debug)]
pub struct LayerDraft {
    /// Unique within the plan; see [`is_name`].
    pub name: String,
    /// Position of its constraints in the mission's order, below [`limits::MAX_LAYERS`].
    pub rank: u8,
    /// Its cells.
    pub packed: PackedLayer,
}

/// Why a draft cannot be written.
#[derive(Clone, Debug, PartialEq)]
pub enum WriteError {
    /// A parameter is out of its range.
    Parameter {
        /// Its name in a mission file.
        name: &'static str,
        /// Least value allowed.
        low: f32,
        /// Greatest value allowed.
        high: f32,
    },
    /// More parallel plans than [`limits::MAX_PLANS`].
    TooManyPlans(usize),
    /// A plan without layers or with more than [`limits::MAX_LAYERS`].
    LayerCount {
        /// The plan's name.
        plan: String,
        /// Number of its layers.
        layers: usize,
    },
    /// A plan without goals or with more than [`limits::MAX_GOALS`].
    GoalCount {
        /// The plan's name.
        plan: String,
        /// Number of its goals.
        goals: usize,
    },
    /// A layer that names the goals of its cells although its plan has one goal, or does not although
    /// it has several.
    Goals {
        /// The plan's name.
        plan: String,
        /// The layer's name.
        layer: String,
    },
    /// The name of a plan or a layer that [`is_name`] refuses.
    Name(String),
    /// A layer that does not have the grid's columns and rows.
    LayerSize {
        /// The plan's name.
        plan: String,
        /// The layer's name.
        layer: String,
    },
    /// More bytes than [`limits::MAX_BLOB_BYTES`].
    TooLarge {
        /// Bytes of the whole blob.
        bytes: usize,
    },
    /// A number that exceeds its field.
    Number {
        /// The field of the format.
        field: &'static str,
        /// The number.
        number: usize,
    },
    /// The reader refuses the result, because the draft breaks another rule of the format.
    Refused(BlobError),
}

impl std::fmt::Display for WriteError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Parameter { name, low, high } => {
                write!(f, "parameter {name} must be within {low} and {high}")
            }
            Self::TooManyPlans(plans) => {
                write!(f, "{plans} plans, but the format allows {}", limits::MAX_PLANS)
            }
            Self::LayerCount { plan, layers } => {
                write!(f, "plan {plan} has {layers} layers, not 1 to {}", limits::MAX_LAYERS)
            }
            Self::GoalCount { plan, goals } => {
                write!(f, "plan {plan} has {goals} goals, not 1 to {}", limits::MAX_GOALS)
            }
            Self::Goals { plan, layer } => {
                write!(f, "layer {plan}/{layer} does not say which goal is meant, or needlessly")
            }
            Self::Name(name) => write!(
                f,
                "{name:?} cannot be a name: 1 to {} bytes, trimmed, without `/`",
                limits::MAX_NAME_BYTES
            ),
            Self::LayerSize { plan, layer } => {
                write!(f, "layer {plan}/{layer} does not have the size of the grid")
            }
            Self::TooLarge { bytes } => {
                write!(f, "{bytes} bytes, but the format allows {}", limits::MAX_BLOB_BYTES)
            }
            Self::Number { field, number } => {
                write!(f, "{field} is {number}, which exceeds the field")
            }
            Self::Refused(error) => write!(f, "the reader refuses the result: {error}"),
        }
    }
}

impl std::error::Error for WriteError {}

/// The blob of a draft. The result has been read back by [`Blob::parse_exact`].
pub fn write(draft: &Draft) -> Result<Vec<u8>, WriteError> {
    write_with_recipe(draft, "")
}

/// The blob of a draft, with the build's map options as a text for tools. The robot does not read
/// the text; [`recipe`] does.
pub fn write_with_recipe(draft: &Draft, recipe: &str) -> Result<Vec<u8>, WriteError> {
    check(draft)?;
    let mut sections = Sections::default();
    for plan in &draft.plans {
        sections.put(&draft.grid, plan)?;
    }
    let mission =
        draft.mission.write().map_err(|error| WriteError::Refused(BlobError::Mission { error }))?;
    let directory = Directory {
        grid: draft.grid,
        origin: draft.origin.map(Into::into),
        parameters: draft.parameters,
        plans: &sections.plans,
        layers: &sections.layers,
        names: &sections.names.bytes,
        mission: &mission,
        recipe: recipe.as_bytes(),
        cells: &sections.cells.bytes,
    };
    // Serialising plain data into a growing vector does not fail.
    let payload =
        postcard::to_stdvec(&directory).map_err(|_| WriteError::Refused(BlobError::Directory))?;
    let blob =
        seal::seal(SCHEMA_HASH, &payload).ok_or(WriteError::TooLarge { bytes: payload.len() })?;
    Blob::parse_exact(&blob).map_err(WriteError::Refused)?;
    Ok(blob)
}

/// The recipe that [`write_with_recipe`] stored in a blob; empty if there is none, `None` if the
/// bytes are not a blob or the text is not UTF-8.
pub fn recipe(blob: &[u8]) -> Option<&str> {
    let sealed = seal::open(blob, SCHEMA_HASH, || ()).ok()?;
    let (directory, _) = postcard::take_from_bytes::<Directory<'_>>(sealed.payload).ok()?;
    std::str::from_utf8(directory.recipe).ok()
}

/// Reports the mistakes that the draft explains better than its bytes.
fn check(draft: &Draft) -> Result<(), WriteError> {
    if let Some((name, low, high)) = draft.parameters.check() {
        return Err(WriteError::Parameter { name, low, high });
    }
    if draft.plans.len() > limits::MAX_PLANS {
        return Err(WriteError::TooManyPlans(draft.plans.len()));
    }
    for plan in &draft.plans {
        let layers = plan.layers.len();
        if !(1..=limits::MAX_LAYERS).contains(&layers) {
            return Err(WriteError::LayerCount { plan: plan.name.clone(), layers });
        }
        let goals = plan.goals_m.len();
        if !(1..=limits::MAX_GOALS).contains(&goals) {
            return Err(WriteError::GoalCount { plan: plan.name.clone(), goals });
        }
        let mut names = std::iter::once(&plan.name).chain(plan.layers.iter().map(|l| &l.name));
        if let Some(name) = names.find(|name| !is_name(name)) {
            return Err(WriteError::Name(name.clone()));
        }
        for layer in &plan.layers {
            let packed = &layer.packed;
            if (packed.columns, packed.rows) != (draft.grid.columns, draft.grid.rows) {
                let (plan, layer) = (plan.name.clone(), layer.name.clone());
                return Err(WriteError::LayerSize { plan, layer });
            }
            if packed.goals.is_some() != (goals > 1) {
                let (plan, layer) = (plan.name.clone(), layer.name.clone());
                return Err(WriteError::Goals { plan, layer });
            }
        }
    }
    Ok(())
}

#[derive(Default)]
struct Sections {
    plans: Vec<u8>,
    layers: Vec<u8>,
    names: Pool,
    cells: Pool,
}

/// Converts a number to the type of its field.
fn number<T: TryFrom<usize>>(field: &'static str, number: usize) -> Result<T, WriteError> {
    T::try_from(number).map_err(|_| WriteError::Number { field, number })
}

impl Sections {
    fn put(&mut self, grid: &Grid, plan: &PlanDraft) -> Result<(), WriteError> {
        // Of several goals, the first one that robots can look up.
        let is_on_grid = |goal: &&[f64; 2]| grid.cell_at(goal[0], goal[1]).is_some();
        let goal_m = plan.goals_m.iter().find(is_on_grid).or(plan.goals_m.first());
        let record = PlanRecord {
            name: self.name(&plan.name)?,
            layers_and_flag: PlanRecord::layers_byte(
                number("number of layers", plan.layers.len())?,
                plan.goals_m.len() > 1,
            ),
            first_layer: number("first layer", self.layers.len() / LayerRecord::SIZE)?,
            goal_m: goal_m.copied().unwrap_or_default(),
        };
        record.encode(&mut self.plans);
        for layer in &plan.layers {
            let before = self.cells.bytes.len();
            let packed = &layer.packed;
            if usize::from(layer.rank) >= limits::MAX_LAYERS {
                return Err(WriteError::Number { field: "rank", number: layer.rank.into() });
            }
            let toll_unit = packed.tolls.as_ref().map(|tolls| tolls.unit);
            let has_several_goals = packed.goals.is_some();
            let record = LayerRecord {
                name: self.name(&layer.name)?,
                rank_and_flags: LayerRecord::rank_byte(layer.rank, toll_unit, has_several_goals),
                terrain: self.cells.put_plane(&packed.terrain)?,
                routes: self.cells.put_plane(&packed.routes)?,
                roots: self.put_roots(packed, &plan.goals_m)?,
                root_count: number("number of roots", packed.roots.len() / ROOT_WORDS as usize)?,
                bytes: number("bytes of a layer", self.cells.bytes.len() - before)?,
                counts: packed.counts,
            };
            record.encode(&mut self.layers);
        }
        Ok(())
    }

    /// The offset of a layer's roots, or of the headers before them.
    fn put_roots(&mut self, packed: &PackedLayer, goals_m: &[[f64; 2]]) -> Result<u32, WriteError> {
        let mut words = Vec::new();
        if let Some(goals) = &packed.goals {
            let plane = self.cells.put_plane(goals)?;
            let numbers = goals_m.as_flattened().iter().map(|number| number.to_bits());
            let numbers = numbers.flat_map(|bits| [bits as u32, (bits >> 32) as u32]);
            let list: Vec<u32> = std::iter::once(goals_m.len() as u32).chain(numbers).collect();
            words.extend([plane, self.cells.put_words(&list)?]);
        }
        if let Some(tolls) = &packed.tolls {
            words.extend(self.toll_header(tolls)?.words());
        }
        words.extend(&packed.roots);
        self.cells.put_words(&words)
    }

    fn toll_header(&mut self, tolls: &PackedTolls) -> Result<TollHeader, WriteError> {
        let limits = tolls.limits.as_ref().map(|limits| self.cells.put_plane(limits));
        Ok(TollHeader {
            corrections: self.cells.put_plane(&tolls.corrections)?,
            values: self.cells.put_words(&tolls.values)?,
            value_count: number("number of corrections", tolls.values.len())?,
            limits: limits.transpose()?.unwrap_or(NO_TABLE),
            multipliers: tolls.multipliers,
        })
    }

    fn name(&mut self, name: &str) -> Result<Name, WriteError> {
        Ok(Name {
            offset: number("offset of a name", self.names.put(name.as_bytes()))?,
            length: number("length of a name", name.len())?,
        })
    }
}

/// Bytes that store equal items once.
#[derive(Default)]
struct Pool {
    bytes: Vec<u8>,
    known: HashMap<Vec<u8>, usize>,
}

impl Pool {
    /// The offset of an item, bytes.
    fn put(&mut self, item: &[u8]) -> usize {
        if let Some(&offset) = self.known.get(item) {
            return offset;
        }
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(item);
        self.known.insert(item.to_vec(), offset);
        offset
    }

    /// The offset of some words, in words.
    fn put_words(&mut self, words: &[u32]) -> Result<u32, WriteError> {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        number("offset of words", self.put(&bytes) / WORD_BYTES)
    }

    /// The offset of a plane's table, in words; its superblocks are stored before it.
    fn put_plane(&mut self, plane: &PackedPlane) -> Result<u32, WriteError> {
        let mut table = Vec::with_capacity(plane.superblocks.len());
        for superblock in &plane.superblocks {
            table.push(match superblock {
                Superblock::Uniform(entry) => UNIFORM | entry,
                Superblock::Words { first, words } => {
                    let start = self.put_words(words)? as usize;
                    number("offset of a superblock", start.saturating_add(*first))?
                }
            });
        }
        self.put_words(&table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{Root, Terrain};
    use crate::{Answer, Cell, Counts, Direction};

    /// Three cells in a row, all of one terrain, with the goal in the westernmost.
    fn layer(name: &str, terrain: Terrain, counts: Counts) -> LayerDraft {
        let plane = |entry| PackedPlane { superblocks: vec![Superblock::Uniform(entry)] };
        let goal = Root { cell: Cell::new(0, 0), cost: 0 };
        LayerDraft {
            name: name.into(),
            rank: 0,
            packed: PackedLayer {
                columns: 3,
                rows: 1,
                terrain: plane(terrain.entry()),
                routes: plane(0),
                roots: goal.words().into(),
                tolls: None,
                goals: None,
                counts,
            },
        }
    }

    fn draft() -> Draft {
        let open = Counts { free: 3, blocked: 0, unreachable: 0 };
        let shut = Counts { free: 0, blocked: 3, unreachable: 0 };
        let plan = |name: &str| PlanDraft {
            name: name.into(),
            goals_m: vec![[-0.5, 0.5]],
            layers: vec![
                layer("physical", Terrain::Free, open),
                layer("comms", Terrain::Escape(Direction::W), shut),
            ],
        };
        Draft {
            grid: Grid { columns: 3, rows: 1, resolution_m: 1.0, corner_m: [-1.0, 0.0] },
            origin: None,
            parameters: Parameters::default(),
            plans: vec![plan("pier"), plan("base")],
            mission: MissionDraft::default(),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let blob = write(&draft()).unwrap();
        let blob = Blob::parse(&blob).unwrap();
        assert_eq!(blob.plan_count(), 2);
        let plan = blob.find("base").unwrap();
        let at = |layer, x| {
            let layer = plan.layer(layer).unwrap();
            layer.look_up(blob.cell_at(math::Vec2::new(x, 0.0)).unwrap())
        };
        assert_eq!(at(0, -1.0), Answer::Goal);
        assert_eq!(at(0, 0.9), Answer::Move { direction: Direction::W, cost: 5741 });
        assert_eq!(at(1, 1.0), Answer::Blocked { escape: Some(Direction::W) });
        let comms = plan.layer(1).unwrap();
        assert_eq!(comms.name(), "comms");
        assert_eq!(comms.look_up(Cell::new(3, 0)), Answer::OffMap);
        assert!(size_of::<Blob<'_>>() <= 704, "{}", size_of::<Blob<'_>>());
    }

    #[test]
    fn a_recipe_is_kept_for_tools() {
        let plain = write(&draft()).unwrap();
        assert_eq!(recipe(&plain), Some(""));
        let text = "robot_radius = 0.3\n";
        let blob = write_with_recipe(&draft(), text).unwrap();
        assert_eq!(recipe(&blob), Some(text));
        assert_eq!(blob.len(), plain.len() + text.len());
        assert_eq!(recipe(&blob[..blob.len() - 1]), None);
    }

    #[test]
    fn drafts_that_cannot_be_written_say_why() {
        let mut twice = draft();
        twice.plans[1].name = "pier".into();
        assert_eq!(write(&twice), Err(WriteError::Refused(BlobError::Name)));
        let mut slash = draft();
        slash.plans[1].layers[0].name = "a/b".into();
        assert_eq!(write(&slash), Err(WriteError::Name("a/b".into())));
        let mut small = draft();
        small.grid.rows = 2;
        assert!(matches!(write(&small), Err(WriteError::LayerSize { .. })));
        let mut rooted = draft();
        rooted.plans[0].layers[0].packed.roots = vec![0; 2 << 16];
        let (field, number) = ("number of roots", 1 << 16);
        assert_eq!(write(&rooted), Err(WriteError::Number { field, number }));
    }
}
