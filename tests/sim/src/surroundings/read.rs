//! Reads a world file, and reports every mistake with its place and how to fix it.

use super::{Field, Leak, Surroundings, Tank, Work};
use crate::Point;
use crate::geometry::distance;
use maps::names::nearest;
use maps::problem::{Problem, Source, has_errors};
use maps::source;
use robot_io::limits::{MAX_CHANNELS, MAX_OUTPUTS};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::{Document, Item, TableLike, Value};

/// Largest coordinate of a point, metres.
const FARTHEST_M: f64 = 1e6;
/// Longest time limit, seconds: a week.
const LONGEST_S: f64 = 604_800.0;
/// Time limit of a world that sets none, seconds.
const AN_HOUR_S: f64 = 3_600.0;

/// The path of the world file beside a map or a mission.
fn path_beside(path: &Path) -> PathBuf {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    match name.strip_suffix(".mission.toml") {
        Some(plain) => path.with_file_name(format!("{plain}.world.toml")),
        None => path.with_extension("world.toml"),
    }
}

/// The world beside a map or a mission; `None` if there is none or it has a mistake.
pub(super) fn beside(path: &Path, problems: &mut Vec<Problem>) -> Option<Surroundings> {
    let path = path_beside(path);
    if !path.exists() {
        return None;
    }
    match source::read_text(&path) {
        Ok((text, found)) => {
            problems.extend(found);
            parse(&text, problems)
        }
        Err(problem) => {
            problems.push(problem);
            None
        }
    }
}

/// The world in a text; `None` if it has a mistake. All mistakes are added to `problems`.
pub(super) fn parse(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Option<Surroundings> {
    let mut reader = Reader { source, problems: Vec::new() };
    let world = match Document::parse(source.text.as_str()) {
        Ok(document) => reader.world(document.as_table()),
        Err(error) => {
            let help = "each line is `key = value`, `[section]` or `# comment`";
            reader.error("this is not TOML", error.span().unwrap_or(0..0), error.message(), help);
            None
        }
    };
    let world = world.filter(|_| !has_errors(&reader.problems));
    reader.problems.sort_by_key(|problem| problem.place.as_ref().map(|place| place.span.start));
    problems.append(&mut reader.problems);
    world
}

struct Reader<'s> {
    source: &'s Arc<Source>,
    problems: Vec<Problem>,
}

/// One table of the file, with its path for messages and the span of its name.
#[derive(Clone, Copy)]
struct Section<'t> {
    table: &'t dyn TableLike,
    path: &'t str,
    at: &'t Range<usize>,
}

impl Section<'_> {
    fn key(&self, key: &str) -> String {
        if self.path.is_empty() { format!("`{key}`") } else { format!("`{}.{key}`", self.path) }
    }

    /// The value of a key, and its span.
    fn get(&self, key: &str) -> Option<(&Item, Range<usize>)> {
        let item = self.table.get(key)?;
        Some((item, item.span().unwrap_or_else(|| self.at.clone())))
    }
}

impl Reader<'_> {
    fn error(&mut self, message: impl Into<String>, at: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, at, label).help(help));
    }

    fn world(&mut self, table: &dyn TableLike) -> Option<Surroundings> {
        const KEYS: [&str; 7] =
            ["start", "heading", "time_limit", "gps_sigma", "signal", "tanks", "fields"];
        let top = Section { table, path: "", at: &(0..0) };
        self.unknown_keys(&top, &KEYS);
        let start = self.needed_point(&top, "start");
        let heading = self.number(&top, "heading", (-10.0, 10.0), "0.0").unwrap_or(0.0);
        let limit = self.number(&top, "time_limit", (0.05, LONGEST_S), "600");
        let gps_sigma = self.number(&top, "gps_sigma", (0.0, 1_000.0), "0.02");
        let signal = self.whole(&top, "signal", 1, u16::MAX.into()).map(|signal| signal as u16);
        let tanks = self.all(&top, "tanks", Self::tank);
        let fields = self.all(&top, "fields", Self::field);
        self.check_channels(&top);
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

    /// Every table below a table, by its name.
    fn all<T>(
        &mut self,
        top: &Section<'_>,
        key: &str,
        mut read: impl FnMut(&mut Self, &Section<'_>) -> Option<T>,
    ) -> BTreeMap<String, T> {
        let mut found = BTreeMap::new();
        let Some((item, at)) = top.get(key) else { return found };
        let Some(tables) = item.as_table_like() else {
            let help = format!("write [{key}.NAME] and its keys below it");
            self.error(format!("`{key}` must be tables"), at, "not a table", &help);
            return found;
        };
        for (name, item) in tables.iter() {
            let at = tables.key(name).and_then(toml_edit::Key::span).unwrap_or_else(|| at.clone());
            let path = format!("{key}.{name}");
            match item.as_table_like() {
                Some(table) => {
                    let section = Section { table, path: &path, at: &at };
                    found.extend(read(self, &section).map(|value| (name.to_owned(), value)));
                }
                None => {
                    let help = format!("write [{path}] and its keys below it");
                    self.error(format!("`{path}` must be a table"), at, "not a table", &help);
                }
            }
        }
        found
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

    fn unknown_keys(&mut self, section: &Section<'_>, known: &[&str]) {
        for (key, _) in section.table.iter().filter(|(key, _)| !known.contains(key)) {
            let help = match nearest(key, known.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("the keys here are {}", known.join(", ")),
            };
            let at = section.table.key(key).and_then(toml_edit::Key::span);
            let at = at.unwrap_or_else(|| section.at.clone());
            let message = format!("{} is not a key of a world", section.key(key));
            self.error(message, at, "unknown key", &help);
        }
    }

    fn missing(&mut self, section: &Section<'_>, key: &str, help: &str) {
        let message = format!("{} is missing", section.key(key));
        self.error(message, section.at.clone(), "here", help);
    }

    fn needed_number(
        &mut self,
        section: &Section<'_>,
        key: &str,
        range: (f64, f64),
        example: &str,
    ) -> Option<f64> {
        if section.get(key).is_none() {
            self.missing(section, key, &format!("write {key} = {example}"));
        }
        self.number(section, key, range, example)
    }

    fn number(
        &mut self,
        section: &Section<'_>,
        key: &str,
        (low, high): (f64, f64),
        example: &str,
    ) -> Option<f64> {
        let (item, at) = section.get(key)?;
        let number = item.as_value().and_then(number_of);
        let number = number.filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let message = format!("{} must be a number from {low} to {high}", section.key(key));
            let help = format!("write {key} = {example}");
            self.error(message, at, "not a number in this range", &help);
        }
        number
    }

    fn whole(&mut self, section: &Section<'_>, key: &str, low: i64, high: i64) -> Option<i64> {
        let (item, at) = section.get(key)?;
        let number = item.as_integer().filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let name = section.key(key);
            let message = format!("{name} must be a whole number from {low} to {high}");
            let help = format!("write {key} = {}", low.max(1));
            self.error(message, at, "not a whole number in this range", &help);
        }
        number
    }

    fn needed_point(&mut self, section: &Section<'_>, key: &str) -> Option<Point> {
        let help = format!("write {key} = [X, Y] in the map's metres, x east, y north");
        let Some((item, at)) = section.get(key) else {
            self.missing(section, key, &help);
            return None;
        };
        let point = item.as_value().and_then(point_of);
        if point.is_none() {
            self.error(format!("{} must be a point", section.key(key)), at, "not a point", &help);
        }
        point
    }
}

