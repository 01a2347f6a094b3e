//! The relation between two components.

use crate::situation_grid::{SituationGrid, production_of};
use parts::Id;
use parts::bits::bit;
use plan_format::mission::{Mission, Production};

/// The relation of one component to another (H, "Situation Grid").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relation {
    /// Ancestor of.
    AO,
    /// Descendant of.
    DO,
    /// Comes before.
    CB,
    /// Comes after.
    CA,
    /// Optional choice: at most one of the two will ever exist.
    OC,
    /// No entry: both may run at the same time.
    NE,
}

impl Relation {
    /// The relation with the components exchanged.
    pub const fn inverse(self) -> Self {
        match self {
            Self::AO => Self::DO,
            Self::DO => Self::AO,
            Self::CB => Self::CA,
            Self::CA => Self::CB,
            Self::OC => Self::OC,
            Self::NE => Self::NE,
        }
    }
}

/// A component of the plan, or a possible future one: an edge of a production that a frame could
/// choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Node {
    /// The component, or the frame that could choose.
    pub id: Id,
    /// Index of the production in the mission and of the edge within it, for a possible component.
    pub option: Option<(u16, u8)>,
}

impl From<Id> for Node {
    fn from(id: Id) -> Self {
        Self { id, option: None }
    }
}

impl SituationGrid<'_> {
    /// The relation of `x` to `y`, read as "x is ... y"; `None` if the two are the same or one is
    /// not in the grid.
    pub fn relation(self, mission: &Mission<'_>, x: Node, y: Node) -> Option<Relation> {
        if x == y {
            return None;
        }
        let (a, b) = (self.get(x.id)?, self.get(y.id)?);
        if a.owner != b.owner {
            return Some(Relation::NE);
        }
        if x.id == y.id {
            return Some(match (x.option, y.option) {
                (Some((one, first)), Some((other, second))) if one == other => {
                    let production = mission.productions().get(usize::from(one))?;
                    by_graph(mission, &production, first, second)
                }
                (Some(_), Some(_)) => Relation::OC,
                (None, _) => Relation::AO,
                (_, None) => Relation::DO,
            });
        }
        if self.above(y.id).any(|(id, _)| id == x.id) {
            return Some(self.to_descendant(mission, x, y));
        }
        if self.above(x.id).any(|(id, _)| id == y.id) {
            return Some(self.to_descendant(mission, y, x).inverse());
        }
        self.at_common_ancestor(mission, x.id, y.id)
    }

    /// The relation of `x` to a `y` below the component of `x`. If `x` is an edge of another
    /// production than the chosen one, it excludes `y`; otherwise the graph that contains `y`
    /// decides.
    fn to_descendant(self, mission: &Mission<'_>, x: Node, y: Node) -> Relation {
        let Some((production, edge)) = x.option else { return Relation::AO };
        let made = self.get(x.id).and_then(|entry| entry.production);
        let part = core::iter::once(y.id)
            .chain(self.above(y.id).map(|(id, _)| id))
            .filter_map(|id| self.get(id))
            .find(|entry| entry.parent == Some(x.id));
        match (mission.productions().get(usize::from(production)), part) {
            (Some(record), Some(part)) if made.map(u16::from) == Some(production) => {
                if part.edge == edge {
                    Relation::AO
                } else {
                    by_graph(mission, &record, edge, part.edge)
                }
            }
            _ => Relation::OC,
        }
    }

    fn at_common_ancestor(self, mission: &Mission<'_>, x: Id, y: Id) -> Option<Relation> {
        for (id, frame) in self.above(x) {
            let child = |of: Id| {
                core::iter::once(of)
                    .chain(self.above(of).map(|(above, _)| above))
                    .filter_map(|below| self.get(below))
                    .find(|entry| entry.parent == Some(id))
            };
            if let (Some(a), Some(b)) = (child(x), child(y)) {
                let production = production_of(mission, frame)?;
                return Some(by_graph(mission, &production, a.edge, b.edge));
            }
        }
        None
    }
}

/// The relation of two different edges of one production.
fn by_graph(mission: &Mission<'_>, production: &Production, x: u8, y: u8) -> Relation {
    let first = usize::from(production.first_edge);
    let edge = |number: u8| mission.edges().get(first + usize::from(number));
    let (Some(x), Some(y)) = (edge(x), edge(y)) else { return Relation::NE };
    if leads(mission, production, x.to, y.from) {
        Relation::CB
    } else if leads(mission, production, y.to, x.from) {
        Relation::CA
    } else {
        Relation::NE
    }
}

/// Whether a path leads from one vertex to another, or they are the same.
pub(crate) fn leads(mission: &Mission<'_>, production: &Production, from: u8, to: u8) -> bool {
    if from >= to {
        return from == to;
    }
    let edges = || mission.edges_of(production);
    let mut reached = bit(from);
    // Edges lead to later vertices, so one pass over the vertices in order is enough.
    for vertex in from..to {
        if reached & bit(vertex) != 0 {
            let next = edges().filter(|edge| edge.from == vertex);
            reached = next.fold(reached, |reached, edge| reached | bit(edge.to));
        }
    }
    reached & bit(to) != 0
}
