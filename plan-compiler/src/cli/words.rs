//! Arguments of one word: parsers and the types that they return.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use maps::names::Word;
use math::GeoPoint;
use plan_compiler::boards::{BOARDS, Board};
use plan_compiler::mission;
use plan_compiler::mission::words::{number, pair};
use plan_compiler::render::SIZES_PX;

/// A tick of a trace.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TickAt {
    /// Counted from 0.
    Number(usize),
    /// The last one.
    Last,
}

impl TickAt {
    /// The index of this tick in a trace of `ticks` ticks.
    pub(crate) fn index(self, ticks: usize) -> usize {
        match self {
            Self::Number(number) => number,
            Self::Last => ticks.saturating_sub(1),
        }
    }
}

impl std::str::FromStr for TickAt {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self::Number(0)),
            "last" => Ok(Self::Last),
            _ => text
                .parse()
                .map(Self::Number)
                .map_err(|_| "write a number from 0, `first` or `last`".into()),
        }
    }
}

/// A point on the command line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PointAt {
    /// The map's metres.
    Map([f64; 2]),
    /// WGS-84.
    Globe(GeoPoint),
}

/// `PLAN/LAYER`.
#[derive(Clone, Debug)]
pub(crate) struct LayerName {
    pub(crate) plan: String,
    pub(crate) layer: String,
}

impl std::str::FromStr for LayerName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('/') {
            Some((plan, layer)) if !plan.is_empty() && !layer.is_empty() => {
                Ok(Self { plan: plan.into(), layer: layer.into() })
            }
            _ => {
                Err("write PLAN/LAYER, for example gate/physical; `inspect` lists the layers"
                    .into())
            }
        }
    }
}

pub(super) fn board() -> impl TypedValueParser<Value = &'static Board> {
    let names = BOARDS.iter().map(|board| {
        let (size, address) = (board.memory.plans.bytes >> 10, board.memory.plans.address);
        let firmware =
            if board.state.has_firmware() { "" } else { "; plans only, no firmware yet" };
        PossibleValue::new(board.name.as_str())
            .help(format!("{size} KiB at {address:#010x}{firmware}"))
    });
    PossibleValuesParser::new(names)
        .try_map(|name| Board::find(&name).ok_or("there is no such board"))
}

/// GiB as bytes.
pub(super) fn gib(text: &str) -> Result<u64, String> {
    let gib = number(text)?;
    if gib > 0.0 {
        Ok((gib * f64::from(1 << 30)) as u64)
    } else {
        Err("write a number of GiB above 0".into())
    }
}

pub(super) fn point(text: &str) -> Result<PointAt, String> {
    if mission::is_geo_uri(text) {
        return mission::geo_uri(text).map(PointAt::Globe);
    }
    pair(text).map(PointAt::Map)
}

/// A number of metres. The compiler checks its range.
pub(super) fn length(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 5] =
        [("mm", 1e-3), ("cm", 1e-2), ("ft", 0.3048), ("feet", 0.3048), ("m", 1.0)];
    let text = text.trim();
    if let Ok(number) = text.parse() {
        return Ok(number);
    }
    let with_unit = UNITS.iter().find_map(|(unit, metres)| {
        let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
        Some((number * metres * 1e6).round() / 1e6)
    });
    Err(match with_unit {
        Some(metres) => format!("write the number of metres without a unit: {metres}"),
        None => "write a number of metres, for example 0.25".into(),
    })
}

/// The longer side of a picture.
pub(super) fn size() -> impl TypedValueParser<Value = u32> {
    let (least, most) = (i64::from(*SIZES_PX.start()), i64::from(*SIZES_PX.end()));
    clap::value_parser!(u32).range(least..=most)
}

pub(super) fn place(text: &str) -> Result<GeoPoint, String> {
    let [lat, lon] = pair(text)?;
    let off = "latitudes are -90 to 90 degrees, longitudes -180 to 180; the latitude comes first";
    GeoPoint::from_degrees(lat, lon).ok_or_else(|| off.into())
}

/// A parser for the words of a choice.
pub(super) fn words<T: Word + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let values = T::WORDS.iter().map(|(word, meaning, _)| PossibleValue::new(word).help(*meaning));
    PossibleValuesParser::new(values)
        .try_map(|word| T::of_word(&word).ok_or_else(|| format!("`{word}` is not a known word")))
}
