//! Missions from their text to the actions that run: frames that end, facts in rules, behaviours
//! that run once, and the way back.

use super::compiled;
use behaviour::{Behaviours, Observations, Report};
use math::{Vec2, vector};
use plan_format::mission::{ActionKind, Mission};
use soak::fixtures::Open;

/// Carries out a mission with ticks of 100 ms. Fuel is given for each tick. The robot moves 1 m a
/// tick towards the point to which an action drives. Returns the actions that run, each with the
/// tick in which it begins.
pub(super) fn carried_out(text: &str, fuel: impl Fn(usize) -> f32, ticks: usize) -> String {
    let (draft, problems) = compiled(text);
    let draft = draft.unwrap_or_else(|| panic!("{}", maps::problem::draw(&problems, false)));
    let section = draft.write().expect("it fits");
    let mission = Mission::parse(&section).expect("it is sound");
    let mut behaviours = Behaviours::new(&mission);
    let (mut at, mut log, mut last) = (Vec2::new(0.0, 0.0), Vec::new(), String::new());
    for tick in 0..ticks {
        let mut channels = [None; 8];
        channels[1] = Some(fuel(tick));
        let seen = Observations {
            time_us: 1_000_000 + tick as u64 * 100_000,
            position: Some(at),
            channels: &channels,
            mates: &[],
            team: 0,
            world: &Open(Some(at)),
        };
        let running = behaviours.step(&mission, &seen, &mut Report::default());
        let names = running.iter().map(|part| {
            let action = mission.actions().get(part.action.into()).expect("it exists");
            mission.name(action.name)
        });
        let now = names.collect::<Vec<_>>().join(" & ");
        for part in &running {
            if let ActionKind::GoTo { x_m, y_m } = part.kind {
                let way = Vec2::new(x_m, y_m) - at;
                at += way / vector::length(way).max(1.0);
            }
        }
        if now != last {
            log.push(format!("{tick} {now}"));
            last = now;
        }
    }
    log.join(", ")
}

/// A patrol that ends when the tank is low, and does not take longer than its time.
#[test]
fn frames_end_by_conditions_and_by_time() {
    let mission = |clause: &str| {
        format!(
            "[inputs]
             fuel = {{ source = 'fuel', missing = {{ then = 0 }} }}
             [facts]
             low = {{ input = 'fuel', at_most = 0.3 }}
             [actions]
             out = {{ do = 'go-to 4, 0' }}
             back = {{ do = 'go-to 0, 0' }}
             beep = {{ do = 'hold 0.3 s' }}
             [frames]
             patrol = {{ productions = ['entry -> out -> back -> patrol -> exit'], {clause} }}
             work = {{ productions = ['entry -> patrol -> beep -> exit', 'entry -> beep -> exit'] }}
             [behaviours.work]
             criticality = {{ fuel = 'PS PS PS PS PS PS PS' }}
             once = true"
        )
    };
    let fuel = |tick: usize| if tick < 11 { 0.9 } else { 0.2 };
    let patrol = "0 out, 4 back, 8 out";
    let until = carried_out(&mission("until = ['low']"), fuel, 20);
    assert_eq!(until, format!("{patrol}, 11 beep, 14 "));
    let timeout = carried_out(&mission("timeout_s = 0.9"), fuel, 20);
    assert_eq!(timeout, format!("{patrol}, 10 beep, 13 "));
    let skipped = carried_out(&mission("until = ['low']"), |_| 0.2, 20);
    assert_eq!(skipped, "0 beep, 3 ");
}

/// A loop through two frames. The second one fails when it is dark. The loop ends in any round when
/// the tank is low, and its constraint holds in all later rounds.
#[test]
fn a_loop_passes_through_a_frame_with_constraints() {
    let mission = |transient: &str| {
        format!(
            "[inputs]
             fuel = {{ source = 'fuel', missing = {{ then = 0 }} }}
             [facts]
             dark = {{ input = 'fuel', at_most = 0.1 }}
             [actions]
             out = {{ do = 'go-to 4, 0' }}
             back = {{ do = 'go-to 0, 0' }}
             beep = {{ do = 'hold 0.3 s' }}
             [frames]
             work = {{ productions = ['entry -> patrol -> beep -> exit', 'entry -> beep -> exit'] }}
             [frames.patrol]
             productions = [{{ graph = 'entry -> out -> careful -> exit', applicable = {{ fuel = 'NB NB NB PB PB PB PB' }} }}]
             [frames.careful]
             {transient}
             productions = ['entry -> back -> patrol -> exit']
             [behaviours.work]
             criticality = {{ fuel = 'PS PS PS PS PS PS PS' }}
             once = true"
        )
    };
    let constrained = mission("transient = ['not dark']");
    // Low after one round, and after a hundred.
    for last in [1, 2, 5, 100] {
        let fuel = |tick| if tick < 8 * last - 1 { 0.9 } else { 0.2 };
        let rounds = (0..last).map(|round| format!("{} out, {} back, ", 8 * round, 8 * round + 4));
        let end = 8 * last;
        let expected = format!("{}{end} beep, {} ", rounds.collect::<String>(), end + 3);
        assert_eq!(carried_out(&constrained, fuel, end + 9), expected);
        assert_eq!(carried_out(&mission(""), fuel, end + 9), expected);
    }
    // Dark in the third round: the loop fails, whichever of its frames is at work.
    for (tick, at_work) in [(18, "16 out, 18 beep, 21 "), (22, "16 out, 20 back, 22 beep, 25 ")] {
        let fuel = |now| if now < tick { 0.9 } else { 0.05 };
        let log = carried_out(&constrained, fuel, 30);
        assert_eq!(log, format!("0 out, 4 back, 8 out, 12 back, {at_work}"));
    }
}

