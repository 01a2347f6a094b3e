//! What the mission file sets and the tick reads: gains, speeds, limits, policies.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The robot's parameters, carried by every blob. Plain data; [`Parameters::check`] holds
/// for every value that a reader hands out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Parameters {
    /// Which parallel plan to follow, an index into the blob's plans.
    pub plan: u16,
    /// How advice and reactive schemas are weighed.
    pub gains: Gains,
    /// Which layer of the parallel plan to follow, and when that is decided.
    pub selection: Selection,
    /// How the robot moves.
    pub vehicle: Vehicle,
    /// Motor schemas.
    pub schemas: SchemaParameters,
    /// When a position is good enough.
    pub fixes: FixPolicy,
    /// What to do in trouble.
    pub trouble: TroublePolicy,
    /// What the loss of the operator's link does.
    pub link: LinkPolicy,
    /// Seed of the noise schema.
    pub seed: u32,
}

/// Weights of the blend `reactive (goal + avoid) + plan advice + noise wander`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Gains {
    /// Weight of move-to-goal and avoid-static-obstacle together, 0 ..= 1.
    pub reactive: f32,
    /// Weight of the advice, 0 ..= 1.
    pub plan: f32,
    /// Weight of the noise schema, 0 ..= 1.
    pub noise: f32,
}

impl Gains {
    /// Noise weight of all experiments of the paper (W, section 4).
    pub const NOISE: f32 = 0.11;
    /// Reactive behaviours alone: 100:0.
    pub const REACTIVE_ONLY: Self = Self { reactive: 1.0, plan: 0.0, noise: Self::NOISE };
    /// 66:34, mostly reactive.
    pub const MOSTLY_REACTIVE: Self = Self { reactive: 0.66, plan: 0.34, noise: Self::NOISE };
    /// 34:66, mostly plan.
    pub const MOSTLY_PLAN: Self = Self { reactive: 0.34, plan: 0.66, noise: Self::NOISE };
    /// 0:100, the advice alone.
    pub const PLAN_ONLY: Self = Self { reactive: 0.0, plan: 1.0, noise: Self::NOISE };
}

/// Which layer of a parallel plan is followed (W, section 2.3): the most constrained one
/// that has a route from here, and the position is looked at ...
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Selection {
    /// ... once, at the start.
    Static,
    /// ... every tick, switching back too.
    Dynamic,
}

/// The body that the commands are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Steering {
    /// Turns on the spot: differential drive or skid steer.
    Differential,
    /// Car-like: never turns tighter than the minimum radius.
    Ackermann,
    /// Needs way on to turn, and drifts: never stops to turn.
    Boat,
}

/// How the robot moves. SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Vehicle {
    /// Kind of steering.
    pub steering: Steering,
    /// The body fits in a circle of this radius about its centre, metres.
    pub radius_m: f32,
    /// Speed for a blended vector of length 1, m/s.
    pub base_speed_mps: f32,
    /// Never faster than this, m/s.
    pub max_speed_mps: f32,
    /// Speed where obstacles repel hard, m/s.
    pub cautious_speed_mps: f32,
    /// Never turns faster than this, rad/s.
    pub max_turn_rate_radps: f32,
    /// Smallest turning circle, metres; for Ackermann steering.
    pub min_turn_radius_m: f32,
    /// Motion towards any range reading nearer to the body than this is stopped, metres.
    pub stop_distance_m: f32,
    /// Creep straight ahead while the heading is not yet known.
    pub may_creep: bool,
}

/// Settings of the motor schemas. Metres unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SchemaParameters {
    /// Gain of move-to-goal within the reactive part.
    pub goal_gain: f32,
    /// Gain of avoid-static-obstacle within the reactive part.
    pub avoid_gain: f32,
    /// Beyond the margin, an obstacle repels up to this distance.
    pub avoid_sphere_m: f32,
    /// An obstacle this near to the body repels at full strength.
    pub avoid_margin_m: f32,
    /// The goal is reached within this distance.
    pub goal_tolerance_m: f32,
    /// Ticks for which the noise schema holds a heading.
    pub noise_persistence_ticks: u16,
}

/// When a GPS fix is good enough to be used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FixPolicy {
    /// A fix older than this is stale, microseconds.
    pub stale_after_us: u32,
    /// A fix that is less accurate than this is refused, millimetres.
    pub max_accuracy_mm: u32,
    /// A fix that implies a jump faster than this is refused, m/s.
    pub max_jump_mps: f32,
}

/// What to do when a part of the controller's information is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum OnTrouble {
    /// Stand still.
    Stop,
    /// Drive by the reactive schemas alone.
    Reactive,
}

