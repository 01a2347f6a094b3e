//! Missions and scripts as text in, what was decided as text out.
//!
//! A mission is made of lines, each an item and, after semicolons, its clauses:
//! ```text
//! input fuel; hold 500; missing 0      a channel, 0 ..= 1, numbered in order
//! fact on-field inside 0 0 60 40       also: symbol, set, level INPUT LOW HIGH, near X Y R, stuck M MS
//! action forward goto 30 0; needs on-field; keeps !stuck; goal done; adds x; deletes y; until z
//! frame plough; at-least 0.3           clauses of actions, too
//! = forward:10 turn|lift plough; when ready PS PS PS PS PS NB NB; protect on-field 0 2
//! behaviour ploughing plough; when ready PS PS PS PS PS PS NB; dwell 1000
//! ```
//! A production's stages follow one another; what is joined by `|` runs in parallel; the number
//! after a colon is the work lost when interrupted after it.
//!
//! A script is one line for some ticks: `fuel=0.5 at=3,4 x20`. What is set stays set. The log has a
//! line for each tick that differs from the one before.

use behaviour::{Behaviours, Decision, Observations, Refusal, Report, Running, World};
use math::{Vec2, vector};
use monitor::{Doubt, Signal, Violation};
use plan_format::mission::{
    Action, ActionKind, Behaviour, Condition, Description, Edge, Fact, FactKind, Facts, Inference,
    Input, Interval, Label, Mission, MissionDraft, PlanFrame, Production, Rule, RuleBase, Source,
    SwitchPoint, Symbol,
};
use std::fmt::Write;

/// Runs a script and compares the log, line by line, without regard to indentation.
#[track_caller]
pub(crate) fn check(mission: &str, script: &str, expected: &str) {
    let log = log(mission, script);
    let lines = |text: &str| -> Vec<String> {
        text.lines().map(|line| line.trim().to_owned()).filter(|line| !line.is_empty()).collect()
    };
    assert_eq!(lines(&log), lines(expected), "the log is\n{log}");
}

/// What comes of a script.
pub(crate) fn log(mission: &str, script: &str) -> String {
    let blob = blob(mission);
    let mut robot = Robot::new(&blob);
    for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
        robot.go(line);
    }
    robot.log
}

/// The bytes of a mission's section.
pub(crate) fn blob(mission: &str) -> Vec<u8> {
    draft(mission).write().expect("the mission is sound")
}

/// The mission of a text. Panics where the text makes no sense.
pub(crate) fn draft(text: &str) -> MissionDraft {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let mut writer = Writer { draft: MissionDraft::default(), names: Vec::new() };
    for kind in ["input", "fact", "action", "frame", "behaviour"] {
        let all = lines.iter().filter_map(|line| line.strip_prefix(kind));
        let names = all.filter_map(|rest| rest.split([' ', ';']).nth(1)).map(str::to_owned);
        writer.names.push((kind, names.collect()));
    }
    for line in lines {
        let mut clauses = line.split(';').map(|clause| clause.split_whitespace().collect());
        let head: Vec<&str> = clauses.next().expect("a line has a head");
        let clauses: Vec<Vec<&str>> = clauses.collect();
        match head[0] {
            "input" => writer.input(head[1], &clauses),
            "fact" => writer.fact(head[1], &head[2..]),
            "action" => writer.action(head[1], &head[2..], &clauses),
            "frame" => writer.frame(head[1], &clauses),
            "=" => writer.production(&head[1..], &clauses),
            "behaviour" => writer.behaviour(head[1], head[2], &clauses),
            other => panic!("what is `{other}`?"),
        }
    }
    writer.close_effects();
    writer.draft
}

