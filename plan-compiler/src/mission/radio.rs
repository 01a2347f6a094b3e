//! `[radio]`: layer `comms` computed from a radio's reach.

use super::{Goal, GoalAt, Reader};
use crate::comms::Need;
use crate::toml::{Fields, Span};
use maps::radio::Settings;
use toml_edit::{Item, TableLike};

/// Where the robot must have a link, and its radio.
#[derive(Clone, Debug)]
pub struct RadioRule {
    /// The radio and the heights.
    pub settings: Settings,
    /// Least margin of a link, dB.
    pub threshold_db: f64,
    /// Which of the places it must reach.
    pub need: Need,
    /// The places; their layers are not used.
    pub places: Vec<Goal>,
}

impl Default for RadioRule {
    /// The paper's laboratory counted a link as usable above 10 dB.
    fn default() -> Self {
        let (settings, need) = (Settings::default(), Need::default());
        Self { settings, threshold_db: 10.0, need, places: Vec::new() }
    }
}

/// A number of the radio.
#[derive(Debug)]
pub struct RadioKey {
    /// Its name in the table `[radio]`.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Lowest and highest value.
    pub range: (f64, f64),
    /// What it sets.
    pub meaning: &'static str,
    /// Its value in a rule; `None` where the rule leaves it open.
    pub get: fn(&RadioRule) -> Option<f64>,
    /// Sets it.
    pub set: fn(&mut RadioRule, f64),
}

/// Greatest height of antennas and obstacles, metres.
const MAX_HEIGHT_M: f64 = 1000.0;

/// The numbers of the table, in the order of the documentation.
pub const RADIO_KEYS: &[RadioKey] = &[
    RadioKey {
        name: "threshold",
        unit: "dB",
        range: (-100.0, 200.0),
        meaning: "Least margin: how far a signal must be above the receiver's sensitivity.",
        get: |rule| Some(rule.threshold_db),
        set: |rule, value| rule.threshold_db = value,
    },
    RadioKey {
        name: "frequency",
        unit: "GHz",
        range: (0.03, 100.0),
        meaning: "Frequency.",
        get: |rule| Some(rule.settings.frequency_ghz),
        set: |rule, value| rule.settings.frequency_ghz = value,
    },
    RadioKey {
        name: "power",
        unit: "dBm",
        range: (-100.0, 100.0),
        meaning: "Power of the transmitter, plus the gains of both antennas.",
        get: |rule| Some(rule.settings.power_dbm),
        set: |rule, value| rule.settings.power_dbm = value,
    },
    RadioKey {
        name: "sensitivity",
        unit: "dBm",
        range: (-200.0, 0.0),
        meaning: "Least power that the receiver understands.",
        get: |rule| Some(rule.settings.sensitivity_dbm),
        set: |rule, value| rule.settings.sensitivity_dbm = value,
    },
    RadioKey {
        name: "antenna",
        unit: "m",
        range: (0.0, MAX_HEIGHT_M),
        meaning: "Height of the robot's antenna above ground.",
        get: |rule| Some(rule.settings.antenna_heights_m[1]),
        set: |rule, value| rule.settings.antenna_heights_m[1] = value,
    },
    RadioKey {
        name: "place_antenna",
        unit: "m",
        range: (0.0, MAX_HEIGHT_M),
        meaning: "Height of the antennas at the places.",
        get: |rule| Some(rule.settings.antenna_heights_m[0]),
        set: |rule, value| rule.settings.antenna_heights_m[0] = value,
    },
    RadioKey {
        name: "obstacle_height",
        unit: "m",
        range: (0.0, MAX_HEIGHT_M),
        meaning: "Height of obstacles for which the map gives no height.",
        get: |rule| Some(rule.settings.obstacle_height_m),
        set: |rule, value| rule.settings.obstacle_height_m = value,
    },
    RadioKey {
        name: "foliage_height",
        unit: "m",
        range: (0.0, MAX_HEIGHT_M),
        meaning: "Height of areas that weaken radio for which the map gives no height.",
        get: |rule| Some(rule.settings.foliage_height_m),
        set: |rule, value| rule.settings.foliage_height_m = value,
    },
    RadioKey {
        name: "wall_loss",
        unit: "dB",
        range: (0.0, 200.0),
        meaning: "Loss of each wall on the straight line, where that is less than the loss on the way over the obstacles: 4 for wood, 7 for concrete with windows, 10 to 20 for concrete. Without it, walls are opaque.",
        get: |rule| rule.settings.wall_db,
        set: |rule, value| rule.settings.wall_db = Some(value),
    },
    RadioKey {
        name: "small",
        unit: "m",
        range: (0.0, MAX_HEIGHT_M),
        meaning: "Obstacles whose longest side is at most this do not weaken radio.",
        get: |rule| Some(rule.settings.small_m),
        set: |rule, value| rule.settings.small_m = value,
    },
];

impl RadioKey {
    /// The key with a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        RADIO_KEYS.iter().find(|key| key.name == name)
    }

    /// Whether a number is in range.
    pub fn accepts(&self, number: f64) -> bool {
        (self.range.0..=self.range.1).contains(&number)
    }

    /// What it may be, for a sentence.
    pub fn expected(&self) -> String {
        format!("a number from {} to {} {}", self.range.0, self.range.1, self.unit)
    }

    /// Its row in the documentation's table.
    pub fn row(&self) -> String {
        let default = (self.get)(&RadioRule::default());
        let default = default.map_or(String::new(), |value| format!("`{value}`"));
        format!("| `radio.{}` | {} | {default} | {} |", self.name, self.expected(), self.meaning)
    }
}

