//! What is violated now, and what may be violated later.

use crate::grid::{Entry, Grid, Id, Owner, is_reached};
use crate::relation::{Node, Relation};
use plan_format::mission::{Condition, Description, Facts, Life, Mission, Symbol};

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
    /// A protection interval that a sleeping behaviour holds; the component is that one's frame.
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

/// A protection interval in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The frame whose production set it up.
    pub frame: Id,
    /// The behaviour that it belongs to.
    pub owner: Owner,
    /// What it protects.
    pub condition: Condition,
}

impl Held {
    /// The protected facts that something with these effects may violate.
    pub const fn endangered(&self, may_add: Facts, may_delete: Facts) -> Facts {
        self.condition.must & may_delete | self.condition.must_not & may_add
    }
}

/// The facts of a condition that are not as it wants them.
fn violated(condition: Condition, facts: Facts) -> Facts {
    condition.must & !facts | condition.must_not & facts
}

/// What carrying out a component may make true, and what it may make false.
fn effects(mission: &Mission<'_>, symbol: Symbol) -> (Facts, Facts) {
    match symbol {
        Symbol::Frame(index) => mission
            .frames()
            .get(usize::from(index))
            .map_or((0, 0), |frame| (frame.may_add, frame.may_delete)),
        Symbol::Action(_) => mission
            .description(symbol)
            .map_or((0, 0), |d| (d.add | d.goal.must, d.delete | d.goal.must_not)),
    }
}

impl Grid {
    /// Whether a component may start: its initial description, checked once.
    pub fn initial(&self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Initial, |description| description.initial)
    }

    /// Whether a component that has ended has reached its goal: checked once, with the symbols of
    /// its add and delete lists already changed.
    pub fn goal(&self, mission: &Mission<'_>, id: Id, facts: Facts) -> Option<Signal> {
        self.check(mission, id, facts, Violation::Goal, |description| description.goal)
    }

    /// Every evident conflict of a behaviour's view: the transient descriptions of what runs, and
    /// the protection intervals in force, foreign ones of the behaviours in `holding` (one bit
    /// each) included. Checked every tick.
    pub fn evident(
        &self,
        mission: &Mission<'_>,
        owner: Owner,
        holding: u16,
        facts: Facts,
        tell: &mut dyn FnMut(Signal),
    ) {
        for (id, entry) in self.iter() {
            if entry.owner == owner && entry.life == Life::Started {
                let signal = self.check(mission, id, facts, Violation::Transient, |d| d.transient);
                signal.into_iter().for_each(&mut *tell);
            }
        }
        self.held(mission, owner, holding, &mut |held| {
            let facts = violated(held.condition, facts);
            if facts != 0 {
                let is_own = held.owner == owner;
                let what = if is_own { Violation::Interval } else { Violation::Foreign };
                tell(Signal::Evident { id: held.frame, what, facts });
            }
        });
    }

    /// The protection intervals in force in a behaviour's view: those of its own plan, and those of
    /// the behaviours in `holding`.
    pub fn held(
        &self,
        mission: &Mission<'_>,
        owner: Owner,
        holding: u16,
        tell: &mut dyn FnMut(Held),
    ) {
        for (frame, entry) in self.iter() {
            let is_foreign = 1_u16.checked_shl(u32::from(entry.owner)).unwrap_or(0) & holding != 0;
            if entry.owner == owner || is_foreign {
                self.held_by(mission, frame, entry, tell);
            }
        }
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
            violated(needs, facts) & (needs.must & may_add | needs.must_not & may_delete);
        let mut at_risk = needs.must | needs.must_not;
        for (other, before) in self.iter().filter(|(_, other)| !is_over(other)) {
            let relation = self.relation(mission, Node::from(other), Node::from(id));
            if before.owner != entry.owner || !matches!(relation, Some(Relation::CB | Relation::NE))
            {
                continue;
            }
            let (adds, deletes) = effects(mission, before.symbol);
            let provides = needs.must & adds | needs.must_not & deletes;
            let destroys = needs.must & deletes & !adds | needs.must_not & adds & !deletes;
            if relation == Some(Relation::CB) {
                missing &= !provides;
            }
            let facts = destroys & at_risk & !self.restored(mission, other, id, needs);
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
    /// which may violate a protection interval in force.
    pub fn choices(
        &self,
        mission: &Mission<'_>,
        id: Id,
        holding: u16,
        tell: &mut dyn FnMut(Signal),
    ) {
        let Some(entry) = self.get(id).filter(|entry| entry.production.is_none()) else { return };
        let Symbol::Frame(index) = entry.symbol else { return };
        let Some(frame) = mission.frames().get(usize::from(index)) else { return };
        let numbers = (frame.first..).zip(0..frame.count);
        for production in numbers.map(|(production, _)| production) {
            let Some(record) = mission.productions().get(usize::from(production)) else { continue };
            let edges = mission.edges_of(&record);
            let (adds, deletes) = edges.fold((0, 0), |(adds, deletes), edge| {
                let (more, less) = effects(mission, edge.symbol);
                (adds | more, deletes | less)
            });
            let mut facts = 0;
            self.held(mission, entry.owner, holding, &mut |held| {
                facts |= held.endangered(adds, deletes)
            });
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
        let facts = violated(which(description), facts);
        (facts != 0).then_some(Signal::Evident { id, what, facts })
    }

    fn held_by(&self, mission: &Mission<'_>, frame: Id, entry: &Entry, tell: &mut dyn FnMut(Held)) {
        let Some(production) = self.production_of(mission, entry) else { return };
        let all = mission.intervals_of(&production);
        let reached = |vertex| is_reached(mission, &production, entry.finished, vertex);
        for interval in all.filter(|interval| reached(interval.from) && !reached(interval.to)) {
            tell(Held { frame, owner: entry.owner, condition: interval.condition });
        }
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
        self.iter()
            .filter(|&(knight, entry)| !is_over(entry) && after(knight) && before(knight))
            .map(|(_, entry)| effects(mission, entry.symbol))
            .fold(0, |facts, (adds, deletes)| facts | needs.must & adds | needs.must_not & deletes)
    }
}

/// Its turn is still to come.
fn is_ahead(entry: &Entry) -> bool {
    matches!(entry.life, Life::Planned | Life::Scheduled)
}

/// It has no effects any more.
fn is_over(entry: &Entry) -> bool {
    matches!(entry.life, Life::Finished | Life::Failed | Life::Abandoned)
}
