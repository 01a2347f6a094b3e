//! What may differ from the paper's experiment: settings that break a finding, and conditions that
//! the paper assumes away (W, section 6).

use maps::{Map, Role, Shape};
use plan_compiler::comms::Need;
use plan_compiler::mission::{Goal, GoalAt, Mission, RadioRule};
use sim::placement::Placement;
use sim::{
    Channel, Conditions, Difference, Fault, PlannedFault, RadioSettings, ReceiverSettings,
    SensorSettings,
};

use super::field::POSTS;

/// A turn limit that limits nothing, rad/s.
const ANY_TURN_RADPS: f32 = 4.0;
/// A base speed at which every vector, however short, gives the highest speed, m/s.
const ANY_SPEED_MPS: f32 = 50.0;
/// Where the blocks of the attenuating area end in the east if it is open there, metres: as far from
/// the houses as in the west.
const OPEN_EAST_M: f64 = 216.0;
/// When the robot in the middle is lost, seconds.
const LOST_AFTER_S: f64 = 60.0;

/// Where radio must reach if the attenuating area is computed, and by how much, dB: two masts in the
/// western corners, in view of all the way around the blocks.
const MASTS: [(&str, [f64; 2]); 2] = [("south", [17.0, 20.0]), ("north", [17.0, 246.0])];
const MARGIN_DB: f64 = 20.0;

/// A condition beyond the paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its name.
    pub name: String,
    /// What varies, with its unit, and its value; `None` if it is not a number.
    pub axis: Option<(&'static str, f64)>,
    /// What it changes.
    pub variation: Variation,
}

/// Changes of the experiment; by default none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// Number of posts.
    pub posts: usize,
    /// Whether the robots turn as fast as they like.
    pub turns_freely: bool,
    /// Whether the length of the blended vector does not matter.
    pub is_constant_speed: bool,
    /// Whether all robots have the goal of the one in the middle.
    pub has_common_goal: bool,
    /// Whether each robot draws its own start.
    pub starts_apart: bool,
    /// Whether there is a way round the attenuating area on both sides.
    pub is_open: bool,
    /// Whether robots of the serial row only wait, whatever happens.
    pub waits_only: bool,
    /// Whether the attenuating area is computed from the radio's reach, not drawn by hand.
    pub is_computed: bool,
    /// Standard deviation of a fix, metres; `None` for sensors without error.
    pub gps_sigma_m: Option<f64>,
    /// How far the true obstacles lie east of where the map shows them, metres.
    pub shift_m: f64,
    /// Share of the posts that the map lacks.
    pub unmapped: f64,
    /// Whether the robot in the middle stops for good.
    pub loses_one: bool,
    /// The radio.
    pub radio: RadioSettings,
}

impl Default for Variation {
    fn default() -> Self {
        Self {
            posts: POSTS,
            turns_freely: false,
            is_constant_speed: false,
            has_common_goal: false,
            starts_apart: false,
            is_open: false,
            waits_only: false,
            is_computed: false,
            gps_sigma_m: None,
            shift_m: 0.0,
            unmapped: 0.0,
            loses_one: false,
            radio: RadioSettings::default(),
        }
    }
}

impl Variation {
    /// Settings that break one finding each, and so show on what it depends.
    pub fn variants() -> Vec<(&'static str, Self)> {
        let usual = Self::default();
        vec![
            ("no-turn-limit", Self { turns_freely: true, ..usual }),
            ("constant-speed", Self { is_constant_speed: true, ..usual }),
            ("no-posts", Self { posts: 0, ..usual }),
            ("common-goal", Self { has_common_goal: true, ..usual }),
            ("independent-starts", Self { starts_apart: true, ..usual }),
            ("open-area", Self { is_open: true, ..usual }),
            ("waits-only", Self { waits_only: true, ..usual }),
        ]
    }

