//! From observations to aspects of interest, facts and criticalities.

use crate::mates::{self, Mate};
use crate::{Behaviours, Context, behaviour_bit, fact_bit};
use math::{Vec2, vector};
use plan_format::limits::{MAX_CHANNELS, MAX_INPUTS, MAX_PROGRESS_FACTS, MAX_RULE_BASES};
use plan_format::mission::{Condition, FactKind, Facts, Input, Mission, Source};

/// What the map and the parallel plans give for the robot's position.
pub trait World {
    /// Cost to the goal of a parallel plan, metres, by the most constrained layer with a route.
    fn cost_to_goal(&self, plan: u16) -> Option<f32>;
    /// Cost by a layer of a parallel plan minus cost by its layer 0, metres.
    fn price(&self, plan: u16, layer: u8) -> Option<f32>;
    /// Whether the robot is at the goal of a parallel plan.
    fn is_at_goal(&self, plan: u16) -> bool;
    /// Whether the robot is at a point, map metres.
    fn is_at(&self, point: Vec2) -> bool;
    /// Whether the robot has docked: it is at a point, map metres, which it entered from the front and
    /// in this direction, on the globe, radians counter-clockwise from east.
    fn is_docked(&self, point: Vec2, direction_rad: f32) -> bool;
}

/// What the behaviour control system sees in one tick.
#[derive(Clone, Copy)]
pub struct Observations<'a> {
    /// Microseconds since start.
    pub time_us: u64,
    /// The robot's position, map metres, if it is known.
    pub position: Option<Vec2>,
    /// Input channels (battery, fuel, link, custom).
    pub channels: &'a [Option<f32>; MAX_CHANNELS],
    /// What is known of the mates that were ever heard.
    pub mates: &'a [Mate],
    /// The numbers of all mates, one bit each.
    pub team: u8,
    /// What the map and the parallel plans give for that position.
    pub world: &'a dyn World,
}

/// Inputs, facts and progress.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Senses {
    /// The last value of each input, and its time, microseconds.
    last: [Option<(f32, u64)>; MAX_INPUTS],
    /// The value of each input in this tick, in its own unit.
    values: [f32; MAX_INPUTS],
    /// The position of that value in the input's universe, 0 ..= 1.
    positions: [f32; MAX_INPUTS],
    /// Sensed facts that hold in this tick.
    sensed: Facts,
    /// Facts that are symbols.
    symbolic: Facts,
    /// Facts about progress.
    about_progress: Facts,
    /// Whether rules use facts.
    uses_facts: bool,
    /// For each progress fact, by its number among them: the position and the time of the last
    /// sufficient progress.
    anchors: [Option<(Vec2, u64)>; MAX_PROGRESS_FACTS],
}

impl Default for Senses {
    fn default() -> Self {
        Self {
            last: [None; MAX_INPUTS],
            values: [0.0; MAX_INPUTS],
            positions: [0.0; MAX_INPUTS],
            sensed: 0,
            symbolic: 0,
            about_progress: 0,
            uses_facts: false,
            anchors: [None; MAX_PROGRESS_FACTS],
        }
    }
}

impl Senses {
    /// The result of a rule base in this tick, 1/18 ..= 17/18. Inferred on demand: most rule bases
    /// are applicabilities, and most ticks choose no production.
    pub(crate) fn infer(&self, mission: &Mission<'_>, rules: u16) -> f32 {
        let Some(base) = mission.rule_bases().get(usize::from(rules)) else { return 0.0 };
        let position = |input: u8| self.positions.get(usize::from(input)).copied().unwrap_or(0.0);
        let rows = mission.rules_of(&base).map(|rule| (rule.labels, position(rule.input)));
        fuzzy::infer(rows, base.inference)
    }

    /// Records the value of an input in this tick.
    fn set(&mut self, index: usize, input: &Input, value: f32) {
        let slots = self.values.get_mut(index).zip(self.positions.get_mut(index));
        if let Some((slot, position)) = slots {
            *slot = value;
            *position = fuzzy::position(value, input.low, input.high);
        }
    }

    /// Measures progress from the present position and time.
    pub(crate) fn forget_progress(&mut self) {
        self.anchors = [None; MAX_PROGRESS_FACTS];
        self.sensed &= !self.about_progress;
    }
}

