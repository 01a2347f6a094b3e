//! The recipe: how a map was made into cells. The blob carries it, so that `verify --map` needs no
//! build options.
//!
//! It contains what decides which cells are blocked: the robot's radius, filled walls, how the map
//! was read, the areas of each layer, the radio of layer `comms`. The grid has the resolution; goals do not matter.

use crate::input::{Input, Options};
use crate::mission::{
    self, Band, LayerRule, Mission, NEEDS, RADIO_KEYS, RadioRule, SpeedZone, TollRule,
};
use crate::tolls::LEAST;
use maps::formats::opar::{DeltaOrder, DeltaUnit, ObstructionType};
use maps::formats::{Format, ReadOptions, TagRules};
use maps::names::Word;
use maps::problem::Source;
use maps::{Point, Unknown};
use std::sync::Arc;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// What a blob's recipe says.
#[derive(Clone, Debug, Default)]
pub struct Recipe {
    /// How far obstacles were grown, metres.
    pub robot_radius_m: Option<f64>,
    /// Whether closed walls are solid.
    pub fill_walls: bool,
    /// How the map was read.
    pub reading: ReadOptions,
    /// Areas that become obstacles, layer by layer.
    pub layers: Vec<LayerRule>,
    /// The robot of the mission's team.
    pub robot: Option<String>,
    /// How layer `comms` was computed.
    pub radio: Option<RadioRule>,
}

/// Writes the recipe of an input as text. `places` are those of its radio.
pub(crate) fn write(input: &Input<'_>, robot_radius_m: f64, places: &[(String, Point)]) -> String {
    let mut document = DocumentMut::new();
    let mut put = |key: &str, value: Value| document[key] = Item::Value(value);
    put("robot_radius", robot_radius_m.into());
    if input.options.fill_walls || input.mission.fill_walls.unwrap_or(false) {
        put("fill_walls", true.into());
    }
    if let Some(robot) = input.mission.team.robots.get(input.mission.team.robot) {
        put("robot", robot.as_str().into());
    }
    let reading = &input.options.reading;
    if let Some(format) = reading.format {
        put("format", format.word().into());
    }
    if reading.unknown != Unknown::default() {
        put("unknown", reading.unknown.word().into());
    }
    if reading.opar.units != DeltaUnit::default() {
        put("opar_units", reading.opar.units.word().into());
    }
    if reading.opar.order != DeltaOrder::default() {
        put("opar_order", reading.opar.order.word().into());
    }
    if !reading.opar.types.is_empty() {
        let types = reading.opar.types.iter().map(ToString::to_string);
        put("opar_type", Value::Array(types.collect()));
    }
    for (key, rules) in [("block", &reading.tags.block), ("free", &reading.tags.free)] {
        if !rules.is_empty() {
            put(key, Value::Array(rules.iter().map(ToString::to_string).collect()));
        }
    }
    if reading.tags.open_gates {
        put("open_gates", true.into());
    }
    if let Some(origin) = reading.origin {
        let degrees = [origin.lat_e7, origin.lon_e7].map(|e7| f64::from(e7) / 1e7);
        put("origin", Value::Array(degrees.into_iter().collect()));
    }
    if !input.mission.layers.is_empty() {
        let mut table = Table::new();
        for rule in &input.mission.layers {
            let areas: Array = rule.areas.iter().map(|area| area.name.as_str()).collect();
            let layer: Item =
                if rule.tolls.is_empty() { areas.into() } else { layer(areas, &rule.tolls).into() };
            table.insert(&rule.name.name, layer);
        }
        document["layers"] = Item::Table(table);
    }
    if let Some(rule) = &input.mission.radio {
        document["radio"] = Item::Table(radio(rule, places));
    }
    document.to_string()
}

/// A layer with tolls as in a mission.
fn layer(areas: Array, tolls: &TollRule) -> InlineTable {
    let factor = |eighths: u32| Value::from(f64::from(eighths) / f64::from(LEAST));
    let mut layer = InlineTable::new();
    layer.insert("areas", areas.into());
    let toll = tolls.areas.iter().map(|(area, eighths)| (area.name.as_str(), factor(*eighths)));
    layer.insert("toll", Value::InlineTable(toll.collect()));
    let band = |band: &Band| -> InlineTable {
        [("within", band.within_m.into()), ("factor", factor(band.eighths))].into_iter().collect()
    };
    layer.insert("clearance", Value::Array(tolls.clearance.iter().map(band).collect()));
    let zone = |zone: &SpeedZone| {
        let limit = [("limit", Value::from(zone.limit_mps))];
        let factor = zone.eighths.map(|eighths| ("factor", factor(eighths)));
        let zone_table: InlineTable = limit.into_iter().chain(factor).collect();
        (zone.area.name.clone(), zone_table)
    };
    layer.insert("speed", Value::InlineTable(tolls.speed.iter().map(zone).collect()));
    layer
}

