//! H35, H36: whatever sleeps and protects something, the robot does not idle while a behaviour is critical, and
//! the most critical one has its turn within the bound that the compiler reports.

use behaviour::{Behaviours, Decision, Observations, Phase, REST_US, Refusal, Report};
use maps::problem::{Problem, Source};
use plan_compiler::behaviours::{Plans, compile};
use plan_compiler::mission::parse;
use plan_format::mission::{Mission, MissionDraft};
use soak::fixtures::Open;
use std::fmt::Write;
use std::sync::Arc;

const TICK_US: u64 = 50_000;
/// The end of an action takes effect in the next tick, and so does a claim.
const SEEN_MS: u64 = 2 * TICK_US / 1_000;
/// Random missions.
const MISSIONS: u64 = 300;
/// Further ones, with loops that end by a condition or by their timeout.
const WITH_LOOPS: u64 = 200;
/// Further ones, in which some behaviours do not need the robot's motion.
const WITH_WAITS: u64 = 200;
/// One that is engaged and most critical waits for the others' protection no longer than this,
/// milliseconds: no plan takes longer.
const LONGEST_MS: u64 = 12_000;
/// Ticks of each: about four minutes.
const TICKS: u64 = 5_000;

/// Numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ mixed >> 31) % limit
    }

    fn one_in(&mut self, cases: u64) -> bool {
        self.below(cases) == 0
    }
}

/// The sources of input channels.
const CHANNELS: [&str; 6] = ["battery", "fuel", "link", "custom 1", "custom 2", "custom 3"];

/// A mission of three or four behaviours. Each makes a fact true, protects it for some steps, and
/// makes another one false, which a third may protect. With loops, a step may be repeated until the
/// behaviour becomes less critical, or until a timeout, alone or in turn with another one; the
/// behaviour may be interrupted at the best point. With waits, some behaviours share no resource with the
/// others: only what they protect keeps them apart.
fn mission(random: &mut Random, has_loops: bool, has_waits: bool) -> String {
    let count = 3 + random.below(2);
    let facts = 2 + random.below(2);
    let (mut inputs, mut fact_lines) = (String::from("[inputs]\n"), String::from("[facts]\n"));
    let (mut actions, mut rest) = (String::from("[actions]\n"), String::new());
    for fact in 0..facts {
        writeln!(fact_lines, "f{fact} = true").unwrap();
    }
    for b in 0..count {
        let source = CHANNELS[b as usize];
        writeln!(inputs, "in{b} = {{ source = \"{source}\", missing = {{ then = 0 }} }}").unwrap();
        let steps = 3 + random.below(2);
        let step_kind = if has_waits && random.one_in(2) { "wait" } else { "hold" };
        // Most pairs can exclude each other: each violates what the next one protects.
        let (own, other) = (b % facts, (b + 1) % facts);
        // The last one changes nothing, so it may interrupt all others anywhere.
        let has_effects = b + 1 < count;
        let last = steps - 1 - random.below(2);
        for step in 0..steps {
            let time = 0.1 + 0.1 * random.below(6) as f64;
            let effect = match step {
                0 => format!(", add = [\"f{own}\"]"),
                _ if step + 1 == steps && has_effects => format!(", delete = [\"f{other}\"]"),
                _ => String::new(),
            };
            writeln!(actions, "a{b}s{step} = {{ do = \"{step_kind} {time:.1} s\"{effect} }}")
                .unwrap();
        }
        let mut graph: Vec<String> = (0..steps).map(|step| format!("a{b}s{step}")).collect();
        if has_loops && random.one_in(2) {
            let step = 1 + random.below(steps - 2) as usize;
            writeln!(fact_lines, "calm{b} = {{ input = \"in{b}\", at_most = 0.4 }}").unwrap();
            let until =
                if random.one_in(2) { format!("until = [\"calm{b}\"]\n") } else { String::new() };
            let timeout_s = 1 + random.below(3);
            // Every other loop passes through a second frame, which may have constraints.
            let next = if random.one_in(2) { format!("m{b}") } else { format!("l{b}") };
            writeln!(
                rest,
                "[frames.l{b}]\nproductions = [\"entry -> {} -> {next} -> exit\"]\n{until}timeout_s = {timeout_s}",
                graph[step]
            )
            .unwrap();
            if next == format!("m{b}") {
                let constraint = ["", "max_speed = 1", "timeout_s = 1.5"][random.below(3) as usize];
                writeln!(
                    rest,
                    "[frames.m{b}]\nproductions = [\"entry -> m{b}s -> l{b} -> exit\"]\n{constraint}"
                )
                .unwrap();
                writeln!(actions, "m{b}s = {{ do = \"hold 0.2 s\" }}").unwrap();
            }
            graph[step] = format!("l{b}");
        }
        let (first, last) = (&graph[1], &graph[last as usize]);
        let protect = format!("protect = [\"f{own} from {first} to {last}\"]");
        writeln!(
            rest,
            "[frames.w{b}]\nproductions = [{{ graph = \"entry -> {} -> exit\", {protect} }}]",
            graph.join(" -> ")
        )
        .unwrap();
        writeln!(rest, "[behaviours.b{b}]\nplan = \"w{b}\"\nhysteresis = 0.02").unwrap();
        writeln!(rest, "dwell_s = {}", random.below(2)).unwrap();
        if has_loops && random.one_in(3) {
            writeln!(rest, "switch = \"best\"").unwrap();
        }
        let row = if random.one_in(8) { "NB NM NS ZO PS PM PB" } else { "NB NM NS ZO PS PM PM" };
        writeln!(rest, "criticality = {{ in{b} = \"{row}\" }}").unwrap();
        if random.one_in(4) {
            writeln!(rest, "start_up = \"u{b}\"\nshut_down = \"d{b}\"").unwrap();
            writeln!(rest, "[frames.u{b}]\nproductions = [\"entry -> u{b}s -> exit\"]").unwrap();
            writeln!(rest, "[frames.d{b}]\nproductions = [\"entry -> d{b}s -> exit\"]").unwrap();
            let frees = random.one_in(2);
            let (add, delete) = if frees {
                (format!(", add = [\"f{own}\"]"), format!(", delete = [\"f{own}\"]"))
            } else {
                (String::new(), String::new())
            };
            writeln!(actions, "u{b}s = {{ do = \"hold 0.2 s\"{add} }}").unwrap();
            writeln!(actions, "d{b}s = {{ do = \"hold 0.2 s\"{delete} }}").unwrap();
        }
    }
    format!("{inputs}{fact_lines}{actions}{rest}")
}

