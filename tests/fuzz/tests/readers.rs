//! Every reader of text or bytes has a fuzz target, named in the table of this file.

use fuzz::Target;
use std::path::Path;

/// Files with functions that read input from outside, and the target that calls them.
const READERS: &[(&str, &str)] = &[
    ("firmware/runtime/src/blob.rs", "blob"),
    ("firmware/runtime/src/gps.rs", "gps"),
    ("plan-compiler/src/behaviours/graph_text.rs", "graph"),
    ("plan-compiler/src/behaviours/language.rs", "mission"),
    ("plan-compiler/src/cli/words.rs", "command_line"),
    ("plan-compiler/maps/src/formats.rs", "any_map"),
    ("plan-compiler/maps/src/formats/geojson.rs", "geojson"),
    ("plan-compiler/maps/src/formats/iplan.rs", "iplan"),
    ("plan-compiler/maps/src/formats/movingai.rs", "movingai"),
    ("plan-compiler/maps/src/formats/opar.rs", "opar"),
    ("plan-compiler/maps/src/formats/opar/options.rs", "command_line"),
    ("plan-compiler/maps/src/formats/osm.rs", "osm_xml"),
    ("plan-compiler/maps/src/formats/osm.rs", "osm_pbf"),
    ("plan-compiler/maps/src/formats/overlay.rs", "overlay"),
    ("plan-compiler/maps/src/formats/pcf.rs", "pcf"),
    ("plan-compiler/maps/src/formats/ros.rs", "ros_image"),
    ("plan-compiler/maps/src/formats/ros.rs", "ros_yaml"),
    ("plan-compiler/maps/src/formats/tags/rules.rs", "command_line"),
    ("plan-compiler/src/mission.rs", "mission"),
    ("plan-compiler/maps/src/source.rs", "any_map"),
    ("plan-compiler/src/trace.rs", "trace"),
    ("shared/plan-format/src/mission/mod.rs", "blob"),
    ("shared/plan-format/src/blob.rs", "blob"),
    ("shared/robot-io/src/packet.rs", "link"),
    ("shared/robot-io/src/record.rs", "lockstep"),
    ("tests/sim/src/world_file.rs", "world"),
];

/// Names of functions that read.
const VERBS: &[&str] = &[
    "parse",
    "parse_paced",
    "parse_exact",
    "read",
    "read_bytes",
    "read_text",
    "from_bytes",
    "decode",
    "push",
    "load",
    "load_paced",
    "beside",
    "from_str",
];

/// Types of their parameters.
const INPUTS: &[&str] = &["u8", "&str", "Source", "&Path"];

#[test]
fn every_reader_has_a_fuzz_target() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = Vec::new();
    for top in
        ["shared", "firmware", "plan-compiler/src", "plan-compiler/maps/src", "tests/sim/src"]
    {
        visit(&root, &root.join(top), &mut found);
    }
    found.sort();
    found.dedup();
    let all = found.clone();
    let has_row = |file: &String| READERS.iter().any(|(reader, _)| reader == file);
    found.retain(|file| !has_row(file));
    assert!(
        found.is_empty(),
        "these files read input from outside: give each a fuzz target and a row here: {found:?}"
    );
    for (file, target) in READERS {
        assert!(all.iter().any(|reader| reader == file), "{file} no longer has a reader");
        assert!(Target::find(target).is_some(), "the target {target} does not exist");
    }
}

/// Adds the files below a folder that contain a reader.
fn visit(root: &Path, folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder is readable").flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if path.is_dir() && name != "tests" && name != "target" {
            visit(root, &path, found);
        } else if name.ends_with(".rs") && name != "tests.rs" {
            let text = std::fs::read_to_string(&path).expect("a source file is readable");
            if text.split("#[cfg(test)]\nmod tests {").next().is_some_and(reads) {
                let file = path.strip_prefix(root).expect("below the root");
                found.push(file.to_string_lossy().replace('\\', "/"));
            }
        }
    }
}

/// Whether a source text has a public function with the name and a parameter of a reader.
fn reads(source: &str) -> bool {
    source.split("fn ").zip(source.split("fn ").skip(1)).any(|(before, function)| {
        let (signature, _) = function.split_once('{').unwrap_or((function, ""));
        let name = signature.split(['(', '<']).next().unwrap_or("");
        let is_open = before.ends_with("pub ") || name == "from_str";
        is_open && VERBS.contains(&name) && INPUTS.iter().any(|input| signature.contains(input))
    })
}
