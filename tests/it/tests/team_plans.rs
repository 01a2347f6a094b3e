//! Serial plans of a team (W, section 3.2): robots that follow one plan after another, by triggers
//! about places, links, mates and time. Mission text in, motion out: each robot runs the firmware's
//! tick on a field without obstacles, knows its pose, and hears a mate while the test links them.

use maps::problem::Source;
use maps::{Map, formats};
use math::{Vec2, vector};
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::parse_for;
use plan_compiler::mutual_waits;
use plan_format::Blob;
use proptest::prelude::*;
use robot_io::{Commands, Heard, Mate, News, Operator, Percepts, Pose, Reason};
use std::path::Path;
use std::sync::Arc;

const MAP: &str =
    "SITE field\nORIGIN 0 0\nMISSION-AREA 100 100\nCONTROL MEASURES:\nPP StartPlace* 5 5\n";
const TICK_US: u64 = 50_000;
/// Ticks after which a link is lost, or regained, by the defaults of the mission file.
const DAMPING_TICKS: u64 = 15;

/// What every mission here has: places, a behaviour that is always engaged, facts and actions.
const SHARED: &str = r#"
resolution = 1
robot_radius = 0.3
[goals]
west = [20, 80]
middle = [50, 80]
east = [80, 80]
meet = [50, 30]
[vehicle]
max_speed = 1.6
[inputs]
time = { source = "time", universe = [0, 1], missing = { then = 0 } }
[behaviours.go]
plan = "serial"
criticality = { time = "PB PB PB PB PB PB PB" }
[facts]
"all linked" = { linked = "all" }
"a mate signals" = { mate = "any", signals = 1 }
[actions]
"to west" = { do = "follow west at 0:100" }
"to middle" = { do = "follow middle at 0:100" }
"to east" = { do = "follow east at 0:100" }
"to meet" = { do = "follow meet at 0:100" }
say = { do = "signal 1" }
wait = { do = "hold 300 s", until = ["all linked"] }
"#;

/// A mission for a team: actions in addition to the shared ones, and further tables.
fn mission(team: &[&str], actions: &str, parts: &str) -> Arc<Source> {
    let names: Vec<String> = team.iter().map(|name| format!("{name:?}")).collect();
    let text = format!(
        "{SHARED}
{actions}
{parts}\n[team]\navoid_gain = 0\nrobots = [{}]\n",
        names.join(", ")
    );
    Arc::new(Source { name: "team.mission.toml".into(), text })
}

fn blob(source: &Arc<Source>, robot: &str) -> &'static [u8] {
    compiled(MAP, source, robot).1.leak()
}

/// A map, and the blob of one robot of a team there.
pub(crate) fn compiled(map: &str, source: &Arc<Source>, robot: &str) -> (Map, Vec<u8>) {
    let loaded = formats::load_bytes(Path::new("field.ovl"), map.into(), &Default::default());
    let map = loaded.map.expect("the map is readable");
    let (mission, mut problems) = parse_for(source, Some(robot));
    let options = Options::default();
    let input = Input { map: &map, source: None, mission: &mission, options: &options };
    let blob = compile(&input, &|_, _| {}, &mut problems);
    let blob = blob.unwrap_or_else(|| panic!("{problems:?}"));
    (map, blob)
}

/// A robot that drives exactly as commanded.
struct Robot {
    blob: Blob<'static>,
    state: controller::State,
    at: Vec2,
    heading_rad: f32,
    heard: [Option<Mate>; 5],
    news: Option<News>,
    commands: Commands,
    /// The goal of the plan that it follows in this tick.
    goal: Option<Vec2>,
    is_alive: bool,
}

impl Robot {
    fn new(source: &Arc<Source>, name: &str, at: [f32; 2]) -> Self {
        let blob = Blob::parse_exact(blob(source, name)).expect("the blob is whole");
        Self {
            state: controller::State::new(&blob),
            blob,
            at: at.into(),
            heading_rad: 1.0,
            heard: [None; 5],
            news: None,
            commands: Commands::stop(Reason::Idle),
            goal: None,
            is_alive: true,
        }
    }

