//! Masks: further maps whose occupied cells keep the robot out, like Nav2's keep-out filter.
//!
//! A mask is read like any map of cells. It may have its own resolution, origin and yaw: its cells
//! are squares on the plane. A cell of the plan is blocked if such a square, grown by the robot's
//! radius, touches it. Only occupied cells of the mask keep out; its unknown cells do nothing.
//!
//! Masks of speeds are in `speed_masks`.

use super::{LayerRule, Named, PHYSICAL, Reader, TollRule};
use crate::toml::{Span, key_span};
use maps::formats::ros::read_shades;
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
    /// Further files that were read with it: its image.
    pub files: Vec<PathBuf>,
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
                "speed" => {
                    let span = item.span().unwrap_or(key_span);
                    self.speed_masks(item, &span);
                }
                other => self.report.error(
                    format!("`{other}` is not a kind of mask"),
                    &key_span,
                    "unknown key",
                    &format!("write {EXAMPLE}"),
                ),
            }
        }
    }

    /// The layer to which a mask belongs; a layer that the mission does not list is added.
    pub(super) fn layer_of_mask(&mut self, raw: &str, span: Span) -> Option<String> {
        let layer = self.name("layer", raw, span.clone())?;
        let is_known = self.mission.layers.iter().any(|rule| rule.name.name == layer);
        if !is_known && layer != PHYSICAL {
            let name = Named { name: layer.clone(), place: self.report.place(&span) };
            let tolls = TollRule::default();
            self.mission.layers.push(LayerRule { name, areas: Vec::new(), tolls });
        }
        Some(layer)
    }

    fn keepout(&mut self, item: &Item, key_span: Span) {
        let Some(layers) = item.as_table_like() else {
            return self.masks_of(PHYSICAL, "masks.keepout", item);
        };
        for (raw, item) in layers.iter() {
            let span = layers.key(raw).and_then(toml_edit::Key::span);
            let span = span.unwrap_or_else(|| key_span.clone());
            let Some(layer) = self.layer_of_mask(raw, span) else { continue };
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
        let path = self.report.beside(text);
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
        if cells.unknown.count() > 0 {
            self.greys(&path, text, &span);
        }
        let cells = CellMap { unknown_as: Unknown::Free, ..cells };
        let (layer, place) = (layer.to_owned(), self.report.place(&span));
        self.mission.masks.push(Mask { layer, path, files: map.files, place, cells });
    }

    /// Warns about greys of a mask: in Nav2's mode `scale` they are costs.
    fn greys(&mut self, path: &Path, text: &str, span: &Span) {
        let count = read_shades(path).0.map_or(0, |shades| shades.greys());
        if count > 0 {
            let message =
                format!("{count} grey pixels of {} do not keep the robot out", path.display());
            let help = format!(
                "only occupied ones do; for costs, add to a layer: costs = {{ image = \"{text}\", black = \
                 5 }}"
            );
            self.report.warning(message, span, "this mask", &help);
        }
    }
}
