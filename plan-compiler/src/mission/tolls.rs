//! The tolls of a layer: where a step costs more than its length.

use super::Named;
use super::costs::{CostImage, CostMap, CostSource, MAX_BYTES, factors};
use super::images;
use crate::tolls;
use crate::toml::{Fields, Report, Span, key_span, number};
use maps::formats::TagRule;
use toml_edit::{Item, TableLike, Value};

/// Where steps of a layer, and of the layers above it, cost more than their length.
#[derive(Clone, Debug, Default)]
pub struct TollRule {
    /// Areas of the map and their factors in eighths. Where areas overlap, the last one counts.
    pub areas: Vec<(Named, u32)>,
    /// Bands around the obstacles of the layer. Where bands overlap, the highest factor counts.
    pub clearance: Vec<Band>,
    /// Areas of the map with a speed limit.
    pub speed: Vec<SpeedZone>,
    /// A factor for each cell, from an array or an image.
    pub costs: Option<CostMap>,
}

/// A band around obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Distance between the robot's body and an obstacle, metres.
    pub within_m: f64,
    /// Factor, eighths.
    pub eighths: u32,
}

/// An area with a speed limit.
#[derive(Clone, Debug)]
pub struct SpeedZone {
    /// The area.
    pub area: Named,
    /// Highest speed, m/s.
    pub limit_mps: f64,
    /// Factor, eighths; `None` if it follows from the limit and the robot's top speed.
    pub eighths: Option<u32>,
}

/// The keys of a layer that is a table.
pub(super) const LAYER_KEYS: [&str; 5] = ["areas", "toll", "clearance", "speed", "costs"];
/// Farthest band, metres.
const MAX_WITHIN_M: f64 = 1_000.0;
/// Speed limits, m/s.
const LIMITS_MPS: std::ops::RangeInclusive<f64> = 0.05..=50.0;
/// What a factor may be, for a sentence.
const FACTOR: &str = "a number from 1 to 32 in steps of 1/8";
const CLEARANCE: &str = "clearance = [{ within = 0.5, factor = 3 }, { within = 1, factor = 2 }]";
const IMAGE: &str = "costs = { image = \"costs.png\", black = 5 }";
const SPEED: &str = "speed = { yard = 0.5 }, or { yard = { limit = 0.5, factor = 2 } }";

impl TollRule {
    /// Whether it changes nothing.
    pub fn is_empty(&self) -> bool {
        let has_areas = !self.areas.is_empty() || !self.speed.is_empty();
        !has_areas && self.clearance.is_empty() && self.costs.is_none()
    }

    /// The areas of the map that it names.
    pub fn names(&self) -> impl Iterator<Item = &Named> {
        self.areas.iter().map(|(area, _)| area).chain(self.speed.iter().map(|zone| &zone.area))
    }
}

/// The tag that a name means, if it is one: `landuse=grass`. Such a name is that of all objects of
/// the kind.
pub fn kind(name: &str) -> Option<TagRule> {
    name.parse().ok().filter(|rule: &TagRule| rule.value.is_some() && rule.to_string() == name)
}

/// Reads the tolls of a layer's table.
pub(super) fn read(report: &mut Report<'_>, fields: &Fields<'_>) -> TollRule {
    TollRule {
        areas: areas(report, fields),
        clearance: clearance(report, fields),
        speed: speed(report, fields),
        costs: costs(report, fields),
    }
}

fn costs(report: &mut Report<'_>, fields: &Fields<'_>) -> Option<CostMap> {
    let (item, span) = fields.item("costs")?;
    if item.is_table_like() {
        return image_of_costs(report, item, &span, format!("{}.costs", fields.path));
    }
    let name = fields.text(report, "costs", "\"costs.npy\"")?;
    if images::is_image_name(name.as_str()) {
        let message = format!("{} does not say which factors its shades mean", name.as_str());
        let help = format!("write costs = {{ image = \"{}\", black = 5 }}", name.as_str());
        report.error(message, &name.span, "an image", &help);
        return None;
    }
    let path = report.beside(name.as_str());
    let size = std::fs::metadata(&path).map(|file| file.len());
    let bytes = match size {
        Ok(size) if size > MAX_BYTES => Err("it is larger than any grid".to_owned()),
        _ => std::fs::read(&path).map_err(|error| error.to_string()),
    };
    match bytes.and_then(|bytes| factors(&bytes)) {
        Ok(factors) => {
            let factors = CostSource::Array(factors);
            Some(CostMap { path, place: report.place(&name.span), factors })
        }
        Err(reason) => {
            let message = format!("{} cannot be used as a cost map", path.display());
            let help = "save an array [row, column] of factors from 1 to 32, row 0 in the south, with \
                        numpy.save";
            report.error(message, &name.span, &reason, help);
            None
        }
    }
}