struct Writer {
    draft: MissionDraft,
    names: Vec<(&'static str, Vec<String>)>,
}

/// The words of a clause after its name.
fn clause<'a>(clauses: &'a [Vec<&'a str>], name: &str) -> Option<&'a [&'a str]> {
    clauses.iter().find(|clause| clause[0] == name).map(|clause| &clause[1..])
}

fn number<T: std::str::FromStr>(clauses: &[Vec<&str>], name: &str, otherwise: T) -> T {
    clause(clauses, name).map_or(otherwise, |words| parse(words[0]))
}

fn parse<T: std::str::FromStr>(word: &str) -> T {
    word.parse().unwrap_or_else(|_| panic!("`{word}` is no number"))
}

fn label(word: &str) -> Label {
    Label::ALL.into_iter().find(|label| format!("{label:?}") == word).expect("a label")
}

impl Writer {
    fn index(&self, kind: &str, name: &str) -> usize {
        let (_, names) = self.names.iter().find(|(other, _)| *other == kind).expect("a kind");
        let index = names.iter().position(|other| other == name);
        index.unwrap_or_else(|| panic!("there is no {kind} `{name}`"))
    }

    fn condition(&self, words: &[&str]) -> Condition {
        words.iter().fold(Condition::default(), |mut condition, word| {
            match word.strip_prefix('!') {
                Some(name) => condition.must_not |= 1 << self.index("fact", name),
                None => condition.must |= 1 << self.index("fact", word),
            }
            condition
        })
    }

    fn input(&mut self, name: &str, clauses: &[Vec<&str>]) {
        let channel = self.draft.inputs.len() as u8;
        let of = clause(clauses, "of");
        let source = match of.map(|words| (words[0], &words[1..])) {
            None => Source::Channel(channel),
            Some(("time", _)) => Source::Time,
            Some(("output", words)) => Source::Output(parse(words[0])),
            Some(("cost", _)) => Source::CostToGoal { plan: 0 },
            Some(("price", words)) => Source::PriceOfConstraint { plan: 0, layer: parse(words[0]) },
            Some(("distance", words)) => {
                Source::DistanceTo { x_m: parse(words[0]), y_m: parse(words[1]) }
            }
            Some(("rules", words)) => Source::Rules(self.rules(words)),
            Some((other, _)) => panic!("what is `{other}`?"),
        };
        let range = clause(clauses, "range").unwrap_or(&["0", "1"]);
        let name = self.draft.name(name);
        self.draft.inputs.push(Input {
            name,
            source,
            low: parse(range[0]),
            high: parse(range[1]),
            hold_ms: number(clauses, "hold", 0),
            missing: number(clauses, "missing", 0.0),
        });
    }

    fn fact(&mut self, name: &str, words: &[&str]) {
        let at = |index: usize| -> f32 { parse(words[index]) };
        let kind = match words[0] {
            "symbol" => FactKind::Symbol { is_set: false },
            "set" => FactKind::Symbol { is_set: true },
            "level" => {
                let input = self.index("input", words[1]) as u8;
                FactKind::Level { input, low: at(2), high: at(3) }
            }
            "near" => FactKind::Near { x_m: at(1), y_m: at(2), radius_m: at(3) },
            "inside" => {
                FactKind::Inside { west_m: at(1), south_m: at(2), east_m: at(3), north_m: at(4) }
            }
            "stuck" => FactKind::NoProgress { distance_m: at(1), within_ms: parse(words[2]) },
            other => panic!("what is `{other}`?"),
        };
        let name = self.draft.name(name);
        self.draft.facts.push(Fact { name, kind });
    }

    fn description(&mut self, clauses: &[Vec<&str>]) -> u16 {
        let condition = |name| self.condition(clause(clauses, name).unwrap_or_default());
        let description = Description {
            initial: condition("needs"),
            transient: condition("keeps"),
            goal: condition("goal"),
            add: condition("adds").must,
            delete: condition("deletes").must,
            max_speed_mps: number(clauses, "speed", f32::INFINITY),
            min_distance_m: number(clauses, "distance", 0.0),
        };
        self.draft.descriptions.push(description);
        self.draft.descriptions.len() as u16 - 1
    }

    fn action(&mut self, name: &str, words: &[&str], clauses: &[Vec<&str>]) {
        let kind = match words[0] {
            "follow" => ActionKind::Follow { plan: 0, reactive: 0.0, advice: 1.0, noise: 0.0 },
            "goto" => ActionKind::GoTo { x_m: parse(words[1]), y_m: parse(words[2]) },
            "hold" => ActionKind::Hold { for_ms: parse(words[1]) },
            "wander" => ActionKind::Wander { for_ms: parse(words[1]) },
            "signal" => ActionKind::Signal { code: parse(words[1]) },
            "set" => ActionKind::SetOutput { output: parse(words[1]), is_on: words[2] == "on" },
            other => panic!("what is `{other}`?"),
        };
        let name = self.draft.name(name);
        let action = Action {
            name,
            kind,
            description: self.description(clauses),
            until: self.condition(clause(clauses, "until").unwrap_or_default()),
            timeout_ms: number(clauses, "timeout", 3_600_000),
            resources: 1,
        };
        self.draft.actions.push(action);
    }

    fn frame(&mut self, name: &str, clauses: &[Vec<&str>]) {
        let name = self.draft.name(name);
        let frame = PlanFrame {
            name,
            first: self.draft.productions.len() as u16,
            count: 0,
            description: self.description(clauses),
            threshold: number(clauses, "at-least", 0.3),
            may_add: 0,
            may_delete: 0,
            resources: 1,
        };
        self.draft.frames.push(frame);
    }

    fn production(&mut self, stages: &[&str], clauses: &[Vec<&str>]) {
        let first_edge = self.draft.edges.len() as u16;
        for (vertex, stage) in (0..).zip(stages) {
            for part in stage.split('|') {
                let (name, work) = part.split_once(':').unwrap_or((part, "0"));
                let frames = &self.names[3].1;
                let symbol = match frames.iter().position(|frame| frame == name) {
                    Some(frame) => Symbol::Frame(frame as u16),
                    None => Symbol::Action(self.index("action", name) as u16),
                };
                let edge = Edge { from: vertex, to: vertex + 1, symbol, work: parse(work) };
                self.draft.edges.push(edge);
            }
        }
        let first_interval = self.draft.intervals.len() as u16;
        for words in clauses.iter().filter(|clause| clause[0] == "protect") {
            self.draft.intervals.push(Interval {
                from: parse(words[2]),
                to: parse(words[3]),
                condition: self.condition(&words[1..2]),
                is_derived: false,
            });
        }
        let production = Production {
            name: self.draft.name(&stages.join(" ")[..stages.join(" ").len().min(32)]),
            rules: clause(clauses, "when").map(|words| self.rules(words)),
            first_edge,
            edges: (self.draft.edges.len() - usize::from(first_edge)) as u8,
            vertices: stages.len() as u8 + 1,
            first_interval,
            intervals: (self.draft.intervals.len() - usize::from(first_interval)) as u8,
        };
        self.draft.productions.push(production);
        self.draft.frames.last_mut().expect("a frame").count += 1;
    }

    /// Rows of `INPUT label x 7`, or one of `always LABEL`.
    fn rules(&mut self, words: &[&str]) -> u16 {
        let first = self.draft.rules.len() as u16;
        if words[0] == "always" {
            self.draft.rules.push(Rule { input: 0, labels: [label(words[1]); 7].into() });
        }
        for row in words.chunks_exact(8) {
            let input = self.index("input", row[0]) as u8;
            let labels: Vec<Label> = row[1..].iter().map(|word| label(word)).collect();
            let labels = <[Label; 7]>::try_from(labels).expect("seven").into();
            self.draft.rules.push(Rule { input, labels });
        }
        let count = (self.draft.rules.len() - usize::from(first)) as u8;
        self.draft.rule_bases.push(RuleBase { first, count, inference: Inference::Min });
        self.draft.rule_bases.len() as u16 - 1
    }

    fn behaviour(&mut self, name: &str, root: &str, clauses: &[Vec<&str>]) {
        let frame = |name| clause(clauses, name).map(|words| self.index("frame", words[0]) as u16);
        let (start_up, shut_down) = (frame("start-up"), frame("shut-down"));
        let is_best = clause(clauses, "best").is_some();
        let rules = self.rules(clause(clauses, "when").expect("a criticality"));
        let behaviour = Behaviour {
            name: self.draft.name(name),
            root: self.index("frame", root) as u16,
            start_up,
            shut_down,
            rules,
            dormant: number(clauses, "dormant", 1.0 / 12.0),
            unconditional: number(clauses, "unconditional", 0.9),
            hysteresis: number(clauses, "hysteresis", 0.0),
            dwell_ms: number(clauses, "dwell", 0),
            switch_point: if is_best { SwitchPoint::Best } else { SwitchPoint::Earliest },
            resources: number(clauses, "resources", 1),
        };
        self.draft.behaviours.push(behaviour);
    }

    /// What frames may do is what anything below them may do.
    fn close_effects(&mut self) {
        let draft = &mut self.draft;
        for _ in 0..draft.frames.len() {
            for index in 0..draft.frames.len() {
                let frame = draft.frames[index];
                let productions = &draft.productions[usize::from(frame.first)..];
                let (mut add, mut delete) = effects(draft, frame.description);
                for production in &productions[..usize::from(frame.count)] {
                    let edges = &draft.edges[usize::from(production.first_edge)..];
                    for edge in &edges[..usize::from(production.edges)] {
                        let (more, less) = match edge.symbol {
                            Symbol::Frame(below) => {
                                let below = &draft.frames[usize::from(below)];
                                (below.may_add, below.may_delete)
                            }
                            Symbol::Action(action) => {
                                effects(draft, draft.actions[usize::from(action)].description)
                            }
                        };
                        add |= more;
                        delete |= less;
                    }
                }
                (draft.frames[index].may_add, draft.frames[index].may_delete) = (add, delete);
            }
        }
    }
}

fn effects(draft: &MissionDraft, description: u16) -> (Facts, Facts) {
    let d = &draft.descriptions[usize::from(description)];
    (d.add | d.goal.must, d.delete | d.goal.must_not)
}

/// A world without obstacles: parallel plan 0 leads straight to (50, 0), layer k at 10 k metres
/// more.
struct Field(Option<Vec2>);

const GOAL: Vec2 = Vec2::new(50.0, 0.0);

impl World for Field {
    fn cost_to_goal(&self, plan: u16) -> Option<f32> {
        self.0.filter(|_| plan == 0).map(|at| vector::length(GOAL - at))
    }

    fn price(&self, plan: u16, layer: u8) -> Option<f32> {
        self.0.filter(|_| plan == 0).map(|_| 10.0 * f32::from(layer))
    }

    fn is_at_goal(&self, plan: u16) -> bool {
        plan == 0 && self.is_at(GOAL)
    }

    fn is_at(&self, place: Vec2) -> bool {
        self.0.is_some_and(|at| vector::length(place - at) <= 1.0)
    }
}

/// A robot whose inputs are written by hand.
pub(crate) struct Robot<'a> {
    pub(crate) mission: Mission<'a>,
    pub(crate) behaviours: Behaviours,
    pub(crate) running: Running,
    pub(crate) report: Report,
    pub(crate) log: String,
    channels: [Option<f32>; 8],
    position: Option<Vec2>,
    tick_ms: u64,
    time_us: u64,
    tick: u32,
    shows_doubts: bool,
    last_line: String,
}

impl<'a> Robot<'a> {
    pub(crate) fn new(blob: &'a [u8]) -> Self {
        let mission = Mission::parse(blob).expect("the mission is sound");
        Self {
            mission,
            behaviours: Behaviours::new(&mission),
            running: Running::new(),
            report: Report::default(),
            log: String::new(),
            channels: [None; 8],
            position: None,
            tick_ms: 100,
            time_us: 1_000_000,
            tick: 0,
            shows_doubts: false,
            last_line: String::new(),
        }
    }

