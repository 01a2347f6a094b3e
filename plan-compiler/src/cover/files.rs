//! Strips as files for other programs.

use super::{Cover, Strip};
use maps::Point;
use math::{MapFrame, Vec2};
use serde_json::{Value, json};
use std::fmt::Write;

/// A line for each strip, in order: its number, its ends in the map's metres, and its length.
pub fn csv(cover: &Cover) -> String {
    let mut text = "strip,from_x,from_y,to_x,to_y,length\n".to_owned();
    for (strip, number) in cover.strips.iter().zip(1..) {
        let Strip { from: [x1, y1], to: [x2, y2] } = strip;
        // Writing to a string does not fail.
        let _ = writeln!(text, "{number},{x1:.3},{y1:.3},{x2:.3},{y2:.3},{:.3}", strip.length_m());
    }
    text
}

/// A FeatureCollection of the strips and the transitions between them, longitudes and latitudes.
pub fn geojson(cover: &Cover, frame: &MapFrame) -> String {
    let degrees = |[x, y]: Point| {
        let place = frame.to_geodetic(Vec2::new(x as f32, y as f32));
        json!([place.lon_deg(), place.lat_deg()])
    };
    let feature = |kind: &str, number: usize, points: &[Point]| {
        let coordinates: Vec<Value> = points.iter().map(|at| degrees(*at)).collect();
        json!({
            "type": "Feature",
            "properties": { "kind": kind, "number": number },
            "geometry": { "type": "LineString", "coordinates": coordinates },
        })
    };
    let strips = cover.strips.iter().zip(1..);
    let strips = strips.map(|(strip, number)| feature("strip", number, &[strip.from, strip.to]));
    let transitions = cover.transition_lines();
    let transitions =
        transitions.iter().zip(1..).map(|(line, number)| feature("transition", number, line));
    let features: Vec<Value> = strips.chain(transitions).collect();
    let collection = json!({ "type": "FeatureCollection", "features": features });
    format!("{collection:#}\n")
}
