//! A test bench: maps drawn as text, and a robot with error-free sensors.

use controller::{State, tick};
use maps::Bitmap;
use math::{GeoPoint, Vec2, vector};
use plan_compiler::layers::Limits;
use plan_compiler::pack::{pack_with_limits, with_goals};
use plan_compiler::search::{Corners, Query, solve};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_format::mission::MissionDraft;
use plan_format::{Blob, Cell, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft, write};
use robot_io::{Commands, Fix, Operator, Percepts, RangeReading};

pub(crate) const TICK_US: u64 = 50_000;

/// Where the map's corner lies on the globe.
pub(crate) const ORIGIN: Origin = Origin {
    place: GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 },
    at_m: [0.0, 0.0],
    heading_rad: 0.0,
};

pub(crate) fn armed() -> Operator {
    Operator { is_armed: true, ..Operator::default() }
}

pub(crate) fn ahead(distance_m: f32) -> RangeReading {
    RangeReading { bearing_rad: 0.0, distance_m }
}

/// The blob of one parallel plan with drawn layers: the northern row first, `#` a blocked cell,
/// `G` a goal's cell. Cells of 1 m, the south-west corner at (0, 0).
pub(crate) fn blob(layers: &[&str], parameters: Parameters) -> Vec<u8> {
    blob_at(layers, parameters, Some(ORIGIN))
}

pub(crate) fn blob_at(layers: &[&str], parameters: Parameters, origin: Option<Origin>) -> Vec<u8> {
    blob_with(layers, parameters, origin, MissionDraft::default())
}

/// As [`blob`], with a mission of one behaviour of constant criticality (a label). Its actions
/// follow one another, in the notation of `fixtures`: `set 3 on, hold 100`.
pub(crate) fn behaving_blob(map: &str, criticality: &str, actions: &str) -> Vec<u8> {
    behaving_blob_at(map, ORIGIN, criticality, actions)
}

/// As [`behaving_blob`], with another origin.
pub(crate) fn behaving_blob_at(
    map: &str,
    origin: Origin,
    criticality: &str,
    actions: &str,
) -> Vec<u8> {
    let mission = mission_of(criticality, actions);
    blob_with(&[map], Parameters::default(), Some(origin), mission)
}

/// As [`behaving_blob`], with other parameters.
pub(crate) fn behaving_blob_with(map: &str, parameters: Parameters, actions: &str) -> Vec<u8> {
    blob_with(&[map], parameters, Some(ORIGIN), mission_of("PS", actions))
}

fn mission_of(criticality: &str, actions: &str) -> MissionDraft {
    let mut mission = String::from("input time; of time\n");
    let mut stages = String::new();
    for (number, action) in actions.split(',').enumerate() {
        mission += &format!("action a{number} {action}; speed 0.5\n");
        stages += &format!(" a{number}");
    }
    mission += &format!(
        "frame all; at-least 0; speed 0.5
         ={stages}
         behaviour work all; when always {criticality}"
    );
    fixtures::mission(&mission)
}

/// The size of cells, metres, what a step out of one costs, in eighths of its length, and how fast the
/// robot may be there, m/s.
#[derive(Clone, Copy)]
pub(crate) struct Ground {
    pub(crate) resolution_m: f64,
    pub(crate) eighths: u32,
    pub(crate) limit_mps: Option<f64>,
}

/// Cells of 1 m that cost their length.
pub(crate) const PLAIN: Ground = Ground { resolution_m: 1.0, eighths: 8, limit_mps: None };

fn blob_with(
    layers: &[&str],
    parameters: Parameters,
    origin: Option<Origin>,
    mission: MissionDraft,
) -> Vec<u8> {
    blob_on(PLAIN, layers, parameters, origin, mission)
}

