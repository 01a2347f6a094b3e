//! Maps: read, compiled on a bounded cell grid, and verified cell by cell.

use ::maps::Map;
use ::maps::formats::{self, Format, ReadOptions};
use ::maps::problem::{Problem, Source, draw, has_errors};
use ::maps::source;
use plan_compiler::compile::{compile, grid, layers};
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{Goal, GoalAt, Mission};
use plan_compiler::verify;
use plan_compiler::verify::{compare, verify};
use plan_format::Blob;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most cells of a map that is compiled; a larger map is only read.
const MAX_CELLS: f64 = 4_096.0;
/// Cells along the longer side of a map of shapes.
const SIDE_CELLS: f64 = 48.0;

pub(crate) fn overlay(bytes: &[u8]) {
    check(Some(Format::Overlay), &[("map.ovl", bytes)]);
}

pub(crate) fn opar(bytes: &[u8]) {
    check(Some(Format::Opar), &[("map.opar", bytes)]);
}

pub(crate) fn ros_yaml(bytes: &[u8]) {
    // 4 x 3 pixels: occupied, unknown and free ones.
    let image = b"P5\n4 3\n255\n\xfe\xfe\xfe\xcd\x00\xfe\xfe\xcd\xfe\xfe\xfe\xfe";
    check(Some(Format::Ros), &[("map.yaml", bytes), ("map.pgm", image)]);
}

pub(crate) fn ros_image(bytes: &[u8]) {
    let yaml = "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.3]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.25\nmode: scale\n";
    check(Some(Format::Ros), &[("map.yaml", yaml.as_bytes()), ("map.pgm", bytes)]);
}

pub(crate) fn movingai(bytes: &[u8]) {
    check(Some(Format::Movingai), &[("map.map", bytes)]);
}

pub(crate) fn iplan(bytes: &[u8]) {
    check(Some(Format::Iplan), &[("Iplan.dat", bytes)]);
}

pub(crate) fn pcf(bytes: &[u8]) {
    let map = b"MISSION-AREA 40 30\nORIGIN 0 0\nCONTROL MEASURES:\nWALL w 5 5 20 5\nPP a 3 3\n";
    check(Some(Format::Pcf), &[("plan.pcf", bytes), ("yard.ovl", map)]);
}

pub(crate) fn geojson(bytes: &[u8]) {
    check(Some(Format::Geojson), &[("map.geojson", bytes)]);
}

pub(crate) fn osm_xml(bytes: &[u8]) {
    check(Some(Format::Osm), &[("map.osm", bytes)]);
}

pub(crate) fn osm_pbf(bytes: &[u8]) {
    check(Some(Format::Osm), &[("map.osm.pbf", bytes)]);
}

/// A map in the format that the reader recognises.
pub(crate) fn any(bytes: &[u8]) {
    check(None, &[("map", bytes)]);
}

/// The target of a format. Add a line for each new format.
#[cfg(test)]
const fn target(format: Format) -> &'static str {
    match format {
        Format::Overlay => "overlay",
        Format::Opar => "opar",
        Format::Ros => "ros_yaml",
        Format::Movingai => "movingai",
        Format::Iplan => "iplan",
        Format::Pcf => "pcf",
        Format::Geojson => "geojson",
        Format::Osm => "osm_xml",
    }
}

/// Reads the first of some files, with the others beside it, and compiles the map.
fn check(format: Option<Format>, files: &[(&str, &[u8])]) {
    let path = put(files);
    let options = ReadOptions { format, ..ReadOptions::default() };
    let (map, problems) = formats::read(&path, &options);
    draw_all(&problems);
    let Some(map) = map else {
        assert!(has_errors(&problems), "neither a map nor an error");
        return;
    };
    if !has_errors(&problems) {
        let source = source::read_text(&path).ok().map(|(text, _)| text);
        build(&map, source.as_ref());
    }
}

/// Writes files into one folder, over those of the input before; returns the path of the first.
pub(crate) fn put(files: &[(&str, &[u8])]) -> PathBuf {
    thread_local! {
        static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a folder for inputs");
    }
    FOLDER.with(|folder| {
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).expect("an input can be written");
        }
        folder.path().join(files[0].0)
    })
}

/// Draws the problems as a user would see them, with places and excerpts.
pub(crate) fn draw_all(problems: &[Problem]) {
    for colour in [false, true] {
        assert!(problems.is_empty() || !draw(problems, colour).is_empty());
    }
}

/// Compiles a map and verifies every cell of the result.
fn build(map: &Map, source: Option<&Arc<Source>>) {
    let mission = Mission::default();
    let options = options(map);
    let input = Input { map, source, mission: &mission, options: &options };
    let mut problems = Vec::new();
    let grid = grid(&input, &mut problems);
    if grid.is_none_or(|grid| f64::from(grid.columns) * f64::from(grid.rows) > MAX_CELLS) {
        return draw_all(&problems);
    }
    let mut problems = Vec::new();
    let blob = compile(&input, &|_, _| (), &mut problems);
    draw_all(&problems);
    let Some(blob) = blob else {
        assert!(has_errors(&problems), "neither a blob nor an error");
        return;
    };
    let blob = Blob::parse_exact(&blob).expect("what was written is read");
    check_report(&verify(&blob, &|_, _| ()));
    let layers = layers(&input, blob.grid(), &mut Vec::new()).expect("it was compiled already");
    check_report(&compare(&blob, &layers));
}

fn check_report(report: &verify::Report) {
    assert_eq!(report.count, 0, "{:?}", report.violations.first());
}

/// Options with cells that bound the work, and with a goal in the middle of a map that has none.
fn options(map: &Map) -> Options {
    let [width, height] = map.extent.size;
    let [x, y] = map.extent.corner;
    let middle = Goal {
        name: "middle".into(),
        at: vec![GoalAt::Position([x + width / 2.0, y + height / 2.0])],
        layers: None,
        place: None,
    };
    let resolution_m = (width.max(height) / SIDE_CELLS).clamp(0.001, 1_000.0);
    Options {
        goals: if map.points.is_empty() { vec![middle] } else { Vec::new() },
        resolution_m: map.cells.is_none().then_some(resolution_m).filter(|side| side.is_finite()),
        robot_radius_m: Some(0.3),
        ..Options::default()
    }
}

/// The map for the missions.
pub(crate) fn yard() -> (Map, Arc<Source>) {
    let text = "MISSION-AREA 60 40\nORIGIN 0 0\nGLOBAL_REF_POINT 51.5 7.4\nCONTROL MEASURES:\n\
                WALL shed 20 10 30 10 30 20 20 20 20 10\nBOUNDARY NoCommZone1 40 5 55 5 55 15 40 15\n\
                BOUNDARY NoFlyZone1 5 25 15 25 15 35\nPP gate 5 5\nPP barn 50 35\nPP home 10 20\n";
    let path = put(&[("yard.ovl", text.as_bytes())]);
    let (map, problems) = formats::read(Path::new(&path), &ReadOptions::default());
    assert!(!has_errors(&problems), "{}", draw(&problems, false));
    let (source, _) = source::read_text(&path).expect("it was read already");
    (map.expect("the yard is a map"), source)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Target;

    #[test]
    fn every_format_has_a_target() {
        for format in Format::ALL {
            assert!(Target::find(target(format)).is_some(), "{}", format.name());
        }
    }
}
