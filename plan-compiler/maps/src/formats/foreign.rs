//! Common files that are not maps for this program: names each and how to convert it.
//!
//! The content decides; the name decides only where no map format recognises the content. Nothing
//! is converted here: a person must decide what a placemark or a mesh means to a robot.

use super::{Format, ros};
use crate::problem::Problem;
use crate::terminal::quoted;
use std::path::Path;

/// Bytes from the start of a file that are examined.
const HEAD_BYTES: usize = 4096;
/// How every plan blob starts.
const BLOB_START: &[u8] = b"WAYFIELD";
/// How every UF2 block starts.
const UF2_START: &[u8] = b"UF2\n";

/// `UF2` or `Intel HEX` if the file is one: a plan blob in a form that carries its address.
pub fn wrapped(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(UF2_START) {
        Some("UF2")
    } else {
        bytes.starts_with(b":").then_some("Intel HEX")
    }
}

/// A kind of file.
struct Kind {
    /// Its common name, after "is".
    what: &'static str,
    /// Extensions of its files, in lower case.
    extensions: &'static [&'static str],
    /// Whether a file begins like one.
    begins: fn(&Head<'_>) -> bool,
    /// How to fix it; `{in}` is the file's name, and `{out.png}` that of a file of another kind.
    help: &'static str,
}

/// The start of a file.
struct Head<'a> {
    bytes: &'a [u8],
    /// The same as text, without leading white space.
    text: String,
}

impl<'a> Head<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        let bytes = &bytes[..bytes.len().min(HEAD_BYTES)];
        let text = String::from_utf8_lossy(bytes);
        Self { bytes, text: text.trim_start_matches('\u{feff}').trim_start().to_owned() }
    }

    fn has(&self, magic: &[u8]) -> bool {
        self.bytes.starts_with(magic)
    }

    fn starts_with_text(&self, start: &str) -> bool {
        self.text.get(..start.len()).is_some_and(|text| text.eq_ignore_ascii_case(start))
    }

    /// Whether it is XML with this root element.
    fn is_xml(&self, root: &str) -> bool {
        let mut rest = self.text.as_str();
        // A declaration, comments and a document type may come first.
        while rest.starts_with("<?") || rest.starts_with("<!") {
            let end = if rest.starts_with("<!--") { "-->" } else { ">" };
            let Some(at) = rest.find(end) else { return false };
            rest = rest[at + end.len()..].trim_start();
        }
        let name = rest.strip_prefix('<').unwrap_or_default();
        let end = name.find(|c: char| c.is_whitespace() || matches!(c, '>' | '/'));
        let name = &name[..end.unwrap_or(name.len())];
        name.rsplit(':').next().is_some_and(|name| name.eq_ignore_ascii_case(root))
    }

    /// Whether it is a JSON object with this text in its head.
    fn is_json_with(&self, part: &str) -> bool {
        let squeezed = || self.text.split_whitespace().collect::<String>();
        self.text.starts_with('{') && squeezed().contains(part)
    }
}

const OGR: &str = "convert it with `ogr2ogr -f GeoJSON {out.geojson} {in}`, and give each \
                   obstacle a property such as `building`";
const ROUTE: &str = "build a map of the place, and give its points as goals: --goal NAME=X,Y";
const PICTURE: &str = "save it as {out.png} with obstacles black and free ground white, \
                       and describe it in a YAML file: image, resolution, origin, thresholds";
const SCAN: &str = "convert it to a grid first, for example with octomap_server, save that with \
                    map_saver, and build the YAML file";
const RECORDED: &str =
    "play it back into your SLAM, save the map with map_saver, and build the YAML file";
const MODEL: &str = "draw the walls as a MissionLab overlay (WALL NAME X Y X Y, metres), or save the grid that a \
                     robot sees in the simulator with map_saver";

