//! `inspect`: the contents of a blob, as text or as JSON.

use super::description::{Member, bytes_per_cell, describe, goals_text, member, raw_bytes};
use super::progress::with_patience;
use super::{Failure, open, print_json, print_text, read_blob};
use crate::cli::Inspect;
use maps::numbers::{metres, pair};
use plan_compiler::width::{self, LayerPassages, Need, Passage, in_words};
use plan_format::parameters::{Blend, Derived, OnLinkLoss, OnTrouble, Selection, Steering};
use plan_format::{Blob, FORMAT_VERSION, Parameters};
use std::io::{self, Write};
use std::path::Path;

pub(super) fn run(args: &Inspect) -> Result<(), Failure> {
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let passages = with_patience(false, "measuring passages", || width::of_blob(&plan, &bytes));
    if args.json {
        return print_json(&describe(&plan, &bytes, &passages));
    }
    let mut out = Vec::new();
    write_text(&mut out, &args.plans, &plan, &bytes, &passages)?;
    print_text(&String::from_utf8_lossy(&out))
}

fn write_text(
    out: &mut dyn Write,
    path: &Path,
    blob: &Blob<'_>,
    bytes: &[u8],
    passages: &[LayerPassages],
) -> io::Result<()> {
    let grid = blob.grid();
    let need = Need::of(blob.parameters());
    let mut passages = passages.iter();
    writeln!(out, "{}: {} bytes, format {FORMAT_VERSION}", path.display(), bytes.len())?;
    writeln!(
        out,
        "  grid    {} x {} cells of {} m",
        grid.columns,
        grid.rows,
        metres(grid.resolution_m)
    )?;
    writeln!(out, "  corner  {} in the south-west, metres", pair(grid.corner_m))?;
    match blob.origin() {
        Some(origin) => {
            let (at, heading) = (pair(origin.at_m), origin.heading_rad);
            let (lat, lon) = (origin.place.lat_deg(), origin.place.lon_deg());
            writeln!(out, "  origin  {lat:.7}, {lon:.7} is {at}; heading {heading} rad")?;
        }
        None => writeln!(out, "  origin  none: a robot with GPS cannot use these plans")?,
    }
    if let Some(Member { robot, robots, name }) = member(blob, bytes) {
        let name = name.map_or_else(String::new, |name| format!(", `{name}`"));
        writeln!(out, "  team    robot {robot} of {robots}{name}")?;
    }
    write_robot(out, blob)?;
    for parallel in blob.parallel_plans() {
        writeln!(out, "  plan    {} to {}", parallel.name(), goals_text(blob, &parallel))?;
        for layer in parallel.layers() {
            let counts = layer.counts();
            writeln!(
                out,
                "    layer {}/{}: {} cells with a route, {} without, {} blocked; {} bytes, {:.3} \
                 per cell",
                parallel.name(),
                layer.name(),
                counts.free,
                counts.unreachable,
                counts.blocked,
                layer.bytes(),
                bytes_per_cell(grid, layer.bytes())
            )?;
            for passage in passages.next().iter().flat_map(|layer| &layer.passages) {
                writeln!(out, "      passage {}", describe_passage(passage, &need))?;
            }
        }
    }
    let count: usize = blob.parallel_plans().map(|parallel| parallel.layer_count()).sum();
    if count > 0 {
        let raw = raw_bytes(grid) * count as u64;
        writeln!(
            out,
            "  raw     the layers would take {raw} bytes with 4 bits of direction and 32 of cost per \
             cell, {:.1} times the file",
            raw as f64 / bytes.len() as f64
        )?;
    }
    Ok(())
}

fn describe_passage(passage: &Passage, need: &Need) -> String {
    let ([width, at], percent) = (in_words(passage), 100.0 * passage.share);
    let verdict = match need.exceeds(passage) {
        true => format!("; too narrow: the robot needs {} m", metres(need.width_m)),
        false => String::new(),
    };
    format!("{width} wide at {at} on {percent:.0} % of the routes{verdict}")
}