/// As [`blob`], on other ground.
pub(crate) fn blob_on(
    ground: Ground,
    layers: &[&str],
    parameters: Parameters,
    origin: Option<Origin>,
    mission: MissionDraft,
) -> Vec<u8> {
    let Ground { resolution_m, eighths, limit_mps } = ground;
    let drawings: Vec<Vec<&[u8]>> = layers
        .iter()
        .map(|layer| layer.split_whitespace().rev().map(str::as_bytes).collect())
        .collect();
    let (columns, rows) = (drawings[0][0].len() as u32, drawings[0].len() as u32);
    let grid = Grid { columns, rows, resolution_m, corner_m: [0.0, 0.0] };
    let character =
        |drawing: &Vec<&[u8]>, cell: Cell| drawing[cell.row as usize][cell.column as usize];
    let goals: Vec<Cell> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| Cell::new(column, row)))
        .filter(|&cell| character(&drawings[0], cell) == b'G')
        .collect();
    let layer = |(index, drawing): (usize, &Vec<&[u8]>)| {
        let blocked = Bitmap::from_fn(columns, rows, |cell| character(drawing, cell) == b'#');
        let tolls = Tolls::from_fn(columns, rows, |_| eighths);
        let field = solve(&Query {
            terrain: &Terrain::new(blocked).with_tolls(tolls),
            goals: &goals,
            corners: Corners::Forbid,
        });
        let mut limits = Limits::default();
        let everywhere = Bitmap::from_fn(columns, rows, |_| true);
        limit_mps.iter().for_each(|limit_mps| limits.lower(&everywhere, *limit_mps));
        let packed = pack_with_limits(&field, &limits);
        let numbered: Vec<_> = (0..).zip(goals.iter().copied()).collect();
        let packed = match goals.len() {
            1 => packed,
            _ => with_goals(packed, &numbered).expect("it fits"),
        };
        LayerDraft { name: format!("layer {index}"), rank: index as u8, packed }
    };
    let plan = PlanDraft {
        name: "goal".into(),
        goals_m: goals.iter().map(|&goal| grid.centre(goal)).collect(),
        layers: drawings.iter().enumerate().map(layer).collect(),
    };
    let draft = Draft { grid, origin, parameters, plans: vec![plan], mission };
    write(&draft).expect("the draft is valid")
}

/// A drawing of an open field of `columns` by `rows` with the goal in one cell.
pub(crate) fn open_field(columns: usize, rows: usize, goal: (usize, usize)) -> String {
    let row = |row: usize| -> String {
        (0..columns).map(|column| if (column, row) == goal { 'G' } else { '.' }).collect()
    };
    (0..rows).rev().map(row).collect::<Vec<_>>().join("\n")
}

/// A controller and the pose of its body.
#[derive(Clone)]
pub(crate) struct Robot<'a> {
    pub(crate) blob: Blob<'a>,
    pub(crate) state: State,
    pub(crate) time_us: u64,
    pub(crate) position: Vec2,
    pub(crate) heading_rad: f32,
}

impl<'a> Robot<'a> {
    pub(crate) fn new(blob: Blob<'a>, x: f32, y: f32) -> Self {
        let state = State::new(&blob);
        Self { blob, state, time_us: 1_000_000, position: Vec2::new(x, y), heading_rad: 0.0 }
    }

    /// Error-free percepts in this pose: armed, without obstacles.
    pub(crate) fn percepts(&self) -> Percepts {
        let fix = self.blob.map_frame().map(|frame| Fix {
            time_us: self.time_us,
            is_valid: true,
            place: frame.to_geodetic(self.position),
            accuracy_mm: 10,
            velocity_mmps: None,
            receiver_ms: None,
        });
        Percepts {
            time_us: self.time_us,
            fix,
            heading_rad: Some(self.heading_rad),
            speed_mps: None,
            turn_rate_radps: None,
            operator: armed(),
            ..Percepts::default()
        }
    }

    /// One tick with percepts that `change` may alter.
    pub(crate) fn tick_with(&mut self, change: impl FnOnce(&mut Percepts)) -> Commands {
        let mut percepts = self.percepts();
        change(&mut percepts);
        let commands = tick(&self.blob, &mut self.state, &percepts);
        self.time_us += TICK_US;
        commands
    }

    /// Moves the robot to another x, slowly enough for its fixes to count.
    pub(crate) fn carry_to(&mut self, x: f32) {
        self.position.x = x;
        self.time_us += 1_000_000;
    }

    /// One tick, and the body's movement by its commands until the next.
    pub(crate) fn drive_with(&mut self, change: impl FnOnce(&mut Percepts)) -> Commands {
        let commands = self.tick_with(change);
        let seconds = TICK_US as f32 * 1e-6;
        let turned = commands.turn_rate_radps * seconds;
        let step = vector::from_angle(self.heading_rad + 0.5 * turned);
        self.position += step * (commands.speed_mps * seconds);
        self.heading_rad = math::scalar::wrap_angle(self.heading_rad + turned);
        commands
    }
}
