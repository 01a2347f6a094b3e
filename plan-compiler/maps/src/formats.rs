//! Detects the format of a map file and calls its reader.
//!
//! A new format is one file beside this one, with `recognises` and `read`, and one arm in
//! each `match` of [`Format`]. The content of a file decides its format; the extension decides
//! only where the content is ambiguous.

pub mod foreign;
pub mod geojson;
mod globe;
mod holes;
pub mod iplan;
mod json;
mod lines;
pub mod movingai;
pub mod opar;
mod openings;
pub mod osm;
pub mod overlay;
mod packed;
pub mod pcf;
pub mod ros;
pub mod tags;
mod turn;
pub mod utm;

pub use opar::OparOptions;
pub use tags::{TagRule, TagRules};

use crate::model::{CellMap, Counts, Map, Unknown};
pub use crate::problem::MAX_PROBLEMS;

use crate::names::Word;
use crate::problem::{Problem, Source, limit};
use crate::source;
use math::GeoPoint;
use std::path::Path;
use std::sync::Arc;

/// Largest distance of a shape from a map's origin, metres: UTM northings fit, and geometry
/// stays far from overflow.
pub const FARTHEST_M: f64 = 1e9;

/// Largest latitude of a map, degrees: here the plane of a map still holds for some kilometres;
/// at a pole a degree of longitude has no length.
pub const FARTHEST_LATITUDE_DEG: f64 = 85.0;

/// A format that maps are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MissionLab overlay.
    Overlay,
    /// OPNET Path Attenuation Routine.
    Opar,
    /// ROS map_server or Nav2: YAML with a PGM or PNG.
    Ros,
    /// MovingAI grid map.
    Movingai,
    /// MissionLab's internalized plans: Iplan.dat.
    Iplan,
    /// MissionLab's plan for a map.
    Pcf,
    /// GeoJSON: features in longitude and latitude.
    Geojson,
    /// OpenStreetMap: XML or PBF.
    Osm,
}

impl Word for Format {
    const WORDS: &'static [(&'static str, &'static str, Self)] = &[
        ("overlay", "MissionLab overlay", Self::Overlay),
        ("opar", "OPNET Path Attenuation Routine", Self::Opar),
        ("ros", "ROS map_server or Nav2: YAML with a PGM or PNG", Self::Ros),
        ("movingai", "MovingAI grid map", Self::Movingai),
        ("iplan", "MissionLab's internalized plans: Iplan.dat", Self::Iplan),
        ("pcf", "MissionLab's plan for a map", Self::Pcf),
        ("geojson", "GeoJSON: features in longitude and latitude", Self::Geojson),
        ("osm", "OpenStreetMap: XML or PBF", Self::Osm),
    ];
}

/// How a user wants a map to be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The format; `None` to detect it.
    pub format: Option<Format>,
    /// How cells that the map marks unknown are treated.
    pub unknown: Unknown,
    /// What OPAR files leave open.
    pub opar: OparOptions,
    /// What the user makes of tags, beyond their default meaning.
    pub tags: TagRules,
    /// Position of 0,0, for formats that give degrees only.
    pub origin: Option<GeoPoint>,
}

impl Format {
    /// All formats, the more easily recognised first.
    pub const ALL: [Self; 8] = [
        Self::Geojson,
        Self::Osm,
        Self::Iplan,
        Self::Pcf,
        Self::Movingai,
        Self::Ros,
        Self::Overlay,
        Self::Opar,
    ];

