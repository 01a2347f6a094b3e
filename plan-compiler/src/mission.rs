//! The mission file: what a map cannot say.
//!
//! `NAME.mission.toml` lies beside a map of any format, such as `NAME.ovl` or `NAME.osm`. It names
//! goals, adds areas to layers and sets the robot's parameters. [`keys::KEYS`] and `MISSION.md` list
//! every key. Reading never stops at the first mistake. An unknown key is a mistake: a misspelt limit
//! must not silently keep its default.
//!
//! [`crate::behaviours`] reads the tables of behaviours.

pub(crate) mod brakes;
mod broken;
mod costs;
pub(crate) mod follow;
mod given;
mod images;
mod key;
pub mod keys;
pub(crate) mod layer_gains;
mod masks;
mod not_toml;
mod place;
mod radio;
mod reading;
mod speed_masks;
mod speeds;
mod tolls;
pub mod words;

pub use costs::{CostImage, CostMap, CostSource, Factors};
pub use given::Given;
pub use layer_gains::NamedGain;
pub use masks::Mask;
pub use place::{geo_uri, is_geo_uri, place_of};
pub use radio::{NEEDS, RADIO_KEYS, RadioKey, RadioRule};
pub use speed_masks::{SpeedMask, SpeedUnit};
pub use tolls::{Band, SpeedZone, TollRule, kind};

use crate::behaviours;
use crate::search::Corners;
use crate::team::{self, Team};
use crate::toml::{Fields, Report, Span, Text, key_span, number};
use keys::{KEYS, Key, Kind, SECTIONS};
use maps::Point;
use maps::formats::TagRules;
use maps::problem::{MAX_PROBLEMS, Place, Problem, Source};
use math::GeoPoint;
use plan_format::{Parameters, limits};
use std::path::PathBuf;
use std::sync::Arc;
use toml_edit::{Document, Item, TableLike, Value};

/// The layer that every map has: obstacles.
pub const PHYSICAL: &str = "physical";
/// The layer of a map with areas that weaken radio, or of a mission with `[radio]`: obstacles and
/// the cells where a link is weak.
pub const COMMS: &str = "comms";

/// What a mission file sets. The default is the mission of a map that has none.
#[derive(Clone, Debug, Default)]
pub struct Mission {
    /// The map, relative to the current folder.
    pub map: Option<PathBuf>,
    /// Where the file names the map.
    pub map_place: Option<Place>,
    /// Side of a cell, metres.
    pub resolution_m: Option<f64>,
    /// How far obstacles are grown, metres.
    pub robot_radius_m: Option<f64>,
    /// Whether a diagonal step may pass between two blocked cells.
    pub corners: Option<Corners>,
    /// Whether closed walls are solid.
    pub fill_walls: Option<bool>,
    /// What the mission changes about the meaning of tags.
    pub tags: TagRules,
    /// The place of 0,0 of the map, for formats that have degrees only.
    pub origin: Option<GeoPoint>,
    /// The goals, in the file's order; `None` without a table `[goals]`.
    pub goals: Option<Vec<Goal>>,
    /// Areas that become obstacles, layer by layer, in the file's order.
    pub layers: Vec<LayerRule>,
    /// What a metre of a layer counts, where layers are selected by gains.
    pub layer_gains: Vec<NamedGain>,
    /// By how much better, as a share, another layer must be then.
    pub selection_hysteresis: Option<f64>,
    /// Maps of where the robot must not go.
    pub masks: Vec<Mask>,
    /// Images that limit the speed.
    pub speed_masks: Vec<SpeedMask>,
    /// How layer `comms` is computed; `None` if it has the map's areas.
    pub radio: Option<RadioRule>,
    /// The parallel plan that the robot follows; `None` for the first.
    pub plan: Option<Named>,
    /// The robot's parameters.
    pub parameters: Parameters,
    /// Whether the file sets `vehicle.radius` itself.
    pub body_radius_given: bool,
    /// The keys that the file sets; `None` if the parameters are to be taken as they are, from a
    /// program instead of a file.
    pub given: Option<Given>,
    /// The team, and the robot that the file was read for.
    pub team: Team,
    /// Behaviours, their plans and their rules.
    pub behaviours: behaviours::Syntax,
}