fn number_of(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|integer| integer as f64))
}

fn point_of(value: &Value) -> Option<Point> {
    let pair = value.as_array().filter(|pair| pair.len() == 2)?;
    let number = |index| {
        pair.get(index).and_then(number_of).filter(|number: &f64| number.abs() <= FARTHEST_M)
    };
    Some([number(0)?, number(1)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<String> {
        let source = Arc::new(Source { name: "yard.world.toml".into(), text: text.into() });
        let mut problems = Vec::new();
        let world = parse(&source, &mut problems);
        assert_eq!(world.is_none(), !problems.is_empty());
        for problem in &problems {
            assert!(problem.help.is_some() && problem.place.is_some(), "{problem:?}");
        }
        problems.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn all_mistakes_are_named_at_once() {
        let messages = read(
            "strat = [1, 2]\nheading = 'east'\ntime_limit = -5\ntruth = \"other.ovl\"\nsignal = 0\n\
             [tanks.fuel]\nchannel = 8\nlevel = 2\nwith_in = 2\nat = [1]\nfill_per_s = nan\n\
             [fields.a]\nchannel = 3\nwithin = 1\nstrips = [[[0, 0], [0, 0]], [[1, 2]]]\n\
             [fields.b]\nchannel = 3\nwithin = 1\nstrips = []\n",
        );
        let expected = [
            "`strat` is not a key of a world",
            "`start` is missing",
            "`heading` must be a number from -10 to 10",
            "`time_limit` must be a number from 0.05 to 604800",
            "`truth` is not a key of a world",
            "`signal` must be a whole number from 1 to 65535",
            "`tanks.fuel.use_per_m` is missing",
            "`tanks.fuel.within` is missing",
            "`tanks.fuel.channel` must be a whole number from 0 to 7",
            "`tanks.fuel.level` must be a number from 0 to 1",
            "`tanks.fuel.with_in` is not a key of a world",
            "`tanks.fuel.at` must be a point",
            "`tanks.fuel.fill_per_s` must be a number from 0 to 100",
            "a strip of `fields.a.strips` is wrong",
            "a strip of `fields.a.strips` is wrong",
            "`fields.b` and `a` both use channel 3",
            "`fields.b.strips` must be a list of strips",
        ];
        assert_eq!(messages, expected, "{messages:#?}");
        assert_eq!(read("start = [1, 2\n"), ["this is not TOML"]);
        assert_eq!(read("start = [1, 2]\ntanks = 3\n"), ["`tanks` must be tables"]);
        assert_eq!(read("start = [1, 2]\n"), [""; 0]);
    }

    #[test]
    fn a_world_lies_beside_its_map_or_its_mission() {
        for (path, world) in [
            ("a/yard.ovl", "a/yard.world.toml"),
            ("yard.mission.toml", "yard.world.toml"),
            ("my.yard.ovl", "my.yard.world.toml"),
            ("my.yard.mission.toml", "my.yard.world.toml"),
            ("yard.toml", "yard.world.toml"),
        ] {
            assert_eq!(path_beside(Path::new(path)), Path::new(world), "{path}");
        }
    }
}