/// A radio as in a mission, with the positions of its places.
fn radio(rule: &RadioRule, places: &[(String, Point)]) -> Table {
    let mut table = Table::new();
    let need = NEEDS.iter().find(|(_, need)| *need == rule.need);
    if let Some((word, _)) = need {
        table.insert("need", (*word).into());
    }
    for key in RADIO_KEYS {
        if let Some(value) = (key.get)(rule) {
            table.insert(key.name, value.into());
        }
    }
    let mut positions = Table::new();
    for (name, at) in places {
        positions.insert(name, Array::from_iter(*at).into());
    }
    table.insert("places", Item::Table(positions));
    table
}

/// Reads the recipe of a blob; `None` if it has none.
pub fn of_blob(blob: &[u8]) -> Option<Recipe> {
    let text = plan_format::recipe(blob).filter(|text| !text.is_empty())?;
    parse(text)
}

/// Parses a recipe. Unknown keys are ignored: a later compiler may write more.
fn parse(text: &str) -> Option<Recipe> {
    let document: DocumentMut = text.parse().ok()?;
    let text_of = |key: &str| document.get(key).and_then(Item::as_str);
    let mut reading = ReadOptions {
        format: text_of("format").and_then(Format::of_word),
        unknown: text_of("unknown").and_then(Unknown::of_word).unwrap_or_default(),
        ..ReadOptions::default()
    };
    reading.opar.units = text_of("opar_units").and_then(DeltaUnit::of_word).unwrap_or_default();
    reading.opar.order = text_of("opar_order").and_then(DeltaOrder::of_word).unwrap_or_default();
    let types = document.get("opar_type").and_then(Item::as_array);
    let types = types.into_iter().flatten().filter_map(Value::as_str);
    reading.opar.types = types.filter_map(|kind| kind.parse::<ObstructionType>().ok()).collect();
    // Tags, origin, layers and radio are written as in a mission. The other keys of a recipe are not
    // mistakes.
    let source = Source { name: "the recipe of the plans".into(), text: text.into() };
    let (Mission { layers, tags, origin, radio, .. }, _) = mission::parse(&Arc::new(source));
    reading.tags = tags;
    reading.origin = origin;
    Some(Recipe {
        robot_radius_m: document
            .get("robot_radius")
            .and_then(Item::as_value)
            .and_then(crate::toml::number),
        fill_walls: document.get("fill_walls").and_then(Item::as_bool).unwrap_or(false),
        reading,
        layers,
        robot: text_of("robot").map(str::to_owned),
        radio,
    })
}

impl Recipe {
    /// Fills in what neither the command line nor a requested mission sets. `is_asked`: whether the
    /// mission was requested.
    pub fn complete(&self, options: &mut Options, mission: &mut Mission, is_asked: bool) {
        let of_mission = mission.robot_radius_m.filter(|_| is_asked);
        options.robot_radius_m = options.robot_radius_m.or(of_mission).or(self.robot_radius_m);
        if !is_asked {
            mission.fill_walls = Some(self.fill_walls);
            // The recipe does not hold cost maps: they stay as the mission beside the map has them.
            let own = std::mem::replace(&mut mission.layers, self.layers.clone());
            for own in own.into_iter().filter(|own| own.tolls.costs.is_some()) {
                let same = |layer: &&mut LayerRule| layer.name.name == own.name.name;
                if let Some(layer) = mission.layers.iter_mut().find(same) {
                    layer.tolls.costs = own.tolls.costs;
                }
            }
            mission.radio.clone_from(&self.radio);
        }
    }

    /// How to read the map: each option as in the build, unless the command line sets it.
    pub fn reading(&self, asked: &ReadOptions) -> ReadOptions {
        let own = &self.reading;
        ReadOptions {
            format: asked.format.or(own.format),
            unknown: given(&asked.unknown, &own.unknown),
            opar: given(&asked.opar, &own.opar),
            tags: TagRules {
                block: given(&asked.tags.block, &own.tags.block),
                free: given(&asked.tags.free, &own.tags.free),
                keep: given(&asked.tags.keep, &own.tags.keep),
                used: asked.tags.used.clone(),
                open_gates: asked.tags.open_gates || own.tags.open_gates,
            },
            origin: asked.origin.or(own.origin),
        }
    }
}

/// The requested value unless it is the default; then the blob's own.
fn given<T: Clone + Default + PartialEq>(asked: &T, own: &T) -> T {
    if *asked == T::default() { own.clone() } else { asked.clone() }
}