fn compiled(text: &str) -> (Option<MissionDraft>, Vec<Problem>) {
    let source = Arc::new(Source { name: "m.mission.toml".into(), text: text.into() });
    let (mission, mut problems) = parse(&source);
    let draft = compile(&mission.behaviours, &Plans::Known(Vec::new()), &mut problems);
    (draft, problems)
}

/// The bound that the compiler reports for a behaviour's wait, milliseconds, if it gives one.
fn bounds(text: &str) -> (Vec<u8>, Vec<Option<u64>>) {
    let (draft, problems) = compiled(text);
    let said: Vec<String> = problems.iter().map(ToString::to_string).collect();
    let draft = draft.unwrap_or_else(|| panic!("{said:#?}\n{text}"));
    let note = said.iter().find(|said| said.contains("longest waits")).cloned().unwrap_or_default();
    let bound = |index: usize| {
        let name = format!("`b{index}` ");
        let from = note.find(&name)? + name.len();
        let seconds: f64 = note[from..].split(' ').next()?.parse().ok()?;
        Some((seconds * 1e3).round() as u64)
    };
    let bounds = (0..draft.behaviours.len()).map(bound).collect();
    (draft.write().expect("it fits"), bounds)
}

/// What a run shows.
#[derive(Default, Debug)]
struct Seen {
    /// Sleepers overruled by urgent behaviours.
    overruled: usize,
    /// Sleepers overruled because they excluded each other.
    circles: usize,
    excluded: usize,
    interrupted: usize,
    stopped: usize,
}

