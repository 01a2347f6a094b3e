//! Random missions, sound by construction, and corrupted copies of them.

use crate::fixtures;
use crate::random::Random;
use plan_format::limits::{
    MAX_BEHAVIOURS, MAX_CHANNELS, MAX_FACTS, MAX_OUTPUTS, MAX_PROGRESS_FACTS, MAX_ROBOTS,
};
use plan_format::mission::effects;
use plan_format::mission::{
    Action, ActionKind, Behaviour, Condition, Description, Edge, Fact, FactKind, Facts, Inference,
    Input, Interval, Label, Mates, Mission, MissionDraft, PlanFrame, Production, Rule, RuleBase,
    Source, SwitchPoint, Symbol,
};

/// Draws a mission. Every feature of sound missions occurs in some.
pub fn draw(random: &mut Random) -> MissionDraft {
    let mut artist = Artist { random, draft: MissionDraft::default() };
    artist.inputs_and_rules();
    artist.facts();
    artist.descriptions();
    artist.actions();
    artist.frames();
    artist.behaviours();
    effects::spread(&mut artist.draft);
    artist.draft
}

/// Lets a mission depend on the robot's mates, and on the range that its fuel still gives.
pub fn join_team(draft: &mut MissionDraft, random: &mut Random) {
    for input in &mut draft.inputs {
        if matches!(input.source, Source::Channel(_)) && random.chance(0.5) {
            let channel = random.index(MAX_CHANNELS) as u8;
            let plan = random.index(2) as u16;
            (input.source, input.high) = match random.index(5) {
                0 => (Source::MatesLinked, 3.0),
                1 => (Source::OldestNews, 10.0),
                2 => (Source::DistanceToMate(some_robots(random)), 25.0),
                3 => (Source::LinkToMate(random.index(MAX_ROBOTS) as u8), 1.0),
                _ => (Source::RangeLeft { plan, channel, full_m: random.between(1.0, 60.0) }, 25.0),
            };
            input.low = 0.0;
        }
    }
    for fact in &mut draft.facts {
        if matches!(fact.kind, FactKind::Near { .. } | FactKind::Inside { .. }) {
            let mates = Mates {
                robots: some_robots(random),
                all: random.chance(0.5),
                missing: random.chance(0.5),
            };
            let radius_m = random.between(0.5, 10.0);
            let (x_m, y_m) = (random.between(0.0, 20.0), random.between(0.0, 20.0));
            fact.kind = match random.index(4) {
                0 => FactKind::Linked(mates),
                1 => FactKind::MateNear { mates, radius_m },
                2 => FactKind::MateAt { mates, x_m, y_m, radius_m },
                _ => FactKind::MateSignals { mates, code: random.index(3) as u16 },
            };
        }
    }
}

/// A set of robots that is not empty.
fn some_robots(random: &mut Random) -> u8 {
    1 + random.index((1 << MAX_ROBOTS) - 1) as u8
}

/// Corrupts a mission in several ways. Returns how often it was refused and, if the corrupted bytes
/// are still a mission, a blob with it.
pub fn corrupt(draft: &MissionDraft, random: &mut Random) -> (u64, Option<Vec<u8>>) {
    let mut refused = 0;
    for corrupt in CORRUPTIONS {
        let mut corrupted = draft.clone();
        corrupt(&mut corrupted);
        assert!(corrupted.write().is_err(), "an unsound mission is refused");
        refused += 1;
    }
    let mut bytes = draft.write().expect("a drawn mission is sound");
    for _ in 0..random.count(1, 4) {
        let at = random.index(bytes.len());
        bytes[at] ^= 1 << random.index(8);
    }
    match Mission::parse(&bytes) {
        Ok(mission) => (refused, fixtures::blob(copied(&mission)).ok()),
        Err(_) => (refused + 1, None),
    }
}