impl Mission {
    /// The mission of a map without a mission file.
    pub fn of_no_file() -> Self {
        Self { given: Some(Given::default()), ..Self::default() }
    }

    /// Sets the parameters that the file leaves out.
    fn complete(&mut self) {
        let Some(given) = &self.given else { return };
        let radius_m = self.robot_radius_m.filter(|radius| *radius > 0.0);
        if let (false, Some(radius_m)) = (self.body_radius_given, radius_m) {
            self.parameters.vehicle.radius_m = radius_m as f32;
        }
        follow::complete(&mut self.parameters, given);
        self.parameters.team.robot = self.team.robot as u8;
        self.parameters.team.robots = self.team.robots.len().max(1) as u8;
    }
}

/// A name and where it was written.
#[derive(Clone, Debug)]
pub struct Named {
    /// The name.
    pub name: String,
    /// Its place in the mission file.
    pub place: Place,
}

/// A goal that a person asked for.
#[derive(Clone, Debug)]
pub struct Goal {
    /// The name of its parallel plan.
    pub name: String,
    /// Where it is: at least one position. Several are goals of one plan, which leads to the one that
    /// costs least.
    pub at: Vec<GoalAt>,
    /// The layers of its plan; `None` for all layers of the mission.
    pub layers: Option<Vec<Named>>,
    /// Its place in the mission file; `None` for a goal of the command line.
    pub place: Option<Place>,
}

/// How a position of a goal was given.
#[derive(Clone, Debug, PartialEq)]
pub enum GoalAt {
    /// Coordinates of the map, metres.
    Position(Point),
    /// The name of a point of the map.
    PointOfMap(String),
    /// A place on the globe, WGS-84.
    Globe(GeoPoint),
}

/// What one layer adds to those below it: areas of the map that are obstacles, and tolls.
#[derive(Clone, Debug)]
pub struct LayerRule {
    /// The layer.
    pub name: Named,
    /// Names of areas of the map.
    pub areas: Vec<Named>,
    /// What its free cells cost.
    pub tolls: TollRule,
}

/// Reads the text of a mission file without a team. The mission contains whatever was understood.
pub fn parse(source: &Arc<Source>) -> (Mission, Vec<Problem>) {
    parse_for(source, None)
}

/// Reads the text of a mission file for one robot of its team, by its name.
pub fn parse_for(source: &Arc<Source>, robot: Option<&str>) -> (Mission, Vec<Problem>) {
    let mut problems = Vec::new();
    let mut report = Report { source, problems: &mut problems };
    let mission = match Document::parse(source.text.as_str()) {
        Ok(document) => {
            let (file, team) = team::part(document.as_table(), robot, &mut report);
            read(&file, team, report)
        }
        Err(first) => {
            not_toml::report(&mut report, &first);
            Mission::default()
        }
    };
    (mission, problems)
}

fn read(file: &dyn TableLike, team: Team, report: Report<'_>) -> Mission {
    let mut reader = Reader { report, mission: Mission { team, ..Mission::of_no_file() } };
    reader.section("", file);
    reader.mission.complete();
    speeds::check(&mut reader.report, file, &reader.mission.parameters.vehicle);
    // Last, because masks may add layers to those that the file lists.
    if let Some(masks) = file.get("masks").and_then(Item::as_table_like) {
        reader.masks(masks);
    }
    if let Some(radio) = file.get("radio").filter(|item| item.is_table_like()) {
        reader.radio(radio, key_span(file, "radio"));
    }
    let Reader { report, mut mission } = reader;
    mission.behaviours = behaviours::read(report.source, file, &mission.team, report.problems);
    broken::keep(file, &mut mission);
    mission
}

/// The name of a plan or a layer, trimmed and without an overlay's trailing `*`; otherwise the
/// reason why it cannot be one.
pub fn tidy_name(raw: &str) -> Result<&str, String> {
    let name = raw.trim();
    let name = name.strip_suffix('*').unwrap_or(name).trim_end();
    if plan_format::is_name(name) {
        Ok(name)
    } else if name.is_empty() {
        Err("a name must not be empty".into())
    } else if name.len() > limits::MAX_NAME_BYTES {
        Err(format!("a name has at most {} bytes, this one {}", limits::MAX_NAME_BYTES, name.len()))
    } else if name.contains('/') {
        Err("a name must not contain `/`, which separates plan and layer".into())
    } else {
        Err("a name must not contain control characters".into())
    }
}

