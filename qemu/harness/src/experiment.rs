//! The team experiment of Wagner and Arkin (W, sections 3 to 5): six rows of trials.
//!
//! A [`Row`] is a line of the paper's table 1: a mission of `tests/maps` and the weights of its
//! blend. A [`Team`] is what the trials of a row share: map, posts and plans. A [`Trial`] is the
//! result of one run of three robots, each with the firmware's own tick. What a trial draws depends
//! on the seed, its row and its number alone, so the numbers are the same on every machine, with
//! any number of threads, and for any division into shards.

pub mod curves;
pub mod field;
pub mod figures;
pub mod findings;
pub mod metric;
pub mod statistics;
pub mod table;
pub mod variation;

use std::path::Path;

use maps::problem::{self, has_errors};
use maps::radio::{Settings, Sight};
use maps::{Map, Problem, Role};
use plan_compiler::compile::compile;
use plan_compiler::input::Options;
use plan_compiler::mission::{Goal, GoalAt};
use plan_compiler::project::{self, Project, Request};
use plan_format::parameters::Gains;
use rayon::prelude::*;
use sim::scenario::place_on_globe;
use sim::{
    Connection, Coverage, Ground, HostPilot, Point, Radio, Random, Scenario, Start, Stream,
    Surroundings, TICK_US, World, Worlds,
};

use crate::setup::root;
use variation::Variation;

/// Robots of a team.
pub const ROBOTS: usize = ROBOT_NAMES.len();
/// Their names in the missions, from west to east at the start.
const ROBOT_NAMES: [&str; 3] = ["west", "middle", "east"];
/// Time limit of a trial, seconds (W, section 4, has none; a trial that reaches it is unfinished).
pub const LIMIT_S: f64 = 1_200.0;
/// The team's centre is drawn between these coordinates along the southern edge, metres.
const START_X_M: [f64; 2] = [20.0, 230.0];
/// How far north of the edge the robots start, metres.
const START_Y_M: f64 = 2.0;
/// Distance between two robots at the start, metres.
const SPACING_M: f64 = 4.0;
/// Trials that share a field of posts: those of one of the paper's experiments.
const PER_FIELD: u32 = table::REPLICATE as u32;
/// The signal of a robot that has arrived.
const ARRIVED: u16 = 1;

/// A line of the paper's table 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Row {
    /// Reactive schemas alone.
    Reactive,
    /// 66 % reactive, 34 % plan.
    MostlyReactive,
    /// 34 % reactive, 66 % plan.
    MostlyPlan,
    /// The plan alone.
    Plan,
    /// A plan that avoids areas without radio, in parallel with one that does not.
    Parallel,
    /// Plans in serial: spread out, meet, go on together.
    Serial,
}

impl Row {
    /// All rows in the order of the table.
    pub const ALL: [Self; 6] = [
        Self::Reactive,
        Self::MostlyReactive,
        Self::MostlyPlan,
        Self::Plan,
        Self::Parallel,
        Self::Serial,
    ];

    /// Its name, also in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reactive => "reactive",
            Self::MostlyReactive => "66:34",
            Self::MostlyPlan => "34:66",
            Self::Plan => "plan",
            Self::Parallel => "parallel",
            Self::Serial => "serial",
        }
    }

    fn index(self) -> u64 {
        Self::ALL.iter().position(|row| *row == self).unwrap_or_default() as u64
    }

    /// The row with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|row| row.name() == name)
    }

    /// Its mission below `tests/maps`, and the weights that replace those of the mission.
    fn mission(self, variation: &Variation) -> (&'static str, Option<Gains>) {
        match self {
            Self::Reactive => ("team.mission.toml", Some(Gains::REACTIVE_ONLY)),
            Self::MostlyReactive => ("team.mission.toml", Some(Gains::MOSTLY_REACTIVE)),
            Self::MostlyPlan => ("team.mission.toml", Some(Gains::MOSTLY_PLAN)),
            Self::Plan => ("team.mission.toml", Some(Gains::PLAN_ONLY)),
            Self::Parallel => ("team-parallel.mission.toml", None),
            Self::Serial if variation.waits_only => ("team-waits.mission.toml", None),
            Self::Serial => ("team-serial.mission.toml", None),
        }
    }
}

