//! Plans as an Iplan.dat: a map of costs per layer, in MissionLab's format.
//!
//! Every file has a contingency map: the first layer of the plan of that name, otherwise of
//! the plan that the robot follows. Each other layer is an element MOVETO with one map, in
//! the order of the blob. Costs count a diagonal step as the square root of two rounded to
//! the millimetre, as that program did.

use maps::Bitmap;
use maps::formats::iplan::{CONTINGENCY, OBSTACLE, UNREACHED};
use maps::problem::Problem;
use plan_format::grid::{DIAGONAL_STEP, STRAIGHT_STEP};
use plan_format::{Answer, Blob, Cell, Grid, Layer, ParallelPlan};
use std::f64::consts::SQRT_2;
use std::io::{self, Write};

/// Reports what an Iplan.dat cannot express of a blob, and what its user should know.
pub fn check(blob: &Blob<'_>) -> Vec<Problem> {
    let grid = blob.grid();
    let mut problems = Vec::new();
    let mut first: Option<Bitmap> = None;
    for (parallel, layer) in layers(blob) {
        let name = format!("{}/{}", parallel.name(), layer.name());
        let costs = cells(grid).filter_map(|cell| match layer.look_up(cell) {
            Answer::Move { cost, .. } => Some(metres(cost, grid)),
            _ => None,
        });
        let farthest = costs.fold(0.0, f64::max);
        if farthest >= OBSTACLE {
            let message = format!("layer `{name}` has routes of {farthest} m");
            problems.push(Problem::error(message).help(
                "an Iplan.dat holds costs below 9998 m: crop the map to the area that the robot uses",
            ));
        }
        let is_blocked = |cell| matches!(layer.look_up(cell), Answer::Blocked { .. });
        let blocked = Bitmap::from_fn(grid.columns, grid.rows, is_blocked);
        if first.as_ref().is_some_and(|first| *first != blocked) {
            let message =
                format!("the obstacles of layer `{name}` differ from those of the first layer");
            problems.push(Problem::warning(message).help(
                "MissionLab reads a file whose maps have different obstacles, but `build` does not; \
                 a mission can choose the layers of its goals",
            ));
        }
        first.get_or_insert(blocked);
    }
    for parallel in blob.parallel_plans().filter(|parallel| parallel.goal_count() > 1) {
        let (name, count) = (parallel.name(), parallel.goal_count());
        let message =
            format!("plan `{name}` leads to {count} goals, but a map of an Iplan.dat has one");
        let help = "build a plan for each of its goals, or convert a blob without it";
        problems.push(Problem::error(message).help(help));
    }
    if first.is_none() {
        let problem = Problem::error("the blob contains no plans");
        problems.push(problem.help("build it with a goal: an Iplan.dat needs one"));
    }
    let [x, y] = offset(grid).map(micrometres);
    if [x, y] != [0.0; 2] {
        problems.push(Problem::note(format!(
            "an Iplan.dat starts at 0,0: its positions are the map's minus {x},{y}"
        )));
    }
    problems
}

/// Writes the plans of a blob that passed [`check`]; `name` is that of the file they come from.
pub fn write(out: &mut dyn Write, blob: &Blob<'_>, name: &str) -> io::Result<()> {
    // A name takes one line.
    let name: String = name.chars().filter(|symbol| !symbol.is_control()).collect();
    let title = name.split('.').find(|part| !part.is_empty()).unwrap_or("plan");
    let contingency = blob.find(CONTINGENCY);
    let skipped = usize::from(contingency.is_some());
    let elements = || {
        let first = contingency.and_then(|_| layers(blob).position(|(p, _)| is_contingency(&p)));
        layers(blob).enumerate().filter(move |(index, _)| Some(*index) != first)
    };
    let count = layers(blob).count() - skipped;
    write!(out, "{title}\n{name}\nORDERED\nFALSE\nTEXT\n{count}\n")?;
    let followed = || blob.parallel_plan(usize::from(blob.parameters().plan));
    if let Some(parallel) = contingency.or_else(followed)
        && let Some(layer) = parallel.layer(0)
    {
        write_map(out, blob.grid(), &parallel, &layer)?;
    }
    for (_, (parallel, layer)) in elements() {
        out.write_all(b"START_ELEMENT\nMOVETO\n")?;
        write_map(out, blob.grid(), &parallel, &layer)?;
    }
    out.write_all(b"END_FILE\n")
}

