//! Lints.
use super::Syntax;
use crate::problem::Problem;
use plan_format::mission::MissionDraft;
/// x
pub fn check(_: &Syntax, _: &MissionDraft, _: &mut Vec<Problem>) {}
