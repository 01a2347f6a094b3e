//! What one layer adds as obstacles: features by their roles and names, and masks.

use crate::input::Input;
use crate::mission::{COMMS, Mask, PHYSICAL};
use maps::{Feature, Role};
use std::collections::HashSet;

/// What one layer adds as obstacles.
pub(super) struct Added<'a> {
    role: Option<Role>,
    areas: HashSet<&'a str>,
    pub(super) masks: Vec<&'a Mask>,
}

impl<'a> Added<'a> {
    pub(super) fn by(input: &Input<'a>, layer: &str) -> Self {
        let role = match layer {
            PHYSICAL => Some(Role::Obstacle),
            // Computed instead of drawn.
            COMMS if input.mission.radio.is_some() => None,
            COMMS => Some(Role::Attenuating),
            _ => None,
        };
        let rules = input.mission.layers.iter().filter(|rule| rule.name.name == layer);
        let areas = rules.flat_map(|rule| &rule.areas).map(|area| area.name.as_str()).collect();
        let masks = input.mission.masks.iter().filter(|mask| mask.layer == layer).collect();
        Self { role, areas, masks }
    }

    pub(super) fn adds(&self, feature: &Feature) -> bool {
        self.role == Some(feature.role) || self.areas.contains(feature.name.as_str())
    }
}
