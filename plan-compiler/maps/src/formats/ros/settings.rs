//! Reads the YAML file and locates every mistake in it.

use crate::names::nearest;
use crate::problem::{Problem, Source};
use saphyr::{LoadableYamlNode, MarkedYaml, Scalar, YamlData};
use saphyr_parser::{Event, Parser};
use std::ops::Range;
use std::sync::Arc;

/// How grey becomes occupancy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// Free, occupied or unknown.
    #[default]
    Trinary,
    /// Between the thresholds, a probability.
    Scale,
    /// Grey is a percentage.
    Raw,
}

/// Values of the file; a value that cannot be read is `None` or map_saver's default.
#[derive(Debug)]
pub(super) struct Settings {
    /// The image's name and its bytes in the file.
    pub(super) image: Option<(String, Range<usize>)>,
    pub(super) resolution_m: Option<f64>,
    /// x and y, metres; yaw, radians counter-clockwise.
    pub(super) origin: Option<[f64; 3]>,
    pub(super) negate: bool,
    pub(super) occupied_thresh: f64,
    pub(super) free_thresh: f64,
    /// Bytes of the value of `free_thresh`, if the file gives it.
    pub(super) free_thresh_span: Option<Range<usize>>,
    pub(super) mode: Mode,
}

/// All known keys.
const KEYS: [&str; 7] =
    ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"];
/// What map_saver writes.
const OCCUPIED_THRESH: f64 = 0.65;
/// What map_saver writes.
const FREE_THRESH: f64 = 0.196;

const HELP: &str = "a map's file has one `key: value` per line: image, resolution, origin, ...";
const OTHER_YAML: &str = "name the file that map_saver wrote: it has lines `image:`, \
                          `resolution:` and `origin:`; a file of parameters may name it as \
                          `yaml_filename`";
/// Most keys, values and brackets of a file: a map has about thirty.
const MAX_EVENTS: usize = 10_000;
/// Deepest nesting of lists; the parser drops its data recursively.
const MAX_DEPTH: usize = 32;
/// A whole turn, plus rounding in files.
const TURN_RAD: f64 = 6.3;

/// Index of the character at which a file becomes too long or too deep, if it does.
fn too_much(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    for (count, event) in Parser::new_from_str(text).enumerate() {
        // The loader reports the error.
        let Ok((event, span)) = event else { return None };
        match event {
            Event::SequenceStart(..) | Event::MappingStart(..) => depth += 1,
            Event::SequenceEnd | Event::MappingEnd => depth = depth.saturating_sub(1),
            _ => {}
        }
        if count > MAX_EVENTS || depth > MAX_DEPTH {
            return Some(span.start.index());
        }
    }
    None
}

/// The byte index of every character; empty for ASCII, where both indices are equal.
fn character_starts(text: &str) -> Vec<usize> {
    if text.is_ascii() { Vec::new() } else { text.char_indices().map(|(byte, _)| byte).collect() }
}

/// Reads the values and reports every mistake.
pub(super) fn parse(source: &Arc<Source>, problems: &mut Vec<Problem>) -> Settings {
    let mut settings = Settings {
        image: None,
        resolution_m: None,
        origin: None,
        negate: false,
        occupied_thresh: OCCUPIED_THRESH,
        free_thresh: FREE_THRESH,
        free_thresh_span: None,
        mode: Mode::default(),
    };
    // YAML allows a tab between key and value; this parser does not. Replacing a tab by a blank
    // keeps all positions.
    let text = source.text.replace('\t', " ");
    let mut reader = Reader { source, problems, starts: character_starts(&text) };
    if let Some(at) = too_much(&text) {
        let at = reader.byte(at);
        reader.error("this is not a map's YAML file".into(), at..at, "too long or too deep", HELP);
        return settings;
    }
    let documents = MarkedYaml::load_from_str(&text);
    let document = documents.as_ref().map(|documents| documents.first());
    match document {
        Err(error) => {
            let at = reader.byte(error.marker().index());
            reader.error(format!("this is not YAML: {}", error.info()), at..at, "here", HELP);
        }
        Ok(Some(MarkedYaml { data: YamlData::Mapping(pairs), .. })) => {
            let pairs: Vec<Pair<'_>> =
                pairs.iter().map(|(key, value)| reader.pair(key, value)).collect();
            if pairs.iter().any(|pair| KEYS.contains(&pair.key)) {
                reader.settings(&pairs, &mut settings);
            } else {
                let span = pairs.first().map_or(0..0, |pair| pair.key_span.clone());
                let message = "this YAML file does not describe a map";
                reader.error(message.into(), span, "not a key of a map", OTHER_YAML);
            }
        }
        Ok(_) => {
            reader.error("the file holds no `key: value` lines".into(), 0..0, "", HELP);
        }
    }
    settings
}

/// A key and its value, with their bytes in the file.
struct Pair<'y> {
    key: &'y str,
    key_span: Range<usize>,
    value: &'y YamlData<'y, MarkedYaml<'y>>,
    span: Range<usize>,
}

