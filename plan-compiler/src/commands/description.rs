//! The contents of a blob as JSON.

use maps::numbers::pair;
use plan_compiler::recipe;
use plan_compiler::width::{LayerPassages, Need, Passage};
use plan_format::parameters::{Blend, Derived};
use plan_format::{Answer, Blob, Counts, FORMAT_VERSION, Grid, Layer, ParallelPlan, Parameters};
use serde::Serialize;

/// The JSON object. Programs rely on these names.
#[derive(Serialize)]
pub(super) struct Description<'b> {
    format_version: u16,
    bytes: usize,
    columns: u32,
    rows: u32,
    resolution_m: f64,
    corner_m: [f64; 2],
    origin: Option<Place>,
    /// Bytes of all layers without packing.
    raw_bytes: u64,
    /// Width that the robot needs between obstacles.
    needed_width_m: f64,
    /// The robot of a team for which the blob is.
    #[serde(skip_serializing_if = "Option::is_none")]
    team: Option<Member>,
    drive: Driving,
    plans: Vec<Parallel<'b>>,
}

/// A robot of a team.
#[derive(Serialize)]
pub(super) struct Member {
    /// Its place in the mission's list, from 1.
    pub(super) robot: u8,
    /// Number of robots.
    pub(super) robots: u8,
    /// Its name, if the blob has it.
    pub(super) name: Option<String>,
}

/// The robot for which a blob is; `None` without a team.
pub(super) fn member(blob: &Blob<'_>, bytes: &[u8]) -> Option<Member> {
    let team = &blob.parameters().team;
    let name = recipe::of_blob(bytes).and_then(|recipe| recipe.robot);
    (team.robots > 1).then(|| Member { robot: team.robot + 1, robots: team.robots, name })
}

/// How the robot drives, and what would follow from its body.
#[derive(Serialize)]
struct Driving {
    blend: &'static str,
    radius_m: f64,
    max_speed_mps: f64,
    braking_mps2: f64,
    latency_s: f64,
    reach_m: f64,
    stopping_distance_m: f64,
    values: Following,
    follows: Following,
}

/// Values that follow from the body unless a mission sets them.
#[derive(Serialize)]
struct Following {
    base_speed_mps: f64,
    cautious_speed_mps: f64,
    max_turn_rate_radps: f64,
    stop_distance_m: f64,
    avoid_margin_m: f64,
    avoid_sphere_m: f64,
    look_ahead_m: f64,
}

fn driving(parameters: &Parameters) -> Driving {
    let (vehicle, schemas) = (&parameters.vehicle, &parameters.schemas);
    let number = |value: f32| rounded(f64::from(value));
    let derived = Derived::of(vehicle);
    Driving {
        blend: match parameters.blend {
            Blend::Route => "route",
            Blend::Paper => "paper",
        },
        radius_m: number(vehicle.radius_m),
        max_speed_mps: number(vehicle.max_speed_mps),
        braking_mps2: number(vehicle.braking_mps2),
        latency_s: f64::from(vehicle.latency_us) / 1e6,
        reach_m: number(vehicle.reach_m),
        stopping_distance_m: number(vehicle.stopping_distance_m(vehicle.max_speed_mps)),
        values: Following {
            base_speed_mps: number(vehicle.base_speed_mps),
            cautious_speed_mps: number(vehicle.cautious_speed_mps),
            max_turn_rate_radps: number(vehicle.max_turn_rate_radps),
            stop_distance_m: number(vehicle.stop_distance_m),
            avoid_margin_m: number(schemas.avoid_margin_m),
            avoid_sphere_m: number(schemas.avoid_sphere_m),
            look_ahead_m: number(schemas.look_ahead_m),
        },
        follows: Following {
            base_speed_mps: number(derived.base_speed_mps),
            cautious_speed_mps: number(derived.cautious_speed_mps),
            max_turn_rate_radps: number(derived.max_turn_rate_radps),
            stop_distance_m: number(derived.stop_distance_m),
            avoid_margin_m: number(derived.avoid_margin_m),
            avoid_sphere_m: number(derived.avoid_sphere_m),
            look_ahead_m: number(derived.look_ahead_m),
        },
    }
}

#[derive(Serialize)]
struct Place {
    lat_deg: f64,
    lon_deg: f64,
    at_m: [f64; 2],
    heading_rad: f64,
}

#[derive(Serialize)]
struct Parallel<'b> {
    name: &'b str,
    goal_m: [f64; 2],
    /// All goals, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    goals_m: Vec<[f64; 2]>,
    layers: Vec<OneLayer<'b>>,
}