    /// The variant with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::variants().into_iter().find(|(known, _)| *known == name).map(|(_, variant)| variant)
    }

    /// The conditions beyond the paper.
    pub fn beyond() -> Vec<Condition> {
        let usual = Self::default();
        let at = |axis: &'static str, value: f64, variation| Condition {
            name: format!("{axis} {value}"),
            axis: Some((axis, value)),
            variation,
        };
        let named = |name: &str, variation| Condition { name: name.into(), axis: None, variation };
        let shift = |shift_m| at("map shift, m", shift_m, Self { shift_m, ..usual });
        let gps =
            |sigma_m| at("GPS sigma, m", sigma_m, Self { gps_sigma_m: Some(sigma_m), ..usual });
        let posts = |unmapped| at("unmapped posts, share", unmapped, Self { unmapped, ..usual });
        let worse = RadioSettings { loss: 0.5, delay_s: 0.5, ..usual.radio };
        let conditions = [0.5, 1.0, 2.0, 4.0].map(shift).into_iter();
        let conditions = conditions.chain([0.5, 1.0, 2.0, 5.0].map(gps));
        let conditions = conditions.chain([0.1, 0.3].map(posts));
        let others = [
            named("one robot lost", Self { loses_one: true, ..usual }),
            named("half the packets lost, late", Self { radio: worse, ..usual }),
            named("attenuating area computed", Self { is_computed: true, ..usual }),
        ];
        conditions.chain(others).collect()
    }

    /// Changes the parameters and the goals of a robot's mission.
    pub(super) fn change_mission(&self, mission: &mut Mission, middle: &[(String, Vec<GoalAt>)]) {
        let vehicle = &mut mission.parameters.vehicle;
        if self.turns_freely {
            vehicle.max_turn_rate_radps = ANY_TURN_RADPS;
        }
        if self.is_constant_speed {
            vehicle.max_speed_mps = vehicle.base_speed_mps;
            vehicle.base_speed_mps = ANY_SPEED_MPS;
        }
        if self.is_computed {
            let place = |(name, at): (&str, [f64; 2])| Goal {
                name: name.to_owned(),
                at: vec![GoalAt::Position(at)],
                layers: None,
                place: None,
            };
            mission.radio = Some(RadioRule {
                threshold_db: MARGIN_DB,
                need: Need::Any,
                places: MASTS.map(place).into(),
                ..RadioRule::default()
            });
        }
        if self.has_common_goal {
            for goal in mission.goals.iter_mut().flatten() {
                let common = middle.iter().find(|(name, _)| *name == goal.name && name == "goal");
                if let Some((_, at)) = common {
                    goal.at = at.clone();
                }
            }
        }
    }

    /// Opens the attenuating area if it is to be open, and takes it away if it is to be computed.
    pub(super) fn change_map(&self, map: &mut Map) {
        if self.is_computed {
            map.features.retain(|area| area.role != Role::Attenuating);
        }
        if !self.is_open {
            return;
        }
        let areas = map.features.iter_mut().filter(|area| area.role == Role::Attenuating);
        for area in areas {
            if let Shape::Polygon(rings) = &mut area.shape {
                for [x, _] in rings.iter_mut().flatten() {
                    *x = x.min(OPEN_EAST_M);
                }
            }
        }
    }

    /// How the true world differs from the map.
    pub(super) fn difference(&self) -> Difference {
        let placement = Placement { shift: [self.shift_m, 0.0], ..Placement::HERE };
        Difference { placement, ..Difference::default() }
    }

    /// The sensors of a robot.
    pub(super) fn sensors(&self) -> SensorSettings {
        let Some(sigma_m) = self.gps_sigma_m else { return SensorSettings::PERFECT };
        let gps = ReceiverSettings { sigma_m, ..ReceiverSettings::ONE_METRE };
        SensorSettings { gps: Some(gps), ..SensorSettings::USUAL }
    }

    /// The conditions of a robot by its number.
    pub(super) fn conditions(&self, robot: usize) -> Conditions {
        let is_lost = self.loses_one && robot == 1;
        let stop = PlannedFault {
            channel: Channel::Actuators,
            fault: Fault::Drop { chance: 1.0 },
            window_s: LOST_AFTER_S..f64::INFINITY,
        };
        let faults = if is_lost { vec![stop] } else { Vec::new() };
        Conditions { faults, ..Conditions::default() }
    }
}
