//! What an extract lacks, and what is wrong in it, as warnings.

use crate::formats::globe;
use crate::problem::{Problem, Source};
use std::ops::Range;
use std::sync::Arc;

/// Counts of the parts that an extract lacks.
#[derive(Debug, Default)]
pub(super) struct Missing {
    pub(super) ways_cut: usize,
    pub(super) nodes: usize,
    pub(super) relations_cut: usize,
    pub(super) members: usize,
    pub(super) open: usize,
}

impl Missing {
    pub(super) fn report(&self, problems: &mut Vec<Problem>) {
        let Self { ways_cut, nodes, relations_cut, members, open } = self;
        let help = "cut the extract out with whole objects: `osmium extract --strategy smart`";
        let mut report = |count: usize, message: String| {
            if count > 0 {
                problems.push(Problem::warning(message).help(help));
            }
        };
        report(
            *nodes,
            format!(
                "outlines that lack nodes: {ways_cut}, nodes missing: {nodes}; drawn without them"
            ),
        );
        report(
            *members,
            format!(
                "areas that lack ways: {relations_cut}, ways missing: {members}; drawn without them"
            ),
        );
        report(*open, globe::open_outlines(*open));
    }
}

/// Inner rings that lie in no outer ring of their relation.
#[derive(Debug, Default)]
pub(super) struct Outside {
    pub(super) rings: usize,
    /// The first relation with such a ring: its id and its bytes.
    pub(super) first: Option<(i64, Range<usize>)>,
}

impl Outside {
    pub(super) fn report(&self, source: Option<&Arc<Source>>, problems: &mut Vec<Problem>) {
        let Some((id, span)) = &self.first else { return };
        let message = format!(
            "inner rings outside every outer ring: {}, first in relation {id}; drawn as areas",
            self.rings
        );
        let problem = Problem::warning(message)
            .help("check the roles of the relation's ways: an area's outline is `outer`, its courtyards are `inner`");
        problems.push(globe::at(problem, source, span, "this relation"));
    }
}
