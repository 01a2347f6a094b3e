//! The mission language: behaviours, their plans as graph grammars and the rules that choose.
//!
//! The tables `inputs`, `facts`, `actions`, `frames` and `behaviours` of a mission file are read
//! ([`language`]), lowered to the blob's tables ([`lower`]) and checked for what would go wrong on
//! the robot ([`lints`]); [`draw`] shows them as graphs. `BEHAVIOURS.md` in this crate's folder
//! documents the language for its users. Source: Hasemann, "Planning, Behaviours, Decomposition,
//! and Monitoring Using Graph Grammars and Fuzzy Logic" (H).
//!
//! Invariants: rule bases are complete by construction, since a row has a label for each of the
//! seven labels of its input and the degrees of neighbouring labels always add up to one. Every
//! limit of the robot is checked here, so the robot does not refuse a mission that compiles.
//!
//! Deliberately absent: variables, arithmetic and any search for plans. A mission is a table that
//! a person can check.

pub mod draw;
pub mod graph_text;
mod language;
pub mod lints;
mod lower;
mod syntax;

pub(crate) use language::channel_of;
pub use language::{TABLES, read};
pub use lower::{PlanNames, Plans, lower};
pub use syntax::Syntax;

use maps::problem::{Problem, has_errors};
use plan_format::mission::MissionDraft;

/// A behaviour is dormant up to this criticality by default, which lies between NB alone (1/18) and
/// NM alone (1/6).
pub const DEFAULT_DORMANT: f32 = 1.0 / 12.0;
/// A behaviour is engaged at once from this criticality; PB exceeds it, PM does not.
pub const DEFAULT_UNCONDITIONAL: f32 = 0.90;
/// How much more critical another behaviour must be to take over. It exceeds the unevenness of min
/// clipping between two labels (0.009) and is less than the distance between two labels (1/9).
pub const DEFAULT_HYSTERESIS: f32 = 0.02;
/// A behaviour is not interrupted conditionally within this time, seconds.
pub const DEFAULT_DWELL_S: f64 = 1.0;
/// Productions below this applicability are not considered: NB alone is below it, NM is not.
pub const DEFAULT_THRESHOLD: f32 = 0.15;
/// An action fails after this time plus its own time, seconds.
pub const DEFAULT_TIMEOUT_S: f64 = 300.0;
/// How long the last value of an input replaces a missing one, seconds.
pub const DEFAULT_MISSING_HOLD_S: f64 = 2.0;

/// Compiles a mission to the blob's tables and adds all errors, warnings and notes to `problems`;
/// returns `None` if `problems` contains an error.
pub fn compile(
    syntax: &Syntax,
    plans: &Plans,
    problems: &mut Vec<Problem>,
) -> Option<MissionDraft> {
    let draft = lower(syntax, plans, problems)?;
    // Lints need a mission that was understood completely.
    if !has_errors(problems) {
        problems.extend(syntax.unused.iter().cloned());
        lints::check(syntax, &draft, problems);
    }
    (!has_errors(problems)).then_some(draft)
}