    /// Its common name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overlay => "MissionLab overlay",
            Self::Opar => "OPAR",
            Self::Ros => "ROS map",
            Self::Movingai => "MovingAI map",
            Self::Iplan => "MissionLab Iplan",
            Self::Pcf => "MissionLab plan",
            Self::Geojson => "GeoJSON",
            Self::Osm => "OpenStreetMap",
        }
    }

    /// Extensions of its files, in lower case.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Overlay => &["ovl", "odl"],
            Self::Opar => &["opar"],
            Self::Ros => &["yaml", "yml"],
            Self::Movingai => &["map"],
            Self::Iplan => &["dat"],
            Self::Pcf => &["pcf"],
            Self::Geojson => &["geojson", "json", "geojsonl", "geojsons", "geojsonseq", "ndjson"],
            Self::Osm => &["osm", "pbf"],
        }
    }

    fn recognises(self, text: &str) -> bool {
        match self {
            Self::Overlay => overlay::recognises(text),
            Self::Opar => opar::recognises(text),
            Self::Ros => ros::recognises(text),
            Self::Movingai => movingai::recognises(text),
            Self::Iplan => iplan::recognises(text),
            Self::Pcf => pcf::recognises(text),
            Self::Geojson => geojson::recognises(text),
            Self::Osm => osm::recognises(text),
        }
    }

    fn read(
        self,
        path: &Path,
        text: &Arc<Source>,
        options: &ReadOptions,
    ) -> (Option<Map>, Vec<Problem>) {
        match self {
            Self::Overlay => overlay::read(text),
            Self::Opar => opar::read(text, &options.opar),
            Self::Ros => ros::read(path, text),
            Self::Movingai => movingai::read(text),
            Self::Iplan => iplan::read(text),
            Self::Pcf => pcf::read(path, text, options),
            Self::Geojson => geojson::read(text, options),
            Self::Osm => osm::read(text, options),
        }
    }

    /// Warns about each option for tags or the globe if the format has neither.
    fn refuse_tags(self, options: &ReadOptions, problems: &mut Vec<Problem>) {
        if matches!(self, Self::Geojson | Self::Osm | Self::Pcf) {
            return;
        }
        let name = self.name();
        if !options.tags.is_empty() {
            let message =
                format!("a {name} has no tags: block, free and open gates have no effect");
            let help = "leave them out; they are for GeoJSON and OpenStreetMap";
            problems.push(Problem::warning(message).help(help));
        }
        if options.origin.is_some() {
            let message = format!("a {name} has its own coordinates: the origin has no effect");
            let help = "leave it out; it is for GeoJSON and OpenStreetMap";
            problems.push(Problem::warning(message).help(help));
        }
    }

    /// The format of a file: by its content, else by its extension.
    fn detect(path: &Path, text: &str) -> Option<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let extension = extension.unwrap_or("").to_ascii_lowercase();
        let by_content = Self::ALL.into_iter().find(|format| format.recognises(text));
        let by_name = |format: &Self| format.extensions().contains(&extension.as_str());
        by_content.or_else(|| Self::ALL.into_iter().find(by_name))
    }
}

/// The result of reading a map.
#[derive(Debug, Default)]
pub struct Loaded {
    /// What could be understood; `None` if the file cannot be read or its format is unknown. A map
    /// that comes with an error is incomplete.
    pub map: Option<Map>,
    /// The file's text, for excerpts; `None` for binary files.
    pub source: Option<Arc<Source>>,
    /// Every mistake, in the order of the file.
    pub problems: Vec<Problem>,
}

/// Reads a map and its mistakes.
pub fn read(path: &Path, options: &ReadOptions) -> (Option<Map>, Vec<Problem>) {
    let loaded = load(path, options);
    (loaded.map, loaded.problems)
}

/// Reads a map and keeps its text. The file is opened once, because a pipe cannot be read twice.
pub fn load(path: &Path, options: &ReadOptions) -> Loaded {
    match source::read_bytes(path) {
        Ok(bytes) => load_bytes(path, bytes, options),
        Err(problem) => Loaded { problems: vec![problem], ..Loaded::default() },
    }
}