/// The keys of a goal's table.
const GOAL_KEYS: [&str; 4] = ["at", "lat", "lon", "layers"];
/// Those that say where it is.
const POSITION_KEYS: [&str; 3] = ["at", "lat", "lon"];

/// Walks the document and fills in the mission.
struct Reader<'r> {
    report: Report<'r>,
    mission: Mission,
}

impl Reader<'_> {
    fn section(&mut self, section: &str, table: &dyn TableLike) {
        // A preset comes first, so that it never overwrites the keys beside it.
        let mut items: Vec<(&str, &Item)> = table.iter().collect();
        items.sort_by_key(|(name, _)| *name != "preset");
        for (name, item) in items {
            let key_span = key_span(table, name);
            let span = item.span().unwrap_or_else(|| key_span.clone());
            if section.is_empty() && SECTIONS.contains(&name) {
                match item.as_table_like() {
                    Some(inner) => self.named_section(name, inner),
                    None => {
                        self.report.wrong_type(name, item, &span, "a section", &format!("[{name}]"))
                    }
                }
            } else if section.is_empty() && behaviours::TABLES.contains(&name) {
                // `behaviours` reads these together, because they refer to each other.
            } else if section == "team" && matches!(name, "robots" | "tether") {
                // `robots` has been read; `tether` names one of them.
                if name == "tether" {
                    self.tether(item, span);
                }
            } else if let Some(key) = KEYS.iter().find(|key| key.is(section, name)) {
                self.value(key, item, span);
            } else {
                self.unknown_key(section, name, key_span);
            }
        }
    }

    fn named_section(&mut self, name: &str, table: &dyn TableLike) {
        match name {
            "goals" => {
                let goals = table.iter().filter_map(|(name, item)| {
                    let span = key_span(table, name);
                    self.goal(name, item, span)
                });
                let goals = goals.collect();
                self.mission.goals = Some(goals);
            }
            "layers" => {
                for (name, item) in table.iter() {
                    let span = key_span(table, name);
                    self.layer(name, item, span);
                }
            }
            "layer_gains" => self.layer_gains(table),
            // Read later: masks once the layers are known.
            "masks" | "radio" => {}
            parameters => self.section(parameters, table),
        }
    }

    fn value(&mut self, key: &Key, item: &Item, span: Span) {
        let expected = key.expected();
        if let Some(given) = &mut self.mission.given {
            given.add(key.path(), self.report.place(&span));
        }
        match (&key.kind, item.as_value()) {
            (Kind::Number { set, .. }, Some(value)) => match number(value) {
                Some(number) if key.accepts(number) => set(&mut self.mission, number),
                Some(_) if key.is("link", "timeout") => {
                    let expected = format!(
                        "{expected}; to drive on without a link, write on_loss = \"continue\""
                    );
                    self.report.out_of_range(&key.path(), &span, &expected);
                }
                Some(_) => self.report.out_of_range(&key.path(), &span, &expected),
                None => self.report.wrong_type(&key.path(), item, &span, &expected, &key.example()),
            },
            (Kind::Flag { set, .. }, Some(Value::Boolean(flag))) => {
                set(&mut self.mission, *flag.value());
            }
            (Kind::Word { words, .. }, Some(Value::String(word))) => {
                match words.iter().find(|(name, _)| name == word.value()) {
                    Some((_, set)) => set(&mut self.mission),
                    None => self.report.unknown_word(&key.path(), word.value(), &span, key.words()),
                }
            }
            (Kind::Text, Some(Value::String(text))) => self.text(key, text.value(), span),
            (Kind::Tags { set }, _) => match self.tags(item) {
                Some(tags) => set(&mut self.mission, tags),
                None => self.report.wrong_type(&key.path(), item, &span, &expected, &key.example()),
            },
            (Kind::Place { set }, _) => match self.place_on_globe(item) {
                Some(place) => set(&mut self.mission, place),
                None => self.report.wrong_type(&key.path(), item, &span, &expected, &key.example()),
            },
            _ => self.report.wrong_type(&key.path(), item, &span, &expected, &key.example()),
        }
    }

    fn text(&mut self, key: &Key, text: &str, span: Span) {
        if key.is("", "map") {
            self.mission.map = Some(self.report.beside(text));
            self.mission.map_place = Some(self.report.place(&span));
        } else {
            self.mission.plan =
                Some(Named { name: text.trim().into(), place: self.report.place(&span) });
        }
    }

    /// `team.tether`: the mate that the robot stays close to.
    fn tether(&mut self, item: &Item, span: Span) {
        let Some(name) = item.as_str() else {
            let example = "tether = \"left\"";
            return self.report.wrong_type(
                "team.tether",
                item,
                &span,
                "the name of a mate",
                example,
            );
        };
        let team = &self.mission.team;
        let number = team.number(name.trim());
        if number == Some(team.robot) {
            let message = format!("`{}` is the robot itself, not a mate", name.trim());
            let help = "name another robot of the team, or remove this line: without it the robot \
                        has no tether";
            return self.report.error(message, &span, "this robot", help);
        }
        if number.is_none() {
            let name = Text { value: name.to_owned(), span };
            self.report.unknown("mate", &name, team.mates(), "name another robot of the team");
        }
        self.mission.parameters.team.tether_to = number.map(|number| number as u8);
    }

    fn goal(&mut self, raw: &str, item: &Item, span: Span) -> Option<Goal> {
        if let Some(key) = misplaced(raw, item) {
            let message = format!("`{raw}` is not a goal: `{}` is a key of its own", key.path());
            self.report.error(message, &span, "in [goals]", &belongs(key));
            return None;
        }
        let name = self.name("goal", raw, span.clone());
        let here = item.span().unwrap_or_else(|| span.clone());
        let (at, layers) = match item.as_table_like() {
            None => (self.positions(raw, item, here), None),
            Some(table) => {
                let mut layers = None;
                for (key, inner) in table.iter() {
                    let key_span = key_span(table, key);
                    match key {
                        "at" | "lat" | "lon" => {}
                        "layers" => layers = self.names(&format!("goals.{raw}.layers"), inner),
                        other => self.unknown_goal_key(&format!("goal `{raw}`"), other, &key_span),
                    }
                }
                (self.goal_table(raw, table, span.clone()), layers)
            }
        };
        Some(Goal { name: name?, at: at?, layers, place: Some(self.report.place(&span)) })
    }

    /// Where a goal, one of several goals or a place of a radio is, `what` says which.
    fn position(&mut self, what: &str, name: &str, item: &Item, span: Span) -> Option<GoalAt> {
        match item.as_value() {
            Some(Value::String(uri)) if is_geo_uri(uri.value()) => match geo_uri(uri.value()) {
                Ok(place) => Some(GoalAt::Globe(place)),
                Err(reason) => {
                    let message = format!("{what} `{name}` is not a place on the globe");
                    self.report.error(message, &span, &reason, "write \"geo:LAT,LON\", degrees");
                    None
                }
            },
            Some(Value::String(point)) => Some(GoalAt::PointOfMap(point.value().trim().into())),
            Some(Value::Array(pair)) => {
                let numbers: Vec<f64> = pair.iter().filter_map(number).collect();
                match numbers[..] {
                    [x, y] if pair.len() == 2 && x.is_finite() && y.is_finite() => {
                        Some(GoalAt::Position([x, y]))
                    }
                    _ => {
                        self.report.error(
                            format!("{what} `{name}` is not a position"),
                            &span,
                            "expected two finite numbers",
                            &format!(
                                "write {} in the map's metres, x east, y north",
                                place::written(what, name, "[x, y]")
                            ),
                        );
                        None
                    }
                }
            }
            _ => {
                let expected = "a position or the name of a point of the map";
                let table = if what == place::MEMBER { "goal" } else { what };
                let path = format!("{table}s.{name}");
                self.report.wrong_type(
                    &path,
                    item,
                    &span,
                    expected,
                    &place::written(what, name, "[12.5, 40.0]"),
                );
                None
            }
        }
    }

    fn layer(&mut self, raw: &str, item: &Item, span: Span) {
        let name = self.name("layer", raw, span.clone());
        let path = format!("layers.{raw}");
        let (areas, tolls) = if item.is_table_like() {
            let example = "quiet = { areas = [\"Pond\"], toll = { grass = 2 } }";
            let keys = tolls::LAYER_KEYS;
            let fields =
                Fields::open(&mut self.report, path.clone(), item, span.clone(), &keys, example);
            let Some(fields) = fields else { return };
            let areas = fields.item("areas");
            let areas = areas.map(|(item, _)| self.names(&format!("{path}.areas"), item));
            (areas.unwrap_or(Some(Vec::new())), tolls::read(&mut self.report, &fields))
        } else {
            (self.names(&path, item), TollRule::default())
        };
        if let (Some(name), Some(areas)) = (name, areas) {
            let name = Named { name, place: self.report.place(&span) };
            let kinds = tolls.names().filter_map(|area| tolls::kind(&area.name));
            self.mission.tags.keep.extend(kinds);
            self.mission.layers.push(LayerRule { name, areas, tolls });
        }
    }

    fn name(&mut self, what: &str, raw: &str, span: Span) -> Option<String> {
        match tidy_name(raw) {
            Ok(name) => Some(name.to_owned()),
            Err(reason) => {
                let message = format!("`{raw}` cannot be the name of a {what}");
                self.report.error(message, &span, &reason, "choose another name");
                None
            }
        }
    }

    fn names(&mut self, path: &str, item: &Item) -> Option<Vec<Named>> {
        let span = item.span().unwrap_or(0..0);
        let named = |value: &Value| {
            let place = self.report.place(&value.span().unwrap_or_else(|| span.clone()));
            value.as_str().map(|name| Named { name: name.trim().into(), place })
        };
        let names = match item.as_value() {
            Some(Value::Array(array)) => array.iter().map(named).collect(),
            Some(value) => named(value).map(|name| vec![name]),
            None => None,
        };
        if names.is_none() {
            let example = format!("{} = [\"NoFlyZone1\"]", path.rsplit('.').next().unwrap_or(path));
            self.report.wrong_type(path, item, &span, "a list of names", &example);
        }
        names
    }

    fn unknown_key(&mut self, section: &str, name: &str, span: Span) {
        let table = if section.is_empty() { "a mission".into() } else { format!("[{section}]") };
        // Problems beyond this number are not shown, and the search for a likely name takes time.
        if self.report.problems.len() >= MAX_PROBLEMS {
            let message = format!("`{name}` is not a key of {table}");
            return self.report.problems.push(Problem::error(message));
        }
        let here = KEYS.iter().filter(|key| key.section == section).map(|key| key.name);
        let sections = SECTIONS.iter().chain(&behaviours::TABLES).copied();
        let sections = sections.filter(|_| section.is_empty());
        let elsewhere = KEYS.iter().find(|key| key.name == name).map(belongs);
        // What `team` reads.
        let of_team = matches!(name, "robots" | "tether");
        let of_team = of_team.then(|| format!("`{name}` belongs in [team]"));
        let known: Vec<&str> = here.chain(sections).collect();
        match elsewhere.or(of_team) {
            Some(help) => {
                let message = format!("`{name}` is not a key of {table}");
                self.report.error(message, &span, "unknown key", &help);
            }
            None => {
                let how = format!("known here: {}", known.join(", "));
                self.report.unknown_key(&table, name, &span, known.iter().copied(), &how);
            }
        }
    }

    fn unknown_goal_key(&mut self, goal: &str, name: &str, span: &Span) {
        let how = "a goal has `at`, or `lat` and `lon`, and `layers`";
        self.report.unknown_key(goal, name, span, GOAL_KEYS.into_iter(), how);
    }
}