/// Drives one mission with inputs that jump, and checks every tick.
fn drive(seed: u64, seen: &mut Seen) -> Result<(), String> {
    let mut random = Random(seed);
    let has_waits = seed >= MISSIONS + WITH_LOOPS;
    let text = mission(&mut random, seed >= MISSIONS, has_waits);
    let (section, bounds) = bounds(&text);
    let mission = Mission::parse(&section).expect("it is sound");
    let mut behaviours = Behaviours::new(&mission);
    let mut channels = [Some(0.0); 8];
    let (mut waits, mut deferrals, mut idle) = ([0_u64; 8], [0_u64; 8], 0);
    let mut rests_until_us = [0_u64; 8];
    for tick in 1..=TICKS {
        for channel in channels.iter_mut().take(bounds.len()) {
            // Those that are critical for long begin anew again and again.
            if random.one_in(if has_waits { 250 } else { 40 }) {
                // Dormant in every third case.
                *channel = Some(random.below(9).saturating_sub(2) as f32 / 6.0);
            }
        }
        let observations = Observations {
            time_us: tick * TICK_US,
            position: None,
            channels: &channels,
            // The missions use neither positions nor plans.
            world: &Open(None),
            mates: &[],
            team: 0,
        };
        let mut report = Report::default();
        behaviours.step(&mission, &observations, &mut report);
        let mut has_ended = false;
        let mut refused = [false; 8];
        for decision in &report.decisions {
            match *decision {
                Decision::Failed { behaviour } => {
                    rests_until_us[usize::from(behaviour)] = tick * TICK_US + REST_US;
                    has_ended = true;
                }
                Decision::Finished { .. } => has_ended = true,
                Decision::Overruled { by, .. } => {
                    let by = usize::from(by);
                    let record = mission.behaviours().get(by).expect("it exists");
                    let is_urgent = report.criticalities[by] >= record.unconditional;
                    seen.overruled += usize::from(is_urgent);
                    seen.circles += usize::from(!is_urgent);
                }
                Decision::Refused { behaviour, why: Refusal::Excluded, .. } => {
                    refused[usize::from(behaviour)] = true;
                    seen.excluded += 1;
                }
                Decision::Interrupted { is_unconditional, .. } => {
                    seen.interrupted += usize::from(!is_unconditional);
                    seen.stopped += usize::from(is_unconditional);
                }
                _ => {}
            }
        }
        let is_engaged = |index| !matches!(behaviours.phase(index), Phase::Idle | Phase::Sleeping);
        let rests = |index: usize| tick * TICK_US <= rests_until_us[index];
        let wants = |index: usize| {
            let record = mission.behaviours().get(index).expect("it exists");
            report.criticalities[index] > record.dormant && !rests(index)
        };
        let count = bounds.len();
        let is_idle = !has_ended && !(0..count).any(is_engaged) && (0..count).any(wants);
        idle = if is_idle { idle + 1 } else { 0 };
        if idle > 1 {
            return Err(format!("seed {seed}, tick {tick}: no behaviour has the robot\n{text}"));
        }
        for index in 0..count {
            let own = report.criticalities[index];
            let others = (0..count).filter(|&other| other != index);
            let highest = others.map(|other| report.criticalities[other]).fold(0.0, f32::max);
            let is_first = wants(index) && own > highest + 0.02;
            let waits_on = is_first && !is_engaged(index);
            waits[index] = if waits_on { waits[index] + TICK_US / 1_000 } else { 0 };
            let is_deferred = is_first && is_engaged(index) && refused[index];
            deferrals[index] = if is_deferred { deferrals[index] + TICK_US / 1_000 } else { 0 };
            if deferrals[index] > LONGEST_MS {
                return Err(format!(
                    "seed {seed}, tick {tick}: b{index} is engaged and waits all the same\n{text}"
                ));
            }
            if let Some(bound) = bounds[index]
                && waits[index] > bound + SEEN_MS
            {
                let waited = waits[index];
                return Err(format!(
                    "seed {seed}, tick {tick}: b{index} waits {waited} ms, the bound is {bound}\n{text}"
                ));
            }
        }
    }
    Ok(())
}

#[test]
fn h35_sleepers_that_exclude_each_other_lock_nobody_out() {
    let mut seen = Seen::default();
    let failures: Vec<String> = (0..MISSIONS + WITH_LOOPS + WITH_WAITS)
        .filter_map(|seed| drive(seed, &mut seen).err())
        .collect();
    let first = failures.first();
    assert!(failures.is_empty(), "{} fail, {seen:?}; first: {}", failures.len(), first.unwrap());
    // The runs are hard enough.
    assert!(seen.overruled > 10 && seen.circles > 10 && seen.excluded > 1_000, "{seen:?}");
    assert!(seen.interrupted > 1_000 && seen.stopped > 1_000, "{seen:?}");
}