    fn step(&mut self, time_us: u64) {
        let pose = Pose {
            time_us,
            position_m: self.at.into(),
            heading_rad: Some(self.heading_rad),
            accuracy_mm: 10,
        };
        let percepts = Percepts {
            time_us,
            pose: Some(pose),
            speed_mps: Some(self.commands.speed_mps),
            turn_rate_radps: Some(self.commands.turn_rate_radps),
            operator: Operator { is_armed: true, ..Operator::default() },
            mates: self.heard.iter().flatten().copied().collect(),
            ..Percepts::default()
        };
        let told = controller::explain(&self.blob, &mut self.state, &percepts);
        self.commands = told.commands;
        self.goal = told.blend.map(|blend| blend.guidance.goal);
        self.news = self.state.team.news(&self.blob.parameters().team);
        let dt = TICK_US as f32 / 1e6;
        self.heading_rad += self.commands.turn_rate_radps * dt;
        self.at += vector::from_angle(self.heading_rad) * (self.commands.speed_mps * dt);
    }

    fn is_near(&self, x: f32, y: f32) -> bool {
        vector::length(self.at - Vec2::new(x, y)) < 2.5
    }

    fn heads_for(&self, x: f32, y: f32) -> bool {
        self.goal.is_some_and(|goal| vector::length(goal - Vec2::new(x, y)) < 1.0)
    }
}

struct Team {
    robots: Vec<Robot>,
    tick: u64,
}

impl Team {
    fn new(source: &Arc<Source>, robots: &[(&str, [f32; 2])]) -> Self {
        let robots = robots.iter().map(|(name, at)| Robot::new(source, name, *at)).collect();
        Self { robots, tick: 0 }
    }

    /// One tick of all robots, after the news of the last one have crossed the links that are up.
    fn step(&mut self, is_linked: bool) {
        self.tick += 1;
        let time_us = self.tick * TICK_US;
        let news: Vec<Option<News>> =
            self.robots.iter().map(|robot| robot.news.filter(|_| robot.is_alive)).collect();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let others = news.iter().enumerate().filter(|(other, _)| *other != index && is_linked);
            for (_, news) in others {
                let Some(news) = *news else { continue };
                let mate = Mate { time_us, heard: Heard { news, quality: 1.0 } };
                robot.heard[usize::from(news.robot)] = Some(mate);
            }
            if robot.is_alive {
                robot.step(time_us);
            }
        }
    }

    /// Steps until `is_so`, at most `ticks`; the number of ticks that it took.
    #[track_caller]
    fn until(&mut self, ticks: u64, is_linked: bool, is_so: impl Fn(&Self) -> bool) -> u64 {
        for step in 0..ticks {
            if is_so(self) {
                return step;
            }
            self.step(is_linked);
        }
        let places: Vec<_> = self.robots.iter().map(|robot| (robot.at, robot.commands)).collect();
        panic!("not within {ticks} ticks: {places:?}");
    }
}