/// As [`load`], for bytes that have been read already.
pub fn load_bytes(path: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Loaded {
    let mut loaded = read_bytes(path, bytes, options);
    if let Some(cells) = loaded.map.as_mut().and_then(|map| map.cells.as_mut()) {
        cells.unknown_as = options.unknown;
        loaded.problems.push(count(cells));
    }
    limit(&mut loaded.problems);
    loaded
}

fn read_bytes(path: &Path, bytes: Vec<u8>, options: &ReadOptions) -> Loaded {
    let refused = |problem| Loaded { problems: vec![problem], ..Loaded::default() };
    if let Some(problem) = foreign::refuse(path, &bytes, options.format.is_none()) {
        return refused(problem);
    }
    let bytes = match packed::unpack(path, bytes) {
        Ok(bytes) => bytes,
        Err(problem) => return refused(problem),
    };
    // The only binary format.
    if matches!(options.format, None | Some(Format::Osm)) && osm::is_binary(path, &bytes) {
        let (map, problems) = osm::read_binary(path, &bytes, options);
        return Loaded { map, problems, source: None };
    }
    let (text, mut problems) = match source::decode(path, bytes) {
        Ok(read) => read,
        Err(problem) => return refused(problem),
    };
    let source = Some(Arc::clone(&text));
    let Some(format) = options.format.or_else(|| Format::detect(path, &text.text)) else {
        problems.push(unknown_format(path));
        return Loaded { map: None, source, problems };
    };
    let (map, more) = format.read(path, &text, options);
    problems.extend(more);
    format.refuse_tags(options, &mut problems);
    Loaded { map, source, problems }
}

/// A note that counts a file's cells by kind.
fn count(cells: &CellMap) -> Problem {
    let here = cells.counts();
    let file = cells.turned_from.unwrap_or(here);
    let kinds = |Counts { free, occupied, unknown, .. }: Counts| {
        format!("{free} free, {occupied} occupied, {unknown} unknown")
    };
    let unknown_as = match cells.unknown_as {
        _ if file.unknown == 0 => "",
        Unknown::Obstacle => ", which count as obstacles",
        Unknown::Free => ", which count as free",
    };
    let turned = match cells.turned_from {
        Some(_) => {
            format!("; rotated by its yaw {} x {}: {}", here.columns, here.rows, kinds(here))
        }
        None => String::new(),
    };
    let (columns, rows, side) = (file.columns, file.rows, cells.resolution_m);
    let kinds = kinds(file);
    Problem::note(format!(
        "the file has {columns} x {rows} cells of {side} m: {kinds}{unknown_as}{turned}"
    ))
}

fn unknown_format(path: &Path) -> Problem {
    let known: Vec<String> = Format::ALL
        .iter()
        .map(|format| format!("{} (.{})", format.name(), format.extensions()[0]))
        .collect();
    Problem::error(format!("{} is not a map in a known format", path.display()))
        .help(format!("the formats are: {}", known.join(", ")))
}

/// A map as short text, the expectation of the readers' tests.
#[cfg(test)]
pub(crate) mod dump;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_can_be_named() {
        for format in Format::ALL {
            assert_eq!(Format::of_word(format.word()), Some(format));
        }
        assert_eq!(Format::WORDS.len(), Format::ALL.len());
    }

    fn check(name: &str, text: &str, expected: Option<Format>) {
        assert_eq!(Format::detect(Path::new(name), text), expected, "{name} {text:?}");
    }

    #[test]
    fn content_decides_and_the_extension_helps() {
        let overlay = "ORIGIN 0 0\nCONTROL MEASURES:\nPP a 1 2\n";
        let opar = "Farm\n51.0\n7.0\n3\n0\n0\n10\n0\n0\n10\n1\n1\n14\n0.45\n0.284\n1\n1.33\n0.284\n0.588\n";
        check("a.ovl", overlay, Some(Format::Overlay));
        check("a.opar", opar, Some(Format::Opar));
        check("a.opar", overlay, Some(Format::Overlay));
        check("a.ovl", opar, Some(Format::Opar));
        check("a", opar, Some(Format::Opar));
        check("a.OVL", "-- nothing yet", Some(Format::Overlay));
        check("a.opar", "nothing yet", Some(Format::Opar));
        check("a.txt", "Dear reader,\n", None);
        check("a", "", None);
    }

    #[test]
    fn a_file_in_no_known_format_is_refused_with_the_list() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("letter.txt");
        std::fs::write(&path, "Dear reader,\n").unwrap();
        let (map, problems) = read(&path, &ReadOptions::default());
        assert!(map.is_none());
        assert!(problems[0].message.ends_with("letter.txt is not a map in a known format"));
        assert!(problems[0].help.as_ref().unwrap().contains("MissionLab overlay (.ovl)"));
    }
}