#[derive(Serialize)]
struct OneLayer<'b> {
    name: &'b str,
    bytes: usize,
    bytes_per_cell: f64,
    raw_bytes: u64,
    free: u32,
    blocked: u32,
    unreachable: u32,
    /// The narrowest passages of its routes, the narrowest first.
    passages: Vec<OnePassage>,
}

/// A passage of a layer's routes.
#[derive(Serialize)]
pub(super) struct OnePassage {
    /// The middle between its sides.
    at_m: [f64; 2],
    /// Least and largest width between the obstacles of the map.
    width_m: [f64; 2],
    /// Share of the cells with a route whose route passes here.
    share: f64,
    /// Whether the robot may need more width than there is.
    is_too_narrow: bool,
}

/// A number to the millionth, so that single precision and binary fractions do not show.
pub(super) fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

/// A passage for a robot with a need.
pub(super) fn passage(passage: &Passage, need: &Need) -> OnePassage {
    let Passage { at_m, width_m, share } = *passage;
    OnePassage {
        at_m: at_m.map(rounded),
        width_m: width_m.map(rounded),
        share: rounded(share),
        is_too_narrow: need.exceeds(passage),
    }
}

/// Bits of a cell without packing: 4 of direction and 32 of cost.
const RAW_BITS: u64 = 4 + 32;

/// Bytes of a layer without packing.
pub(super) fn raw_bytes(grid: &Grid) -> u64 {
    (grid.cells() as u64 * RAW_BITS).div_ceil(8)
}

/// Bytes of a layer per cell.
pub(super) fn bytes_per_cell(grid: &Grid, bytes: usize) -> f64 {
    bytes as f64 / grid.cells().max(1) as f64
}

/// The goals of a plan as text, without those that were left out of all layers.
pub(super) fn goals_text(blob: &Blob<'_>, parallel: &ParallelPlan<'_>) -> String {
    let is_kept = |&[x, y]: &[f64; 2]| {
        let place = parallel.layer(0).zip(blob.grid().cell_at(x, y));
        place.is_some_and(|(layer, cell)| layer.look_up(cell) == Answer::Goal)
    };
    let goals: Vec<String> = parallel.goals_m().filter(is_kept).map(pair).collect();
    match goals.as_slice() {
        [goal] => goal.clone(),
        several => format!("the cheapest of {}", several.join(", ")),
    }
}

/// Describes a blob with these bytes, whose layers have these passages.
pub(super) fn describe<'b>(
    blob: &Blob<'b>,
    bytes: &[u8],
    passages: &[LayerPassages],
) -> Description<'b> {
    let need = Need::of(blob.parameters());
    let mut passages = passages.iter();
    let grid = blob.grid();
    let origin = blob.origin().map(|origin| Place {
        lat_deg: origin.place.lat_deg(),
        lon_deg: origin.place.lon_deg(),
        at_m: origin.at_m,
        heading_rad: origin.heading_rad,
    });
    let mut one_layer = |layer: Layer<'b>| {
        let own = passages.next().map(|layer| layer.passages.as_slice()).unwrap_or_default();
        let Counts { free, blocked, unreachable } = layer.counts();
        OneLayer {
            name: layer.name(),
            bytes: layer.bytes(),
            bytes_per_cell: bytes_per_cell(grid, layer.bytes()),
            raw_bytes: raw_bytes(grid),
            free,
            blocked,
            unreachable,
            passages: own.iter().map(|own| passage(own, &need)).collect(),
        }
    };
    let plans = blob.parallel_plans().map(|parallel| Parallel {
        name: parallel.name(),
        goal_m: parallel.goal_m(),
        goals_m: parallel.goals_m().filter(|_| parallel.goal_count() > 1).collect(),
        layers: parallel.layers().map(&mut one_layer).collect(),
    });
    let plans: Vec<Parallel<'b>> = plans.collect();
    let layers: usize = plans.iter().map(|plan| plan.layers.len()).sum();
    Description {
        format_version: FORMAT_VERSION,
        bytes: bytes.len(),
        columns: grid.columns,
        rows: grid.rows,
        resolution_m: grid.resolution_m,
        corner_m: grid.corner_m,
        origin,
        raw_bytes: raw_bytes(grid) * layers as u64,
        needed_width_m: rounded(need.width_m),
        team: member(blob, bytes),
        drive: driving(blob.parameters()),
        plans,
    }
}
