//! What is violated now, and what may be violated later.

use crate::grid::SituationGrid;
use crate::relation::{Node, Relation};
use parts::{Component, Id, Life, Owner};
use plan_format::mission::{Condition, Description, Facts, Mission, Symbol};

/// A conflict between the plan and the world, or within the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Violated now.
    Evident {
        /// The component that cannot go on.
        id: Id,
        /// What is violated.
        what: Violation,
        /// The facts that are not as they must be.
        facts: Facts,
    },
    /// May be violated later.
    Possible {
        /// The component that may not be able to start.
        id: Id,
        /// Why.
        why: Doubt,
        /// The facts that it is about.
        facts: Facts,
    },
}

impl Signal {
    /// What a sleeping behaviour holds against all others is violated; `root` is that of its plan.
    pub fn foreign(root: Id, held: Condition, facts: Facts) -> Option<Self> {
        let facts = held.violated(facts);
        (facts != 0).then_some(Self::Evident { id: root, what: Violation::Foreign, facts })
    }
}

/// What is violated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Violation {
    /// The initial description of a component that is to start.
    Initial,
    /// The transient description of one that runs.
    Transient,
    /// The goal description of one that has ended.
    Goal,
    /// A protection interval of the behaviour's own plan; the component is the frame that set it up.
    Interval,
    /// A protection interval that a sleeping behaviour holds; the component is the root of its plan.
    Foreign,
}

/// Why something may go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// It needs a fact that does not hold, and no component that comes before it brings it about.
    NoProducer,
    /// It needs a fact that this component may destroy before, and none in between restores.
    Clobberer(Id),
    /// This choice of a frame may violate a protection interval that is in force.
    Choice(u16),
}

/// What carrying out a component may make true, and what it may make false.
fn effects(mission: &Mission<'_>, symbol: Symbol) -> (Facts, Facts) {
    match symbol {
        Symbol::PlanFrame(index) => mission
            .frames()
            .get(usize::from(index))
            .map_or((0, 0), |frame| (frame.may_add, frame.may_delete)),
        Symbol::Action(_) => mission
            .description(symbol)
            .map_or((0, 0), |d| (d.add | d.goal.must, d.delete | d.goal.must_not)),
    }
}