    /// One line of a script.
    pub(crate) fn go(&mut self, line: &str) {
        let mut ticks = 1;
        for word in line.split_whitespace() {
            match word.split_once('=') {
                Some(("at", "?")) => self.position = None,
                Some(("at", place)) => {
                    let (x, y) = place.split_once(',').expect("a place is x,y");
                    self.position = Some(Vec2::new(parse(x), parse(y)));
                }
                Some(("tick", ms)) => self.tick_ms = parse(ms),
                Some(("doubts", shown)) => self.shows_doubts = shown == "shown",
                Some(("back", ms)) => self.time_us -= parse::<u64>(ms) * 1_000,
                Some(("paused", ms)) => {
                    self.time_us += parse::<u64>(ms) * 1_000;
                    self.behaviours.pause(self.time_us);
                }
                Some((input, value)) => self.set(input, value),
                None => ticks = parse(word.strip_prefix('x').expect("a number of ticks")),
            }
        }
        for _ in 0..ticks {
            self.step();
        }
    }

    fn set(&mut self, input: &str, value: &str) {
        let mut inputs = self.mission.inputs().iter();
        let found = inputs.position(|record| self.mission.name(record.name) == input);
        let index = found.unwrap_or_else(|| panic!("there is no input `{input}`"));
        self.channels[index] = if value == "?" { None } else { Some(parse(value)) };
    }

