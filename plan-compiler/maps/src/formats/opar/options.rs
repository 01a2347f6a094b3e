//! Options for what an OPAR file leaves open.

use crate::names::Word;
use std::str::FromStr;

/// Unit of deltas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeltaUnit {
    /// Metres.
    #[default]
    Metres,
    /// Degrees of longitude and latitude.
    Degrees,
}

impl Word for DeltaUnit {
    const WORDS: &'static [(&'static str, &'static str, Self)] = &[
        ("m", "Metres", Self::Metres),
        ("deg", "Degrees of longitude and latitude", Self::Degrees),
    ];
}

/// Which delta of a pair comes first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeltaOrder {
    /// East, then north.
    #[default]
    EastNorth,
    /// North, then east.
    NorthEast,
}

impl Word for DeltaOrder {
    const WORDS: &'static [(&'static str, &'static str, Self)] =
        &[("en", "East, then north", Self::EastNorth), ("ne", "North, then east", Self::NorthEast)];
}

/// What an obstruction is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObstructionKind {
    /// An obstacle.
    Building,
    /// Weakens radio; a robot may drive through it.
    Foliage,
}

/// A type number and its meaning, written `N=building` or `N=foliage`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObstructionType {
    /// Type number in the file.
    pub number: u32,
    /// Its meaning.
    pub kind: ObstructionKind,
}

impl FromStr for ObstructionType {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("write N=building or N=foliage with a whole number N, not {text}");
        let (number, kind) = text.split_once('=').ok_or_else(wrong)?;
        let number = number.trim().parse().map_err(|_| wrong())?;
        let kind = match kind.trim().to_ascii_lowercase().as_str() {
            "building" => ObstructionKind::Building,
            "foliage" => ObstructionKind::Foliage,
            _ => return Err(wrong()),
        };
        Ok(Self { number, kind })
    }
}

impl std::fmt::Display for ObstructionType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = match self.kind {
            ObstructionKind::Building => "building",
            ObstructionKind::Foliage => "foliage",
        };
        write!(f, "{}={kind}", self.number)
    }
}

/// Options for what an OPAR file leaves open. The defaults are the module's assumptions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OparOptions {
    /// Unit of deltas.
    pub units: DeltaUnit,
    /// Which delta of a pair comes first.
    pub order: DeltaOrder,
    /// Types that extend or override 1 = building and 2 = foliage; the last entry wins.
    pub types: Vec<ObstructionType>,
}

impl OparOptions {
    /// Meaning of a type number, if known.
    pub(super) fn kind(&self, number: f64) -> Option<ObstructionKind> {
        let given = self.types.iter().rev().find(|entry| f64::from(entry.number) == number);
        match given {
            Some(entry) => Some(entry.kind),
            None if number == 1.0 => Some(ObstructionKind::Building),
            None if number == 2.0 => Some(ObstructionKind::Foliage),
            None => None,
        }
    }
}
