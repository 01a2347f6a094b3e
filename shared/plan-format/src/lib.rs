//! The blob: the plans and the mission that the compiler writes and the robot reads in place.
//!
//! The crate defines what each byte means (`FORMAT.md`), the [`limits`] of every table, and when a
//! blob is refused. [`Blob::parse`] validates all of it once, at boot; a blob that is truncated,
//! damaged, too large or from another version is refused with a [`BlobError`].
//!
//! ```
//! # #[cfg(feature = "std")] {
//! # use plan_format::layout::{Root, Terrain};
//! # use plan_format::mission::MissionDraft;
//! # use plan_format::*;
//! # let plane = |entry| PackedPlane { superblocks: vec![Superblock::Uniform(entry)] };
//! # let packed = PackedLayer {
//! #     columns: 3,
//! #     rows: 1,
//! #     terrain: plane(Terrain::Free.entry()),
//! #     routes: plane(0),
//! #     roots: Root { cell: Cell::new(0, 0), cost: 0 }.words().into(),
//! #     tolls: None,
//! #     goals: None,
//! #     counts: Counts { free: 3, blocked: 0, unreachable: 0 },
//! # };
//! # let layers = vec![LayerDraft { name: "physical".into(), rank: 0, packed }];
//! # let pier = PlanDraft { name: "pier".into(), goals_m: vec![[0.5, 0.5]], layers };
//! # let flash = write(&Draft {
//! #     grid: Grid { columns: 3, rows: 1, resolution_m: 1.0, corner_m: [0.0, 0.0] },
//! #     origin: None,
//! #     parameters: Parameters::default(),
//! #     plans: vec![pier],
//! #     mission: MissionDraft::default(),
//! # })
//! # .unwrap();
//! use math::Vec2;
//! use plan_format::{Answer, Blob, Direction};
//!
//! // Three free cells of 1 m in a row; the goal `pier` is in the westernmost.
//! let blob = Blob::parse(&flash)?;
//! let layer = blob.find("pier").and_then(|plan| plan.layer(0)).unwrap();
//! let cell = blob.cell_at(Vec2::new(2.5, 0.5)).unwrap();
//! assert_eq!(layer.look_up(cell), Answer::Move { direction: Direction::W, cost: 2 * 5741 });
//! # }
//! # Ok::<(), plan_format::BlobError>(())
//! ```
//!
//! Invariants: after parsing, no look-up fails, and each takes constant time. The blob's length
//! bounds the time that parsing takes. Equal drafts give equal bytes.
//!
//! Sources: the plan of a layer is from Wagner and Arkin, "Internalized Plans for
//! Communication-Sensitive Robot Team Behaviors"; the tables of [`mission`] are from Hasemann,
//! "Planning, Behaviours, Decomposition, and Monitoring Using Graph Grammars and Fuzzy Logic".
//!
//! Deliberately absent: allocation, `unsafe` and, without the feature `std`, the writer. The choice
//! of a layer's words is the packer's, in the compiler; here is only their [`layout`].
#![cfg_attr(not(feature = "std"), no_std)]

mod blob;
mod directory;
mod error;
mod layer;
pub mod layout;
pub mod limits;
pub mod mission;
mod names;
#[cfg(feature = "std")]
mod packed;
pub mod parameters;
mod plane;
pub mod record;
mod seal;
mod team;
mod words;
mod work;
#[cfg(feature = "std")]
mod write;

pub use blob::{Blob, ParallelPlan};
pub use directory::{Counts, Origin};
pub use error::BlobError;
pub use layer::{Answer, Layer, Step};
pub use math::grid::{self, Cell, Direction, Grid};
pub use names::is_name;
pub use parameters::Parameters;
pub use seal::{FORMAT_VERSION, MAGIC};
pub use team::TeamPolicy;

#[cfg(feature = "std")]
pub use packed::{PackedLayer, PackedPlane, PackedTolls, Superblock};
#[cfg(feature = "std")]
pub use write::{Draft, LayerDraft, PlanDraft, WriteError, recipe, write, write_with_recipe};
