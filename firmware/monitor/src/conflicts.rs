//! Conflicts: what is violated now, and what may be violated later.

use crate::relation::{Node, Relation};
use crate::situation_grid::SituationGrid;
use parts::{Component, Id, Life, Owner};
use plan_format::mission::{Condition, Description, Facts, Mission, Production, Symbol};

/// A conflict between the plan and the world, or within the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Violated now.
    Evident {
        /// The component that cannot go on.
        id: Id,
        /// What is violated.
        what: Violation,
        /// The facts that violate it.
        facts: Facts,
    },
    /// May be violated later.
    Possible {
        /// The component that may not be able to start.
        id: Id,
        /// Why.
        why: Doubt,
        /// The facts concerned.
        facts: Facts,
    },
}

impl Signal {
    /// The conflict if the condition that a sleeping behaviour protects is violated; `root` is the
    /// root of its plan.
    pub fn foreign(root: Id, held: Condition, facts: Facts) -> Option<Self> {
        let facts = held.violated(facts);
        (facts != 0).then_some(Self::Evident { id: root, what: Violation::Foreign, facts })
    }
}

/// What is violated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Violation {
    /// The initial description of a component that is due to start.
    Initial,
    /// The transient description of a component that runs.
    Transient,
    /// The goal description of a component that has ended.
    Goal,
    /// A protection interval of the behaviour's own plan; the component is the frame whose
    /// production has the interval.
    Interval,
    /// A protection interval of a sleeping behaviour; the component is the root of its plan.
    Foreign,
}

/// Why a conflict is possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The component needs a fact that does not hold, and no component before it provides the fact.
    NoProducer,
    /// This component may destroy a needed fact before the start, and none in between restores it.
    Clobberer(Id),
    /// This production of a frame, an index in the mission, may violate a protection interval in
    /// force.
    Choice(u16),
}

/// The facts that a component may make true, and those that it may make false.
fn effects(mission: &Mission<'_>, symbol: Symbol) -> (Facts, Facts) {
    match symbol {
        Symbol::PlanFrame(index) => mission
            .plan_frames()
            .get(usize::from(index))
            .map_or((0, 0), |frame| (frame.may_add, frame.may_delete)),
        Symbol::Action(_) => mission
            .description(symbol)
            .map_or((0, 0), |d| (d.add | d.goal.must, d.delete | d.goal.must_not)),
    }
}

/// The facts of a condition that a part of a production may violate.
pub fn endangers(mission: &Mission<'_>, production: &Production, held: Condition) -> Facts {
    mission.edges_of(production).fold(0, |facts, edge| {
        let (adds, deletes) = effects(mission, edge.symbol);
        facts | held.must & deletes | held.must_not & adds
    })
}

impl SituationGrid<'_> {
    /// The conflict if a component's initial description is violated. Checked once, when it starts.
    pub fn initial(self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Initial, |description| description.initial)
    }

    /// The conflict if a component's goal description is violated. Checked once, when it ends,
    /// after the symbols of its add and delete lists have changed.
    pub fn goal(self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Goal, |description| description.goal)
    }

    /// Every evident conflict of an owner's plan: violated transient descriptions of running
    /// components, and violated protection intervals in force. Checked every tick.
    pub fn evident(self, owner: Owner, facts: Facts) -> impl Iterator<Item = Signal> {
        let transients = self.transients(owner).map(|part| (part, Violation::Transient));
        let held = self.held(owner).map(|frame| (frame, Violation::Interval));
        transients.chain(held).filter_map(move |((id, condition), what)| {
            let facts = condition.violated(facts);
            (facts != 0).then_some(Signal::Evident { id, what, facts })
        })
    }

    /// Doubts about one planned or scheduled component, by the Modal Truth Criterion: each fact
    /// that it needs at its start must hold now or be provided by a component before it, and no
    /// component that may run in between may destroy the fact, unless a later one before the start
    /// restores it.
    pub fn possible(
        self,
        mission: &Mission<'_>,
        id: Id,
        facts: Facts,
        tell: &mut dyn FnMut(Signal),
    ) {
        let Some(entry) = self.get(id).filter(|entry| is_ahead(entry)) else { return };
        let Some(needs) = mission.description(entry.symbol).map(|d| d.initial) else { return };
        // The plan must provide only facts that one of its components can change; the world
        // provides the others, which are checked when the component starts.
        let root = self.above(id).last().map_or(entry.symbol, |(_, root)| root.symbol);
        let (may_add, may_delete) = effects(mission, root);
        let mut missing =
            needs.violated(facts) & (needs.must & may_add | needs.must_not & may_delete);
        let mut at_risk = needs.must | needs.must_not;
        for (other, before) in self.of(entry.owner).filter(|(_, other)| !is_over(other)) {
            let (adds, deletes) = effects(mission, before.symbol);
            let provides = missing & (needs.must & adds | needs.must_not & deletes);
            let destroys =
                at_risk & (needs.must & deletes & !adds | needs.must_not & adds & !deletes);
            // Relations are expensive, and most components do not affect these facts.
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

    /// Doubts about the productions of a frame that is not decomposed yet: those with a part that
    /// may violate what its own plan protects now, or what sleeping behaviours protect (`foreign`).
    pub fn choices(
        self,
        mission: &Mission<'_>,
        id: Id,
        foreign: Condition,
        tell: &mut dyn FnMut(Signal),
    ) {
        let Some(entry) = self.get(id).filter(|entry| entry.production.is_none()) else { return };
        let Symbol::PlanFrame(index) = entry.symbol else { return };
        let Some(frame) = mission.plan_frames().get(usize::from(index)) else { return };
        let held = self.held(entry.owner).fold(foreign, |all, (_, held)| all.and(held));
        let numbers = (frame.first..).zip(0..frame.count);
        for production in numbers.map(|(production, _)| production) {
            let Some(record) = mission.productions().get(usize::from(production)) else { continue };
            let facts = endangers(mission, &record, held);
            if facts != 0 {
                tell(Signal::Possible { id, why: Doubt::Choice(production), facts });
            }
        }
    }

    fn check(
        self,
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

    /// The needs of `id` that a component between `clobberer` and `id` restores (the "white
    /// knight").
    fn restored(self, mission: &Mission<'_>, clobberer: Id, id: Id, needs: Condition) -> Facts {
        let after = |knight| {
            self.relation(mission, Node::from(clobberer), Node::from(knight)) == Some(Relation::CB)
        };
        let before = |knight| {
            self.relation(mission, Node::from(knight), Node::from(id)) == Some(Relation::CB)
        };
        // Only components of the same plan come before and after each other.
        let plan = self.get(id).map(|entry| self.of(entry.owner));
        let knights = plan.into_iter().flatten().filter(|(_, entry)| !is_over(entry));
        knights.fold(0, |restored, (knight, entry)| {
            let (adds, deletes) = effects(mission, entry.symbol);
            let provides = (needs.must & adds | needs.must_not & deletes) & !restored;
            let is_between = provides != 0 && after(knight) && before(knight);
            restored | if is_between { provides } else { 0 }
        })
    }
}

/// Whether it has not started yet.
fn is_ahead(entry: &Component) -> bool {
    matches!(entry.life, Life::Planned | Life::Scheduled)
}

/// Whether it can have no further effects.
fn is_over(entry: &Component) -> bool {
    matches!(entry.life, Life::Finished | Life::Failed | Life::Abandoned)
}
