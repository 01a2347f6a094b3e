//! The start and the work of a world file: limits, tanks and fields.

use super::reader::{FARTHEST_M, Reader, Section, point_of};
use crate::Point;
use crate::geometry::distance;
use crate::surroundings::{Field, Leak, Surroundings, Tank, Work};
use robot_io::limits::{MAX_CHANNELS, MAX_OUTPUTS};
use std::collections::BTreeMap;
use std::ops::Range;
use toml_edit::{Item, TableLike};

/// Longest time limit, seconds: a week.
pub(super) const LONGEST_S: f64 = 604_800.0;
/// Time limit of a world that sets none, seconds.
const AN_HOUR_S: f64 = 3_600.0;

impl Reader<'_> {
    /// The start and what the robot's work changes.
    pub(super) fn surroundings(&mut self, top: &Section<'_>) -> Option<Surroundings> {
        let start = self.needed_point(top, "start");
        let heading = self.number(top, "heading", (-10.0, 10.0), "0.0").unwrap_or(0.0);
        let limit = self.number(top, "time_limit", (0.05, LONGEST_S), "600");
        let gps_sigma = self.number(top, "gps_sigma", (0.0, 1_000.0), "0.02");
        let signal = self.whole(top, "signal", 1, u16::MAX.into()).map(|signal| signal as u16);
        let tanks = self.all(top, "tanks", Self::tank);
        let fields = self.all(top, "fields", Self::field);
        self.check_channels(top);
        Some(Surroundings {
            start: start?,
            heading,
            time_limit: limit.unwrap_or(AN_HOUR_S),
            gps_sigma,
            signal,
            is_signalled: false,
            tanks,
            fields,
        })
    }

    fn tank(&mut self, tank: &Section<'_>) -> Option<Tank> {
        self.unknown_keys(
            tank,
            &["channel", "level", "use_per_m", "fill_per_s", "at", "within", "output", "leak"],
        );
        let channel = self.channel(tank);
        let level = self.needed_number(tank, "level", (0.0, 1.0), "1.0");
        let use_per_m = self.needed_number(tank, "use_per_m", (0.0, 1.0), "0.0025");
        let fill_per_s = self.needed_number(tank, "fill_per_s", (0.0, 100.0), "0.05");
        let at = self.needed_point(tank, "at");
        let within = self.needed_number(tank, "within", (0.01, FARTHEST_M), "2.0");
        let output = self.output(tank);
        let leak = tank.get("leak").and_then(|(item, span)| self.leak(tank, item, span));
        Some(Tank {
            channel: channel?,
            level: level?,
            use_per_m: use_per_m?,
            fill_per_s: fill_per_s?,
            at: at?,
            within: within?,
            output,
            leak,
            fills: 0,
            driven_m: 0.0,
            is_filling: false,
        })
    }

    fn leak(&mut self, tank: &Section<'_>, item: &Item, at: Range<usize>) -> Option<Leak> {
        let path = format!("{}.leak", tank.path);
        let Some(table) = item.as_table_like() else {
            let help = "write leak = { after_m = 180, to = 0.1 }";
            self.error(format!("`{path}` must be a table"), at, "not a table", help);
            return None;
        };
        let leak = Section { table, path: &path, at: &at };
        self.unknown_keys(&leak, &["after_m", "to"]);
        let after_m = self.needed_number(&leak, "after_m", (0.0, FARTHEST_M), "180");
        let to = self.needed_number(&leak, "to", (0.0, 1.0), "0.1");
        Some(Leak { after_m: after_m?, to: to? })
    }

    fn field(&mut self, field: &Section<'_>) -> Option<Field> {
        self.unknown_keys(field, &["channel", "within", "output", "strips"]);
        let channel = self.channel(field);
        let within = self.needed_number(field, "within", (0.01, FARTHEST_M), "1.5");
        let output = self.output(field);
        let strips = self.strips(field)?;
        let work = vec![Work::default(); strips.len()];
        Some(Field { channel: channel?, within: within?, output, strips, work })
    }

    fn strips(&mut self, field: &Section<'_>) -> Option<Vec<[Point; 2]>> {
        const HELP: &str = "write strips = [[[10, 12], [10, 68]]]: each strip from its start to its \
                            end, two points that differ";
        let Some((item, at)) = field.get("strips") else {
            self.missing(field, "strips", HELP);
            return None;
        };
        let list = item.as_array().filter(|list| !list.is_empty());
        let Some(list) = list else {
            let message = format!("{} must be a list of strips", field.key("strips"));
            self.error(message, at, "not a list of strips", HELP);
            return None;
        };
        let mut strips = Vec::new();
        for strip in list {
            let ends: Vec<Point> =
                strip.as_array().into_iter().flatten().filter_map(point_of).collect();
            match ends[..] {
                [from, to] if distance(from, to) > 0.0 => strips.push([from, to]),
                _ => {
                    let here = strip.span().unwrap_or_else(|| at.clone());
                    let message = format!("a strip of {} is wrong", field.key("strips"));
                    self.error(message, here, "not two points that differ", HELP);
                }
            }
        }
        Some(strips)
    }

    fn channel(&mut self, section: &Section<'_>) -> Option<usize> {
        if section.get("channel").is_none() {
            self.missing(section, "channel", "write channel = 1, the input that reports it");
        }
        self.whole(section, "channel", 0, MAX_CHANNELS as i64 - 1).map(|channel| channel as usize)
    }

    fn output(&mut self, section: &Section<'_>) -> Option<u16> {
        self.whole(section, "output", 0, MAX_OUTPUTS as i64 - 1).map(|output| output as u16)
    }

    /// Reports channels that two tanks or fields use.
    fn check_channels(&mut self, top: &Section<'_>) {
        let mut taken = BTreeMap::new();
        for kind in ["tanks", "fields"] {
            let tables = top.get(kind).and_then(|(item, _)| item.as_table_like());
            for (name, item) in tables.into_iter().flat_map(TableLike::iter) {
                let channel = item.as_table_like().and_then(|table| table.get("channel"));
                let Some(number) = channel.and_then(Item::as_integer) else { continue };
                if let Some(other) = taken.insert(number, name) {
                    let at = channel.and_then(Item::span).unwrap_or(0..0);
                    let message =
                        format!("`{kind}.{name}` and `{other}` both use channel {number}");
                    self.error(message, at, "already used", "give each a channel of its own");
                }
            }
        }
    }
}
