//! Plane `goals`: the goal that the packed advice leads to from each cell, in a plan with several.
//!
//! Where moves are equally good, the packer chooses, and with the move perhaps the goal. So the goals
//! are not found by the search: the advice of the packed layer is followed to its end, from each cell
//! once.

use super::encode::Block;
use super::{blocks_of, plane};
use crate::field::all_cells;
use plan_format::layout::{GOAL_BITS, OWN_4_4, superblocks};
use plan_format::{
    Blob, Cell, Draft, Grid, Layer, LayerDraft, PackedLayer, Parameters, PlanDraft, Step, write,
};

/// The cell of a goal, with its number among the goals of its plan.
pub type Numbered = (u8, Cell);

/// The label of a cell that has not been followed yet.
const UNKNOWN: u8 = u8::MAX;
/// The label of a cell without a route.
const NONE: u8 = UNKNOWN - 1;

/// Adds plane `goals` to a packed layer whose routes end at these goals. Of goals in one cell, the
/// first counts. `None` if the layer exceeds what a blob can hold.
pub fn with_goals(packed: PackedLayer, goals: &[Numbered]) -> Option<PackedLayer> {
    let (columns, rows) = (packed.columns, packed.rows);
    let grid = Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0; 2] };
    let layers = vec![LayerDraft { name: "layer".into(), rank: 0, packed }];
    let goals_m = vec![grid.centre(Cell::new(0, 0))];
    // A blob of this layer alone, because only a blob can be looked up.
    let mut draft = Draft {
        grid,
        origin: None,
        parameters: Parameters::default(),
        plans: vec![PlanDraft { name: "plan".into(), goals_m, layers }],
        mission: Default::default(),
    };
    let bytes = write(&draft).ok()?;
    let layer = Blob::parse_exact(&bytes).ok()?.parallel_plan(0)?.layer(0)?;
    let labels = labels(&layer, &grid, goals);
    let mut packed = draft.plans.pop()?.layers.pop()?.packed;
    packed.goals = Some(packed_labels(&labels, &grid));
    Some(packed)
}

/// The number of the goal at the end of each cell's route, or [`NONE`].
fn labels(layer: &Layer<'_>, grid: &Grid, goals: &[Numbered]) -> Vec<u8> {
    let index = |cell: Cell| cell.row as usize * grid.columns as usize + cell.column as usize;
    let mut labels = vec![UNKNOWN; grid.cells()];
    for &(number, cell) in goals.iter().rev() {
        labels[index(cell)] = number;
    }
    let mut path = Vec::new();
    for start in all_cells(grid.columns, grid.rows) {
        let mut cell = start;
        while labels[index(cell)] == UNKNOWN {
            // Until the end is known: a route that came back here would have none.
            labels[index(cell)] = NONE;
            path.push(index(cell));
            let Step::Move(direction) = layer.step(cell) else { break };
            let Some(next) = cell.neighbour(direction, grid.columns, grid.rows) else { break };
            cell = next;
        }
        let end = labels[index(cell)];
        path.drain(..).for_each(|passed| labels[passed] = end);
    }
    labels
}

/// The plane of these labels. Cells without a route may have any entry.
fn packed_labels(labels: &[u8], grid: &Grid) -> plan_format::PackedPlane {
    let block_columns = superblocks(grid.columns) as usize * 4;
    let mut blocks = vec![Vec::<(u32, u64)>::new(); blocks_of([grid.columns, grid.rows])];
    for (cell, &label) in all_cells(grid.columns, grid.rows).zip(labels) {
        if label == NONE {
            continue;
        }
        let [column, row] = [cell.column, cell.row].map(|at| at as usize);
        let entries = &mut blocks[row / 8 * block_columns + column / 8];
        let bit = 1 << (row % 8 * 8 + column % 8);
        match entries.iter_mut().find(|entry| entry.0 == u32::from(label)) {
            Some(entry) => entry.1 |= bit,
            None => entries.push((label.into(), bit)),
        }
    }
    let blocks: Vec<Block> = blocks.into_iter().map(Block::Palette).collect();
    plane(&blocks, block_columns, GOAL_BITS, 0, |_, _| OWN_4_4)
}
