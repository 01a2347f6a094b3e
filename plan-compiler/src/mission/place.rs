//! Where goals are: lists of positions, and places on the globe: `geo:LAT,LON`, as in RFC 5870, and
//! `{ lat = .., lon = .. }`.

use super::{GoalAt, Reader};
use crate::toml::{Span, key_span, number};
use math::GeoPoint;
use plan_format::limits;
use toml_edit::{Array, Item, Table, TableLike, Value};

/// Example of how a place is written.
const EXAMPLE: &str = "write geo:LAT,LON in degrees, for example geo:51.5,-0.1";

/// Whether a text is meant to be a place on the globe.
pub fn is_geo_uri(text: &str) -> bool {
    text.trim().get(..4).is_some_and(|scheme| scheme.eq_ignore_ascii_case("geo:"))
}

/// Reads `geo:LAT,LON`, a URI of RFC 5870; otherwise returns the reason why it is not one. An
/// altitude and the parameters `crs=wgs84` and `u=METRES` are accepted and ignored.
pub fn geo_uri(text: &str) -> Result<GeoPoint, String> {
    let rest = text.trim().get(4..).filter(|_| is_geo_uri(text)).ok_or(EXAMPLE)?;
    // Map applications append a query such as `?z=17`.
    let rest = rest.split('?').next().unwrap_or(rest);
    let mut parts = rest.split(';');
    let mut numbers = parts.next().unwrap_or_default().split(',');
    for parameter in parts {
        let (key, value) = parameter.split_once('=').unwrap_or((parameter, ""));
        if key.eq_ignore_ascii_case("crs") && !value.eq_ignore_ascii_case("wgs84") {
            return Err(format!("`{parameter}`: places are read in WGS-84 only"));
        }
    }
    let mut degrees = || {
        let word = numbers.next().ok_or_else(|| EXAMPLE.to_owned())?;
        word.trim().parse::<f64>().map_err(|_| format!("`{word}` is not a number; {EXAMPLE}"))
    };
    let (lat, lon) = (degrees()?, degrees()?);
    if numbers.count() > 1 {
        return Err(EXAMPLE.to_owned());
    }
    place_of(lat, lon)
}

/// The place of a latitude and a longitude in degrees; otherwise the reason why there is none.
pub fn place_of(lat: f64, lon: f64) -> Result<GeoPoint, String> {
    GeoPoint::from_degrees(lat, lon).ok_or_else(|| {
        let swapped = match GeoPoint::from_degrees(lon, lat) {
            Some(_) => "; are latitude and longitude swapped?",
            None => "",
        };
        format!(
            "{lat},{lon} is not on the globe: latitude first, -90 to 90, then longitude, -180 to \
             180{swapped}"
        )
    })
}

/// What one of several goals is called in messages.
pub(super) const MEMBER: &str = "member";