/// The more easily mistaken last.
const KINDS: &[Kind] = &[
    Kind {
        what: "a mission trace",
        extensions: &["trace"],
        begins: |head| head.has(b"WAYTRACE"),
        help: "run `plan-compiler explain {in}` to see what happened",
    },
    Kind {
        what: "an array",
        extensions: &["npy", "npz"],
        begins: |head| head.has(b"\x93NUMPY"),
        help: "name the map that it was exported from; save a grid of your own as a PGM with a YAML \
               file",
    },
    Kind { what: "a KML file", extensions: &["kml"], begins: |head| head.is_xml("kml"), help: OGR },
    Kind { what: "a KMZ file", extensions: &["kmz"], begins: |_| false, help: OGR },
    Kind {
        what: "a GPX file, which is a route and not a map",
        extensions: &["gpx"],
        begins: |head| head.is_xml("gpx"),
        help: ROUTE,
    },
    Kind {
        what: "an autopilot's list of waypoints, which is a route and not a map",
        extensions: &["waypoints"],
        begins: |head| head.starts_with_text("QGC WPL"),
        help: ROUTE,
    },
    Kind {
        what: "a QGroundControl plan, which is a route and not a map",
        extensions: &["plan"],
        begins: |head| {
            head.is_json_with("\"groundStation\":") || head.is_json_with("\"fileType\":\"Plan\"")
        },
        help: ROUTE,
    },
    Kind {
        what: "TopoJSON",
        extensions: &["topojson"],
        begins: |head| head.is_json_with("\"type\":\"Topology\""),
        help: OGR,
    },
    Kind {
        what: "a Shapefile",
        extensions: &["shp", "shx", "dbf"],
        begins: |head| head.has(b"\0\0\x27\x0a"),
        help: OGR,
    },
    Kind {
        what: "a DXF drawing",
        extensions: &["dxf"],
        begins: |head| {
            let mut lines = head.text.lines().map(str::trim);
            let first = (lines.next(), lines.next());
            first == (Some("0"), Some("SECTION")) || head.starts_with_text("AutoCAD Binary DXF")
        },
        help: "export its walls as GeoJSON in degrees, or draw them as a MissionLab overlay: WALL \
               NAME X Y X Y, metres",
    },
    Kind {
        what: "a DWG drawing",
        extensions: &["dwg"],
        begins: |head| head.has(b"AC10"),
        help: "export its walls as GeoJSON in degrees, or draw them as a MissionLab overlay: WALL \
               NAME X Y X Y, metres",
    },
    Kind {
        what: "an OctoMap octree",
        extensions: &["bt", "ot"],
        begins: |head| head.starts_with_text("# Octomap OcTree"),
        help: SCAN,
    },
    Kind {
        what: "a point cloud",
        extensions: &["pcd", "ply", "las", "laz", "e57"],
        begins: |head| head.starts_with_text("# .PCD") || head.has(b"ply\n") || head.has(b"LASF"),
        help: SCAN,
    },
    Kind {
        what: "a ROS recording",
        extensions: &["bag", "db3", "mcap"],
        begins: |head| head.has(b"#ROSBAG V") || head.has(b"\x89MCAP0\r\n"),
        help: RECORDED,
    },
    Kind {
        what: "a GeoPackage",
        extensions: &["gpkg"],
        begins: |head| head.has(b"SQLite format 3\0") && head.bytes.get(68..72) == Some(b"GPKG"),
        help: OGR,
    },
    Kind {
        what: "a database, perhaps a ROS recording",
        extensions: &["sqlite", "mbtiles"],
        begins: |head| head.has(b"SQLite format 3\0"),
        help: RECORDED,
    },
    Kind {
        what: "a simulator's world or model",
        extensions: &["world", "sdf", "urdf", "xacro", "dae", "wbt"],
        begins: |head| ["sdf", "gazebo", "robot", "COLLADA"].iter().any(|root| head.is_xml(root)),
        help: MODEL,
    },
    Kind {
        what: "a mesh",
        extensions: &["stl", "obj", "glb", "gltf"],
        begins: |head| {
            head.has(b"glTF")
                || (head.starts_with_text("solid") && head.text.contains("facet normal"))
        },
        help: MODEL,
    },
    Kind {
        what: "a TIFF image",
        extensions: &["tif", "tiff", "geotiff"],
        begins: |head| {
            [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| head.has(*magic))
        },
        help: "convert it with `gdal_translate -of PNG {in} {out.png}`, and describe it in a YAML \
               file: image, resolution, origin, thresholds",
    },
    Kind {
        what: "a picture in an unsupported format",
        extensions: &["jpg", "jpeg", "webp", "bmp", "gif", "heic", "avif", "jxl"],
        begins: |head| {
            let is_bmp = head.has(b"BM") && head.bytes.get(6..10) == Some(&[0; 4]);
            let is_webp = head.has(b"RIFF") && head.bytes.get(8..12) == Some(b"WEBP");
            is_bmp || is_webp || head.has(b"\xff\xd8\xff") || head.has(b"GIF8")
        },
        help: PICTURE,
    },
    Kind {
        what: "a vector picture",
        extensions: &["svg", "pdf", "eps", "ai"],
        begins: |head| head.is_xml("svg") || head.has(b"%PDF") || head.has(b"%!PS"),
        help: PICTURE,
    },
    Kind {
        what: "a MovingAI scenario",
        extensions: &["scen"],
        begins: |head| head.starts_with_text("version 1") && head.text.contains(".map"),
        help: "name the map that it is for; its goals are given as --goal NAME=X,Y",
    },
    Kind {
        what: "a web page",
        extensions: &["html", "htm"],
        begins: |head| head.starts_with_text("<!doctype html") || head.starts_with_text("<html"),
        help: "the download may have failed: open it in a browser to see why",
    },
    Kind {
        what: "a zip archive",
        extensions: &["zip", "7z", "rar", "tar"],
        begins: |head| head.has(b"PK\x03\x04") || head.has(b"7z\xbc\xaf") || head.has(b"Rar!"),
        help: "unpack it, and name the map inside",
    },
];

