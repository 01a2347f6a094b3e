//! Instructions and bytes that the control code needs, counted exactly in QEMU.

use std::path::{Path, PathBuf};

use crate::mission::{self, Changes};
use crate::setup::root;
use crate::{Build, Machine, QemuPilot};
use maps::Bitmap;
use math::GeoPoint;
use plan_compiler::pack::pack;
use plan_compiler::search::{Corners, Query, solve};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_format::mission::MissionDraft;
use plan_format::{
    Cell, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft, WriteError, write,
};
use sim::{Dialect, ReceiverSettings, Scenario, SensorSettings, Simulation, Start};

/// Names of counts and their upper limits.
///
/// A look-up gives direction and cost; state and stack are those of the control code.
pub const LIMITS: &[(&str, u64)] = &[
    ("blob-validation", 30_000_000),
    ("look-up-worst", 400),
    ("tick-8-obstacles-worst", 20_000),
    ("tick-crowded-worst", 33_000),
    ("tick-stack-bytes", 4_096),
    ("control-state-bytes", 8_192),
    ("plan-view-bytes", 640),
    ("behaviours-tick-worst", 38_000),
    ("behaviours-tick-crowded-worst", 54_000),
    ("behaviours-tick-stack-bytes", 8_192),
    ("worst-map-blob-validation", 30_000_000),
    ("worst-map-look-up-worst", 400),
    ("tolled-map-look-up-worst", 500),
    ("guest-stack-bytes", 16_384),
];

/// The golden file of the counts.
pub fn golden() -> PathBuf {
    root().join("tests/golden/instructions.txt")
}

/// Counts on the emulated Cortex-M4F and returns a name and a number per line. The plans are those
/// of the campus, the behaviours those of [`soak::fixtures::budget`]. A look-up and a validation
/// are also counted on a map that packs badly, a look-up also on one with tolls. The stack of the whole guest, with tasks and
/// executor, is measured in a mission on the campus. The error is a message for the user.
pub fn measure() -> Result<String, String> {
    let map: &Path = &root().join("tests/maps/campus.opar");
    let campus = mission::scenario(map, &Changes::default())?;
    let plans = count(&campus.blob)?;
    let blob = soak::fixtures::blob(soak::fixtures::budget()).map_err(|error| error.to_string())?;
    let all = count(&blob)?;
    let behaviours = all.lines().filter(|line| line.starts_with("behaviours-"));
    let large = count(&worst_map().map_err(|error| error.to_string())?)?;
    let large = large
        .lines()
        .filter(|line| line.starts_with("blob-validation") || line.starts_with("look-up-worst"));
    let large = large.map(|line| format!("worst-map-{line}"));
    let tolled = count(&tolled_map().map_err(|error| error.to_string())?)?;
    let tolled = tolled.lines().filter(|line| line.starts_with("look-up-worst"));
    let tolled = tolled.map(|line| format!("tolled-map-{line}"));
    let stack = format!("guest-stack-bytes {}", guest_stack(&campus)?);
    let more = behaviours.map(str::to_owned).chain(large).chain(tolled).chain([stack]);
    Ok(more.fold(plans, |counts, line| counts + &line + "\n"))
}

/// Most bytes of stack that the guest uses from reset to the end of one minute of a mission.
fn guest_stack(scenario: &Scenario) -> Result<u64, String> {
    const TICKS: usize = 1_200;
    let position = scenario.draw_start(1).ok_or("the campus has no free place")?;
    // NMEA sentences take the longer path through the receiver's drivers.
    let gps = ReceiverSettings { dialect: Dialect::Nmea, ..ReceiverSettings::ONE_METRE };
    let sensors = SensorSettings { gps: Some(gps), ..SensorSettings::USUAL };
    let start = Start { position, heading_rad: 0.5, seed: 1, sensors };
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let mut pilot = QemuPilot::boot(Machine::CortexM4F, Build::Release, &scenario.blob)
        .map_err(|error| text(&error))?;
    let robot = scenario.robot(&start, &mut pilot)?;
    let mut simulation = Simulation::new(&scenario.truth, [robot]);
    for _ in 0..TICKS {
        simulation.step().map_err(|error| text(&error))?;
    }
    drop(simulation);
    let report = pilot.finish().map_err(|error| text(&error))?;
    report.get("stack-bytes").ok_or_else(|| format!("no stack in {}", report.console))
}