/// Changes that make any sound mission unsound.
const CORRUPTIONS: &[fn(&mut MissionDraft)] = &[
    |d| d.inputs[0].high = d.inputs[0].low,
    |d| d.inputs[0].missing = f32::NAN,
    |d| d.rules[0].input = u8::MAX,
    |d| d.rule_bases[0].count = 0,
    |d| d.rule_bases[0].first = u16::MAX,
    |d| d.descriptions[0].max_speed_mps = -1.0,
    |d| d.actions[0].timeout_ms = 0,
    |d| d.actions[0].description = u16::MAX,
    |d| d.frames[0].count = 0,
    |d| d.frames[0].threshold = 1.5,
    |d| d.productions[0].vertices = 1,
    |d| d.edges[0].to = d.edges[0].from,
    |d| d.edges[0].symbol = Symbol::PlanFrame(u16::MAX),
    |d| d.behaviours[0].rules = u16::MAX - 1,
    |d| d.behaviours[0].dormant = f32::INFINITY,
    |d| d.behaviours = vec![d.behaviours[0]; MAX_BEHAVIOURS + 1],
];

/// A mission's records, without their names.
fn copied(mission: &Mission<'_>) -> MissionDraft {
    let mut draft = MissionDraft::default();
    let name = draft.name("");
    draft.inputs = mission.inputs().iter().map(|input| Input { name, ..input }).collect();
    draft.rules = mission.rules().iter().collect();
    draft.rule_bases = mission.rule_bases().iter().collect();
    draft.facts = mission.facts().iter().map(|fact| Fact { name, ..fact }).collect();
    draft.descriptions = mission.descriptions().iter().collect();
    draft.actions = mission.actions().iter().map(|action| Action { name, ..action }).collect();
    draft.frames = mission.plan_frames().iter().map(|frame| PlanFrame { name, ..frame }).collect();
    draft.productions =
        mission.productions().iter().map(|production| Production { name, ..production }).collect();
    draft.edges = mission.edges().iter().collect();
    draft.intervals = mission.intervals().iter().collect();
    draft.behaviours =
        mission.behaviours().iter().map(|behaviour| Behaviour { name, ..behaviour }).collect();
    draft
}

struct Artist<'r> {
    random: &'r mut Random,
    draft: MissionDraft,
}

