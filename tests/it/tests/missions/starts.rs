//! Missions from random starts with the paper's mixes of reactive schemas and advice.

use super::*;
use sim::{Ending, picture};
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Starts in each row of the table.
const STARTS: usize = 20;
/// Seed of the starts; the sensors of start `i` have the seed `SEED + i`.
const SEED: u64 = 2005;

/// Hollows of buildings, as south-west and north-east corners. A robot without advice drives into
/// them and is trapped.
const HOLLOWS: [[Point; 2]; 5] = [
    [[50.0, 60.0], [68.0, 96.0]],
    [[44.0, 154.0], [78.0, 212.0]],
    [[137.0, 110.0], [148.0, 130.0]],
    [[180.0, 70.0], [222.0, 112.0]],
    [[187.0, 140.0], [213.0, 176.0]],
];

/// One row of the table.
struct Row {
    gains: &'static str,
    receiver: &'static str,
    outcomes: Vec<(Point, Outcome)>,
}

#[test]
fn plans_lead_from_everywhere_to_the_goal() {
    let drifting = ReceiverSettings { correlation_s: 20.0, ..ReceiverSettings::ONE_METRE };
    let receivers = [
        ("perfect", SensorSettings::PERFECT),
        ("1 m white", SensorSettings::USUAL),
        ("1 m drifting", SensorSettings { gps: Some(drifting), ..SensorSettings::USUAL }),
    ];
    let mut rows = Vec::new();
    for gains in ["100:0", "66:34", "34:66", "0:100"] {
        let blob = blob(&[("\"34:66\"", &format!("\"{gains}\""))]);
        let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
        for (receiver, sensors) in receivers {
            // With advice alone, a GPS error may lead into an obstacle: no schema avoids it.
            if gains != "0:100" || receiver == "perfect" {
                rows.push(Row { gains, receiver, outcomes: run(blob, sensors) });
            }
        }
    }
    let table = table(&rows);
    // Shown if one of the checks below fails.
    println!("{table}");
    for row in &rows {
        row.check();
    }
    insta::assert_snapshot!(table, @r"
    gains  GPS           outside  hollow  trapped  late  touches  closest m  time s   way m
    100:0  perfect         14/17     3/3        3     0        0       0.58   127.1   144.2
    100:0  1 m white       13/17     3/3        4     0        0       0.58   119.8   138.0
    100:0  1 m drifting    14/17     3/3        3     0        0       0.57   126.2   144.1
    66:34  perfect         16/17     3/3        1     0        0       0.59   124.0   153.0
    66:34  1 m white       15/17     3/3        2     0        0       0.60   125.1   147.5
    66:34  1 m drifting    16/17     3/3        1     0        0       0.51   128.6   153.4
    34:66  perfect         17/17     3/3        0     0        0       0.59   121.0   158.0
    34:66  1 m white       17/17     3/3        0     0        0       0.48   142.8   160.4
    34:66  1 m drifting    17/17     3/3        0     0        0       0.46   132.0   160.2
    0:100  perfect         17/17     3/3        0     0        0       0.58   114.5   158.8
    ");
}

#[test]
fn a_hollow_traps_the_reactive_robot_and_not_the_advised_one() {
    for (gains, wanted) in [("100:0", Ending::Trapped), ("34:66", Ending::Reached)] {
        let blob = blob(&[("\"34:66\"", &format!("\"{gains}\""))]);
        let blob = Blob::parse(&blob).expect("the compiler writes what the robot reads");
        // Between the arms of the library.
        let robot = robot(blob, [59.5, 75.5], 0.0, SensorSettings::USUAL, SEED);
        let outcome = robot.run(&campus().world).expect("the robot answers");
        assert_eq!(outcome.ending, Some(wanted), "{gains}: {:?}", outcome.reasons);
        assert_eq!(outcome.touches, 0);
    }
}

/// Runs once from each start, on all cores.
fn run(blob: Blob<'_>, sensors: SensorSettings) -> Vec<(Point, Outcome)> {
    let starts = starts(&blob);
    let next = AtomicUsize::new(0);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let mut outcomes: Vec<(usize, Outcome)> = std::thread::scope(|scope| {
        let work = || {
            let mut done = Vec::new();
            loop {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(&(start, heading_rad)) = starts.get(number) else { return done };
                let robot = robot(blob, start, heading_rad, sensors, SEED + number as u64);
                done.push((number, robot.run(&campus().world).expect("the robot answers")));
            }
        };
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles.into_iter().flat_map(|handle| handle.join().expect("a worker ends")).collect()
    });
    outcomes.sort_by_key(|(number, _)| *number);
    outcomes.into_iter().map(|(number, outcome)| (starts[number].0, outcome)).collect()
}

/// Random positions and headings with a route to the goal and a metre of free space around the body.
fn starts(blob: &Blob<'_>) -> Vec<(Point, f64)> {
    let mut random = Random::new(SEED, Stream::Start);
    let advice = blob.parallel_plan(0).and_then(|plan| plan.layer(0)).expect("layer `physical`");
    let mut starts = Vec::new();
    while starts.len() < STARTS {
        let at = [random.between(2.0, 248.0), random.between(2.0, 248.0)];
        let heading_rad = random.between(-PI, PI);
        let cell = blob.cell_at(Vec2::new(at[0] as f32, at[1] as f32));
        let has_route =
            cell.is_some_and(|cell| matches!(advice.look_up(cell), Answer::Move { .. }));
        if has_route && campus().world.is_clear(at, 1.4) {
            starts.push((at, heading_rad));
        }
    }
    starts
}

fn is_in_a_hollow(at: Point) -> bool {
    let within = |[low, high]: [Point; 2]| {
        (low[0]..high[0]).contains(&at[0]) && (low[1]..high[1]).contains(&at[1])
    };
    HOLLOWS.into_iter().any(within)
}

impl Row {
    /// A robot with mostly advice arrives, and no robot touches anything.
    fn check(&self) {
        for (start, outcome) in &self.outcomes {
            let Row { gains, receiver, .. } = self;
            let described = || {
                let Campus { world, .. } = campus();
                let picture = picture::text(world, &outcome.route, [125.5, 240.5], 2.0);
                let Outcome { ending, closest_m, touches, reasons, .. } = outcome;
                format!(
                    "{gains} with {receiver} GPS from {start:?}: {ending:?}, {touches} touches, \
                     closest {closest_m:.2} m, {reasons:?}\n{picture}"
                )
            };
            if matches!(*gains, "34:66" | "0:100") {
                assert!(outcome.reached(), "{}", described());
            }
            assert_eq!(outcome.touches, 0, "{}", described());
        }
    }
}

/// The outcomes as a table. Starts in hollows are counted separately: a mostly reactive robot is not
/// expected to leave a hollow.
fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "gains  GPS           outside  hollow  trapped  late  touches  closest m  time s   way m\n",
    );
    for Row { gains, receiver, outcomes } in rows {
        let all = || outcomes.iter().map(|(_, outcome)| outcome);
        let count = |ending| all().filter(|outcome| outcome.ending == Some(ending)).count();
        let share = |hollow: bool| {
            let starts = outcomes.iter().filter(|(start, _)| is_in_a_hollow(*start) == hollow);
            let reached = starts.clone().filter(|(_, outcome)| outcome.reached()).count();
            format!("{reached}/{}", starts.count())
        };
        let reached = count(Ending::Reached).max(1) as f64;
        let mean = |of: fn(&Outcome) -> f64| {
            all().filter(|outcome| outcome.reached()).map(of).sum::<f64>() / reached
        };
        let (trapped, late) = (count(Ending::Trapped), count(Ending::OutOfTime));
        let touches: u32 = all().map(|outcome| outcome.touches).sum();
        let closest = all().map(|outcome| outcome.closest_m).fold(f64::INFINITY, f64::min);
        let (time, way) = (mean(|outcome| outcome.time_s), mean(|outcome| outcome.distance_m));
        let _ = writeln!(
            text,
            "{gains:<5}  {receiver:<12}  {:>7}  {:>6}  {trapped:>7}  {late:>4}  {touches:>7}  \
             {closest:>9.2}  {time:>6.1}  {way:>6.1}",
            share(false),
            share(true),
        );
    }
    text
}