/// An image of costs: `{ image = "costs.png", black = 5 }`.
fn image_of_costs(
    report: &mut Report<'_>,
    item: &Item,
    span: &Span,
    path: String,
) -> Option<CostMap> {
    let keys = ["image", "white", "black"];
    let fields = Fields::open(report, path.clone(), item, span.clone(), &keys, IMAGE)?;
    let mut complete = true;
    for key in ["image", "black"].into_iter().filter(|key| fields.lacks(key)) {
        let message = format!("`{path}` has no `{key}`");
        report.error(message, span, "this image", &format!("write {IMAGE}"));
        complete = false;
    }
    let [white, black] = ["white", "black"].map(|key| {
        let given = fields.item(key);
        given.map(|(item, span)| factor(report, &format!("{path}.{key}"), item, &span))
    });
    let name = fields.text(report, "image", "\"costs.png\"")?;
    let (path, shades) = images::shades(report, &name)?;
    let ends = [white.unwrap_or(Some(tolls::LEAST))?, black.flatten()?];
    let factors = CostSource::Image(CostImage { shades, ends });
    complete.then(|| CostMap { path, place: report.place(&name.span), factors })
}

fn areas(report: &mut Report<'_>, fields: &Fields<'_>) -> Vec<(Named, u32)> {
    let Some(table) = table(report, fields, "toll", "toll = { grass = 2, mud = 4, road = 1 }")
    else {
        return Vec::new();
    };
    let mut areas = Vec::new();
    for (name, item) in table.iter() {
        let span = key_span(table, name);
        let path = format!("{}.toll.{name}", fields.path);
        let here = item.span().unwrap_or_else(|| span.clone());
        let factor = factor(report, &path, item, &here);
        areas.extend(factor.map(|factor| (named(report, name, &span), factor)));
    }
    areas
}

fn clearance(report: &mut Report<'_>, fields: &Fields<'_>) -> Vec<Band> {
    let Some((item, span)) = fields.item("clearance") else { return Vec::new() };
    let path = format!("{}.clearance", fields.path);
    let tables: Vec<Item> = match item {
        Item::ArrayOfTables(tables) => tables.iter().cloned().map(Item::Table).collect(),
        Item::Value(Value::Array(values)) => values.iter().cloned().map(Item::Value).collect(),
        Item::Table(_) | Item::Value(Value::InlineTable(_)) => vec![item.clone()],
        _ => {
            report.wrong_type(&path, item, &span, "a list of tables", CLEARANCE);
            return Vec::new();
        }
    };
    let mut bands = Vec::new();
    for table in &tables {
        let here = table.span().unwrap_or_else(|| span.clone());
        let keys = ["within", "factor"];
        let Some(band) = Fields::open(report, path.clone(), table, here.clone(), &keys, CLEARANCE)
        else {
            continue;
        };
        let within = band.number(report, "within", 0.001..=MAX_WITHIN_M, "m");
        let factor = band
            .item("factor")
            .and_then(|(item, span)| factor(report, &format!("{path}.factor"), item, &span));
        for key in keys.into_iter().filter(|key| band.lacks(key)) {
            let message = format!("a band of `{path}` has no `{key}`");
            report.error(message, &here, "this band", &format!("write {CLEARANCE}"));
        }
        if let (Some(within), Some(eighths)) = (within, factor) {
            bands.push(Band { within_m: within.value, eighths });
        }
    }
    bands
}

fn speed(report: &mut Report<'_>, fields: &Fields<'_>) -> Vec<SpeedZone> {
    let Some(table) = table(report, fields, "speed", SPEED) else { return Vec::new() };
    let mut zones = Vec::new();
    for (name, item) in table.iter() {
        let span = key_span(table, name);
        let path = format!("{}.speed.{name}", fields.path);
        let here = item.span().unwrap_or_else(|| span.clone());
        let (limit, eighths) = if item.is_table_like() {
            let keys = ["limit", "factor"];
            let zone = Fields::open(report, path.clone(), item, here.clone(), &keys, SPEED);
            let Some(zone) = zone else { continue };
            if zone.lacks("limit") {
                let message = format!("`{path}` has no limit");
                report.error(message, &here, "this area", &format!("write {SPEED}"));
            }
            let limit = zone.number(report, "limit", LIMITS_MPS, "m/s").map(|limit| limit.value);
            let factor = zone
                .item("factor")
                .map(|(item, span)| factor(report, &format!("{path}.factor"), item, &span));
            // A wrong factor has been reported.
            (limit, factor.unwrap_or(None))
        } else {
            let limit = item.as_value().and_then(number).filter(|l| LIMITS_MPS.contains(l));
            if limit.is_none() {
                let expected = "a number from 0.05 to 50 m/s";
                report.wrong_type(&path, item, &here, expected, SPEED);
            }
            (limit, None)
        };
        let area = named(report, name, &span);
        zones.extend(limit.map(|limit_mps| SpeedZone { area, limit_mps, eighths }));
    }
    zones
}

