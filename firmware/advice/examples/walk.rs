//! From a cell to the goal, one look-up a step. On a robot the bytes lie in flash.
//!
//! `cargo run -p wayfield-advice --example walk -- target/yard.bin -26 -18`

use advice::{Choice, advise};
use plan_format::Blob;
use plan_format::parameters::Selection;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, file, x, y] = &arguments[..] else { return Err("usage: walk BLOB X Y".into()) };

    let bytes = std::fs::read(file)?;
    let blob = Blob::parse(&bytes)?;
    let plan = blob.parallel_plan(0).ok_or("the blob has no plan")?;
    let mut cell = blob.grid().cell_at(x.parse()?, y.parse()?);
    let mut choice = Choice::default();
    loop {
        let advice = advise(&plan, cell, Selection::Dynamic, &mut choice);
        println!("{cell:?}: {:?}, {:?}", advice.kind, advice.direction);
        let (Some(here), Some(step)) = (cell, advice.direction) else { return Ok(()) };
        cell = here.neighbour(step, blob.grid().columns, blob.grid().rows);
    }
}
