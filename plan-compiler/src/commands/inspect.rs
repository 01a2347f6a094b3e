//! `inspect`: what a blob holds, for a person or as JSON.

use super::{Failure, layers, open, parallel_plans, read_blob};
use crate::cli::Inspect;
use plan_compiler::compile::{metres, pair};
use plan_format::parameters::{OnTrouble, Selection, Steering};
use plan_format::{Counts, FORMAT_VERSION, Layer, Plan};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

pub(super) fn run(args: &Inspect) -> Result<(), Failure> {
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let mut out = io::stdout().lock();
    if args.json {
        serde_json::to_writer_pretty(&mut out, &describe(&plan, bytes.len()))
            .map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        write_text(&mut out, &args.plans, &plan, bytes.len())?;
    }
    out.flush()?;
    Ok(())
}

/// The whole of the JSON. Programs rely on these names.
#[derive(Serialize)]
struct Blob<'b> {
    format_version: u16,
    bytes: usize,
    columns: u32,
    rows: u32,
    resolution_m: f64,
    corner_m: [f64; 2],
    origin: Option<Place>,
    plans: Vec<Parallel<'b>>,
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
    layers: Vec<OneLayer<'b>>,
}

#[derive(Serialize)]
struct OneLayer<'b> {
    name: &'b str,
    bytes: usize,
    free: u32,
    blocked: u32,
    unreachable: u32,
}

fn describe<'b>(plan: &Plan<'b>, bytes: usize) -> Blob<'b> {
    let grid = plan.grid();
    let origin = plan.origin().map(|origin| Place {
        lat_deg: origin.place.lat_deg(),
        lon_deg: origin.place.lon_deg(),
        at_m: origin.at_m,
        heading_rad: origin.heading_rad,
    });
    let one_layer = |layer: Layer<'b>| {
        let Counts { free, blocked, unreachable } = layer.counts();
        OneLayer { name: layer.name(), bytes: layer.bytes(), free, blocked, unreachable }
    };
    let plans = parallel_plans(plan).map(|parallel| Parallel {
        name: parallel.name(),
        goal_m: parallel.goal_m(),
        layers: layers(parallel).map(one_layer).collect(),
    });
    Blob {
        format_version: FORMAT_VERSION,
        bytes,
        columns: grid.columns,
        rows: grid.rows,
        resolution_m: grid.resolution_m,
        corner_m: grid.corner_m,
        origin,
        plans: plans.collect(),
    }
}

fn write_text(out: &mut dyn Write, path: &Path, plan: &Plan<'_>, bytes: usize) -> io::Result<()> {
    let grid = plan.grid();
    writeln!(out, "{}: {bytes} bytes, format {FORMAT_VERSION}", path.display())?;
    writeln!(
        out,
        "  grid    {} x {} cells of {} m",
        grid.columns,
        grid.rows,
        metres(grid.resolution_m)
    )?;
    writeln!(out, "  corner  {} in the south-west, metres", pair(grid.corner_m))?;
    match plan.origin() {
        Some(origin) => {
            let (at, heading) = (pair(origin.at_m), origin.heading_rad);
            let (lat, lon) = (origin.place.lat_deg(), origin.place.lon_deg());
            writeln!(out, "  origin  {lat:.7}, {lon:.7} is {at}; heading {heading} rad")?;
        }
        None => writeln!(out, "  origin  none: a robot with GPS cannot use these plans")?,
    }
    write_robot(out, plan)?;
    for parallel in parallel_plans(plan) {
        writeln!(out, "  plan    {} to {}", parallel.name(), pair(parallel.goal_m()))?;
        for layer in layers(parallel) {
            let counts = layer.counts();
            writeln!(
                out,
                "    layer {}/{}: {} cells with a route, {} without, {} blocked; {} bytes",
                parallel.name(),
                layer.name(),
                counts.free,
                counts.unreachable,
                counts.blocked,
                layer.bytes()
            )?;
        }
    }
    Ok(())
}

fn write_robot(out: &mut dyn Write, plan: &Plan<'_>) -> io::Result<()> {
    let parameters = plan.parameters();
    let name = plan.parallel_plan(usize::from(parameters.plan)).map(|followed| followed.name());
    let when = match parameters.selection {
        Selection::Static => "once at the start",
        Selection::Dynamic => "every tick",
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
        vehicle.radius_m,
        vehicle.cautious_speed_mps,
        vehicle.max_speed_mps,
        vehicle.max_turn_rate_radps,
        vehicle.stop_distance_m
    )?;
    let word = |action| match action {
        OnTrouble::Stop => "stops",
        OnTrouble::Reactive => "drives by its schemas",
    };
    let trouble = parameters.trouble;
    writeln!(
        out,
        "  trouble {} off the map, {} without a route",
        word(trouble.off_map),
        word(trouble.no_route)
    )
}