fn is_contingency(parallel: &ParallelPlan<'_>) -> bool {
    parallel.name() == CONTINGENCY
}

/// Writes one map. MissionLab too ends the first lines of a map with a space.
fn write_map(
    out: &mut dyn Write,
    grid: &Grid,
    parallel: &ParallelPlan<'_>,
    layer: &Layer<'_>,
) -> io::Result<()> {
    let (columns, rows, side) = (grid.columns, grid.rows, grid.resolution_m);
    let ([x, y], [left, bottom]) = (parallel.goal_m(), offset(grid));
    let [x, y] = [x - left, y - bottom].map(micrometres);
    write!(out, "BEGIN_MAP\n{}/{} \n", parallel.name(), layer.name())?;
    write!(out, "{columns} \n{rows} \n{side} \n{x} \n{y} \n#Data\n")?;
    for cell in cells(grid) {
        writeln!(out, "{}", value(layer.look_up(cell), grid))?;
    }
    out.write_all(b"END_MAP\n")
}

/// Every layer of every plan.
fn layers<'b>(blob: &Blob<'b>) -> impl Iterator<Item = (ParallelPlan<'b>, Layer<'b>)> {
    let with_layers =
        |parallel: ParallelPlan<'b>| parallel.layers().map(move |layer| (parallel, layer));
    blob.parallel_plans().flat_map(with_layers)
}

/// The cells in the order of the file.
fn cells(grid: &Grid) -> impl Iterator<Item = Cell> {
    let rows = grid.rows;
    (0..grid.columns).flat_map(move |column| (0..rows).map(move |row| Cell::new(column, row)))
}

/// The centre of the south-west cell, which is 0,0 in the file; metres.
fn offset(grid: &Grid) -> [f64; 2] {
    grid.corner_m.map(|corner| corner + grid.resolution_m / 2.0)
}

/// The value of a cell in the file.
fn value(answer: Answer, grid: &Grid) -> f64 {
    match answer {
        Answer::Goal => 0.0,
        Answer::Move { cost, .. } => metres(cost, grid),
        Answer::Blocked { .. } => OBSTACLE,
        Answer::NoRoute | Answer::OffMap => UNREACHED,
    }
}

/// A cost in metres, as MissionLab computed it.
fn metres(cost: u32, grid: &Grid) -> f64 {
    let (straight, diagonal) = steps(cost);
    let diagonal_m = millimetres(SQRT_2 * grid.resolution_m);
    millimetres(f64::from(straight) * grid.resolution_m + f64::from(diagonal) * diagonal_m)
}

/// The straight and diagonal steps of a cost. From 5,741 diagonal steps on, the answer is
/// ambiguous, and the one with the fewest diagonal steps is returned.
fn steps(cost: u32) -> (u32, u32) {
    /// Inverse of a diagonal step modulo a straight step.
    const INVERSE: u64 = 3363;
    const _: () = assert!(DIAGONAL_STEP as u64 * INVERSE % STRAIGHT_STEP as u64 == 1);
    let diagonal = (u64::from(cost) * INVERSE % u64::from(STRAIGHT_STEP)) as u32;
    (cost.saturating_sub(diagonal * DIAGONAL_STEP) / STRAIGHT_STEP, diagonal)
}

fn millimetres(metres: f64) -> f64 {
    (metres * 1e3).round() / 1e3
}

/// Fine enough for any goal, without the noise of a subtraction; never a negative zero.
fn micrometres(metres: f64) -> f64 {
    (metres * 1e6).round() / 1e6 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(straight: u32, diagonal: u32) {
        let cost = straight * STRAIGHT_STEP + diagonal * DIAGONAL_STEP;
        assert_eq!(steps(cost), (straight, diagonal));
    }

    #[test]
    fn a_cost_tells_its_steps() {
        for straight in [0, 1, 2, 99, 5741, 8118] {
            for diagonal in [0, 1, 2, 70, 5740] {
                check(straight, diagonal);
            }
        }
        check(300_000, 5_740);
    }
}
