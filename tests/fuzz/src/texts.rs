//! Texts that users write: missions, worlds, graphs, command lines.

use crate::cli::Cli;
use crate::maps::{draw_all, yard};
use crate::robot;
use ::maps::problem::Source;
use ::maps::problem::has_errors;
use ::maps::source;
use ::maps::{Extent, Map};
use clap::Parser;
use plan_compiler::behaviours::draw::{Drawn, dot, picture};
use plan_compiler::behaviours::{self, Plans, graph_text};
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission;
use plan_format::Blob;
use plan_format::mission::Mission;
use robot_io::{Commands, Reason};
use sim::{SensorSettings, WorldFile};
use std::ffi::OsString;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Ticks of a mission's run.
const MISSION_TICKS: u64 = 100;

/// Reads a mission, checks it, draws it, compiles it for a map and runs it.
pub(crate) fn mission(bytes: &[u8]) {
    static YARD: OnceLock<(Map, Arc<Source>)> = OnceLock::new();
    let Ok((text, _)) = source::decode(Path::new("yard.mission.toml"), bytes.to_vec()) else {
        return;
    };
    let (read, mut problems) = mission::parse(&text);
    draw_all(&problems);
    if has_errors(&problems) {
        return;
    }
    if let Some(draft) = behaviours::compile(&read.behaviours, &Plans::Any, &mut problems) {
        let section = draft.write().expect("what compiles can be written");
        let mission = Mission::parse(&section).expect("what was written is read");
        let drawn = Drawn { mission, plans: &[] };
        assert!(!dot(&drawn).is_empty() && !picture(&drawn).is_empty());
    }
    let (map, source) = YARD.get_or_init(yard);
    // Large cells bound the work for any mission.
    let options = Options { resolution_m: Some(2.0), ..Options::default() };
    let input = Input { map, source: Some(source), mission: &read, options: &options };
    let mut problems = Vec::new();
    let blob = compile(&input, &|_, _| (), &mut problems);
    draw_all(&problems);
    match blob {
        None => assert!(has_errors(&problems), "neither a blob nor an error"),
        Some(blob) => {
            let blob = Blob::parse_exact(&blob).expect("what was written is read");
            robot::drive(&blob, bytes, MISSION_TICKS);
        }
    }
}

/// The text of a production's graph.
pub(crate) fn graph(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match graph_text::parse(text) {
        Ok(graph) => {
            let last = graph.vertices.saturating_sub(1);
            assert!(graph.leads(0, last), "the exit is reached from the entry");
        }
        Err(mistakes) => {
            assert!(!mistakes.is_empty());
            for mistake in mistakes {
                // An excerpt must be able to show the span.
                assert!(text.get(mistake.span.clone()).is_some(), "{mistake:?}");
            }
        }
    }
}

/// A world file, and a robot's steps in its world.
pub(crate) fn world(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(file) = text.parse::<WorldFile>() else { return };
    let map = Map::empty(Extent { corner: [0.0; 2], size: [9.0; 2] });
    let worlds = file.difference.apply(&map, 1);
    assert_eq!(worlds.unmapped.len(), file.difference.extra.len());
    for disc in &file.conditions.discs {
        let at = disc.at(3.0);
        assert!(at.iter().all(|x| x.is_finite()), "{disc:?}");
    }
    let sensors = file.conditions.sensors(SensorSettings::USUAL);
    assert_eq!(sensors.without_error().pose.is_some(), file.conditions.pose.is_some());
    let mut world = file.surroundings;
    for step in 0..100 {
        let inputs = world.inputs();
        let commands = Commands { outputs: step as u16, ..Commands::stop(Reason::Driving) };
        let [x, y] = world.start;
        world.step([x + f64::from(step), y], 1.0, &commands, 0.05);
        assert_eq!(inputs.len(), world.inputs().len());
    }
    let _ = (world.is_done(Reason::Idle), world.summary());
}

/// The words of a command line, one per line.
pub(crate) fn command_line(bytes: &[u8]) {
    let words = bytes.split(|&byte| byte == b'\n').map(word);
    match Cli::try_parse_from(std::iter::once("plan-compiler".into()).chain(words)) {
        Ok(_) => {}
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

#[cfg(unix)]
fn word(bytes: &[u8]) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes.to_vec())
}

#[cfg(not(unix))]
fn word(bytes: &[u8]) -> OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}

/// Points, poses and messages as `query -` takes them, one per line.
pub(crate) fn points(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for line in text.lines() {
        if let Ok(Some(at)) = crate::points::point(line) {
            assert!(at.iter().all(|number| number.is_finite()), "{line}: {at:?}");
        }
    }
}