impl SituationGrid {
    /// Whether a component may start: its initial description, checked once.
    pub fn initial(&self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Initial, |description| description.initial)
    }

    /// Whether a component that has ended has reached its goal: checked once, with the symbols of
    /// its add and delete lists already changed.
    pub fn goal(&self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Goal, |description| description.goal)
    }

    /// Every evident conflict of a behaviour's own plan: the transient descriptions of what runs,
    /// and the protection intervals in force. Checked every tick.
    pub fn evident(&self, owner: Owner, facts: Facts) -> impl Iterator<Item = Signal> {
        let transients = self.transients(owner).map(|part| (part, Violation::Transient));
        let held = self.held(owner).map(|frame| (frame, Violation::Interval));
        transients.chain(held).filter_map(move |((id, condition), what)| {
            let facts = condition.violated(facts);
            (facts != 0).then_some(Signal::Evident { id, what, facts })
        })
    }

    /// Doubts about one component that is planned or scheduled, after the Modal Truth Criterion:
    /// every fact that it needs at its start must be provided for, now or by a component that comes
    /// before it, and nothing that may come between may destroy it, unless a later component before
    /// it restores it.
    pub fn possible(
        &self,
        mission: &Mission<'_>,
        id: Id,
        facts: Facts,
        tell: &mut dyn FnMut(Signal),
    ) {
        let Some(entry) = self.get(id).filter(|entry| is_ahead(entry)) else { return };
        let Some(needs) = mission.description(entry.symbol).map(|d| d.initial) else { return };
        // Only what some component of this plan can bring about is the plan's business; the rest
        // is up to the world, and checked when the time comes.
        let root = self.above(id).last().map_or(entry.symbol, |(_, root)| root.symbol);
        let (may_add, may_delete) = effects(mission, root);
        let mut missing =
            needs.violated(facts) & (needs.must & may_add | needs.must_not & may_delete);
        let mut at_risk = needs.must | needs.must_not;
        for (other, before) in self.iter().filter(|(_, other)| !is_over(other)) {
            if before.owner != entry.owner {
                continue;
            }
            let (adds, deletes) = effects(mission, before.symbol);
            let provides = missing & (needs.must & adds | needs.must_not & deletes);
            let destroys =
                at_risk & (needs.must & deletes & !adds | needs.must_not & adds & !deletes);
            // Relations are what costs; most components have nothing to do with these facts.
            if provides | destroys == 0 {
                continue;
            }
            let relation = self.relation(mission, Node::from(other), Node::from(id));
            if relation == Some(Relation::CB) {
                missing &= !provides;
            }
            if destroys == 0 || !matches!(relation, Some(Relation::CB | Relation::NE)) {
                continue;
            }
            let facts = destroys & !self.restored(mission, other, id, needs);
            if facts != 0 {
                at_risk &= !facts;
                tell(Signal::Possible { id, why: Doubt::Clobberer(other), facts });
            }
        }
        if missing != 0 {
            tell(Signal::Possible { id, why: Doubt::NoProducer, facts: missing });
        }
    }

    /// Doubts about the choices of a frame that is not decomposed yet: productions some part of
    /// which may violate what its plan protects now, or what others hold against it (`foreign`).
    pub fn choices(
        &self,
        mission: &Mission<'_>,
        id: Id,
        foreign: Condition,
        tell: &mut dyn FnMut(Signal),
    ) {
        let Some(entry) = self.get(id).filter(|entry| entry.production.is_none()) else { return };
        let Symbol::PlanFrame(index) = entry.symbol else { return };
        let Some(frame) = mission.frames().get(usize::from(index)) else { return };
        let held = self.held(entry.owner).fold(foreign, |all, (_, held)| all.and(held));
        let numbers = (frame.first..).zip(0..frame.count);
        for production in numbers.map(|(production, _)| production) {
            let Some(record) = mission.productions().get(usize::from(production)) else { continue };
            let edges = mission.edges_of(&record);
            let (adds, deletes) = edges.fold((0, 0), |(adds, deletes), edge| {
                let (more, less) = effects(mission, edge.symbol);
                (adds | more, deletes | less)
            });
            let facts = held.must & deletes | held.must_not & adds;
            if facts != 0 {
                tell(Signal::Possible { id, why: Doubt::Choice(production), facts });
            }
        }
    }

    fn check(
        &self,
        mission: &Mission<'_>,
        id: Id,
        facts: Facts,
        what: Violation,
        which: impl FnOnce(Description) -> Condition,
    ) -> Option<Signal> {
        let description = mission.description(self.get(id)?.symbol)?;
        let facts = which(description).violated(facts);
        (facts != 0).then_some(Signal::Evident { id, what, facts })
    }

    /// The needs of `id` that some component between `clobberer` and it brings about again (the
    /// "white knight").
    fn restored(&self, mission: &Mission<'_>, clobberer: Id, id: Id, needs: Condition) -> Facts {
        let after = |knight| {
            self.relation(mission, Node::from(clobberer), Node::from(knight)) == Some(Relation::CB)
        };
        let before = |knight| {
            self.relation(mission, Node::from(knight), Node::from(id)) == Some(Relation::CB)
        };
        let knights = self.iter().filter(|(_, entry)| !is_over(entry));
        knights.fold(0, |restored, (knight, entry)| {
            let (adds, deletes) = effects(mission, entry.symbol);
            let provides = (needs.must & adds | needs.must_not & deletes) & !restored;
            let is_between = provides != 0 && after(knight) && before(knight);
            restored | if is_between { provides } else { 0 }
        })
    }
}

/// Its turn is still to come.
fn is_ahead(entry: &Component) -> bool {
    matches!(entry.life, Life::Planned | Life::Scheduled)
}

/// It has no effects any more.
fn is_over(entry: &Component) -> bool {
    matches!(entry.life, Life::Finished | Life::Failed | Life::Abandoned)
}