impl Reader<'_> {
    /// Reads where a goal is: one position, or a list of positions of any form.
    pub(super) fn positions(&mut self, name: &str, item: &Item, span: Span) -> Option<Vec<GoalAt>> {
        let members: Vec<(Item, Option<Span>)> = match item {
            Item::ArrayOfTables(tables) => {
                let table = |table: &Table| (Item::Table(table.clone()), table.span());
                tables.iter().map(table).collect()
            }
            Item::Value(Value::Array(array)) if is_list(array) => {
                array.iter().map(|value| (Item::Value(value.clone()), value.span())).collect()
            }
            _ => return self.position("goal", name, item, span).map(|at| vec![at]),
        };
        if members.len() > limits::MAX_GOALS {
            let (count, most) = (members.len(), limits::MAX_GOALS);
            let message =
                format!("goal `{name}` has {count} positions, but a plan leads to {most}");
            let help = "divide them among several goals";
            self.report.error(message, &span, "too many", help);
            return None;
        }
        let mut read = |(index, (item, own)): (usize, &(Item, Option<Span>))| {
            let (name, span) = (format!("{name}[{index}]"), own.clone().unwrap_or(span.clone()));
            self.member(&name, item, span)
        };
        let all: Vec<Option<GoalAt>> = members.iter().enumerate().map(&mut read).collect();
        all.into_iter().collect()
    }

    /// Reads one of several goals.
    fn member(&mut self, name: &str, item: &Item, span: Span) -> Option<GoalAt> {
        let Some(table) = item.as_table_like() else {
            return self.position(MEMBER, name, item, span);
        };
        let mut is_known = true;
        for (key, _) in table.iter().filter(|(key, _)| !super::POSITION_KEYS.contains(key)) {
            is_known = false;
            let key_span = key_span(table, key);
            if key == "layers" {
                let message = format!("`{name}` has layers of its own");
                let help = "all goals of a plan have its layers: write { at = [[1, 2], [3, 4]], \
                            layers = [..] }";
                self.report.error(message, &key_span, "not here", help);
            } else {
                self.unknown_goal_key(&format!("goal `{name}`"), key, &key_span);
            }
        }
        if !is_known {
            return None;
        }
        match only_at(table) {
            Some(at) => self.position(MEMBER, name, at, at.span().unwrap_or(span)),
            None => self.globe_of_table(MEMBER, name, table, span),
        }
    }

    /// Reads the positions of a goal's table: `at`, or `lat` and `lon`.
    pub(super) fn goal_table(
        &mut self,
        name: &str,
        table: &dyn TableLike,
        span: Span,
    ) -> Option<Vec<GoalAt>> {
        match only_at(table) {
            Some(at) => self.positions(name, at, at.span().unwrap_or(span)),
            None => self.globe_of_table("goal", name, table, span).map(|at| vec![at]),
        }
    }

    /// Reads `lat` and `lon` of a table, and reports what is wrong with a table without them.
    fn globe_of_table(
        &mut self,
        what: &str,
        name: &str,
        table: &dyn TableLike,
        span: Span,
    ) -> Option<GoalAt> {
        let here = |key: &str| table.get(key).and_then(Item::span);
        match (table.get("at"), table.get("lat"), table.get("lon")) {
            (None, Some(lat), Some(lon)) => {
                let degrees = [lat, lon].map(|item| item.as_value().and_then(number));
                let place = match degrees {
                    [Some(lat), Some(lon)] => place_of(lat, lon),
                    _ => Err("`lat` and `lon` are numbers, degrees".to_owned()),
                };
                place.map(GoalAt::Globe).map_or_else(
                    |reason| {
                        let message = format!("goal `{name}` is not a place on the globe");
                        let at = here("lat").unwrap_or_else(|| span.clone());
                        let help =
                            format!("write {}", written(what, name, "{ lat = 51.5, lon = -0.1 }"));
                        self.report.error(message, &at, &reason, &help);
                        None
                    },
                    Some,
                )
            }
            (None, None, None) => {
                let help = format!("write {}", written(what, name, "{ at = [12.5, 40.0] }"));
                self.report.error(format!("goal `{name}` has no `at`"), &span, "this goal", &help);
                None
            }
            // A misspelt key has been reported.
            _ if table.iter().any(|(key, _)| !super::GOAL_KEYS.contains(&key)) => None,
            _ => {
                let [at, globe] = ["{ at = [12.5, 40.0] }", "{ lat = 51.5, lon = -0.1 }"]
                    .map(|form| written(what, name, form));
                let help = format!("write either {at} or {globe}");
                let message = format!("goal `{name}` needs `at` alone, or `lat` and `lon`");
                self.report.error(message, &span, "this goal", &help);
                None
            }
        }
    }
}

/// Whether an array is a list of goals: a position begins with a number.
fn is_list(array: &Array) -> bool {
    array.get(0).is_some_and(|first| number(first).is_none())
}

/// The `at` of a table without `lat` and `lon`.
fn only_at(table: &dyn TableLike) -> Option<&Item> {
    let is_alone = table.get("lat").is_none() && table.get("lon").is_none();
    table.get("at").filter(|_| is_alone)
}

/// How a goal with a position is written: one of several has no name of its own.
pub(super) fn written(what: &str, name: &str, position: &str) -> String {
    if what == MEMBER { position.to_owned() } else { format!("{name} = {position}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_as_the_rfc_writes_them() {
        let place = GeoPoint::from_degrees(51.5, -0.1).unwrap();
        for text in [
            "geo:51.5,-0.1",
            "GEO:51.5,-0.1,12",
            " geo:51.5, -0.1;u=35",
            "geo:51.5,-0.1;crs=WGS84;u=35",
            "geo:51.5,-0.1?z=17",
        ] {
            assert_eq!(geo_uri(text), Ok(place), "{text}");
        }
        for (text, expected) in [
            ("geo:51.5", "write geo:LAT,LON"),
            ("geo:north,east", "`north` is not a number"),
            ("geo:1,2,3,4", "write geo:LAT,LON"),
            ("geo:51.5;-0.1", "write geo:LAT,LON"),
            ("geo:51.5,-0.1;crs=nad27", "WGS-84 only"),
            ("geo:-0.1,181", "-180 to 180"),
            ("geo:151.2,-33.8", "swapped?"),
            ("geo:nan,1", "not on the globe"),
        ] {
            let reason = geo_uri(text).expect_err(text);
            assert!(reason.contains(expected), "{text}: {reason}");
        }
    }
}
