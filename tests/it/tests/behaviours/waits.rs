//! H36: no behaviour waits longer for the robot than the bound that the compiler reports.

use super::carried_out::carried_out;
use super::compiled;
use behaviour::{Behaviours, Decision, Observations, Phase, Refusal, Report};
use maps::problem::Problem;
use plan_format::mission::Mission;
use soak::fixtures::Open;
use std::fmt::Write;

const TICK_US: u64 = 50_000;
/// The end of an action takes effect in the next tick, and so does a claim.
const SEEN_MS: u64 = 2 * TICK_US / 1_000;

/// Behaviours with steps of different lengths. The first eight are as critical as their input
/// channels; the others have the inverse criticality of these.
fn mission(count: usize, plan: impl Fn(usize) -> String) -> String {
    let mut text = String::from("[facts]\nready = false\n[inputs]\n");
    for channel in 0..8 {
        let source = match channel {
            0 => "battery".into(),
            1 => "fuel".into(),
            2 => "link".into(),
            _ => format!("custom {}", channel - 2),
        };
        writeln!(text, "in{channel} = {{ source = \"{source}\", missing = {{ then = 0 }} }}")
            .unwrap();
    }
    text += "[actions]\nprepare = { do = \"hold 0.2 s\" }\ntidy = { do = \"hold 0.3 s\" }\n";
    for index in 0..count {
        let time = 0.1 + 0.1 * (index % 5) as f64;
        writeln!(text, "begin{index} = {{ do = \"hold {time:.1} s\", add = [\"ready\"] }}")
            .unwrap();
        writeln!(text, "end{index} = {{ do = \"hold 0.2 s\", delete = [\"ready\"] }}").unwrap();
    }
    for index in 0..count {
        let row = if index < 8 { "NM NM NS ZO PS PM PM" } else { "PM PM PS ZO NS NM NM" };
        let channel = index % 8;
        writeln!(text, "[behaviours.b{index}]\nplan = \"work{index}\"").unwrap();
        writeln!(text, "criticality = {{ in{channel} = \"{row}\" }}\n{}", plan(index)).unwrap();
    }
    text
}

/// The largest number of behaviours; each has one component besides its root.
fn sixteen() -> String {
    let dwell = |index| String::from(if index % 5 == 2 { "dwell_s = 1" } else { "" });
    let mut text = mission(16, dwell);
    text += "[frames]\n";
    for index in 0..16 {
        writeln!(text, "work{index} = {{ productions = [\"entry -> begin{index} -> exit\"] }}")
            .unwrap();
    }
    text
}

/// With loops, start-up, shut-down and protection intervals.
fn five() -> String {
    let activities = |index: usize| match index % 2 {
        0 => String::from("start_up = \"set_up\"\nshut_down = \"put_away\""),
        _ => String::from("dwell_s = 1"),
    };
    let mut text = mission(5, activities);
    text += "[frames]\nset_up = { productions = [\"entry -> prepare -> exit\"] }\n";
    text += "put_away = { productions = [\"entry -> tidy -> exit\"] }\n";
    for index in 0..5 {
        let graph = format!("entry -> begin{index} -> end{index} -> work{index} -> exit");
        let protect = format!("protect = [\"ready from end{index} to end{index}\"]");
        let protect = if index % 3 == 0 { protect } else { "protect = []".into() };
        writeln!(text, "work{index} = {{ productions = [{{ graph = \"{graph}\", {protect} }}] }}")
            .unwrap();
    }
    text
}