/// An error that names a file which is not a map and how to convert it; `None` if it may be a map.
pub(super) fn refuse(path: &Path, bytes: &[u8], may_go_by_name: bool) -> Option<Problem> {
    if bytes.starts_with(BLOB_START) {
        let problem = Problem::error(format!("{} is a plan blob, not a map", path.display()));
        let help =
            "name the map that it was built from, or look into it with `plan-compiler inspect`";
        return Some(problem.help(help));
    }
    if let Some(problem) = ros::refuse_alone(path, bytes) {
        return Some(problem);
    }
    let head = Head::of(bytes);
    let named = |kind: &&Kind| {
        let extension = path.extension().map(|extension| extension.to_string_lossy());
        let extension = extension.unwrap_or_default().to_ascii_lowercase();
        kind.extensions.contains(&extension.as_str())
    };
    let by_name = || {
        let kind = KINDS.iter().find(named).filter(|_| may_go_by_name)?;
        let text = String::from_utf8_lossy(bytes);
        (!Format::ALL.iter().any(|format| format.recognises(&text))).then_some(kind)
    };
    let by_content = KINDS.iter().find(|kind| (kind.begins)(&head));
    // A KMZ is a zip archive: where two kinds fit, the name decides.
    let by_content = by_content.map(|kind| {
        let narrower = KINDS.iter().find(named);
        narrower.filter(|_| head.has(b"PK\x03\x04") || head.has(b"SQLite")).unwrap_or(kind)
    });
    if let Some(kind) = by_content.or_else(by_name) {
        let name = Path::new(path.file_name().unwrap_or(path.as_os_str()));
        let help = kind.help.replace("{out.geojson}", &quoted(&name.with_extension("geojson")));
        let help = help.replace("{out.png}", &quoted(&name.with_extension("png")));
        let help = help.replace("{in}", &quoted(name));
        return Some(Problem::error(format!("{} is {}", path.display(), kind.what)).help(help));
    }
    wrapped(bytes).map(|kind| {
        Problem::error(format!("{} is {kind}, which is for flashing only", path.display()))
            .help("name the map that its plans were built from")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(name: &str, bytes: &[u8], what: &str, help: &str) {
        let problem = refuse(Path::new(name), bytes, true).unwrap_or_else(|| panic!("{name}"));
        assert!(problem.message.contains(what), "{name}: {problem}");
        let got = problem.help.expect("advice");
        assert!(got.contains(help), "{name}: {got}");
    }

    #[test]
    fn common_files_are_named_with_help() {
        let kml = b"<?xml version=\"1.0\"?>\n<!-- <osm> -->\n<kml xmlns=\"x\"><Document/></kml>";
        check("yard.kml", kml, "a KML file", "ogr2ogr -f GeoJSON yard.geojson yard.kml");
        check("yard.xml", kml, "a KML file", "ogr2ogr -f GeoJSON yard.geojson yard.xml");
        check("yard.kmz", b"PK\x03\x04", "a KMZ file", "ogr2ogr");
        check("a.gpx", b"<gpx version=\"1.1\">", "a GPX file", "--goal");
        check("a.txt", b"QGC WPL 110\n0\t1\t0", "waypoints", "--goal");
        check("a.plan", b"{\n \"fileType\" : \"Plan\",\n", "QGroundControl", "--goal");
        check("a.json", b"{\"type\": \"Topology\"}", "TopoJSON", "ogr2ogr");
        check("a.jpg", b"\xff\xd8\xff\xe0", "a picture", "a.png");
        check("a", b"RIFF\0\0\0\0WEBPVP8 ", "a picture", "YAML");
        check("a", b"BM\x36\x10\0\0\0\0\0\0", "a picture", "YAML");
        check("a.tiff", b"II*\0", "a TIFF image", "gdal_translate -of PNG a.tiff a.png");
        check("a", b"\0\0\x27\x0a", "a Shapefile", "ogr2ogr");
        check("a.dbf", b"\x03\x7a", "a Shapefile", "ogr2ogr");
        check("a", b"  0\r\nSECTION\r\n  2\r\nHEADER", "DXF", "WALL");
        check("a", b"solid a\n facet normal 0 0 1", "a mesh", "map_saver");
        check("a.stl", &[0; 84], "a mesh", "map_saver");
        check("a.bt", b"# Octomap OcTree binary file\n", "octree", "octomap_server");
        check("a.pcd", b"# .PCD v0.7", "a point cloud", "octomap_server");
        check("a.bag", b"#ROSBAG V2.0\n", "recording", "SLAM");
        check("a.db3", b"SQLite format 3\0", "a ROS recording", "SLAM");
        check("a.world", b"<?xml version='1.0'?><sdf version='1.6'>", "simulator", "WALL");
        check("a.npy", b"\x93NUMPY\x01\0", "an array", "PGM");
        check("a.bin", BLOB_START, "a plan blob", "inspect");
        check("a.hex", b":020000042000DA", "for flashing only", "built from");
        check("a.scen", b"version 1\n0\tarena.map\t49", "a MovingAI scenario", "--goal");
        check("a.osm", b"<!DOCTYPE html><html>", "a web page", "browser");
        check("a.trace", b"WAYTRACE\x01\0", "a mission trace", "explain a.trace");
    }

    #[test]
    fn a_map_by_content_is_accepted_under_any_name() {
        let overlay = b"ORIGIN 0 0\nCONTROL MEASURES:\nPP a 1 2\n";
        for name in ["a.ovl", "a.world", "a.plan", "a"] {
            assert!(refuse(Path::new(name), overlay, true).is_none(), "{name}");
        }
        assert!(refuse(Path::new("a.kml"), b"whatever", false).is_none());
        assert!(refuse(Path::new("BM.ovl"), b"BM a letter", true).is_none());
    }
}