/// The cargo decides which behaviour is critical, and which production is applicable.
#[test]
fn facts_decide_in_rules() {
    let mission = "
        [facts]
        loaded = false
        [actions]
        fetch = { do = 'go-to 3, 0', add = ['loaded'] }
        bring = { do = 'go-to 0, 0', delete = ['loaded'] }
        look = { do = 'hold 0.2 s' }
        [frames]
        fetch_it = { productions = ['entry -> fetch -> report -> exit'] }
        bring_it = { productions = ['entry -> bring -> report -> exit'] }
        report = { productions = [
            { graph = 'entry -> look -> exit', applicable = { loaded = 'NB PB' } },
            { graph = 'entry -> look -> look -> exit', applicable = { loaded = 'PB NB' } },
        ] }
        [behaviours.fetching]
        plan = 'fetch_it'
        criticality = { loaded = 'PS NB' }
        [behaviours.bringing]
        plan = 'bring_it'
        criticality = { loaded = 'NB PS' }";
    let log = carried_out(mission, |_| 1.0, 20);
    assert_eq!(log, "0 fetch, 3 look, 5 bring, 8 look, 12 fetch, 15 look, 17 bring");
}

/// H44: a frame behind a `wait` chooses its production when what it waits for holds, by the fuel
/// that is there then; a wait that ends without its condition fails.
#[test]
fn h44_a_wait_delays_the_choice_until_its_condition_holds() {
    let mission = |limit_s: f32| {
        format!(
            "[inputs]
             fuel = {{ source = 'fuel', missing = {{ then = 0 }} }}
             [facts]
             open = false
             [actions]
             knock = {{ do = 'go-to 3, 0', add = ['open'] }}
             'wait for door' = {{ do = 'wait {limit_s} s', until = ['open'], goal = ['open'] }}
             far = {{ do = 'wait 0.5 s' }}
             near = {{ do = 'wait 0.2 s' }}
             [frames]
             work = {{ productions = ['entry -> (knock | wait for door -> choose) -> exit'] }}
             choose = {{ productions = [
                 {{ graph = 'entry -> far -> exit', applicable = {{ fuel = 'NB NB NB NB PB PB PB' }} }},
                 {{ graph = 'entry -> near -> exit', applicable = {{ fuel = 'PB PB PB NB NB NB NB' }} }},
             ] }}
             [behaviours.work]
             criticality = {{ fuel = 'PS PS PS PS PS PS PS' }}
             once = true"
        )
    };
    let waiting = "0 knock & wait for door";
    for (fuel_then, chosen) in [(0.9, "3 far, 8 "), (0.1, "3 near, 5 ")] {
        // At first, the other production would be chosen.
        let fuel = |tick| if tick < 3 { 1.0 - fuel_then } else { fuel_then };
        assert_eq!(carried_out(&mission(60.0), fuel, 12), format!("{waiting}, {chosen}"));
    }
    assert_eq!(carried_out(&mission(0.2), |_| 0.9, 9), format!("{waiting}, 2 "));
}

/// A survey that was interrupted goes on where it was left.
#[test]
fn a_start_up_returns_to_the_place_left() {
    let mission = "
        [inputs]
        fuel = { source = 'fuel', missing = { then = 0 } }
        [actions]
        survey = { do = 'go-to 20, 0' }
        resume = { do = 'return', max_speed = 1 }
        fill = { do = 'go-to 0, 0' }
        [frames]
        work = { productions = ['entry -> survey -> exit'] }
        go_back = { productions = ['entry -> resume -> exit'] }
        refuel = { productions = ['entry -> fill -> exit'] }
        [behaviours.work]
        criticality = { fuel = 'PS PS PS PS PS PS PS' }
        start_up = 'go_back'
        [behaviours.refuel]
        criticality = { fuel = 'PB NB NB NB NB NB NB' }";
    let fuel = |tick: usize| if (6..8).contains(&tick) { 0.0 } else { 1.0 };
    assert_eq!(carried_out(mission, fuel, 20), "0 survey, 6 fill, 12 resume, 18 survey");
}

/// Sixteen plans of two actions each live at the same time. At most eight actions run at once, and
/// the others follow when these end.
#[test]
fn sixteen_behaviours_have_two_actions_each() {
    let mut text = String::from(
        "[inputs]
         fuel = { source = 'fuel', missing = { then = 0 } }
         [actions]\n",
    );
    let mut behaviours = String::new();
    for number in 0..16 {
        text += &format!(
            "a{number} = {{ do = 'wait 0.3 s' }}
             b{number} = {{ do = 'wait 0.2 s' }}\n"
        );
        behaviours += &format!(
            "[frames.plan{number}]
             productions = ['entry -> a{number} -> b{number} -> exit']
             [behaviours.plan{number}]
             once = true
             criticality = {{ fuel = 'PS PS PS PS PS PS PS' }}\n"
        );
    }
    text += &behaviours;
    assert_eq!(
        carried_out(&text, |_| 1.0, 30),
        "0 a0 & a1 & a2 & a3 & a4 & a5 & a6 & a7, 3 b0 & b1 & b2 & b3 & b4 & b5 & b6 & b7, \
         5 a8 & a9 & a10 & a11 & a12 & a13 & a14 & a15, 8 b8 & b9 & b10 & b11 & b12 & b13 & b14 & b15, 10 "
    );
}