/// Each protects a fact from its first step to its last but one and violates that of the next one at
/// its end, so one that is interrupted shuts another out. A sixth one, which violates nothing, interrupts them all.
fn holding() -> String {
    let mut text = mission(6, |_| "dwell_s = 0".into());
    text = text.replace(
        "ready = false",
        "held0 = true\nheld1 = true\nheld2 = true\nheld3 = true\nheld4 = true",
    );
    for index in 0..6 {
        text = text.replace(
            &format!("begin{index} = {{ do = "),
            &format!("step{index} = {{ do = \"hold 0.2 s\" }}\nbegin{index} = {{ do = "),
        );
    }
    text = text.replace(", add = [\"ready\"]", "").replace(", delete = [\"ready\"]", "");
    for index in 0..5 {
        let next = (index + 1) % 5;
        let end = format!("end{index} = {{ do = \"hold 0.2 s\" }}");
        assert!(text.contains(&end));
        text = text.replace(&end, &format!("end{index} = {{ do = \"hold 0.2 s\", delete = [\"held{next}\"], add = [\"held{index}\"] }}"));
    }
    text += "[frames]\n";
    for index in 0..6 {
        let graph = format!("entry -> begin{index} -> step{index} -> end{index} -> exit");
        let protect = match index {
            5 => String::new(),
            _ => format!(", protect = [\"held{index} from begin{index} to step{index}\"]"),
        };
        writeln!(text, "work{index} = {{ productions = [{{ graph = \"{graph}\"{protect} }}] }}")
            .unwrap();
    }
    text
}

/// The bound that the compiler reports for each behaviour's wait, milliseconds.
fn bounds(problems: &[Problem], count: usize) -> Vec<u64> {
    let said: Vec<String> = problems.iter().map(ToString::to_string).collect();
    let note = said
        .iter()
        .find(|said| said.contains("longest waits"))
        .unwrap_or_else(|| panic!("waits are not said: {said:#?}"));
    (0..count)
        .map(|index| {
            let name = format!("`b{index}` ");
            let from = note.find(&name).unwrap_or_else(|| panic!("{name} in {note}")) + name.len();
            let seconds = note[from..].split(' ').next().expect("a number");
            let seconds: f64 = seconds.parse().unwrap_or_else(|_| panic!("{name} in {note}"));
            (seconds * 1e3).round() as u64
        })
        .collect()
}

/// Returns how often a behaviour was excluded by what another one protects.
#[track_caller]
fn check(text: &str, count: usize) -> usize {
    let (draft, problems) = compiled(text);
    let bounds = bounds(&problems, count);
    let section = draft.expect("the mission is sound").write().expect("it fits");
    let mission = Mission::parse(&section).expect("it is sound");
    let hysteresis = mission.behaviours().iter().map(|b| b.hysteresis).fold(0.0, f32::max);
    let mut behaviours = Behaviours::new(&mission);
    let (mut waits, mut longest, mut changes) = ([0_u64; 16], [0_u64; 16], 0);
    let mut exclusions = 0;
    for tick in 1..=40_000_u64 {
        // Triangle waves of eight periods: the most critical behaviour changes within seconds.
        let wave = |channel: u64| {
            let half = 13 + 9 * channel;
            let phase = tick % (2 * half);
            Some(phase.min(2 * half - phase) as f32 / half as f32)
        };
        let seen = Observations {
            time_us: tick * TICK_US,
            position: None,
            channels: &[0, 1, 2, 3, 4, 5, 6, 7].map(wave),
            mates: &[],
            team: 0,
            // The missions use neither positions nor plans.
            world: &Open(None),
        };
        let mut report = Report::default();
        behaviours.step(&mission, &seen, &mut report);
        let changed =
            |d: &&Decision| matches!(d, Decision::Engaged { .. } | Decision::Resumed { .. });
        changes += report.decisions.iter().filter(changed).count();
        let excluded =
            |d: &&Decision| matches!(d, Decision::Refused { why: Refusal::Excluded, .. });
        exclusions += report.decisions.iter().filter(excluded).count();
        for (index, wait) in waits.iter_mut().enumerate().take(count) {
            let own = report.criticalities[index];
            let others = report.criticalities.iter().enumerate();
            let others = others.filter(|&(other, _)| other != index).map(|(_, &value)| value);
            let is_first = own > others.fold(0.0, f32::max) + hysteresis;
            let has_robot = !matches!(behaviours.phase(index), Phase::Idle | Phase::Sleeping);
            *wait = if is_first && !has_robot { *wait + TICK_US / 1_000 } else { 0 };
            longest[index] = longest[index].max(*wait);
        }
    }
    assert!(changes > 500, "only {changes} changes");
    let waited = longest.iter().filter(|&&wait| wait > SEEN_MS).count();
    assert!(waited > count / 2, "hardly anybody waits: {longest:?}");
    for (index, (wait, bound)) in longest.iter().zip(&bounds).enumerate() {
        assert!(*wait <= bound + SEEN_MS, "b{index} waited {wait} ms, and {bound} were said");
    }
    exclusions
}

