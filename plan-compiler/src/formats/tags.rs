//! What tags mean to a planner: OpenStreetMap's, and the same words as properties in GeoJSON.
//!
//! Source: the wiki of OpenStreetMap, "Map features". Deliberately absent: what blocks one
//! vehicle and carries another (water, stairs), and gates, which may be shut.

use crate::map::Role;

/// Height of a storey where only their number is known, metres.
const STOREY_M: f64 = 3.0;
/// Values of `barrier` that are drawn as lines and stop a robot.
const WALLS: [&str; 5] = ["wall", "fence", "hedge", "city_wall", "retaining_wall"];
/// Values of `layer` that say that an area weakens radio.
const ATTENUATING: [&str; 3] = ["foliage", "comms", "nocommzone"];

/// Keys and values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Tags(pub(super) Vec<(String, String)>);

/// What an object is to a planner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Meaning {
    pub(super) role: Role,
    /// Whether only the line counts, not what it encloses.
    pub(super) is_line: bool,
    /// By which a mission names it; empty where it has none.
    pub(super) name: String,
}

impl Tags {
    /// The value of a key, trimmed; nothing where it is empty.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        let (_, value) = self.0.iter().find(|(known, _)| known == key)?;
        Some(value.trim()).filter(|value| !value.is_empty())
    }

    /// Whether a key is there and does not say no.
    pub(super) fn says(&self, key: &str) -> bool {
        self.get(key).is_some_and(|value| !says_no(value))
    }

    /// What an object with these tags is; `None` where it is nothing to a planner.
    pub(super) fn meaning(&self) -> Option<Meaning> {
        let (role, is_line, kind) = self.kind()?;
        let name = self.get("name").unwrap_or(kind).to_owned();
        Some(Meaning { role, is_line, name })
    }

    /// Role, whether a line, and the name of what has no name of its own.
    fn kind(&self) -> Option<(Role, bool, &str)> {
        if self.says("building") || self.says("obstacle") {
            return Some((Role::Obstacle, false, ""));
        }
        if self.get("barrier").is_some_and(|barrier| WALLS.contains(&barrier)) {
            return Some((Role::Obstacle, !self.says("area"), ""));
        }
        for (key, value) in [("natural", "wood"), ("landuse", "forest")] {
            if self.get(key) == Some(value) {
                return Some((Role::Attenuating, false, value));
            }
        }
        // In OpenStreetMap `layer` is the number of a level, which means nothing here.
        let layer = self.get("layer").filter(|layer| layer.parse::<f64>().is_err())?;
        let weakens = ATTENUATING.iter().any(|known| layer.eq_ignore_ascii_case(known));
        Some((if weakens { Role::Attenuating } else { Role::Zone }, false, layer))
    }

    /// Height above ground, metres, where it is given and makes sense.
    pub(super) fn height_m(&self) -> Option<f64> {
        let metres = |text: &str| text.strip_suffix('m').unwrap_or(text).trim().parse().ok();
        let given = self.get("height").and_then(metres);
        let storeys = || self.get("building:levels")?.parse::<f64>().ok();
        let height = given.or_else(|| storeys().map(|storeys| storeys * STOREY_M));
        height.filter(|height: &f64| height.is_finite() && *height >= 0.0)
    }
}

fn says_no(value: &str) -> bool {
    ["no", "false", "0"].iter().any(|no| value.eq_ignore_ascii_case(no))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(tags: &str, meaning: &str) {
        let pairs = tags.split(", ").filter_map(|tag| tag.split_once('='));
        let tags = Tags(pairs.map(|(key, value)| (key.into(), value.into())).collect());
        let got = tags.meaning().map_or("nothing".into(), |meaning| {
            let line = if meaning.is_line { " line" } else { "" };
            let height = tags.height_m().map_or(String::new(), |height| format!(" {height} m"));
            format!("{:?}{line} {:?}{height}", meaning.role, meaning.name)
        });
        assert_eq!(got, meaning, "{tags:?}");
    }

    #[test]
    fn tags_have_a_meaning_or_none() {
        check("building=yes, name=Shed", "Obstacle \"Shed\"");
        check("building=no", "nothing");
        check("building=", "nothing");
        check("obstacle=true", "Obstacle \"\"");
        check("obstacle=False", "nothing");
        check("building=house, height=7.5", "Obstacle \"\" 7.5 m");
        check("building=house, height=7 m, building:levels=1", "Obstacle \"\" 7 m");
        check("building=house, height=tall, building:levels=2.5", "Obstacle \"\" 7.5 m");
        check("building=house, height=-3", "Obstacle \"\"");
        check("building=house, height=inf", "Obstacle \"\"");
        check("barrier=fence", "Obstacle line \"\"");
        check("barrier=hedge, area=yes", "Obstacle \"\"");
        check("barrier=gate", "nothing");
        check("natural=wood", "Attenuating \"wood\"");
        check("natural=water", "nothing");
        check("landuse=forest, name=Spinney", "Attenuating \"Spinney\"");
        check("layer=NoCommZone, name=north", "Attenuating \"north\"");
        check("layer=night", "Zone \"night\"");
        check("layer=-1", "nothing");
        check("building=yes, layer=1", "Obstacle \"\"");
        check("name=Gate", "nothing");
    }
}