struct Reader<'a> {
    source: &'a Arc<Source>,
    problems: &'a mut Vec<Problem>,
    /// Result of [`character_starts`].
    starts: Vec<usize>,
}

impl Reader<'_> {
    fn error(&mut self, message: String, span: Range<usize>, label: &str, help: &str) {
        self.problems.push(Problem::error(message).at(self.source, span, label).help(help));
    }

    /// Byte index of a character index, which the parser reports.
    fn byte(&self, character: usize) -> usize {
        let end = self.source.text.len();
        match self.starts.as_slice() {
            [] => character.min(end),
            starts => starts.get(character).copied().unwrap_or(end),
        }
    }

    fn span(&self, node: &MarkedYaml<'_>) -> Range<usize> {
        let start = self.byte(node.span.start.index());
        start..self.byte(node.span.end.index()).max(start)
    }

    fn pair<'y>(&self, key: &'y MarkedYaml<'y>, value: &'y MarkedYaml<'y>) -> Pair<'y> {
        let text = match &key.data {
            YamlData::Value(Scalar::String(text)) => text,
            _ => "",
        };
        Pair { key: text, key_span: self.span(key), value: &value.data, span: self.span(value) }
    }

    fn settings(&mut self, pairs: &[Pair<'_>], settings: &mut Settings) {
        for pair in pairs {
            match pair.key {
                "image" => settings.image = self.image(pair),
                "resolution" => settings.resolution_m = self.resolution(pair),
                "origin" => settings.origin = self.origin(pair),
                "negate" => settings.negate = self.negate(pair).unwrap_or_default(),
                "occupied_thresh" => {
                    settings.occupied_thresh = self.share(pair).unwrap_or(OCCUPIED_THRESH);
                }
                "free_thresh" => {
                    settings.free_thresh = self.share(pair).unwrap_or(FREE_THRESH);
                    settings.free_thresh_span = Some(pair.span.clone());
                }
                "mode" => settings.mode = self.mode(pair).unwrap_or_default(),
                other => {
                    let warning = Problem::warning(format!("`{other}` is not a known key")).at(
                        self.source,
                        pair.key_span.clone(),
                        "ignored",
                    );
                    self.problems.push(match nearest(other, KEYS.into_iter()) {
                        Some(meant) => warning.help(format!("did you mean `{meant}`?")),
                        None => warning.help(format!("the keys are: {}", KEYS.join(", "))),
                    });
                }
            }
        }
        let find = |key: &str| pairs.iter().find(|pair| pair.key == key);
        let needed = [
            ("image", "image: map.pgm"),
            ("resolution", "resolution: 0.05"),
            ("origin", "origin: [0, 0, 0]"),
        ];
        for (key, example) in needed.into_iter().filter(|(key, _)| find(key).is_none()) {
            self.problems.push(
                Problem::error(format!("`{key}` is missing"))
                    .help(format!("add a line, for example `{example}`")),
            );
        }
        let assumed =
            [("negate", 0.0), ("occupied_thresh", OCCUPIED_THRESH), ("free_thresh", FREE_THRESH)];
        for (key, value) in assumed.into_iter().filter(|(key, _)| find(key).is_none()) {
            self.problems.push(
                Problem::warning(format!("`{key}` is missing; {value} is assumed"))
                    .help(format!("add a line `{key}: {value}`")),
            );
        }
        if settings.free_thresh >= settings.occupied_thresh {
            let pair = find("free_thresh").or_else(|| find("occupied_thresh"));
            let (free, occupied) = (settings.free_thresh, settings.occupied_thresh);
            let help = if free > occupied {
                "if the two are swapped, swap them; map_saver writes occupied_thresh: 0.65 and \
                 free_thresh: 0.196"
            } else {
                "map_saver writes occupied_thresh: 0.65 and free_thresh: 0.196"
            };
            self.error(
                format!("free_thresh {free} is not below occupied_thresh {occupied}"),
                pair.map_or(0..0, |pair| pair.span.clone()),
                "a pixel cannot be both",
                help,
            );
        }
    }

    fn image(&mut self, pair: &Pair<'_>) -> Option<(String, Range<usize>)> {
        match pair.value {
            YamlData::Value(Scalar::String(name)) if !name.trim().is_empty() => {
                Some((name.trim().to_owned(), pair.span.clone()))
            }
            _ => {
                let help = "write the image's name, for example `image: map.pgm`";
                self.error(
                    "`image` is not the name of a file".into(),
                    pair.span.clone(),
                    "expected a name",
                    help,
                );
                None
            }
        }
    }

    fn resolution(&mut self, pair: &Pair<'_>) -> Option<f64> {
        let side = number(pair.value).filter(|side| *side > 0.0);
        if side.is_none() {
            self.error(
                "`resolution` is not a length".into(),
                pair.span.clone(),
                "expected metres per pixel",
                "write the side of a pixel, for example `resolution: 0.05`",
            );
        }
        side
    }

    fn origin(&mut self, pair: &Pair<'_>) -> Option<[f64; 3]> {
        let items = match pair.value {
            YamlData::Sequence(items) => items.as_slice(),
            _ => &[],
        };
        let numbers = items.iter().enumerate().map(|(index, item)| {
            // Savers write this for a map without an orientation.
            let is_lost = index == 2 && is_not_a_number(&item.data);
            if is_lost {
                self.lost_yaw(pair);
                return Some(0.0);
            }
            number(&item.data)
        });
        let numbers: Option<Vec<f64>> = numbers.collect();
        let origin = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
        if origin.is_none() {
            self.error(
                "`origin` is not three numbers".into(),
                pair.span.clone(),
                "expected x, y and yaw",
                "write the south-west corner in metres and the yaw in radians: `origin: [-10, -10, 0]`",
            );
        }
        if let Some([x, y, yaw]) = origin.filter(|[.., yaw]| yaw.abs() > TURN_RAD) {
            let radians = (yaw.to_radians() * 1e4).round() / 1e4;
            self.problems.push(
                Problem::warning(format!("the yaw of `origin` is {yaw} rad, more than a turn"))
                    .at(self.source, pair.span.clone(), "x, y in metres and yaw in radians")
                    .help(format!("if these are degrees, write `origin: [{x}, {y}, {radians}]`")),
            );
        }
        origin
    }

    fn lost_yaw(&mut self, pair: &Pair<'_>) {
        self.problems.push(
            Problem::warning("the yaw of `origin` is not a number; 0 is assumed")
                .at(self.source, pair.span.clone(), "the map was saved without its orientation")
                .help("write 0, or the yaw in radians, instead of nan"),
        );
    }

    fn negate(&mut self, pair: &Pair<'_>) -> Option<bool> {
        let negate = match pair.value {
            YamlData::Value(Scalar::Boolean(negate)) => Some(*negate),
            YamlData::Value(Scalar::Integer(number @ 0..=1)) => Some(*number == 1),
            YamlData::Value(Scalar::FloatingPoint(number)) => {
                [false, true].into_iter().find(|flag| f64::from(*flag) == number.into_inner())
            }
            // Quoted, or in YAML 1.1 spelling; map_server accepts these too.
            YamlData::Value(Scalar::String(word)) => {
                match word.trim().to_ascii_lowercase().as_str() {
                    "0" | "false" | "no" | "off" => Some(false),
                    "1" | "true" | "yes" | "on" => Some(true),
                    _ => None,
                }
            }
            _ => None,
        };
        if negate.is_none() {
            let help = "write `negate: 0`, or 1 where white is occupied";
            self.error("`negate` is neither 0 nor 1".into(), pair.span.clone(), "0 or 1", help);
        }
        negate
    }

    fn share(&mut self, pair: &Pair<'_>) -> Option<f64> {
        let share = number(pair.value).filter(|share| (0.0..=1.0).contains(share));
        if share.is_none() {
            self.error(
                format!("`{}` is not a fraction", pair.key),
                pair.span.clone(),
                "expected 0 to 1",
                "map_saver writes occupied_thresh: 0.65 and free_thresh: 0.196",
            );
        }
        share
    }

    fn mode(&mut self, pair: &Pair<'_>) -> Option<Mode> {
        let word = match pair.value {
            YamlData::Value(Scalar::String(word)) => word.as_ref(),
            _ => "",
        };
        let mode = match word.trim().to_ascii_lowercase().as_str() {
            "trinary" => Some(Mode::Trinary),
            "scale" => Some(Mode::Scale),
            "raw" => Some(Mode::Raw),
            _ => None,
        };
        if mode.is_none() {
            let help = "write `mode: trinary`, `scale` or `raw`, or leave the line out";
            self.error("the mode is unknown".into(), pair.span.clone(), "", help);
        }
        mode
    }
}

/// A finite number within the size of maps. It may be quoted, as map_server allows.
fn number<'y>(value: &YamlData<'y, MarkedYaml<'y>>) -> Option<f64> {
    let number = match value {
        YamlData::Value(Scalar::Integer(number)) => *number as f64,
        YamlData::Value(Scalar::FloatingPoint(number)) => number.into_inner(),
        YamlData::Value(Scalar::String(text)) => text.trim().parse().ok()?,
        _ => return None,
    };
    (number.abs() <= crate::formats::FARTHEST_M).then_some(number)
}

fn is_not_a_number<'y>(value: &YamlData<'y, MarkedYaml<'y>>) -> bool {
    match value {
        YamlData::Value(Scalar::FloatingPoint(number)) => number.into_inner().is_nan(),
        YamlData::Value(Scalar::String(text)) => {
            text.trim().trim_start_matches(['-', '+', '.']).eq_ignore_ascii_case("nan")
        }
        _ => false,
    }
}