/// What the trials of a row share.
#[derive(Clone, Debug)]
pub struct Team {
    /// The row.
    pub row: Row,
    /// For each robot its plans, with the map and the true world that all share.
    pub scenarios: Vec<Scenario>,
    variation: Variation,
    ground: Ground,
    /// What carries radio: buildings block it, and posts are too small to.
    air: Sight,
}

/// The result of one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The row.
    pub row: Row,
    /// Its number within the row.
    pub number: u32,
    /// Time until the last robot arrived, seconds.
    pub time_s: f64,
    /// Distance driven until they arrived, all robots together, metres.
    pub distance_m: f64,
    /// Time that robots were connected to at least one other, the sum over the robots, seconds.
    pub connected_s: f64,
    /// Share of the time in which the team was one network, 0 to 1.
    pub one_network: f64,
    /// Mean share of the pairs that reached each other without a relay, 0 to 1.
    pub connectivity: f64,
    /// Area seen, with squares of 3 m, m^2.
    pub coverage_m2: f64,
    /// Area seen, with discs of 3 m, m^2.
    pub coverage_disc_m2: f64,
    /// Robots that had not arrived when the time was over.
    pub unfinished: u32,
}

impl Trial {
    /// A trial without anything in it.
    const NONE: Self = Self {
        row: Row::Reactive,
        number: 0,
        time_s: 0.0,
        distance_m: 0.0,
        connected_s: 0.0,
        one_network: 0.0,
        connectivity: 0.0,
        coverage_m2: 0.0,
        coverage_disc_m2: 0.0,
        unfinished: 0,
    };
}

impl Team {
    /// Compiles a row's mission on a map with the posts that `field` draws. The error is a message
    /// for the user.
    pub fn new(row: Row, field: u64, variation: &Variation) -> Result<Self, String> {
        let (mission, gains) = row.mission(variation);
        let path = root().join("tests/maps").join(mission);
        let mut problems = Vec::new();
        let team = Self::compiled(row, &path, gains, field, variation, &mut problems);
        let team = team.filter(|_| !has_errors(&problems));
        team.ok_or_else(|| problem::draw(&problems, false))
    }

    fn compiled(
        row: Row,
        path: &Path,
        gains: Option<Gains>,
        field: u64,
        variation: &Variation,
        problems: &mut Vec<Problem>,
    ) -> Option<Self> {
        let mut projects = Vec::new();
        for name in ROBOT_NAMES {
            let options = Options { robot: Some(name.to_owned()), ..Options::default() };
            let request = Request { path: path.into(), options, ..Request::default() };
            projects.push(project::load(request, problems)?);
        }
        let goals = |project: &Project| project.mission.goals.clone().unwrap_or_default();
        let middle: Vec<(String, Vec<GoalAt>)> =
            goals(&projects[1]).into_iter().map(|goal| (goal.name, goal.at)).collect();
        let places: Vec<Point> = projects.iter().flat_map(goals).flat_map(places_of).collect();
        let mut whole = projects[0].map.clone();
        let buildings = World::of_map(&whole);
        let posts =
            field::posts(&whole.extent, &buildings, &places, START_Y_M, variation.posts, field);
        let mapped = posts.len() - (variation.unmapped * posts.len() as f64).round() as usize;
        whole.features.extend(posts.iter().cloned());
        let worlds = variation.difference().apply(&whole, 0);
        let mut scenarios = Vec::new();
        for (robot, mut project) in projects.into_iter().enumerate() {
            project.map.features.extend(posts[..mapped].iter().cloned());
            variation.change_map(&mut project.map);
            variation.change_mission(&mut project.mission, &middle);
            if let Some(gains) = gains {
                project.mission.behaviours.weigh(&gains);
            }
            place_on_globe(&mut project.map);
            let blob = compile(&project.input(), &|_, _| (), problems)?;
            let worlds = Worlds { known: project.map.clone(), ..worlds.clone() };
            let scenario = Scenario::new(project.map, blob, Some(surroundings()));
            scenarios.push(scenario.in_world(worlds).under(variation.conditions(robot)));
        }
        let air = Sight::of(&whole, &Settings::default());
        Some(Self { row, scenarios, variation: *variation, ground: ground(&whole), air })
    }

