//! The compiler as a library: a map in, a blob out.
//!
//! `cargo run -p wayfield-plan-compiler --example compile -- tests/maps/yard.osm target/yard.bin`

use std::error::Error;
use std::path::Path;

use maps::formats::{self, ReadOptions};
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{Goal, GoalAt, Mission};
use plan_format::Blob;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, map, output] = &arguments[..] else { return Err("usage: compile MAP OUTPUT".into()) };

    // A reader returns what it understood and every problem that it found.
    let loaded = formats::load(Path::new(map), &ReadOptions::default());
    let mut problems = loaded.problems;
    let map = loaded.map.ok_or_else(|| format!("the map cannot be read: {problems:?}"))?;

    // This replaces `--goal gate=-17.5,17.5` and a mission file.
    let at = vec![GoalAt::Position([-17.5, 17.5])];
    let goal = Goal { name: "gate".to_owned(), at, layers: None, place: None };
    let input = Input {
        map: &map,
        source: loaded.source.as_ref(),
        mission: &Mission::default(),
        options: &Options { goals: vec![goal], ..Options::default() },
    };
    let bytes = compile(&input, &|done, all| eprintln!("{done} of {all}"), &mut problems);
    for problem in &problems {
        eprintln!("{problem}");
    }
    let bytes = bytes.ok_or("the map was not compiled")?;

    let blob = Blob::parse_exact(&bytes)?;
    for plan in blob.parallel_plans() {
        println!("{}: {} layers", plan.name(), plan.layer_count());
    }
    Ok(std::fs::write(output, &bytes)?)
}