/// What to do in each kind of trouble.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TroublePolicy {
    /// The position is outside the map.
    pub off_map: OnTrouble,
    /// No layer has a route from here.
    pub no_route: OnTrouble,
}

/// What an armed robot does when the operator falls silent. A robot that was driven by hand
/// stands still and is no longer armed, whatever is set here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum OnLinkLoss {
    /// Go on with the mission: for plans that lead out of the radio's range.
    Continue,
    /// Stand still, no longer armed.
    Disarm,
}

/// When the operator's link counts as lost, and what that does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LinkPolicy {
    /// The link is lost when nothing was heard for longer than this, microseconds.
    pub timeout_us: u32,
    /// What the loss does.
    pub on_loss: OnLinkLoss,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            plan: 0,
            gains: Gains::MOSTLY_PLAN,
            selection: Selection::Static,
            vehicle: Vehicle {
                steering: Steering::Differential,
                radius_m: 0.3,
                base_speed_mps: 1.4,
                max_speed_mps: 1.6,
                cautious_speed_mps: 0.3,
                max_turn_rate_radps: 1.0,
                min_turn_radius_m: 0.0,
                stop_distance_m: 0.3,
                may_creep: true,
            },
            schemas: SchemaParameters {
                goal_gain: 1.0,
                avoid_gain: 1.0,
                avoid_sphere_m: 5.0,
                avoid_margin_m: 0.5,
                goal_tolerance_m: 1.0,
                noise_persistence_ticks: 10,
            },
            fixes: FixPolicy {
                stale_after_us: 2_000_000,
                max_accuracy_mm: 5_000,
                max_jump_mps: 15.0,
            },
            trouble: TroublePolicy { off_map: OnTrouble::Stop, no_route: OnTrouble::Stop },
            link: LinkPolicy { timeout_us: 1_000_000, on_loss: OnLinkLoss::Continue },
            seed: 1,
        }
    }
}

impl Parameters {
    /// The name of the first number that is out of its range, with the range; `None` when
    /// all are fine. One table serves the compiler's message and the reader's refusal.
    pub fn check(&self) -> Option<(&'static str, f32, f32)> {
        let table = [
            ("gains.reactive", self.gains.reactive, 0.0, 1.0),
            ("gains.plan", self.gains.plan, 0.0, 1.0),
            ("gains.noise", self.gains.noise, 0.0, 1.0),
            ("vehicle.radius", self.vehicle.radius_m, 0.0, 100.0),
            ("vehicle.base_speed", self.vehicle.base_speed_mps, 0.0, 50.0),
            ("vehicle.max_speed", self.vehicle.max_speed_mps, 0.0, 50.0),
            ("vehicle.cautious_speed", self.vehicle.cautious_speed_mps, 0.0, 50.0),
            ("vehicle.max_turn_rate", self.vehicle.max_turn_rate_radps, 0.01, 20.0),
            ("vehicle.min_turn_radius", self.vehicle.min_turn_radius_m, 0.0, 100.0),
            ("vehicle.stop_distance", self.vehicle.stop_distance_m, 0.0, 100.0),
            ("schemas.goal_gain", self.schemas.goal_gain, 0.0, 100.0),
            ("schemas.avoid_gain", self.schemas.avoid_gain, 0.0, 100.0),
            ("schemas.avoid_sphere", self.schemas.avoid_sphere_m, 0.0, 1_000.0),
            ("schemas.avoid_margin", self.schemas.avoid_margin_m, 0.0, 1_000.0),
            ("schemas.goal_tolerance", self.schemas.goal_tolerance_m, 0.01, 1_000.0),
            ("fixes.max_jump", self.fixes.max_jump_mps, 0.1, 1_000.0),
            ("link.timeout", self.link.timeout_us as f32 / 1e6, 0.1, 3_600.0),
        ];
        table
            .into_iter()
            .find(|&(_, value, low, high)| !(low..=high).contains(&value))
            .map(|(name, _, low, high)| (name, low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_and_nan_is_not() {
        assert_eq!(Parameters::default().check(), None);
        let mut parameters = Parameters::default();
        parameters.vehicle.max_speed_mps = f32::NAN;
        assert_eq!(parameters.check(), Some(("vehicle.max_speed", 0.0, 50.0)));
    }

    #[test]
    fn the_links_timeout_has_a_lowest_and_a_highest_value() {
        for (timeout_us, is_fine) in
            [(99_999, false), (100_000, true), (3_600_000_000, true), (u32::MAX, false)]
        {
            let mut parameters = Parameters::default();
            parameters.link.timeout_us = timeout_us;
            assert_eq!(parameters.check().is_none(), is_fine, "{timeout_us}");
        }
    }
}