impl Behaviours {
    /// Evaluates every input, including the results of rules, and every fact.
    pub(crate) fn sense(&mut self, mission: &Mission<'_>, seen: &Observations<'_>) {
        let (mut results_wanted, mut uses_facts) = (0, false);
        for (index, input) in mission.inputs().iter().enumerate() {
            match input.source {
                Source::Rules(rules) => {
                    results_wanted |= rules_bit(rules);
                    continue;
                }
                Source::Fact(_) => {
                    uses_facts = true;
                    continue;
                }
                _ => {}
            }
            self.observe(index, &input, seen);
            let value = self.sensed_value(index, &input);
            self.senses.set(index, &input, value);
        }
        self.track_progress(mission, seen);
        self.senses.uses_facts = uses_facts;
        if uses_facts {
            // Facts about results of rules count here as in the last tick.
            self.sense_facts(mission, seen);
        }
        self.sense_inputs_of_facts(mission);
        if results_wanted != 0 {
            self.sense_results(mission, results_wanted);
        }
        self.sense_facts(mission, seen);
    }

    /// Evaluates what may depend on symbols that have changed since: inputs that are facts, and results
    /// of rules.
    pub(crate) fn sense_anew(&mut self, mission: &Mission<'_>) {
        self.sense_inputs_of_facts(mission);
        let wanted = mission.inputs().iter().fold(0, |wanted, input| match input.source {
            Source::Rules(rules) => wanted | rules_bit(rules),
            _ => wanted,
        });
        if wanted != 0 {
            self.sense_results(mission, wanted);
        }
    }

    /// Evaluates the inputs that are facts.
    pub(crate) fn sense_inputs_of_facts(&mut self, mission: &Mission<'_>) {
        if !self.senses.uses_facts {
            return;
        }
        let facts = self.facts();
        for (index, input) in mission.inputs().iter().enumerate() {
            if let Source::Fact(fact) = input.source {
                let holds = facts & fact_bit(fact.into()) != 0;
                self.senses.set(index, &input, if holds { 1.0 } else { 0.0 });
            }
        }
    }

    /// Evaluates the inputs that are results of these rule bases, in order: each uses earlier
    /// results only.
    fn sense_results(&mut self, mission: &Mission<'_>, wanted: u64) {
        for rules in (0..MAX_RULE_BASES as u16).filter(|&rules| wanted & rules_bit(rules) != 0) {
            let result = self.senses.infer(mission, rules);
            for (index, input) in mission.inputs().iter().enumerate() {
                if input.source == Source::Rules(rules) {
                    self.senses.set(index, &input, result);
                }
            }
        }
    }

    /// Infers the criticality of some behaviours, one bit each, by their rule bases, and derives their
    /// weights.
    pub(crate) fn infer_criticalities(&mut self, some: u16, context: &mut Context<'_>) {
        let behaviours = context.mission.behaviours().iter().zip(&mut self.statuses);
        let noted = &mut context.report.criticalities;
        for (index, ((behaviour, status), noted)) in behaviours.zip(noted).enumerate() {
            if some & behaviour_bit(index) == 0 {
                continue;
            }
            let criticality = self.senses.infer(context.mission, behaviour.rules);
            *noted = criticality;
            status.resources = behaviour.resources;
            status.is_dormant = criticality <= behaviour.dormant;
            status.weight =
                criticality + if status.is_engaged() { behaviour.hysteresis } else { 0.0 };
            status.is_urgent = !status.is_dormant && status.weight >= behaviour.unconditional;
        }
    }

    /// The facts that hold now. Symbols may change within a tick; sensed facts do not.
    pub(crate) fn facts(&self) -> Facts {
        self.senses.sensed | self.symbols & self.senses.symbolic
    }

    fn sense_facts(&mut self, mission: &Mission<'_>, seen: &Observations<'_>) {
        let (mut sensed, mut symbolic, mut about_progress) = (0, 0, 0);
        let mut anchors = self.senses.anchors.iter();
        for (index, fact) in (0..).zip(mission.facts().iter()) {
            let bit = fact_bit(index);
            let holds = match fact.kind {
                FactKind::Symbol { .. } => {
                    symbolic |= bit;
                    false
                }
                FactKind::Level { input, low, high } => {
                    let value = self.value_of(usize::from(input));
                    (low..=high).contains(&value)
                }
                FactKind::Near { x_m, y_m, radius_m } => seen
                    .position
                    .is_some_and(|at| vector::length(at - Vec2::new(x_m, y_m)) <= radius_m),
                FactKind::Inside { west_m, south_m, east_m, north_m } => {
                    seen.position.is_some_and(|at| {
                        (west_m..=east_m).contains(&at.x) && (south_m..=north_m).contains(&at.y)
                    })
                }
                FactKind::NoProgress { within_ms, .. } => {
                    about_progress |= bit;
                    let anchor = anchors.next().copied().flatten();
                    anchor.is_some_and(|(_, since)| is_over(since, within_ms, self.now_us))
                }
                FactKind::Linked(_)
                | FactKind::MateNear { .. }
                | FactKind::MateAt { .. }
                | FactKind::MateSignals { .. } => {
                    mates::holds(fact.kind, seen.mates, seen.position) == Some(true)
                }
            };
            sensed |= if holds { bit } else { 0 };
        }
        (self.senses.sensed, self.senses.symbolic) = (sensed, symbolic);
        self.senses.about_progress = about_progress;
    }