/// Where a key belongs, as help.
fn belongs(key: &Key) -> String {
    match key.section {
        "" => format!("`{}` belongs at the top, above every [section]", key.name),
        section => format!("`{}` belongs in [{section}]", key.name),
    }
}

/// The key that a line of `[goals]` sets instead of a goal: it has the key's name and a value that
/// the key takes and no goal has. Any name may be a goal at a position or a named point.
fn misplaced(name: &str, item: &Item) -> Option<&'static Key> {
    let value = item.as_value()?;
    let key = KEYS.iter().find(|key| key.name == name)?;
    let is_of_key = match value {
        Value::String(word) => key.words().any(|known| known == word.value()),
        Value::Integer(_) | Value::Float(_) => matches!(key.kind, Kind::Number { .. }),
        Value::Boolean(_) => matches!(key.kind, Kind::Flag { .. }),
        _ => false,
    };
    is_of_key.then_some(key)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A mission and its mistakes, as text.
    pub(crate) fn read(text: &str) -> (Mission, Vec<String>) {
        let source = Arc::new(Source { name: "m.mission.toml".into(), text: text.into() });
        let (mission, problems) = parse(&source);
        (mission, problems.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn a_whole_mission_is_understood() {
        let (mission, problems) = read(
            "map = 'campus.opar'\nresolution = 1\nrobot_radius = 0.5\nplan = 'Gate'\n\
             [goals]\nGate = [1, -2.5]\nDepot = 'PP1'\nHill = { at = [3, 4], layers = ['comms'] }\n\
             [layers]\nnight = ['NoFlyZone1', 'Zone 2']\n\
             [gains]\npreset = '66:34'\nnoise = 0.2\n[vehicle]\nmax_speed = 2\n",
        );
        assert_eq!(problems, [""; 0]);
        let goals = mission.goals.unwrap();
        assert_eq!(goals[0].at, [GoalAt::Position([1.0, -2.5])]);
        assert_eq!(goals[1].at, [GoalAt::PointOfMap("PP1".into())]);
        assert_eq!(goals[2].layers.as_ref().unwrap()[0].name, "comms");
        assert_eq!(mission.layers[0].areas[1].name, "Zone 2");
        assert_eq!(mission.parameters.gains.reactive, 0.66);
        assert_eq!(mission.parameters.gains.noise, 0.2);
        assert_eq!(mission.parameters.vehicle.max_speed_mps, 2.0);
    }

    #[test]
    fn all_mistakes_come_at_once() {
        let (_, problems) = read(
            "resolutoin = 1\nrobot_radius = 'wide'\ncorners = 'maybe'\n[goals]\nA = [1]\n\
             'a/b' = [1, 2]\n[vehicle]\nmax_speed = 1000\nresolution = 2\n",
        );
        assert_eq!(problems.len(), 7, "{problems:#?}");
    }

    #[test]
    fn a_key_below_the_goals_is_not_a_goal() {
        let (mission, problems) = read(
            "[goals]\non_loss = 'continue'\nresolution = 0.5\nopen_gates = true\n\
             plan = 'Depot'\nradius = [1, 2]\nseed = 'North'\n",
        );
        let expected = [
            "`on_loss` is not a goal: `link.on_loss` is a key of its own",
            "`resolution` is not a goal: `resolution` is a key of its own",
            "`open_gates` is not a goal: `open_gates` is a key of its own",
        ];
        assert_eq!(problems, expected);
        let names: Vec<String> = mission.goals.unwrap().into_iter().map(|g| g.name).collect();
        assert_eq!(names, ["plan", "radius", "seed"]);
    }

    #[test]
    fn a_timeout_of_nothing_is_answered_with_what_was_meant() {
        let source = Arc::new(Source { name: "m".into(), text: "[link]\ntimeout = 0\n".into() });
        let help = parse(&source).1[0].help.clone().unwrap();
        assert!(help.ends_with("write on_loss = \"continue\""), "{help}");
    }

    #[test]
    fn the_documentation_lists_every_key_as_it_is() {
        let documentation = include_str!("../MISSION.md");
        for row in KEYS.iter().map(Key::row) {
            assert!(documentation.contains(&row), "MISSION.md lacks the row\n{row}");
        }
    }

    #[test]
    fn every_documented_default_is_the_default() {
        let has_value = |key: &&Key| !key.default.is_empty() && !key.follows();
        for key in KEYS.iter().filter(has_value) {
            let mut text = key.example_with(key.default);
            let mut expected = Parameters::default();
            if key.section == "team" {
                text.push_str("\nrobots = [\"a\", \"b\"]\n");
                expected.team.robots = 2;
            }
            let robot = (key.section == "team").then_some("a");
            let source = Arc::new(Source { name: "m".into(), text });
            let (mission, problems) = parse_for(&source, robot);
            assert!(problems.is_empty(), "{}: {problems:?}", key.path());
            assert_eq!(mission.parameters, expected, "{}", key.path());
        }
    }

    #[test]
    fn what_is_not_toml_or_nested_deeply_is_a_problem() {
        for text in
            ["=", "[", "a = ", "\u{0}", &"[".repeat(10_000), &format!("a = {}", "[".repeat(9_999))]
        {
            assert!((1..=10).contains(&read(text).1.len()), "{text:.20}");
        }
    }
}