/// The words of `need`.
pub const NEEDS: [(&str, Need); 2] = [("all", Need::All), ("any", Need::Any)];

/// An example of a table.
const EXAMPLE: &str = "[radio] with places = { base = [12.5, 40.0] }";

impl Reader<'_> {
    /// Reads the table `[radio]`.
    pub(super) fn radio(&mut self, item: &Item, span: Span) {
        let known: Vec<&str> =
            ["places", "need"].into_iter().chain(RADIO_KEYS.iter().map(|key| key.name)).collect();
        let fields =
            Fields::open(&mut self.report, "radio".into(), item, span.clone(), &known, EXAMPLE);
        let Some(fields) = fields else { return };
        let mut rule = RadioRule::default();
        for key in RADIO_KEYS {
            let (low, high) = key.range;
            let value = fields.number(&mut self.report, key.name, low..=high, key.unit);
            if let Some(value) = value {
                (key.set)(&mut rule, value.value);
            }
        }
        if let Some(need) = fields.word(&mut self.report, "need", &NEEDS) {
            rule.need = need;
        }
        let Some((places, at)) = fields.item("places") else {
            let help = "name at least one: places = { base = [12.5, 40.0] }";
            self.report.error("`radio` has no places to reach", &span, "this table", help);
            return;
        };
        match places.as_table_like() {
            Some(table) => rule.places = self.radio_places(table),
            None => {
                let example = "places = { base = [12.5, 40.0], mate = \"gate\" }";
                self.report.wrong_type("radio.places", places, &at, "a table of places", example);
                return;
            }
        }
        if rule.places.is_empty() && self.report.problems.is_empty() {
            let help = "write base = [x, y] in it, or the name of a point of the map";
            self.report.error("`radio.places` is empty", &at, "this table", help);
        }
        self.mission.radio = Some(rule);
    }

    fn radio_places(&mut self, table: &dyn TableLike) -> Vec<Goal> {
        let places = table.iter().filter_map(|(name, item)| {
            let span = crate::toml::key_span(table, name);
            let here = item.span().unwrap_or_else(|| span.clone());
            let at: Option<GoalAt> = self.position("place", name, item, here);
            let name = self.name("place", name, span.clone());
            Some(Goal {
                name: name?,
                at: vec![at?],
                layers: None,
                place: Some(self.report.place(&span)),
            })
        });
        places.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::tests::read;

    #[test]
    fn a_mission_names_places_and_its_radio() {
        let (mission, problems) = read(
            "[radio]\nthreshold = 6\nantenna = 0.4\nplace_antenna = 3\nwall_loss = 7\nneed = 'any'\n\
             places = { base = [1, 2], mate = 'Depot', ship = 'geo:51.5,-0.1' }\n",
        );
        assert_eq!(problems, [""; 0]);
        let rule = mission.radio.unwrap();
        assert_eq!((rule.threshold_db, rule.need), (6.0, Need::Any));
        assert_eq!(rule.settings.antenna_heights_m, [3.0, 0.4]);
        assert_eq!(rule.settings.wall_db, Some(7.0));
        let places: Vec<&GoalAt> = rule.places.iter().flat_map(|place| &place.at).collect();
        assert!(matches!(places[..], [
            GoalAt::Position([1.0, 2.0]),
            GoalAt::PointOfMap(name),
            GoalAt::Globe(_)
        ] if name == "Depot"));
    }

    #[test]
    fn every_mistake_in_a_radio_is_reported() {
        let (_, problems) = read(
            "[radio]\nthreshold = 'ten'\npower = 1e9\nfrequncy = 2.4\nneed = 'some'\n\
             places = { base = [1], 'a/b' = [1, 2] }\n",
        );
        assert_eq!(problems.len(), 6, "{problems:?}");
        for (text, expected) in [
            ("[radio]\n", "`radio` has no places to reach"),
            ("[radio]\nplaces = {}\n", "`radio.places` is empty"),
            ("[radio]\nplaces = 'base'\n", "`radio.places`"),
            ("radio = 3\n", "`radio`"),
        ] {
            let (_, problems) = read(text);
            assert!(problems.len() == 1 && problems[0].contains(expected), "{problems:?}");
        }
    }

    #[test]
    fn the_documentation_lists_every_number_as_it_is() {
        let documentation = include_str!("../../MISSION.md");
        for row in RADIO_KEYS.iter().map(RadioKey::row) {
            assert!(documentation.contains(&row), "MISSION.md lacks the row\n{row}");
        }
    }

    #[test]
    fn every_default_is_in_range_and_every_key_sets_its_own_value() {
        for key in RADIO_KEYS {
            let mut rule = RadioRule::default();
            assert!((key.get)(&rule).is_none_or(|value| key.accepts(value)), "{}", key.name);
            (key.set)(&mut rule, 0.5);
            assert_eq!((key.get)(&rule), Some(0.5));
            let changed = RADIO_KEYS
                .iter()
                .filter(|other| (other.get)(&rule) != (other.get)(&RadioRule::default()));
            assert_eq!(changed.map(|key| key.name).collect::<Vec<_>>(), [key.name]);
        }
    }
}