const REGROUP: &str = r#"
[robots.a.frames.serial]
productions = ["entry -> to meet -> wait -> to west -> exit"]
[robots.b.frames.serial]
productions = ["entry -> to meet -> wait -> to east -> exit"]
"#;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// W30, W35, W36: the team meets at a common point, stands until the links are up, and goes on at
    /// the predicted tick, whenever that is.
    #[test]
    fn w35_a_team_regroups_and_goes_on_at_the_predicted_tick(pause in 1_u64..300) {
        let source = mission(&["a", "b"], "", REGROUP);
        let mut team = Team::new(&source, &[("a", [40.0, 10.0]), ("b", [70.0, 10.0])]);
        let all = |team: &Team, reason| {
            team.robots.iter().all(|robot| robot.commands.reason == reason)
        };
        team.until(1_500, false, |team| all(team, Reason::Holding));
        let places: Vec<Vec2> = team.robots.iter().map(|robot| robot.at).collect();
        prop_assert!(team.robots.iter().all(|robot| robot.is_near(50.0, 30.0)));
        (0..pause).for_each(|_| team.step(false));
        let still: Vec<Vec2> = team.robots.iter().map(|robot| robot.at).collect();
        prop_assert_eq!(places, still, "no vector while the link is down");
        let steps = team.until(60, true, |team| !all(team, Reason::Holding));
        prop_assert_eq!(steps, DAMPING_TICKS + 1);
        team.until(2_500, true, |team| {
            team.robots[0].is_near(20.0, 80.0) && team.robots[1].is_near(80.0, 80.0)
        });
    }

    /// W32, W33: when the link fails on the way, the robot goes to the place of the contingency plan
    /// at the predicted tick, and resumes its own plan when the link is back.
    #[test]
    fn w33_a_lost_link_leads_to_the_meeting_point_and_back(lost_at in 50_u64..500) {
        let parts = r#"
            [frames.serial]
            productions = ["entry -> lead -> exit"]
            [frames.lead]
            productions = [
                { graph = "entry -> own -> exit" },
                { graph = "entry -> regroup -> lead -> exit" },
            ]
            [robots.a.actions]
            own = { do = "follow west at 0:100", initial = ["all linked"], transient = ["all linked"] }
            [robots.b.actions]
            own = { do = "follow east at 0:100", initial = ["all linked"], transient = ["all linked"] }
        "#;
        let regroup = r#"regroup = { do = "follow meet at 0:100", until = ["all linked"] }"#;
        let source = mission(&["a", "b"], regroup, parts);
        let mut team = Team::new(&source, &[("a", [40.0, 10.0]), ("b", [60.0, 10.0])]);
        let own = |team: &Team| team.robots[0].heads_for(20.0, 80.0);
        let meeting = |team: &Team| team.robots[0].heads_for(50.0, 30.0);
        team.until(100, true, own);
        team.until(lost_at, true, |team| team.tick == lost_at);
        let steps = team.until(60, false, meeting);
        prop_assert!((DAMPING_TICKS - 1..=DAMPING_TICKS + 1).contains(&steps), "{}", steps);
        let steps = team.until(60, true, own);
        prop_assert!((DAMPING_TICKS..=DAMPING_TICKS + 2).contains(&steps), "{}", steps);
        team.until(2_500, true, |team| {
            team.robots[0].is_near(20.0, 80.0) && team.robots[1].is_near(80.0, 80.0)
        });
    }

    /// W37: two robots that wait for each other move again within the time that the compiler
    /// printed.
    #[test]
    fn w37_robots_that_wait_for_each_other_move_again_in_time(seconds in 2_u32..40) {
                let parts = r#"
            [frames.serial]
            productions = ["entry -> stand -> say -> to west -> exit"]
        "#;
        let stand = format!(
            "stand = {{ do = \"hold {seconds} s\", until = [\"a mate signals\"] }}"
        );
        let source = mission(&["a", "b"], &stand, parts);
        let (read, _) = parse_for(&source, Some("a"));
        let warnings = mutual_waits::check(&source, &read.team);
        prop_assert_eq!(warnings.len(), 1);
        let help = warnings[0].help.clone().unwrap_or_default();
        let printed = format!("a after {seconds} s and b after {seconds} s");
        prop_assert!(help.contains(&printed), "{help}");
        let mut team = Team::new(&source, &[("a", [40.0, 10.0]), ("b", [60.0, 10.0])]);
        team.until(60, true, |team| {
            team.robots.iter().all(|robot| robot.commands.reason == Reason::Holding)
        });
        let bound = u64::from(seconds) * 1_000_000 / TICK_US + 2;
        team.until(bound, true, |team| {
            team.robots.iter().all(|robot| robot.commands.reason == Reason::Driving)
        });
    }
}