/// Cells along each side of the map that packs badly.
const SIDE: u32 = 394;

/// A blob of 256 KB: its map has noise in the west and a maze in the east, for which blocks of roots
/// save nothing.
fn worst_map() -> Result<Vec<u8>, WriteError> {
    let blocked = Bitmap::from_fn(SIDE, SIDE, |cell| {
        if cell.column < SIDE / 2 { hash(cell).is_multiple_of(5) } else { is_wall(cell) }
    });
    // A room of the maze, so it is free.
    let middle = (SIDE / 2) | 1;
    blob(&Terrain::new(blocked), Cell::new(middle, middle))
}

/// A blob of a map with tolls of all kinds: houses with bands around them, areas, and in the north a
/// factor of its own for each cell.
fn tolled_map() -> Result<Vec<u8>, WriteError> {
    const SIDE: u32 = 250;
    let is_house = |column: u32, row: u32| {
        let block = Cell::new(column / 24, row / 24);
        let [x, y] = [column % 24, row % 24];
        hash(block).is_multiple_of(2)
            && (6..18).contains(&x)
            && (6..14 + hash(block) % 6).contains(&y)
    };
    let blocked = Bitmap::from_fn(SIDE, SIDE, |cell| is_house(cell.column, cell.row));
    let is_near = |cell: Cell, reach: u32| {
        let around = |at: u32| at.saturating_sub(reach)..(at + reach + 1).min(SIDE);
        around(cell.row).any(|row| around(cell.column).any(|column| is_house(column, row)))
    };
    let tolls = Tolls::from_fn(SIDE, SIDE, |cell| {
        let bands = [24, 16, 12].into_iter().zip(1..).find(|&(_, reach)| is_near(cell, reach));
        let area =
            if hash(Cell::new(cell.column / 40, cell.row / 30)).is_multiple_of(3) { 2 } else { 1 };
        let own = if cell.row > SIDE * 3 / 4 { 8 + hash(cell) % 24 } else { 8 };
        bands.map_or(own, |(factor, _)| factor) * area
    });
    blob(&Terrain::new(blocked).with_tolls(tolls), Cell::new(2, 2))
}

/// A blob with one layer.
fn blob(terrain: &Terrain, goal: Cell) -> Result<Vec<u8>, WriteError> {
    // Needed because the guest also counts ticks, which use fixes.
    let place = GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 };
    let [columns, rows] = terrain.size();
    let grid = Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] };
    let packed = pack(&solve(&Query { terrain, goals: &[goal], corners: Corners::Forbid }));
    let plan = PlanDraft {
        name: "worst".into(),
        goals_m: vec![grid.centre(goal)],
        layers: vec![LayerDraft { rank: 0, name: "physical".into(), packed }],
    };
    write(&Draft {
        grid,
        origin: Some(Origin { place, at_m: [0.0, 0.0], heading_rad: 0.0 }),
        parameters: Parameters::default(),
        plans: vec![plan],
        mission: MissionDraft::default(),
    })
}

/// Whether a cell is a wall of a maze of corridors one cell wide. A room is a cell in an odd column
/// and an odd row; each is open to the room east or north of it.
fn is_wall(cell: Cell) -> bool {
    let opens_north = |room: Cell| room.column + 2 >= SIDE || hash(room).is_multiple_of(2);
    match (cell.column % 2, cell.row % 2) {
        (1, 1) => false,
        (0, 1) => cell.column + 1 >= SIDE || opens_north(Cell::new(cell.column - 1, cell.row)),
        (1, 0) => cell.row == 0 || !opens_north(Cell::new(cell.column, cell.row - 1)),
        _ => true,
    }
}

/// A pseudo-random number for a cell.
fn hash(cell: Cell) -> u32 {
    let mut state = (cell.column << 16) | cell.row | (1 << 15);
    for _ in 0..3 {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
    }
    state >> 8
}

fn count(blob: &[u8]) -> Result<String, String> {
    let machine = Machine::CortexM4F;
    let (mut command, _plans) = machine
        .counting_command("instructions", Build::Release, blob)
        .map_err(|error| error.to_string())?;
    let output = command.output().map_err(|error| error.to_string())?;
    let counts = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(counts)
    } else {
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        Err(format!("the guest ended with {}: {counts}{errors}", output.status))
    }
}
