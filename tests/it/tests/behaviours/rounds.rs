//! The shipped ploughing mission, run by the robot's behaviour crate in the simplest world: a point
//! that drives straight, a tank, and six strips.
//!
//! Shows that the mission itself is sound (H26, H28, figure 4); `work` simulates it with body and
//! sensors.

use super::plough::section;
use behaviour::{Behaviours, Decision, Observations, Phase, Report, World};
use math::{Vec2, vector};
use plan_format::mission::{ActionKind, FactKind, Mission};

const TICK_S: f32 = 0.05;
const SPEED_MPS: f32 = 1.2;
/// Positions of the plans' goals, in the order of the mission's first mention of them.
const GALLON: Vec2 = Vec2::new(90.25, 28.25);
const FIELD: Vec2 = Vec2::new(60.25, 40.25);

struct Point {
    at: Vec2,
    fuel: f32,
    /// For each strip, how often it was begun at its start and how often it was finished.
    begun: [u32; 6],
    ended: [u32; 6],
}

impl World for Point {
    fn cost_to_goal(&self, _: u16) -> Option<f32> {
        None
    }

    fn price(&self, _: u16, _: u8) -> Option<f32> {
        None
    }

    fn is_at_goal(&self, plan: u16) -> bool {
        self.is_at(if plan == 0 { GALLON } else { FIELD })
    }

    fn is_at(&self, place: Vec2) -> bool {
        vector::length(place - self.at) < 0.8
    }

    fn is_docked(&self, place: Vec2, _: f32) -> bool {
        self.is_at(place)
    }
}

impl Point {
    fn ready(&self) -> f32 {
        self.ended.iter().filter(|&&ended| ended > 0).count() as f32 / 6.0
    }
}

/// The events as text: `interrupted plough by refuel after strip 2`.
#[derive(Debug, Default)]
struct Log(Vec<String>);

/// Runs until ploughing is finished. The robot burns `fuel_per_m`. `thirst` may change the tank; it
/// gets the number of finished strips and the position.
fn run(fuel_per_m: f32, mut thirst: impl FnMut(&mut Point)) -> (Point, Log) {
    let section = section();
    let mission = Mission::parse(&section).expect("a good mission");
    let mut behaviours = Behaviours::new(&mission);
    let mut point = Point { at: Vec2::new(12.0, 10.0), fuel: 1.0, begun: [0; 6], ended: [0; 6] };
    let mut log = Log::default();
    let strip_of = |index: usize| {
        let action = mission.actions().get(index)?;
        mission.name(action.name).strip_prefix("plough strip ")?.parse::<usize>().ok()
    };
    let mut last_strip = None;
    for tick in 0_u64..40_000 {
        thirst(&mut point);
        let mut channels = [None; 8];
        (channels[1], channels[3]) = (Some(point.fuel), Some(point.ready()));
        let seen = Observations {
            time_us: tick * 50_000,
            position: Some(point.at),
            channels: &channels,
            mates: &[],
            team: 0,
            world: &point,
        };
        let mut report = Report::default();
        let running = behaviours.step(&mission, &seen, &mut report);
        for decision in &report.decisions {
            match decision {
                Decision::Interrupted { behaviour, by, is_unconditional, .. } => {
                    log.0.push(format!(
                        "{behaviour} interrupted by {by} {} with {:?} ended",
                        if *is_unconditional { "at once" } else { "at a point" },
                        point.ended
                    ))
                }
                Decision::Finished { behaviour } => log.0.push(format!("{behaviour} finished")),
                Decision::Failed { behaviour } => log.0.push(format!("{behaviour} failed")),
                Decision::TimedOut { .. } => log.0.push("timed out".into()),
                _ => {}
            }
        }
        let strip = running.iter().find_map(|part| strip_of(part.action.into()));
        if strip != last_strip {
            // A strip counts as finished only if the robot is at its end.
            if let Some(ended) = last_strip
                && is_at_end(&mission, &point, ended)
            {
                point.ended[ended - 1] += 1;
            }
            if let Some(begun) = strip {
                assert!(is_at_start(&mission, &point, begun), "strip {begun} begins at its start");
                point.begun[begun - 1] += 1;
            }
            last_strip = strip;
        }
        for part in &running {
            let to = match part.kind {
                ActionKind::Follow { plan: 0, .. } => GALLON,
                ActionKind::Follow { .. } => FIELD,
                ActionKind::GoTo { x_m, y_m } => Vec2::new(x_m, y_m),
                _ => continue,
            };
            let way = to - point.at;
            let step = (SPEED_MPS * TICK_S).min(vector::length(way));
            point.at += way * (step / vector::length(way).max(1e-6));
            point.fuel = (point.fuel - step * fuel_per_m).max(0.0);
        }
        if behaviours.outputs() & 2 != 0 && point.is_at(GALLON) {
            point.fuel = (point.fuel + 0.05 * TICK_S).min(1.0);
        }
        // A behaviour that was interrupted at the last point stays asleep: nothing is left to plough.
        let is_over = matches!(behaviours.phase(0), Phase::Idle | Phase::Sleeping);
        if is_over && point.ready() >= 1.0 && behaviours.phase(1) == Phase::Idle {
            return (point, log);
        }
    }
    panic!("ploughing never ended: {log:#?}, {:?} {:?} {}", point.ended, point.at, point.fuel);
}