/// A table of the user's names within a layer.
fn table<'t>(
    report: &mut Report<'_>,
    fields: &Fields<'t>,
    key: &str,
    example: &str,
) -> Option<&'t dyn TableLike> {
    let (item, span) = fields.item(key)?;
    let table = item.as_table_like();
    if table.is_none() {
        let path = format!("{}.{key}", fields.path);
        report.wrong_type(&path, item, &span, "a table of areas", example);
    }
    table
}

fn named(report: &Report<'_>, name: &str, span: &Span) -> Named {
    Named { name: name.trim().to_owned(), place: report.place(span) }
}

/// A factor in eighths.
pub(super) fn factor(report: &mut Report<'_>, path: &str, item: &Item, span: &Span) -> Option<u32> {
    let Some(number) = item.as_value().and_then(number) else {
        report.wrong_type(path, item, span, FACTOR, "2, or 1.5");
        return None;
    };
    let eighths = tolls::eighths(number);
    if eighths.is_none() {
        let help = if number < 1.0 && number > 0.0 {
            "cells cannot cost less than their length: multiply all factors until the lowest is 1"
                .to_owned()
        } else if (1.0..=32.0).contains(&number) {
            let close = (number * 8.0 + 0.5).trunc() / 8.0;
            format!("factors are exact in eighths: write {close}")
        } else {
            "to keep the robot out, list the area in the layer's `areas`".to_owned()
        };
        let message = format!("`{path}` must be {FACTOR}");
        report.error(message, span, "this factor", &help);
    }
    eighths
}

#[cfg(test)]
mod tests {
    use crate::mission::tests::read;

    #[test]
    fn a_layer_may_have_tolls() {
        let (mission, problems) = read(
            "[layers]\nnight = [\"A\"]\n[layers.quiet]\nareas = [\"B\"]\n\
             toll = { grass = 2, mud = 4.125, road = 1 }\n\
             clearance = [{ within = 0.5, factor = 3 }, { within = 1, factor = 1.5 }]\n\
             speed = { yard = 0.5, school = { limit = 1, factor = 2 } }\n",
        );
        assert_eq!(problems, [""; 0]);
        let [night, quiet] = &mission.layers[..] else { panic!("two layers") };
        assert!(night.tolls.is_empty());
        assert_eq!(quiet.areas[0].name, "B");
        let areas: Vec<(&str, u32)> =
            quiet.tolls.areas.iter().map(|(area, factor)| (area.name.as_str(), *factor)).collect();
        assert_eq!(areas, [("grass", 16), ("mud", 33), ("road", 8)]);
        let bands: Vec<(f64, u32)> =
            quiet.tolls.clearance.iter().map(|band| (band.within_m, band.eighths)).collect();
        assert_eq!(bands, [(0.5, 24), (1.0, 12)]);
        let zones: Vec<(f64, Option<u32>)> =
            quiet.tolls.speed.iter().map(|zone| (zone.limit_mps, zone.eighths)).collect();
        assert_eq!(zones, [(0.5, None), (1.0, Some(16))]);
    }

    #[test]
    fn mistakes_in_tolls_come_all_at_once() {
        let (_, problems) = read(
            "[layers.a]\ntoll = { x = 0.5, y = 1.1, z = 33, w = \"2\" }\nspead = { yard = 1 }\n\
             clearance = [{ within = -1, factor = 2 }, { factor = 2 }, 7]\n\
             speed = { u = 0, v = { factor = 2 } }\n[layers.b]\ntoll = 2\nclearance = 3\n",
        );
        let expected = [
            "`layers.a.toll.x` must be a number from 1 to 32 in steps of 1/8",
            "`layers.a.toll.y` must be a number from 1 to 32 in steps of 1/8",
            "`layers.a.toll.z` must be a number from 1 to 32 in steps of 1/8",
            "`layers.a.toll.w` must be a number from 1 to 32 in steps of 1/8",
            "`spead` is not a key of `layers.a`",
            "`layers.a.clearance.within` is out of range",
            "a band of `layers.a.clearance` has no `within`",
            "`layers.a.clearance` must be a table",
            "`layers.a.speed.u` must be a number from 0.05 to 50 m/s",
            "`layers.a.speed.v` has no limit",
            "`layers.b.toll` must be a table of areas",
            "`layers.b.clearance` must be a list of tables",
        ];
        let mut found = problems.clone();
        let mut expected = expected.map(str::to_owned).to_vec();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}
