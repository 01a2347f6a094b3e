//! The whole route from a point, in the formats of ROS, tables and map viewers.

use crate::cli::RouteFormat;
use crate::commands::Failure;
use crate::commands::render::help;
use maps::Point;
use maps::numbers::{metres, pair};
use maps::problem::Problem;
use math::Vec2;
use math::scalar::wide;
use plan_compiler::route::{self, Route};
use plan_format::{Blob, Layer, ParallelPlan};
use serde::Serialize;
use serde_json::json;
use std::io::Write;

/// A point of a route with the direction to the next one.
#[derive(Serialize)]
struct Pose {
    x: f64,
    y: f64,
    /// Radians counter-clockwise from east.
    yaw: f64,
}

/// Writes the route from a point to the goal, or reports why there is none.
pub(super) fn write(
    out: &mut dyn Write,
    blob: &Blob<'_>,
    (parallel, layer): &(ParallelPlan<'_>, Layer<'_>),
    start: Point,
    format: RouteFormat,
) -> Result<(), Failure> {
    let name = format!("{}/{}", parallel.name(), layer.name());
    let followed = route::follow(blob.grid(), parallel, layer, start);
    let route = followed.map_err(|reason| {
        let message = format!("{name} has no route from {}: {reason}", pair(start));
        Problem::error(message).help(help(reason))
    })?;
    // The number of the goal, if the plan has several.
    let goal = Some(route.goal).filter(|_| parallel.goal_count() > 1);
    match format {
        RouteFormat::Json => {
            let (poses, length_m) = (poses(&route), route.length_m);
            let mut whole =
                json!({ "layer": name, "frame_id": "map", "length_m": length_m, "poses": poses });
            if let Some(goal) = goal {
                whole["goal"] = goal.into();
            }
            writeln!(out, "{whole}")?;
        }
        RouteFormat::Csv => write_table(out, blob, &route)?,
        RouteFormat::Geojson => {
            let line = line(blob, &route).ok_or_else(|| {
                Problem::error("the plans have no place on the globe, which GeoJSON needs").help(
                    "write --format json or csv, or give the map a reference: GLOBAL_REF_POINT in \
                     an overlay",
                )
            })?;
            let mut whole = json!({
                "type": "FeatureCollection",
                "features": [{
                    "type": "Feature",
                    "properties": { "layer": name, "length_m": route.length_m },
                    "geometry": { "type": "LineString", "coordinates": line },
                }],
            });
            if let Some(goal) = goal {
                whole["features"][0]["properties"]["goal"] = goal.into();
            }
            writeln!(out, "{whole}")?;
        }
    }
    Ok(())
}

/// Poses that point along the route; the last one has the yaw of the one before it.
fn poses(route: &Route) -> Vec<Pose> {
    let points = &route.points;
    let mut yaw = 0.0;
    let pose = |index: usize| {
        let [x, y] = points[index];
        if let Some([next_x, next_y]) = points.get(index + 1).filter(|next| **next != [x, y]) {
            yaw = wide::atan2(next_y - y, next_x - x);
        }
        Pose { x, y, yaw }
    };
    (0..points.len()).map(pose).collect()
}

fn write_table(out: &mut dyn Write, blob: &Blob<'_>, route: &Route) -> Result<(), Failure> {
    let line = line(blob, route);
    writeln!(out, "x,y,yaw{}", if line.is_some() { ",lat,lon" } else { "" })?;
    for (index, pose) in poses(route).iter().enumerate() {
        write!(out, "{},{},{}", metres(pose.x), metres(pose.y), metres(pose.yaw))?;
        if let Some([lon, lat]) = line.as_ref().and_then(|line| line.get(index)) {
            write!(out, ",{lat},{lon}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Longitude and latitude of every point; `None` if the plans have no place on the globe.
fn line(blob: &Blob<'_>, route: &Route) -> Option<Vec<[f64; 2]>> {
    let frame = blob.map_frame()?;
    let place = |&[x, y]: &Point| {
        let place = frame.to_geodetic(Vec2::new(x as f32, y as f32));
        [place.lon_deg(), place.lat_deg()]
    };
    Some(route.points.iter().map(place).collect())
}
