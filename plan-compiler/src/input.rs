//! What is compiled: a map, a mission, and the options of the command line.

use crate::mission::{Goal, Mission};
use crate::search::Corners;
use maps::formats::ReadOptions;
use maps::{Map, Source};
use std::sync::Arc;

/// What the command line sets. Each option outranks the mission.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Goals. If there are any, those of mission and map are not used.
    pub goals: Vec<Goal>,
    /// The parallel plan that the robot follows.
    pub plan: Option<String>,
    /// The robot of the mission's team.
    pub robot: Option<String>,
    /// Side of a cell, metres.
    pub resolution_m: Option<f64>,
    /// How far obstacles are grown, metres.
    pub robot_radius_m: Option<f64>,
    /// Whether a diagonal step may pass a blocked cell beside it.
    pub corners: Option<Corners>,
    /// Whether closed walls are solid.
    pub fill_walls: bool,
    /// How the map was read. The blob keeps it, so that it can be compared with its map later.
    pub reading: ReadOptions,
    /// Limit of the searches' memory, bytes; 4 GiB by default.
    pub max_memory_bytes: Option<u64>,
}

/// What is compiled.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The map.
    pub map: &'a Map,
    /// The map's text, for excerpts.
    pub source: Option<&'a Arc<Source>>,
    /// The mission; the default one where there is none.
    pub mission: &'a Mission,
    /// The options of the command line.
    pub options: &'a Options,
}