/// How the robot drives. A value that differs from what would follow from the body has that beside
/// it.
fn write_drive(out: &mut dyn Write, parameters: &Parameters) -> io::Result<()> {
    let (vehicle, schemas) = (&parameters.vehicle, &parameters.schemas);
    let follows = Derived::of(vehicle);
    let number = |value: f32| metres(f64::from(value));
    let value = |value: f32, follows: f32| match (value - follows).abs() < 1e-3 {
        true => number(value),
        false => format!("{} ({} would follow)", number(value), number(follows)),
    };
    let blend = match parameters.blend {
        Blend::Route => "along the route",
        Blend::Paper => "as in the paper",
    };
    writeln!(
        out,
        "  drive   blends {blend}, at {} m/s; stops within {} m from {} m/s and sees {} m",
        value(vehicle.base_speed_mps, follows.base_speed_mps),
        number(vehicle.stopping_distance_m(vehicle.max_speed_mps)),
        vehicle.max_speed_mps,
        vehicle.reach_m
    )?;
    writeln!(
        out,
        "          keeps {} m, margin {} m, sphere {} m",
        value(vehicle.stop_distance_m, follows.stop_distance_m),
        value(schemas.avoid_margin_m, follows.avoid_margin_m),
        value(schemas.avoid_sphere_m, follows.avoid_sphere_m)
    )?;
    writeln!(
        out,
        "          turns at {} rad/s at most, cautious at {} m/s, looks {} m ahead",
        value(vehicle.max_turn_rate_radps, follows.max_turn_rate_radps),
        value(vehicle.cautious_speed_mps, follows.cautious_speed_mps),
        value(schemas.look_ahead_m, follows.look_ahead_m)
    )
}

fn write_robot(out: &mut dyn Write, blob: &Blob<'_>) -> io::Result<()> {
    let parameters = blob.parameters();
    let name = blob.parallel_plan(usize::from(parameters.plan)).map(|followed| followed.name());
    let when = match parameters.selection {
        Selection::Static => "once at the start",
        Selection::Dynamic => "every tick",
        Selection::Gains(_) => "every tick by its cost and gain",
    };
    let gains = parameters.gains;
    writeln!(out, "  robot   follows {}, layer chosen {when}", name.unwrap_or("no plan"))?;
    writeln!(
        out,
        "  gains   {} reactive, {} plan, {} noise",
        gains.reactive, gains.plan, gains.noise
    )?;
    let vehicle = parameters.vehicle;
    let steering = match vehicle.steering {
        Steering::Differential => "differential",
        Steering::Ackermann => "ackermann",
        Steering::Boat => "boat",
    };
    writeln!(
        out,
        "  vehicle {steering}, radius {} m, {} to {} m/s, {} rad/s, stops {} m before obstacles",
        metres(vehicle.radius_m.into()),
        metres(vehicle.cautious_speed_mps.into()),
        metres(vehicle.max_speed_mps.into()),
        metres(vehicle.max_turn_rate_radps.into()),
        metres(vehicle.stop_distance_m.into())
    )?;
    write_drive(out, parameters)?;
    let word = |action| match action {
        OnTrouble::Stop => "stops",
        OnTrouble::Reactive => "drives by its reactive schemas",
    };
    let trouble = parameters.trouble;
    writeln!(
        out,
        "  trouble {} off the map, {} without a route",
        word(trouble.off_map),
        word(trouble.no_route)
    )?;
    let link = parameters.link;
    let policy = match link.on_loss {
        OnLinkLoss::Continue => "continues the mission",
        OnLinkLoss::Disarm => "disarms and stands still",
    };
    let timeout_s = metres(f64::from(link.timeout_us) / 1e6);
    writeln!(out, "  link    lost after {timeout_s} s without a message, then {policy}")
}
