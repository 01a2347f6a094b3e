//! How a mission says its map is to be read.

use super::{Mission, Reader};
use crate::toml::{Span, number};
use maps::formats::{ReadOptions, TagRule, TagRules};
use math::GeoPoint;
use toml_edit::{Item, Value};

impl Mission {
    /// The options of the command line, completed by the mission. Each option and each list of the
    /// command line replaces the mission's.
    pub fn reading(&self, given: ReadOptions) -> ReadOptions {
        let or = |given: Vec<TagRule>, own: &Vec<TagRule>| {
            if given.is_empty() { own.clone() } else { given }
        };
        // What is kept for one purpose is kept for all.
        let both = |mut given: Vec<TagRule>, own: &Vec<TagRule>| {
            let is_new =
                |rule: &&TagRule| given.iter().all(|one| one.to_string() != rule.to_string());
            let new: Vec<TagRule> = own.iter().filter(is_new).cloned().collect();
            given.extend(new);
            given
        };
        let tags = TagRules {
            block: or(given.tags.block, &self.tags.block),
            free: or(given.tags.free, &self.tags.free),
            keep: both(given.tags.keep, &self.tags.keep),
            used: given.tags.used,
            open_gates: given.tags.open_gates || self.tags.open_gates,
        };
        ReadOptions { tags, origin: given.origin.or(self.origin), ..given }
    }
}

impl Reader<'_> {
    /// Reads a list of tags; `None` if the value is not a list of texts.
    pub(super) fn tags(&mut self, item: &Item) -> Option<Vec<TagRule>> {
        let span = item.span().unwrap_or(0..0);
        let array = item.as_array()?;
        let texts: Option<Vec<(String, Span)>> = array
            .iter()
            .map(|value| {
                let at = value.span().unwrap_or_else(|| span.clone());
                Some((value.as_str()?.to_owned(), at))
            })
            .collect();
        let mut rules = Vec::new();
        for (text, at) in texts? {
            match text.parse::<TagRule>() {
                Ok(rule) => rules.push(TagRule { place: Some(self.report.place(&at)), ..rule }),
                Err(help) => {
                    self.report.error(format!("`{text}` is not a tag"), &at, "this", &help)
                }
            }
        }
        Some(rules)
    }

    /// Reads a latitude and a longitude; `None` if the value is not a pair of numbers.
    pub(super) fn place_on_globe(&mut self, item: &Item) -> Option<Option<GeoPoint>> {
        let array = item.as_value().and_then(Value::as_array)?;
        let numbers: Vec<f64> = array.iter().filter_map(number).collect();
        let [lat, lon] = numbers[..] else { return None };
        let place = GeoPoint::from_degrees(lat, lon);
        if place.is_none() {
            let span = item.span().unwrap_or(0..0);
            let help = "latitudes are -90 to 90 degrees, longitudes -180 to 180; the latitude \
                        comes first";
            self.report.error("the origin is off the globe", &span, "this place", help);
        }
        (array.len() == 2).then_some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::tests::read;

    #[test]
    fn a_mission_says_what_tags_mean_and_where_the_origin_is() {
        let (mission, problems) = read(
            "block = ['landuse=farmland', 'highway']\nfree = [\"natural=water\"]\n\
             open_gates = true\norigin = [51.5, -0.1]\n",
        );
        assert_eq!(problems, [""; 0]);
        let said: Vec<String> = mission.tags.block.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["landuse=farmland", "highway=*"]);
        assert!(mission.tags.open_gates && mission.tags.free.len() == 1);
        assert_eq!(mission.origin, GeoPoint::from_degrees(51.5, -0.1));
    }

    #[test]
    fn the_command_line_comes_first() {
        let (mission, _) = read("block = ['highway']\nfree = ['waterway']\norigin = [1, 2]\n");
        let rule = |text: &str| vec![text.parse::<TagRule>().expect("a rule")];
        let tags = TagRules { block: rule("shop"), ..TagRules::default() };
        let both = mission.reading(ReadOptions { tags, ..ReadOptions::default() });
        assert_eq!(both.tags.block, rule("shop"));
        assert_eq!(both.tags.free, rule("waterway"));
        assert_eq!(both.origin, GeoPoint::from_degrees(1.0, 2.0));
        let origin = GeoPoint::from_degrees(3.0, 4.0);
        assert_eq!(
            mission.reading(ReadOptions { origin, ..ReadOptions::default() }).origin,
            origin
        );
    }

    #[test]
    fn what_is_no_tag_and_no_place_is_a_mistake() {
        for text in [
            "block = 'water'",
            "block = [1]",
            "block = ['=water']",
            "free = ['natural=']",
            "origin = [91, 0]",
            "origin = [1]",
            "origin = [1, 2, 3]",
            "origin = '1,2'",
            "open_gates = 1",
        ] {
            assert_eq!(read(text).1.len(), 1, "{text} {:?}", read(text).1);
        }
    }
}