/// The start of a strip, from the fact that its action needs.
fn start_of(mission: &Mission<'_>, strip: usize) -> (Vec2, f32) {
    let name = format!("at strip {strip}");
    let fact = mission.facts().iter().find(|fact| mission.name(fact.name) == name);
    match fact.map(|fact| fact.kind) {
        Some(FactKind::Near { x_m, y_m, radius_m }) => (Vec2::new(x_m, y_m), radius_m),
        other => panic!("{name} is {other:?}"),
    }
}

fn is_at_start(mission: &Mission<'_>, point: &Point, strip: usize) -> bool {
    let (at, radius_m) = start_of(mission, strip);
    vector::length(point.at - at) <= radius_m
}

/// Strips lead from north to south or from south to north: the end is at the field's other side.
fn is_at_end(mission: &Mission<'_>, point: &Point, strip: usize) -> bool {
    let (at, _) = start_of(mission, strip);
    point.is_at(Vec2::new(at.x, 80.0 - at.y))
}

/// With enough fuel, no behaviour is interrupted.
#[test]
fn six_strips_are_ploughed_one_after_the_other() {
    let (point, log) = run(0.0, |_| {});
    assert_eq!((point.begun, point.ended), ([1; 6], [1; 6]), "{log:#?}");
    assert_eq!(log.0, ["0 finished"]);
}

/// H26, figure 4: refuelling becomes more critical than ploughing during a strip forward. The switch
/// waits for the point after `back`, and no strip is ploughed twice.
#[test]
fn h26_conditional_switching_waits_for_point_2() {
    let (point, log) = run(1.0 / 400.0, |_| {});
    assert_eq!((point.begun, point.ended), ([1; 6], [1; 6]), "{log:#?}");
    let interrupted: Vec<&String> =
        log.0.iter().filter(|line| line.contains("interrupted")).collect();
    assert!(!interrupted.is_empty(), "{log:#?}");
    for line in interrupted {
        assert!(line.starts_with("0 interrupted by 1 at a point"), "{log:#?}");
        // An even number of strips is finished: forward and back.
        let ended = line.matches('1').count() - "0 interrupted by 1 ".matches('1').count();
        assert_eq!(ended % 2, 0, "{line}");
    }
    assert!(
        !log.0.iter().any(|line| line.contains("failed") || line.contains("timed out")),
        "{log:#?}"
    );
}

/// H28: the tank is almost empty in the middle of a strip, forward or back. The switch is at once,
/// and only that strip is ploughed again from its start.
#[test]
fn h28_unconditional_switching_has_the_strip_ploughed_again() {
    for strip in [1_usize, 4] {
        let mut has_leaked = false;
        let (point, log) = run(1.0 / 1_000.0, |point| {
            let is_in_it = point.begun[strip - 1] == 1 && point.ended[strip - 1] == 0;
            let is_halfway = (30.0..50.0).contains(&point.at.y);
            if is_in_it && is_halfway && !has_leaked {
                has_leaked = true;
                point.fuel = 0.1;
            }
        });
        let mut begun = [1; 6];
        begun[strip - 1] = 2;
        assert_eq!((point.begun, point.ended), (begun, [1; 6]), "{log:#?}");
        assert!(log.0[0].starts_with("0 interrupted by 1 at once"), "{log:#?}");
        assert!(!log.0.iter().any(|line| line.contains("timed out")), "{log:#?}");
    }
}
