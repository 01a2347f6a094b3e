//! Where a behaviour can be interrupted: the vertices ahead, and what is protected there.

use crate::relation::leads;
use crate::situation_grid::{SituationGrid, ahead, production_of};
use parts::bits::bit;
use parts::{Component, Id, Life, Owner};
use plan_format::mission::{Condition, Mission, Production};

/// A point ahead in a plan at which it may be interrupted (H, figure 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Point {
    /// The frame whose production has the vertex.
    pub frame: Id,
    /// The vertex.
    pub vertex: u8,
    /// What the protection intervals in force there protect together.
    pub held: Condition,
    /// Work lost by an interruption there.
    pub lost_work: u16,
}

impl<'a> SituationGrid<'a> {
    /// The interruption points ahead in an owner's plan, in the order in which they will be
    /// reached: from the innermost frames outwards, within a frame along the graph. A frame's exit
    /// is listed as the vertex of the parent's production to which the frame leads. The root's exit
    /// is the end of the plan and not an interruption point.
    pub fn points(self, mission: &Mission<'_>, owner: Owner, tell: &mut dyn FnMut(Point)) {
        let deepest = self.frames(owner).map(|(id, _)| self.above(id).count()).max().unwrap_or(0);
        for depth in (0..=deepest).rev() {
            for (id, frame) in self.frames(owner) {
                if self.above(id).count() == depth {
                    self.points_of(mission, id, frame, tell);
                }
            }
        }
    }

    fn frames(self, owner: Owner) -> impl Iterator<Item = (Id, &'a Component)> {
        self.of(owner).filter(|(_, entry)| {
            entry.production.is_some() && matches!(entry.life, Life::Started | Life::Suspended)
        })
    }

    fn points_of(
        self,
        mission: &Mission<'_>,
        id: Id,
        frame: &Component,
        tell: &mut dyn FnMut(Point),
    ) {
        let Some(production) = production_of(mission, frame) else { return };
        let outer = self.held_above(mission, id);
        let ahead = ahead(mission, &production, frame.finished);
        for vertex in 1..production.vertices.saturating_sub(1) {
            if ahead & bit(vertex) == 0 {
                continue;
            }
            let held = with_held_at(mission, &production, vertex, outer);
            let edges = mission.edges_of(&production);
            let into = edges.filter(|edge| edge.to == vertex);
            let lost_work = into.fold(0_u16, |sum, edge| sum.saturating_add(edge.work));
            tell(Point { frame: id, vertex, held, lost_work });
        }
    }

    /// What the frames above protect while this frame runs.
    fn held_above(self, mission: &Mission<'_>, id: Id) -> Condition {
        let mut held = Condition::default();
        let mut part = self.get(id);
        for (_, above) in self.above(id) {
            if let (Some(production), Some(below)) = (production_of(mission, above), part) {
                // In force if it begins before this part of the production and ends after it.
                for interval in intervals(mission, &production) {
                    if leads(mission, &production, interval.from, below.from)
                        && leads(mission, &production, below.to, interval.to)
                    {
                        held = held.and(interval.condition);
                    }
                }
            }
            part = Some(above);
        }
        held
    }
}

fn with_held_at(
    mission: &Mission<'_>,
    production: &Production,
    vertex: u8,
    outer: Condition,
) -> Condition {
    intervals(mission, production)
        .filter(|interval| {
            leads(mission, production, interval.from, vertex)
                && !leads(mission, production, interval.to, vertex)
        })
        .fold(outer, |held, interval| held.and(interval.condition))
}

fn intervals(
    mission: &Mission<'_>,
    production: &Production,
) -> impl Iterator<Item = plan_format::mission::Interval> {
    mission.intervals_of(production)
}
