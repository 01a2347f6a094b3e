//! Scripts as text in, decisions as text out. Missions are in the notation of `fixtures`.
//!
//! Each line of a script sets values and runs ticks: `fuel=0.5 at=3,4 x20`. Values keep until they
//! are set again. The log has a line for each tick that differs from the one before.

use behaviour::{Behaviours, Decision, Observations, Refusal, Report, Running, World};
use math::{Vec2, vector};
use monitor::{Doubt, Signal, Violation};
use plan_format::mission::{ActionKind, Facts, Mission, Symbol};
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

/// The log of a script.
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
    fixtures::mission(mission).write().expect("the mission is sound")
}

fn parse<T: std::str::FromStr>(word: &str) -> T {
    word.parse().unwrap_or_else(|_| panic!("`{word}` is not a number"))
}

/// A world without obstacles. Parallel plan 0 leads straight to (50, 0); its layer k costs 10 k
/// metres more.
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

    fn is_at(&self, point: Vec2) -> bool {
        self.0.is_some_and(|at| vector::length(point - at) <= 1.0)
    }

    fn is_docked(&self, point: Vec2, _: f32) -> bool {
        self.is_at(point)
    }
}

/// A robot with scripted inputs.
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
                Some(("at", point)) => {
                    let (x, y) = point.split_once(',').expect("a point is x,y");
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
            mates: &[],
            team: 0,
            world: &world,
        };
        let mut report = Report::default();
        let running = self.behaviours.step(&self.mission, &seen, &mut report);
        assert_eq!(report.omitted, 0, "a test must see every decision");
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
            if let ActionKind::GoTo { x_m, y_m } = part.kind {
                let to = self.mission.actions().get(usize::from(part.action)).expect("an action");
                if to.kind != part.kind {
                    write!(text, " to {x_m},{y_m}").expect("a string takes everything");
                }
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
                let record = self.mission.plan_frames().get(usize::from(frame)).expect("a frame");
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
            Decision::TimedOut { symbol: Symbol::Action(index) } => {
                format!("{} timed out", self.action(index))
            }
            Decision::TimedOut { symbol: Symbol::PlanFrame(index) } => {
                let record = self.mission.plan_frames().get(usize::from(index)).expect("a frame");
                format!("{} timed out", self.mission.name(record.name))
            }
            Decision::Conflict { signal, .. } => return self.conflict(signal),
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
                    Violation::Foreign => "violates what a sleeper protects",
                },
                facts,
            ),
            Signal::Possible { .. } if !self.shows_doubts => return None,
            Signal::Possible { why, facts, .. } => (
                match why {
                    Doubt::NoProducer => "may lack",
                    Doubt::Clobberer(_) => "may lose",
                    Doubt::Choice(_) => "may violate by a choice",
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
