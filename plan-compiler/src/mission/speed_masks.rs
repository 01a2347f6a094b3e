//! Speed masks: images whose shades limit the speed, as Nav2's speed filter takes them.
//!
//! A pixel with a number from 1 to 100 limits the speed to `base + multiplier x number`, in percent of
//! the top speed or in m/s. A pixel with 0, and one without a number, sets no limit.

use super::images::shades;
use super::tolls::factor;
use super::{PHYSICAL, Reader};
use crate::toml::{Fields, Span, Text};
use maps::formats::ros::Shades;
use maps::problem::Place;
use std::path::PathBuf;
use toml_edit::{Item, Value};

/// An image whose shades limit the speed.
#[derive(Clone, Debug)]
pub struct SpeedMask {
    /// The first layer in which it counts; it counts in the layers above, too.
    pub layer: String,
    /// Its file, relative to the current folder.
    pub path: PathBuf,
    /// Its place in the mission file.
    pub place: Place,
    /// Its shades.
    pub shades: Shades,
    /// What the numbers of its shades mean.
    pub unit: SpeedUnit,
    /// Limit of number 0, were it one.
    pub base: f64,
    /// How much each number adds.
    pub multiplier: f64,
    /// Factor of the cells with a limit, eighths; `None` if it follows from the limit and the top speed.
    pub eighths: Option<u32>,
}

/// What the numbers of a speed mask mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedUnit {
    /// Percent of the vehicle's top speed.
    Percent,
    /// Metres per second.
    MetresPerSecond,
}

impl SpeedMask {
    /// The speed that a number stands for, m/s; `None` for 0, which sets no limit.
    pub fn speed_mps(&self, number: u8, max_speed_mps: f64) -> Option<f64> {
        let speed = self.base + self.multiplier * f64::from(number);
        let in_mps = match self.unit {
            SpeedUnit::Percent => speed / 100.0 * max_speed_mps,
            SpeedUnit::MetresPerSecond => speed,
        };
        (number > 0).then_some(in_mps)
    }
}

const KEYS: [&str; 6] = ["mask", "type", "base", "multiplier", "factor", "layer"];
/// How a speed mask is written.
const EXAMPLE: &str =
    "speed = { mask = \"speed.yaml\", type = \"percent\", base = 100, multiplier = -1 }";
/// The words of `type`; Nav2 writes them as 1 and 2.
const UNITS: [(&str, SpeedUnit); 2] =
    [("percent", SpeedUnit::Percent), ("m/s", SpeedUnit::MetresPerSecond)];
/// A base or a multiplier, in percent or m/s.
const NUMBERS: std::ops::RangeInclusive<f64> = -1000.0..=1000.0;

impl Reader<'_> {
    /// Reads `masks.speed`: a table, or a list of them.
    pub(super) fn speed_masks(&mut self, item: &Item, span: &Span) {
        match item {
            Item::ArrayOfTables(tables) => {
                for table in tables {
                    self.speed_mask(&Item::Table(table.clone()), span);
                }
            }
            Item::Value(Value::Array(values)) => {
                for value in values {
                    let here = value.span().unwrap_or_else(|| span.clone());
                    self.speed_mask(&Item::Value(value.clone()), &here);
                }
            }
            _ => self.speed_mask(item, span),
        }
    }

    fn speed_mask(&mut self, item: &Item, span: &Span) {
        let path = "masks.speed";
        let before = self.report.problems.len();
        let report = &mut self.report;
        let fields = Fields::open(report, path.into(), item, span.clone(), &KEYS, EXAMPLE);
        let Some(fields) = fields else { return };
        if fields.lacks("mask") {
            let message = "a speed mask has no `mask`";
            report.error(message, span, "this mask", &format!("write {EXAMPLE}"));
        }
        let mut meaning = Meaning::default();
        match fields.item("type") {
            // As in the parameters of Nav2's filter.
            Some((item, _)) if item.as_integer() == Some(1) => meaning.unit = SpeedUnit::Percent,
            Some((item, _)) if item.as_integer() == Some(2) => {
                meaning.unit = SpeedUnit::MetresPerSecond;
            }
            Some(_) => {
                meaning.unit = fields.word(report, "type", &UNITS).unwrap_or(meaning.unit);
            }
            None => {}
        }
        if let Some(base) = fields.number(report, "base", NUMBERS, "percent or m/s") {
            meaning.base = base.value;
        }
        if let Some(multiplier) = fields.number(report, "multiplier", NUMBERS, "percent or m/s") {
            meaning.multiplier = multiplier.value;
        }
        if let Some((item, span)) = fields.item("factor") {
            meaning.eighths = factor(report, "masks.speed.factor", item, &span);
        }
        // A mask that is not understood limits nothing, or too much.
        let is_understood = report.problems.len() == before;
        let layer = fields.text(report, "layer", "\"night\"");
        let name = fields.text(report, "mask", "\"speed.yaml\"");
        let layer = match layer {
            None => Some(PHYSICAL.to_owned()),
            Some(layer) => self.layer_of_mask(layer.as_str(), layer.span.clone()),
        };
        if let (Some(name), Some(layer), true) = (name, layer, is_understood) {
            self.add_speed_mask(&name, layer, meaning);
        }
    }

    fn add_speed_mask(&mut self, name: &Text, layer: String, meaning: Meaning) {
        let Some((path, shades)) = shades(&mut self.report, name) else { return };
        let place = self.report.place(&name.span);
        let Meaning { unit, base, multiplier, eighths } = meaning;
        let mask = SpeedMask { layer, path, place, shades, unit, base, multiplier, eighths };
        self.mission.speed_masks.push(mask);
    }
}

/// What a mask's numbers mean, by default as in Nav2.
struct Meaning {
    unit: SpeedUnit,
    base: f64,
    multiplier: f64,
    eighths: Option<u32>,
}

impl Default for Meaning {
    fn default() -> Self {
        Self { unit: SpeedUnit::Percent, base: 0.0, multiplier: 1.0, eighths: None }
    }
}