    /// Runs a trial. The error is a message for the user.
    pub fn trial(&self, number: u32, seed: u64) -> Result<Trial, String> {
        self.run(number, seed, |_| ())
    }

    /// Runs a trial, and hands over the positions of the robots after every tick.
    pub fn run(
        &self,
        number: u32,
        seed: u64,
        mut each_tick: impl FnMut(&[Point; ROBOTS]),
    ) -> Result<Trial, String> {
        let starts = self.starts(number, seed);
        let seed = seed_of(seed, 1 + self.row.index(), number);
        let mut random = Random::new(seed, Stream::Start);
        let mut robots = Vec::new();
        for (number, (scenario, x)) in self.scenarios.iter().zip(starts).enumerate() {
            let start = Start {
                position: [x, START_Y_M],
                heading_rad: std::f64::consts::FRAC_PI_2,
                seed: seed.wrapping_add((number as u64) << 56),
                sensors: self.variation.sensors(),
            };
            let noise = (random.unit() * 4_294_967_296.0) as u32;
            let pilot = HostPilot::new(scenario.plan().with_seed(noise));
            robots.push(scenario.robot(&start, pilot)?.to_the_end());
        }
        let radio = Radio::new(&self.air, self.variation.radio, seed);
        let mut simulation = self.scenarios[0].simulation(robots).with_radio(radio);
        let mut connection = Connection::default();
        let mut coverage = Coverage::new(&self.ground, ROBOTS);
        let mut at = [[0.0; 2]; ROBOTS];
        while !simulation.is_over() {
            simulation.step().map_err(|error| error.to_string())?;
            for (robot, state) in simulation.robots().iter().enumerate() {
                at[robot] = state.body().position;
                coverage.visit(robot, at[robot]);
            }
            connection.note(&simulation.links());
            each_tick(&at);
        }
        let outcomes = simulation.robots().iter().map(|robot| robot.outcome());
        let outcomes: Vec<_> = outcomes.collect();
        Ok(Trial {
            row: self.row,
            number,
            time_s: outcomes.iter().map(|outcome| outcome.time_s).fold(0.0, f64::max),
            distance_m: outcomes.iter().map(|outcome| outcome.distance_m).sum(),
            connected_s: (connection.connected_ticks() * TICK_US) as f64 * 1e-6,
            one_network: connection.one_network_share(),
            connectivity: connection.connectivity(),
            coverage_m2: coverage.square_m2(),
            coverage_disc_m2: coverage.disc_m2(),
            unfinished: outcomes.iter().filter(|outcome| !outcome.reached()).count() as u32,
        })
    }

    /// Where the robots start, metres east. Trials of one number start at one place in every row, so
    /// that rows differ by what they do; their noise is their own.
    fn starts(&self, number: u32, seed: u64) -> [f64; ROBOTS] {
        let mut random = Random::new(seed_of(seed, 0, number), Stream::Start);
        let aside = |robot: usize| (robot as f64 - (ROBOTS - 1) as f64 / 2.0) * SPACING_M;
        let mut draw = || random.between(START_X_M[0], START_X_M[1]);
        if !self.variation.starts_apart {
            let middle = draw();
            return std::array::from_fn(|robot| middle + aside(robot));
        }
        loop {
            let mut starts: [f64; ROBOTS] = std::array::from_fn(|_| draw());
            starts.sort_by(f64::total_cmp);
            if starts.windows(2).all(|pair| pair[1] - pair[0] >= SPACING_M) {
                return starts;
            }
        }
    }
}

