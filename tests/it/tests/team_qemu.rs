//! A team in QEMU: three robots, each on an emulated machine of its own, that hear each other over the
//! simulated radio only. Their traces are those of their twins on the host.

use std::sync::Arc;

use crate::team_plans::compiled;
use harness::{Build, Machine, QemuPilot};
use maps::problem::Source;
use maps::radio::{Settings, Sight};
use robot_io::Reason;
use sim::{
    HostPilot, Outcome, Pilot, Point, Radio, RadioSettings, Scenario, SensorSettings, Start,
    Surroundings,
};

/// A wall between the starts in the west and the one in the east; the radio does not cross it.
const MAP: &str = "\
SITE yard
ORIGIN 0 0
GLOBAL_REF_POINT 51.5 -0.1
MISSION-AREA 40 30
CONTROL MEASURES:
PP StartPlace* 5 5
WALL middle 20 0 20 20
";

/// Each robot goes to the gap north of the wall, waits until it hears both mates, and goes on to a
/// place of its own.
const MISSION: &str = r#"
resolution = 1
robot_radius = 0.3
[team]
robots = ["a", "b", "c"]
[goals]
gap = [20.5, 24.5]
own = [5.5, 20.5]
[robots.a.goals]
gap = [17.5, 24.5]
[robots.b.goals]
gap = [20.5, 27.5]
own = [12.5, 26.5]
[robots.c.goals]
gap = [23.5, 24.5]
own = [35.5, 20.5]
[robots.c.vehicle]
max_speed = 0.8
[vehicle]
max_speed = 1.6
[inputs]
time = { source = "time", universe = [0, 1], missing = { then = 0 } }
[behaviours.go]
plan = "serial"
criticality = { time = "PB PB PB PB PB PB PB" }
[frames.serial]
productions = ["entry -> to gap -> gather -> to own -> arrived -> stay -> exit"]
[facts]
"all linked" = { linked = "all" }
[actions]
"to gap" = { do = "follow gap at 34:66" }
gather = { do = "hold 60 s", until = ["all linked"] }
"to own" = { do = "follow own at 34:66" }
arrived = { do = "signal 1" }
stay = { do = "hold 600 s" }
"#;

const TEAM: [(&str, Point); 3] = [("a", [6.0, 4.0]), ("b", [12.0, 10.0]), ("c", [33.0, 3.0])];

fn scenario(robot: &str) -> Scenario {
    let source = Arc::new(Source { name: "yard.mission.toml".into(), text: MISSION.into() });
    let (map, blob) = compiled(MAP, &source, robot);
    let world = "start = [0, 0]\nsignal = 1\ntime_limit = 120\n";
    let surroundings: Surroundings = world.parse().expect("this world file is sound");
    Scenario::new(map, blob, Some(surroundings))
}

fn outcomes<'s, P: Pilot>(
    scenarios: &'s [Scenario],
    pilot: impl Fn(&'s Scenario) -> P,
) -> Vec<Outcome> {
    let air = Sight::of(&scenarios[0].map, &Settings::default());
    let robots = scenarios.iter().zip(TEAM).zip(1..).map(|((scenario, (_, position)), seed)| {
        let start = Start { position, heading_rad: 1.5, seed, sensors: SensorSettings::USUAL };
        scenario.robot(&start, pilot(scenario)).expect("the start is clear").to_the_end()
    });
    let radio = Radio::new(&air, RadioSettings::default(), 1);
    let simulation = scenarios[0].simulation(robots).with_radio(radio);
    simulation.finish().expect("the robots answer")
}

/// W30, W38: the same bits on the host and in QEMU, while what each robot does depends on the others.
#[test]
fn w38_a_team_in_qemu_has_the_traces_of_the_team_on_the_host() {
    let scenarios = TEAM.map(|(name, _)| scenario(name));
    let on_host = outcomes(&scenarios, |scenario| HostPilot::new(scenario.plan()));
    for (outcome, (name, _)) in on_host.iter().zip(TEAM) {
        assert!(outcome.reached() && outcome.touches == 0, "{name}: {outcome:?}");
        assert!(outcome.ticks_of(Reason::Driving) > 200, "{name}: {outcome:?}");
    }
    assert!(on_host[0].ticks_of(Reason::Holding) > 40, "it waits for the other side: {on_host:?}");
    let in_qemu = outcomes(&scenarios, |scenario| {
        QemuPilot::boot(Machine::CortexM4F, Build::Release, &scenario.blob)
            .unwrap_or_else(|error| panic!("{error}"))
    });
    let hashes = |team: &[Outcome]| team.iter().map(|one| one.trace_hash).collect::<Vec<_>>();
    assert_eq!(hashes(&in_qemu), hashes(&on_host));
    // The hash covers what a robot hears: without mates it is another.
    let alone = outcomes(&scenarios[..1], |scenario| HostPilot::new(scenario.plan()));
    assert_ne!(alone[0].trace_hash, on_host[0].trace_hash);
}
