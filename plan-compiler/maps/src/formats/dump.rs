//! Writes a map as short text for the readers' tests.

use crate::model::{LossTerm, Map, NamedPoint, Point, Radio, Shape};
use crate::problem::{Problem, draw};
use math::Cell;
use std::fmt::Write;

/// Metres to the millimetre, without needless digits.
fn metres(value: f64) -> String {
    // Adding zero turns a negative zero into a positive one.
    format!("{}", (value * 1e3).round() / 1e3 + 0.0)
}

fn point(at: Point) -> String {
    format!("{},{}", metres(at[0]), metres(at[1]))
}

fn points(list: &[Point]) -> String {
    list.iter().map(|at| point(*at)).collect::<Vec<_>>().join(" ")
}

fn named(out: &mut String, what: &str, named: &NamedPoint) {
    writeln!(out, "{what} {:?} {}", named.name, point(named.at)).unwrap();
}

/// A map without its spans.
pub(crate) fn dump(map: &Map) -> String {
    let mut out = String::new();
    writeln!(out, "extent {} + {}", point(map.extent.corner), point(map.extent.size)).unwrap();
    if let Some(title) = &map.title {
        writeln!(out, "title {title:?}").unwrap();
    }
    if let Some(resolution) = map.resolution_m {
        writeln!(out, "resolution {}", metres(resolution)).unwrap();
    }
    if let Some(reference) = map.reference {
        let (lat, lon) = (reference.place.lat_deg(), reference.place.lon_deg());
        let heading = metres(reference.heading_rad.to_degrees());
        writeln!(out, "reference {lat} {lon} at {} heading {heading}", point(reference.at))
            .unwrap();
    }
    if let Some(boundary) = &map.boundary {
        writeln!(out, "boundary {}", points(boundary)).unwrap();
    }
    if let Some(Radio { k1, k2, foliage }) = &map.radio {
        let term = |LossTerm { a, b, c }| format!("{a} {b} {c}");
        let (near, far) = (term(foliage.near), term(foliage.far));
        writeln!(out, "radio k {k1} {k2} cutoff {} near {near} far {far}", foliage.cutoff_m)
            .unwrap();
    }
    for remark in &map.remarks {
        writeln!(out, "remark {remark}").unwrap();
    }
    for feature in &map.features {
        let height = feature.height_m.filter(|h| *h > 0.0);
        let height = height.map_or(String::new(), |h| format!(" high {}", metres(h)));
        let shape = match &feature.shape {
            Shape::Circle { centre, radius } => {
                format!("circle {} radius {}", point(*centre), metres(*radius))
            }
            Shape::Polyline(line) => format!("line {}", points(line)),
            Shape::Polygon(rings) => {
                let rings: Vec<String> = rings.iter().map(|ring| points(ring)).collect();
                format!("polygon {}", rings.join(" / "))
            }
        };
        writeln!(out, "{:?} {:?} {shape}{height}", feature.role, feature.name).unwrap();
    }
    if let Some(cells) = &map.cells {
        let (columns, rows, side) = (cells.columns(), cells.rows(), metres(cells.resolution_m));
        writeln!(out, "cells {columns} x {rows} of {side} from {}", point(cells.corner)).unwrap();
        for row in (0..rows).rev() {
            let columns = (0..columns).map(|column| Cell::new(column, row));
            let symbol = |cell| match (cells.occupied.get(cell), cells.unknown.get(cell)) {
                (false, false) => '.',
                (true, false) => '#',
                (false, true) => '?',
                (true, true) => panic!("{cell:?} is both occupied and unknown"),
            };
            writeln!(out, "  {}", columns.map(symbol).collect::<String>()).unwrap();
        }
    }
    if let Some(start) = &map.start {
        named(&mut out, "start", start);
    }
    for at in &map.points {
        named(&mut out, "point", at);
    }
    out
}

/// A reader's result: its problems as a user sees them, then the map.
pub(crate) fn outcome((map, problems): &(Option<Map>, Vec<Problem>)) -> String {
    let map = map.as_ref().map_or("no map\n".into(), dump);
    // Trailing blanks come from miette and would not survive an editor.
    let drawn = draw(problems, false);
    let drawn: Vec<&str> = drawn.lines().map(str::trim_end).collect();
    let drawn = drawn.join("\n");
    if drawn.is_empty() { map } else { format!("{drawn}\n{map}") }
}
