//! Masks: further maps whose occupied cells keep the robot out, like Nav2's keep-out filter.
//!
//! A mask is read like any map of cells. It may have its own resolution, origin and yaw: its cells
//! are squares on the plane. A cell of the plan is blocked if such a square, grown by the robot's
//! radius, touches it. Only occupied cells of the mask keep out; its unknown cells do nothing.
//!
//! Deliberately absent: speed masks. A speed zone is an area of the map: see `tolls`.

use super::{LayerRule, Named, PHYSICAL, Reader, TollRule};
use crate::toml::{Span, key_span};
use maps::formats::{self, ReadOptions};
use maps::problem::{Place, Severity};
use maps::{CellMap, Unknown};
use std::path::{Path, PathBuf};
use toml_edit::{Item, TableLike, Value};

/// A map of where the robot must not go.
#[derive(Clone, Debug)]
pub struct Mask {
    /// The first layer in which it is an obstacle; the layers above have it too.
    pub layer: String,
    /// Its file, relative to the current folder.
    pub path: PathBuf,
    /// Its place in the mission file.
    pub place: Place,
    /// Its cells.
    pub cells: CellMap,
}

/// Example of how masks are written.
const EXAMPLE: &str =
    "keepout = \"keepout.yaml\", a list of such names, or { LAYER = \"keepout.yaml\" }";

impl Reader<'_> {
    /// Reads the table `[masks]`.
    pub(super) fn masks(&mut self, table: &dyn TableLike) {
        for (name, item) in table.iter() {
            let key_span = key_span(table, name);
            match name {
                "keepout" => self.keepout(item, key_span),
                "speed" => self.report.error(
                    "speed masks cannot be used yet",
                    &key_span,
                    "a mask has no areas",
                    "name areas of the map in a layer, [layers.NAME], as speed = { AREA = 0.5 }",
                ),
                other => self.report.error(
                    format!("`{other}` is not a kind of mask"),
                    &key_span,
                    "unknown key",
                    &format!("write {EXAMPLE}"),
                ),
            }
        }
    }

    fn keepout(&mut self, item: &Item, key_span: Span) {
        let Some(layers) = item.as_table_like() else {
            return self.masks_of(PHYSICAL, "masks.keepout", item);
        };
        for (raw, item) in layers.iter() {
            let span = layers.key(raw).and_then(toml_edit::Key::span);
            let span = span.unwrap_or_else(|| key_span.clone());
            let Some(layer) = self.name("layer", raw, span.clone()) else { continue };
            let is_known = self.mission.layers.iter().any(|rule| rule.name.name == layer);
            if !is_known && layer != PHYSICAL {
                let name = Named { name: layer.clone(), place: self.report.place(&span) };
                self.mission.layers.push(LayerRule {
                    name,
                    areas: Vec::new(),
                    tolls: TollRule::default(),
                });
            }
            self.masks_of(&layer, &format!("masks.keepout.{raw}"), item);
        }
    }

    /// Reads the name of one file or a list of names.
    fn masks_of(&mut self, layer: &str, path: &str, item: &Item) {
        let whole = item.span().unwrap_or(0..0);
        let values: Option<Vec<&Value>> = match item.as_value() {
            Some(Value::Array(array)) => Some(array.iter().collect()),
            value => value.map(|value| vec![value]),
        };
        let texts = values.and_then(|values| {
            let text = |value: &Value| {
                let span = value.span().unwrap_or_else(|| whole.clone());
                value.as_str().map(|text| (text.to_owned(), span))
            };
            values.into_iter().map(text).collect::<Option<Vec<_>>>()
        });
        let Some(texts) = texts else {
            return self.report.wrong_type(
                path,
                item,
                &whole,
                "the name of a file, or a list",
                EXAMPLE,
            );
        };
        for (text, span) in texts {
            self.mask(layer, &text, span);
        }
    }

    fn mask(&mut self, layer: &str, text: &str, span: Span) {
        let folder = Path::new(&self.report.source.name).parent().unwrap_or(Path::new(""));
        let path = folder.join(text);
        let (map, found) = formats::read(&path, &ReadOptions::default());
        let worth_saying = found.into_iter().filter(|problem| problem.severity > Severity::Note);
        let source = self.report.source;
        self.report.problems.extend(worth_saying.map(|problem| match problem.place {
            None => problem.at(source, span.clone(), "named here"),
            Some(_) => problem,
        }));
        let Some(map) = map else { return };
        let Some(cells) = map.cells else {
            return self.report.error(
                format!("{} is not a mask", path.display()),
                &span,
                "a map without cells",
                "a mask is a ROS map, a YAML file with its image; areas that a map draws belong in \
                 [layers]",
            );
        };
        let cells = CellMap { unknown_as: Unknown::Free, ..cells };
        let (layer, place) = (layer.to_owned(), self.report.place(&span));
        self.mission.masks.push(Mask { layer, path, place, cells });
    }
}
