//! Fuzz targets: every reader of text and bytes, with what follows it.
//!
//! A [`Target`] takes any bytes and must come back: no panic, no broken promise. A map is read,
//! compiled and proved; a mission is compiled, looked through, drawn and driven; a blob is asked for
//! everything and driven by. The same targets run in two ways:
//!
//! - `cargo test -p fuzz`, on any toolchain: the corpus and a bounded number of mutations of it,
//!   the same ones each time.
//! - coverage-guided by `cargo fuzz` and libFuzzer, for as long as one likes; README.md beside this
//!   crate says how.
//!
//! Invariants: no reader is without a target (a test holds the list); a target does bounded work,
//! so that what takes long is a finding; all seeds are the project's own.
//!
//! Deliberately absent: the reading of files from odd places (pipes, folders), which the tests of
//! the command line cover.

#[path = "../../../plan-compiler/src/cli/mod.rs"]
#[allow(dead_code, reason = "only what reads words is used")]
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

/// Longer inputs say nothing that shorter ones do not.
pub const MAX_INPUT_BYTES: usize = 64 << 10;

/// One thing that takes bytes from outside.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, and the folder of its corpus.
    pub name: &'static str,
    read: fn(&[u8]),
}

/// All of them.
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
    /// The target of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Runs it on some bytes; returns if nothing is wrong.
    pub fn run(&self, bytes: &[u8]) {
        if bytes.len() <= MAX_INPUT_BYTES {
            (self.read)(bytes);
        }
    }

    /// What it starts from: the files of its corpus, the maps that ship where it reads such, and
    /// what is made by code because it changes with the formats.
    pub fn seeds(&self) -> Vec<Vec<u8>> {
        seeds::of(self.name)
    }
}
