//! The mission language: behaviours, their plans as graph grammars and the rules that choose.
//!
//! A mission file's tables `inputs`, `facts`, `actions`, `frames` and `behaviours` are read
//! ([`language`]), lowered to the blob's tables ([`lower`]) and looked through for what would go
//! wrong on the robot ([`lints`]); [`draw`] shows them as graphs. `BEHAVIOURS.md` beside this crate
//! documents the language for its users. Source: Hasemann, "Planning, Behaviours, Decomposition,
//! and Monitoring Using Graph Grammars and Fuzzy Logic" (H).
//!
//! Invariants: rule bases are complete by construction, since a row has a label for each of the
//! seven labels of its input, and neighbouring labels always add up to one: no input is left
//! without a rule. Every limit of the robot is checked here, so that no mission that compiles is
//! refused there.
//!
//! Deliberately absent: variables, arithmetic and any search for plans. A mission is a table that
//! a person can check.

pub mod draw;
pub mod graph_text;
mod language;
pub mod lints;
mod lower;
mod syntax;

pub use language::{TABLES, read};
pub use lower::{PlanNames, Plans, lower};
pub use syntax::Syntax;

use maps::problem::Problem;
use maps::problem::has_errors;
use plan_format::mission::MissionDraft;

/// A behaviour is dormant up to this criticality unless it says otherwise: NB alone gives 1/18, NM
/// 1/6.
pub const DEFAULT_DORMANT: f32 = 1.0 / 12.0;
/// A behaviour is engaged at once from this criticality: PB, but not PM, exceeds it.
pub const DEFAULT_UNCONDITIONAL: f32 = 0.90;
/// How much more critical another behaviour must be to take over: above the unevenness of min
/// clipping between two labels, 0.009, and below the distance of two labels, 1/9.
pub const DEFAULT_HYSTERESIS: f32 = 0.02;
/// A behaviour is not interrupted conditionally within this time, seconds.
pub const DEFAULT_DWELL_S: f64 = 1.0;
/// Productions below this applicability are not considered: NB alone is below it, NM is not.
pub const DEFAULT_THRESHOLD: f32 = 0.15;
/// An action has failed after this time and its own, seconds; no action runs for ever.
pub const DEFAULT_TIMEOUT_S: f64 = 300.0;
/// For how long a missing input counts as its last value, seconds.
pub const DEFAULT_MISSING_HOLD_S: f64 = 2.0;

/// The blob's tables of a mission, with everything worth knowing about them; `None` if there is an
/// error among the problems then.
pub fn compile(
    syntax: &Syntax,
    plans: &Plans,
    problems: &mut Vec<Problem>,
) -> Option<MissionDraft> {
    let draft = lower(syntax, plans, problems)?;
    // What is only half understood is not looked through.
    if !has_errors(problems) {
        lints::check(syntax, &draft, problems);
    }
    (!has_errors(problems)).then_some(draft)
}