    fn step(&mut self) {
        self.time_us += self.tick_ms * 1_000;
        self.tick += 1;
        let world = Field(self.position);
        let seen = Observations {
            time_us: self.time_us,
            position: self.position,
            channels: &self.channels,
            world: &world,
        };
        let mut report = Report::default();
        let running = self.behaviours.step(&self.mission, &seen, &mut report);
        assert_eq!(report.omitted, 0, "a test shall see everything");
        let mut parts: Vec<String> =
            report.decisions.iter().filter_map(|decision| self.decision(decision)).collect();
        parts.push(self.names(&running));
        (self.running, self.report) = (running, report);
        let line = parts.join(", ");
        if line != self.last_line {
            writeln!(self.log, "{}: {line}", self.tick).expect("a string takes everything");
            self.last_line = line;
        }
    }

    fn action(&self, index: u16) -> &'a str {
        let record = self.mission.actions().get(usize::from(index)).expect("an action");
        self.mission.name(record.name)
    }

    fn names(&self, running: &Running) -> String {
        let mut all = running.iter().map(|part| {
            let mut text = String::from(self.action(part.action));
            if part.max_speed_mps.is_finite() {
                write!(text, "<={}", part.max_speed_mps).expect("a string takes everything");
            }
            if part.min_distance_m > 0.0 {
                write!(text, ">={}", part.min_distance_m).expect("a string takes everything");
            }
            text
        });
        let text = all.by_ref().collect::<Vec<_>>().join(" & ");
        if text.is_empty() { "-".into() } else { text }
    }