/// W34: seven plans in serial, each robot a subset of its own, in the order of its production.
#[test]
fn w34_seven_plans_in_serial_each_robot_a_subset() {
    let goals = [[15, 20], [30, 60], [50, 85], [70, 60], [85, 20], [50, 45], [50, 15]];
    let mut parts = String::new();
    let mut places = String::from("[goals]\n");
    for (index, [x, y]) in goals.iter().enumerate() {
        places += &format!("p{index} = [{x}, {y}]\n");
        parts += &format!("\"to p{index}\" = {{ do = \"follow p{index} at 0:100\" }}\n");
    }
    let routes: [(&str, &[usize]); 3] =
        [("a", &[0, 1, 2, 6]), ("b", &[5, 2, 6]), ("c", &[4, 3, 2, 5])];
    for (name, route) in routes {
        let graph: String = route.iter().map(|place| format!("to p{place} -> ")).collect();
        parts +=
            &format!("[robots.{name}.frames.serial]\nproductions = [\"entry -> {graph}exit\"]\n");
    }
    let shared = mission(&["a", "b", "c"], "", &parts);
    let text = shared.text.replace("[goals]\n", &places);
    let source = Arc::new(Source { name: shared.name.clone(), text });
    let starts = [("a", [20.0, 5.0]), ("b", [50.0, 5.0]), ("c", [80.0, 5.0])];
    let mut team = Team::new(&source, &starts);
    let mut visited: [Vec<usize>; 3] = Default::default();
    for _ in 0..6_000 {
        team.step(true);
        for (robot, visited) in team.robots.iter().zip(&mut visited) {
            let at = goals.iter().position(|[x, y]| robot.heads_for(*x as f32, *y as f32));
            visited.extend(at.filter(|at| visited.last() != Some(at)));
        }
    }
    for ((name, route), visited) in routes.iter().zip(&visited) {
        // The serial plan begins anew once it is done.
        assert_eq!(&visited[..route.len()], *route, "{name}");
    }
}

/// W38: no robot commands the others. When one falls silent, they finish what does not need it.
#[test]
fn w38_the_others_finish_without_a_lost_robot() {
    let parts = r#"
        [robots.a.frames.serial]
        productions = ["entry -> to meet -> wait a little -> to west -> exit"]
        [robots.b.frames.serial]
        productions = ["entry -> to meet -> wait a little -> to east -> exit"]
        [robots.c.frames.serial]
        productions = ["entry -> to meet -> wait a little -> to middle -> exit"]
    "#;
    let own = "\"wait a little\" = { do = \"hold 20 s\", until = [\"all linked\"] }";
    let source = mission(&["a", "b", "c"], own, parts);
    let starts = [("a", [40.0, 10.0]), ("b", [60.0, 10.0]), ("c", [50.0, 5.0])];
    let mut team = Team::new(&source, &starts);
    (0..100).for_each(|_| team.step(true));
    team.robots[2].is_alive = false;
    team.until(4_000, true, |team| team.robots[0].is_near(20.0, 80.0));
    team.until(1_000, true, |team| team.robots[1].is_near(80.0, 80.0));
}

/// Least commitment: of what is left, the robot goes to the goal with the lowest cost from where it
/// is, whatever the order in the file.
#[test]
fn the_nearest_of_what_is_left_comes_first() {
    let parts = r#"
        [inputs.west]
        source = "cost-to-goal west"
        universe = [0, 120]
        missing = { then = 120 }
        [inputs.east]
        source = "cost-to-goal east"
        universe = [0, 120]
        missing = { then = 120 }
        [frames.serial]
        productions = ["entry -> visit -> visit -> exit"]
        [frames.visit]
        productions = [
            { graph = "entry -> see west -> exit", applicable = { west = "PB PM PS ZO NS NM NM" } },
            { graph = "entry -> see east -> exit", applicable = { east = "PB PM PS ZO NS NM NM" } },
        ]
    "#;
    let own = r#"
"see west" = { do = "follow west at 0:100", initial = ["not west seen"], add = ["west seen"] }
"see east" = { do = "follow east at 0:100", initial = ["not east seen"], add = ["east seen"] }
"#;
    let shared = mission(&["a", "b"], own, parts);
    let text =
        shared.text.replace("[facts]\n", "[facts]\n\"west seen\" = false\n\"east seen\" = false\n");
    let source = Arc::new(Source { name: shared.name.clone(), text });
    for (start, first, second) in
        [([25.0, 70.0], [20.0, 80.0], [80.0, 80.0]), ([75.0, 70.0], [80.0, 80.0], [20.0, 80.0])]
    {
        let mut team = Team::new(&source, &[("a", start)]);
        team.until(600, false, |team| team.robots[0].is_near(first[0], first[1]));
        team.until(2_000, false, |team| team.robots[0].is_near(second[0], second[1]));
    }
}
