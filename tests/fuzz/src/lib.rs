//! Fuzz targets: every reader of text and bytes, and the code that uses its results.
//!
//! A [`Target`] takes any bytes. It must neither panic nor violate an assertion. A map is read,
//! compiled and verified; a mission is compiled, checked, drawn and run; a blob is queried in full
//! and then run for some ticks. The same targets run in two ways:
//!
//! - `cargo test -p fuzz`, on any toolchain: the corpus and a bounded number of mutations of it,
//!   the same ones each time.
//! - coverage-guided by `cargo fuzz` and libFuzzer, without a time limit; see this crate's
//!   README.md.
//!
//! Invariants: every reader has a target (a test holds the list); a target does bounded work, so a
//! slow input is a finding; all seeds are the project's own.
//!
//! Deliberately absent: input from pipes and folders, which the tests of the command line cover.

#[path = "../../../plan-compiler/src/cli/mod.rs"]
#[allow(dead_code, unused_imports, reason = "only the parser is used")]
mod cli;

#[path = "../../../plan-compiler/src/commands/query/points.rs"]
mod points;

mod maps;
mod mutate;
mod robot;
mod seeds;
mod texts;

pub use mutate::Mutations;
pub use robot::checksum;

/// Longer inputs are skipped: they exercise no further code.
pub const MAX_INPUT_BYTES: usize = 64 << 10;

/// A reader of bytes from outside, with the code that uses its results.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the target and of its folder in the corpus.
    pub name: &'static str,
    read: fn(&[u8]),
}

/// All targets.
pub const TARGETS: &[Target] = &[
    Target { name: "overlay", read: maps::overlay },
    Target { name: "opar", read: maps::opar },
    Target { name: "ros_yaml", read: maps::ros_yaml },
    Target { name: "ros_image", read: maps::ros_image },
    Target { name: "movingai", read: maps::movingai },
    Target { name: "iplan", read: maps::iplan },
    Target { name: "pcf", read: maps::pcf },
    Target { name: "geojson", read: maps::geojson },
    Target { name: "osm_xml", read: maps::osm_xml },
    Target { name: "osm_pbf", read: maps::osm_pbf },
    Target { name: "any_map", read: maps::any },
    Target { name: "mission", read: texts::mission },
    Target { name: "graph", read: texts::graph },
    Target { name: "world", read: texts::world },
    Target { name: "command_line", read: texts::command_line },
    Target { name: "points", read: texts::points },
    Target { name: "blob", read: robot::blob },
    Target { name: "gps", read: robot::gps },
    Target { name: "link", read: robot::link },
    Target { name: "lockstep", read: robot::lockstep },
    Target { name: "trace", read: robot::trace },
];

impl Target {
    /// The target with this name, if it exists.
    pub fn find(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Runs the target on some bytes. Panics if it finds a mistake.
    pub fn run(&self, bytes: &[u8]) {
        if bytes.len() <= MAX_INPUT_BYTES {
            (self.read)(bytes);
        }
    }

    /// The seeds: the files of its corpus, the shipped maps and missions of its format, and inputs
    /// built by code because they change with the robot's formats.
    pub fn seeds(&self) -> Vec<Vec<u8>> {
        seeds::of(self.name)
    }
}