    fn decision(&self, decision: &Decision) -> Option<String> {
        let behaviours = self.mission.behaviours();
        let name = |index: u8| {
            let record = behaviours.get(usize::from(index)).expect("a behaviour");
            self.mission.name(record.name)
        };
        Some(match *decision {
            Decision::Engaged { behaviour } => format!("{} engaged", name(behaviour)),
            Decision::Resumed { behaviour } => format!("{} resumed", name(behaviour)),
            Decision::Finished { behaviour } => format!("{} finished", name(behaviour)),
            Decision::Prepared { behaviour } => format!("{} prepares", name(behaviour)),
            Decision::Overruled { behaviour, by } => {
                format!("{} overruled by {}", name(behaviour), name(by))
            }
            Decision::NotDecomposed { frame, why } => {
                let record = self.mission.frames().get(usize::from(frame)).expect("a frame");
                format!("{} {why:?}", self.mission.name(record.name))
            }
            Decision::Failed { behaviour } => format!("{} failed", name(behaviour)),
            Decision::Interrupted { behaviour, by, is_unconditional, lost_work } => {
                let how = if is_unconditional { "stopped" } else { "interrupted" };
                let cost = if lost_work > 0 { format!(" losing {lost_work}") } else { "".into() };
                format!("{} {how} by {}{cost}", name(behaviour), name(by))
            }
            Decision::Refused { behaviour, by, why } => {
                let why = match why {
                    Refusal::Dwell => "has just begun",
                    Refusal::NoPointYet => "is at no point",
                    Refusal::BetterPointAhead => "has a better point ahead",
                    Refusal::Excluded => "excludes it",
                    Refusal::ShuttingDown => "is shutting down",
                };
                format!("{} waits: {} {why}", name(behaviour), name(by))
            }
            Decision::Chose { production, .. } => {
                let record = self.mission.productions().get(usize::from(production));
                format!("[{}]", self.mission.name(record.expect("a production").name))
            }
            Decision::TimedOut { component } => {
                let mut running = self.running.iter();
                let part = running.find(|part| part.component == component);
                format!("{} timed out", part.map_or("?", |part| self.action(part.action)))
            }
            Decision::Conflict(signal) => return self.conflict(signal),
        })
    }

    fn conflict(&self, signal: Signal) -> Option<String> {
        let (text, facts) = match signal {
            Signal::Evident { what, facts, .. } => (
                match what {
                    Violation::Initial => "cannot start",
                    Violation::Transient => "cannot go on",
                    Violation::Goal => "missed its goal",
                    Violation::Interval => "lost its protection",
                    Violation::Foreign => "spoils what a sleeper protects",
                },
                facts,
            ),
            Signal::Possible { .. } if !self.shows_doubts => return None,
            Signal::Possible { why, facts, .. } => (
                match why {
                    Doubt::NoProducer => "may lack",
                    Doubt::Clobberer(_) => "may lose",
                    Doubt::Choice(_) => "may spoil by a choice",
                },
                facts,
            ),
        };
        Some(format!("{text}: {}", self.fact_names(facts)))
    }

    /// The names of the facts that hold.
    pub(crate) fn facts(&self) -> String {
        self.fact_names(self.report.facts)
    }

    fn fact_names(&self, facts: Facts) -> String {
        let all = self.mission.facts().iter().enumerate();
        let names = all.filter(|(bit, _)| facts & 1 << bit != 0);
        names.map(|(_, fact)| self.mission.name(fact.name)).collect::<Vec<_>>().join(" ")
    }
}