impl Artist<'_> {
    /// Sensed inputs, rule bases over them, inputs that are results of those, and rule bases over
    /// all.
    fn inputs_and_rules(&mut self) {
        for _ in 0..self.random.count(1, 6) {
            let source = match self.random.index(10) {
                0 => Source::DistanceTo { x_m: self.coordinate(), y_m: self.coordinate() },
                1 => Source::Time,
                2 => Source::CostToGoal { plan: self.random.index(2) as u16 },
                3 => Source::PriceOfConstraint { plan: 0, layer: self.random.index(2) as u8 },
                4 => Source::Output(self.random.index(MAX_OUTPUTS) as u8),
                // Every mission has a fact.
                5 => Source::Fact(0),
                _ => Source::Channel(self.random.index(MAX_CHANNELS) as u8),
            };
            self.input(source);
        }
        for _ in 0..self.random.count(1, 6) {
            self.rule_base();
        }
        for _ in 0..self.random.index(3) {
            let rules = self.random.index(self.draft.rule_bases.len()) as u16;
            self.input(Source::Rules(rules));
        }
        for _ in 0..self.random.count(1, 20) {
            self.rule_base();
        }
    }

    fn input(&mut self, source: Source) {
        let name = self.draft.name("");
        let range = match source {
            Source::Time => 120.0,
            Source::DistanceTo { .. } | Source::CostToGoal { .. } => 25.0,
            _ => 1.0,
        };
        let (low, high) = if self.random.chance(0.2) { (range, 0.0) } else { (0.0, range) };
        self.draft.inputs.push(Input {
            name,
            source,
            low,
            high,
            hold_ms: self.random.below(1_000) as u32,
            missing: self.random.between(0.0, range),
        });
    }

    fn rule_base(&mut self) {
        let first = self.draft.rules.len() as u16;
        let count = self.random.count(1, 4);
        for _ in 0..count {
            let input = self.random.index(self.draft.inputs.len()) as u8;
            let labels = [(); 7].map(|()| Label::from_index(self.random.index(7) as u8));
            self.draft.rules.push(Rule { input, labels: labels.into() });
        }
        let inference = if self.random.chance(0.5) { Inference::Min } else { Inference::Product };
        self.draft.rule_bases.push(RuleBase { first, count: count as u8, inference });
    }

    fn facts(&mut self) {
        let name = self.draft.name("");
        let most = if self.random.one_in(8) { MAX_FACTS } else { 10 };
        let mut progress = 0;
        for _ in 0..self.random.count(1, most) {
            let kind = match self.random.index(8) {
                0 => FactKind::Level {
                    input: self.random.index(self.draft.inputs.len()) as u8,
                    low: self.random.between(0.0, 0.5),
                    high: self.random.between(0.5, 1.0),
                },
                1 => FactKind::Near {
                    x_m: self.coordinate(),
                    y_m: self.coordinate(),
                    radius_m: self.random.between(0.5, 10.0),
                },
                2 => FactKind::Inside {
                    west_m: self.random.between(0.0, 5.0),
                    south_m: self.random.between(0.0, 5.0),
                    east_m: self.random.between(10.0, 25.0),
                    north_m: self.random.between(10.0, 25.0),
                },
                3 if progress < MAX_PROGRESS_FACTS => {
                    progress += 1;
                    FactKind::NoProgress {
                        distance_m: self.random.between(0.1, 2.0),
                        within_ms: 1 + self.random.below(3_000) as u32,
                    }
                }
                _ => FactKind::Symbol { is_set: self.random.chance(0.5) },
            };
            self.draft.facts.push(Fact { name, kind });
        }
    }

    /// Most of them need few facts, or no action would ever run.
    fn descriptions(&mut self) {
        for _ in 0..self.random.count(1, 12) {
            let is_limited = self.random.chance(0.3);
            let description = Description {
                initial: self.condition(0.2),
                transient: self.condition(0.1),
                goal: self.condition(0.1),
                add: self.some_facts(0.4),
                delete: self.some_facts(0.4),
                max_speed_mps: if is_limited {
                    self.random.between(0.0, 2.0)
                } else {
                    f32::INFINITY
                },
                min_distance_m: if is_limited { self.random.between(0.0, 1.0) } else { 0.0 },
            };
            self.draft.descriptions.push(description);
        }
    }

    fn condition(&mut self, probability: f32) -> Condition {
        let must = self.some_facts(probability);
        Condition { must, must_not: self.some_facts(probability) & !must }
    }

    fn some_facts(&mut self, probability: f32) -> Facts {
        if self.random.chance(probability) {
            1 << self.random.index(self.draft.facts.len())
        } else {
            0
        }
    }

    fn actions(&mut self) {
        let name = self.draft.name("");
        for _ in 0..self.random.count(2, 10) {
            let short_ms = self.random.below(1_000) as u32;
            let kind = match self.random.index(12) {
                0 => ActionKind::Follow {
                    plan: self.random.index(2) as u16,
                    reactive: self.random.unit(),
                    advice: self.random.unit(),
                    noise: self.random.unit(),
                },
                1 | 2 => ActionKind::GoTo { x_m: self.coordinate(), y_m: self.coordinate() },
                3 => ActionKind::Wander { for_ms: short_ms },
                4 => ActionKind::Signal { code: self.random.below(1 << 16) as u16 },
                5 => ActionKind::SetOutput {
                    output: self.random.index(MAX_OUTPUTS) as u8,
                    is_on: self.random.chance(0.5),
                },
                6 => ActionKind::Return,
                7 => ActionKind::MoveAhead { direction_rad: self.coordinate(), for_ms: short_ms },
                8 => ActionKind::Dock {
                    x_m: self.coordinate(),
                    y_m: self.coordinate(),
                    direction_rad: self.coordinate(),
                    radius_cm: self.random.count(1, 900) as u16,
                },
                _ => ActionKind::Hold { for_ms: short_ms },
            };
            let action = Action {
                name,
                kind,
                description: self.description(),
                until: self.condition(0.1),
                timeout_ms: 1 + self.random.below(10_000) as u32,
                resources: 1,
            };
            self.draft.actions.push(action);
        }
    }

    fn frames(&mut self) {
        let name = self.draft.name("");
        let frames = self.random.count(1, 8);
        for frame in 0..frames {
            let first = self.draft.productions.len() as u16;
            let count = self.random.count(1, 3) as u8;
            for _ in 0..count {
                self.production(frame, frames);
            }
            let frame = PlanFrame {
                name,
                first,
                count,
                description: self.description(),
                threshold: self.random.between(0.0, 0.5),
                until: self.condition(0.1),
                timeout_ms: if self.random.chance(0.1) {
                    1 + self.random.below(5_000) as u32
                } else {
                    0
                },
                may_add: 0,
                may_delete: 0,
                resources: 1,
            };
            self.draft.frames.push(frame);
        }
    }

    /// Stages in sequence. Some have parallel edges or an edge that skips the next stage; the last
    /// one may be the frame itself.
    fn production(&mut self, frame: usize, frames: usize) {
        let name = self.draft.name("");
        let first_edge = self.draft.edges.len() as u16;
        let stages = self.random.count(1, 4) as u8;
        for from in 0..stages {
            let is_last = from + 1 == stages;
            if is_last && self.random.chance(0.3) {
                self.edge(from, from + 1, Symbol::PlanFrame(frame as u16));
                break;
            }
            let width = if self.random.chance(0.2) { self.random.count(2, 4) } else { 1 };
            for _ in 0..width {
                let symbol = self.symbol(frames);
                self.edge(from, from + 1, symbol);
            }
            if !is_last && self.random.chance(0.1) {
                let symbol = self.symbol(frames);
                self.edge(from, from + 2, symbol);
            }
        }
        let edges = (self.draft.edges.len() - usize::from(first_edge)) as u8;
        let first_interval = self.draft.intervals.len() as u16;
        let mut intervals = 0;
        while intervals < 2 && self.random.chance(0.3) {
            let from = self.random.index(usize::from(stages)) as u8;
            let to = from + 1 + self.random.index(usize::from(stages - from)) as u8;
            let condition = self.condition(0.7);
            self.draft.intervals.push(Interval { from, to, condition, is_derived: false });
            intervals += 1;
        }
        let rules = self.random.index(2 * self.draft.rule_bases.len()) as u16;
        self.draft.productions.push(Production {
            name,
            rules: Some(rules).filter(|&rules| usize::from(rules) < self.draft.rule_bases.len()),
            first_edge,
            edges,
            vertices: stages + 1,
            first_interval,
            intervals,
        });
    }

    fn edge(&mut self, from: u8, to: u8, symbol: Symbol) {
        let work = self.random.below(20) as u16;
        self.draft.edges.push(Edge { from, to, symbol, work });
    }

    fn symbol(&mut self, frames: usize) -> Symbol {
        if self.random.chance(0.25) {
            Symbol::PlanFrame(self.random.index(frames) as u16)
        } else {
            Symbol::Action(self.random.index(self.draft.actions.len()) as u16)
        }
    }

    fn behaviours(&mut self) {
        let name = self.draft.name("");
        let most = if self.random.chance(0.3) { MAX_BEHAVIOURS } else { 4 };
        for _ in 0..self.random.count(1, most) {
            let behaviour = Behaviour {
                name,
                root: self.frame(),
                start_up: self.random.chance(0.2).then(|| self.frame()),
                shut_down: self.random.chance(0.2).then(|| self.frame()),
                rules: self.random.index(self.draft.rule_bases.len()) as u16,
                dormant: self.random.between(0.0, 0.2),
                unconditional: self.random.between(0.6, 1.0),
                hysteresis: self.random.between(0.0, 0.1),
                dwell_ms: if self.random.chance(0.5) { 0 } else { self.random.below(2_000) as u32 },
                switch_point: if self.random.chance(0.5) {
                    SwitchPoint::Earliest
                } else {
                    SwitchPoint::Best
                },
                once: self.random.chance(0.1),
                resources: self.random.below(8) as u16,
            };
            self.draft.behaviours.push(behaviour);
        }
    }

    fn frame(&mut self) -> u16 {
        self.random.index(self.draft.frames.len()) as u16
    }

    fn description(&mut self) -> u16 {
        self.random.index(self.draft.descriptions.len()) as u16
    }

    /// A coordinate on the map, or up to 2 m outside it, metres.
    fn coordinate(&mut self) -> f32 {
        self.random.between(-2.0, 22.0)
    }
}