    /// Records the last known value of an input, if it has one now.
    fn observe(&mut self, index: usize, input: &Input, seen: &Observations<'_>) {
        let value = match input.source {
            Source::Channel(channel) => seen.channels.get(usize::from(channel)).copied().flatten(),
            Source::DistanceTo { x_m, y_m } => {
                seen.position.map(|at| vector::length(at - Vec2::new(x_m, y_m)))
            }
            Source::Time => Some((seen.time_us / 1_000) as f32 / 1_000.0),
            Source::CostToGoal { plan } => seen.world.cost_to_goal(plan),
            Source::PriceOfConstraint { plan, layer } => seen.world.price(plan, layer),
            Source::RangeLeft { plan, channel, full_m } => {
                let level = seen.channels.get(usize::from(channel)).copied().flatten();
                let cost_m = level.and_then(|_| seen.world.cost_to_goal(plan));
                level.zip(cost_m).map(|(level, cost_m)| level * full_m - cost_m)
            }
            Source::Output(output) => {
                let bit = 1_u16.checked_shl(u32::from(output)).unwrap_or(0);
                Some(if self.outputs & bit == 0 { 0.0 } else { 1.0 })
            }
            Source::MatesLinked => Some(mates::linked(seen.mates)),
            Source::OldestNews => mates::oldest_news_s(seen.mates, seen.team),
            Source::DistanceToMate(robots) => mates::distance_m(seen.mates, robots, seen.position),
            Source::LinkToMate(robot) => Some(mates::quality(seen.mates, robot)),
            Source::Rules(_) | Source::Fact(_) => None,
        };
        let slot = self.senses.last.get_mut(index);
        if let (Some(slot), Some(value)) = (slot, value.filter(|value| value.is_finite())) {
            *slot = Some((value, self.now_us));
        }
    }

    /// The value of an input in the last tick, or its replacement, in its own unit.
    pub fn value_of(&self, index: usize) -> f32 {
        self.senses.values.get(index).copied().unwrap_or(0.0)
    }

    fn sensed_value(&self, index: usize, input: &Input) -> f32 {
        match self.senses.last.get(index).copied().flatten() {
            Some((value, at)) if !is_over(at, input.hold_ms, self.now_us) => value,
            _ => input.missing,
        }
    }

    /// Measures progress while an action drives. A robot that stands by intent is not stuck.
    fn track_progress(&mut self, mission: &Mission<'_>, seen: &Observations<'_>) {
        if !self.is_driving {
            self.senses.forget_progress();
            return;
        }
        let Some(position) = seen.position else { return };
        let distances = mission.facts().iter().filter_map(|fact| match fact.kind {
            FactKind::NoProgress { distance_m, .. } => Some(distance_m),
            _ => None,
        });
        for (distance_m, anchor) in distances.zip(&mut self.senses.anchors) {
            let is_far =
                anchor.is_none_or(|(from, _)| vector::length(position - from) >= distance_m);
            if is_far {
                *anchor = Some((position, self.now_us));
            }
        }
    }
}

/// The bit of a rule base.
fn rules_bit(rules: u16) -> u64 {
    const { assert!(MAX_RULE_BASES <= u64::BITS as usize, "sets of rule bases are u64") };
    1_u64.wrapping_shl(u32::from(rules))
}

/// Whether more than `time_ms` has passed since `since_us`.
pub(crate) fn is_over(since_us: u64, time_ms: u32, now_us: u64) -> bool {
    now_us.saturating_sub(since_us) > u64::from(time_ms) * 1_000
}

/// Whether an `until` is given and holds.
pub(crate) fn is_reached(until: Condition, facts: Facts) -> bool {
    !until.is_empty() && until.holds(facts)
}
