//! The binary rule: a straight line is free, or the link is lost.

use super::Settings;
use super::scene::{Ray, Scene};
use crate::model::{Map, Point, Role};

/// Whether two antennas see each other in plan view (W, section 3): the rule of the experiments.
///
/// Heights do not matter, except that a feature of height 0 does not break a line.
#[derive(Clone, Debug)]
pub struct Sight {
    scene: Scene,
}

impl Sight {
    /// Prepares the shapes of a map. Obstacles break a line, unless they are small; areas that
    /// weaken radio do so if the settings say so.
    pub fn of(map: &Map, settings: &Settings) -> Self {
        let scene = Scene::of(map, settings, |feature| match feature.role {
            Role::Obstacle => true,
            Role::Attenuating => settings.areas_block,
            Role::Zone => false,
        });
        Self { scene }
    }

    /// Whether the straight line between two points, metres, is free. A point sees itself.
    pub fn is_linked(&self, a: Point, b: Point) -> bool {
        let (ray, _) = Ray::between(a, b);
        !self.scene.is_met_by(&ray)
    }
}