/// Which trials to run.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The rows.
    pub rows: Vec<Row>,
    /// Trials of each row.
    pub trials: u32,
    /// Seed of starts and noise.
    pub seed: u64,
    /// Seed of the posts.
    pub field: u64,
    /// What differs from the paper's experiment.
    pub variation: Variation,
    /// Index and count of shards: runs only trials whose number leaves that remainder.
    pub shard: (u32, u32),
}

impl Campaign {
    /// The command that runs all its shards at once.
    pub fn command(&self) -> String {
        let Self { rows, trials, seed, field, variation, .. } = self;
        let rows: Vec<&str> = rows.iter().map(|row| row.name()).collect();
        let known = Variation::variants().into_iter().find(|(_, known)| known == variation);
        let variant = known.map(|(name, _)| format!(" --variant {name}")).unwrap_or_default();
        format!(
            "cargo experiment --trials {trials} --seed {seed} --field {field} --rows {}{variant}",
            rows.join(",")
        )
    }

    fn numbers(&self) -> impl Iterator<Item = u32> + '_ {
        let (index, count) = self.shard;
        (0..self.trials).filter(move |number| number % count == index)
    }

    /// The seed of the posts of a trial.
    fn field_of(&self, number: u32) -> u64 {
        seed_of(self.field, 0, number / PER_FIELD)
    }

    /// Number of trials.
    pub fn count(&self) -> usize {
        self.rows.len() * self.numbers().count()
    }

    /// Runs all trials on all cores and calls `step` after each. The order of the results is that of
    /// rows and numbers. The error is a message for the user.
    pub fn run(&self, step: &(dyn Fn() + Sync)) -> Result<Vec<Trial>, String> {
        let rows = self.rows.iter();
        let parts: Vec<(Row, Vec<u32>)> = rows
            .flat_map(|&row| {
                let numbers: Vec<u32> = self.numbers().collect();
                let blocks = numbers.chunk_by(|a, b| a / PER_FIELD == b / PER_FIELD);
                let blocks: Vec<Vec<u32>> = blocks.map(<[u32]>::to_vec).collect();
                blocks.into_iter().map(move |block| (row, block))
            })
            .collect();
        let run = |(row, numbers): &(Row, Vec<u32>)| {
            let team = Team::new(*row, self.field_of(numbers[0]), &self.variation)?;
            let run = |&number: &u32| {
                let trial = team.trial(number, self.seed);
                step();
                trial
            };
            numbers.par_iter().map(run).collect::<Result<Vec<Trial>, String>>()
        };
        let done: Vec<Vec<Trial>> = parts.par_iter().map(run).collect::<Result<_, String>>()?;
        Ok(done.concat())
    }
}

/// The seed of what a trial draws: neighbouring seeds, purposes and numbers draw nothing alike.
fn seed_of(seed: u64, purpose: u64, number: u32) -> u64 {
    seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add((purpose << 32) + u64::from(number))
}

/// A robot works until it reports that it has arrived.
fn surroundings() -> Surroundings {
    let world = format!("start = [0, 0]\nsignal = {ARRIVED}\ntime_limit = {LIMIT_S}\n");
    world.parse().expect("this world file is sound")
}

fn ground(map: &Map) -> Ground {
    let obstacles = map.features.iter().filter(|feature| feature.role == Role::Obstacle);
    Ground::new(&map.extent, obstacles.map(|feature| &feature.shape))
}

/// Where a goal is, as far as that is given in metres.
fn places_of(goal: Goal) -> impl Iterator<Item = Point> {
    goal.at.into_iter().filter_map(|at| match at {
        GoalAt::Position(at) => Some(at),
        GoalAt::PointOfMap(_) | GoalAt::Globe(_) => None,
    })
}