#[test]
fn h36_no_behaviour_waits_longer_than_its_bound() {
    check(&sixteen(), 16);
    check(&five(), 5);
    let exclusions = check(&holding(), 6);
    assert!(
        exclusions > 100,
        "only {exclusions} exclusions: no behaviour is interrupted while it holds"
    );
}

/// A behaviour goes round a loop and protects a fact meanwhile. The other one violates the fact, so it
/// waits for the timeout of the loop, or of the frame around the loop.
#[test]
fn h36_a_loop_that_a_timeout_ends_has_a_bound() {
    let mission = |frames: &str| {
        format!(
            "[facts]
             ready = false
             [inputs]
             fuel = {{ source = 'fuel', missing = {{ then = 0 }} }}
             [actions]
             begin = {{ do = 'hold 0.1 s', add = ['ready'] }}
             step = {{ do = 'hold 0.4 s' }}
             end = {{ do = 'hold 0.2 s', delete = ['ready'] }}
             [frames]
             {frames}
             [frames.work]
             productions = [{{ graph = 'entry -> begin -> rounds -> end -> exit', protect = ['ready from rounds to end'] }}]
             [behaviours.b0]
             plan = 'work'
             dwell_s = 0
             criticality = {{ fuel = 'ZO ZO ZO ZO ZO ZO ZO' }}
             [behaviours.b1]
             plan = 'violate'
             criticality = {{ fuel = 'PM PM PM NB NB NB NB' }}
             [frames.violate]
             productions = ['entry -> end -> exit']"
        )
    };
    let own =
        mission("rounds = { productions = ['entry -> step -> rounds -> exit'], timeout_s = 3 }");
    let around = mission(
        "rounds = { productions = ['entry -> loop -> exit'], timeout_s = 3 }
         loop = { productions = ['entry -> step -> loop -> exit'] }",
    );
    let until = own.replace("timeout_s = 3", "until = ['ready'], timeout_s = 3");
    let without = mission("rounds = { productions = ['entry -> step -> rounds -> exit'] }");
    let within = mission(
        "rounds = { productions = ['entry -> once -> rounds -> exit'] }
         once = { productions = ['entry -> step -> exit'], timeout_s = 3 }",
    );
    for text in [&own, &around] {
        let (_, problems) = compiled(text);
        // 0.1 s, 3 s, and twice 0.5 s for the steps of the plan.
        assert_eq!(bounds(&problems, 2)[1], 4_100);
        // The fuel is low from 0.5 s on.
        let done = carried_out(text, |tick| if tick < 5 { 1.0 } else { 0.0 }, 40);
        assert_eq!(done, "0 begin, 1 step, 32 end");
    }
    // If it ends well, the last action follows.
    let (_, problems) = compiled(&until);
    assert_eq!(bounds(&problems, 2)[1], 4_800);
    // Without a timeout, or where the timeout is that of each round only, nothing ends the loop.
    for text in [&without, &within] {
        let (_, problems) = compiled(text);
        let is_said = |said: &Problem| said.to_string().contains("may wait for `b0` indefinitely");
        assert!(problems.iter().any(is_said), "{problems:#?}");
    }
}
