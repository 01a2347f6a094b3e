//! What the mission file sets and the tick reads: gains, speeds, limits, policies.

use crate::limits;
use crate::team::TeamPolicy;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The robot's parameters. Plain data; in a parsed blob, all are within the ranges of
/// [`Parameters::check`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Parameters {
    /// Index of the parallel plan to follow.
    pub plan: u16,
    /// Weights of the advice and the reactive schemas.
    pub gains: Gains,
    /// What the weights apply to.
    pub blend: Blend,
    /// When the layer of the parallel plan is chosen.
    pub selection: Selection,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Motor schemas.
    pub schemas: SchemaParameters,
    /// When a GPS fix is good enough.
    pub fixes: FixPolicy,
    /// What to do off the map or without a route.
    pub trouble: TroublePolicy,
    /// When the operator's link is lost, and what that does.
    pub link: LinkPolicy,
    /// When the range finder counts as silent.
    pub ranges: RangePolicy,
    /// When the robot makes no progress, and what that does.
    pub progress: ProgressPolicy,
    /// What the robot needs before it may drive, and where it may drive.
    pub safety: SafetyPolicy,
    /// The robot's team, and when a link to a mate counts as up.
    pub team: TeamPolicy,
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
    /// The default: the advice sets the speed, and obstacles at the margin balance half of it.
    /// With [`Blend::Route`] nothing else pulls, so little noise is enough.
    pub const ROUTE: Self = Self { reactive: 0.5, plan: 1.0, noise: 0.05 };
    /// Reactive behaviours alone: 100:0.
    pub const REACTIVE_ONLY: Self = Self { reactive: 1.0, plan: 0.0, noise: Self::NOISE };
    /// 66:34, mostly reactive.
    pub const MOSTLY_REACTIVE: Self = Self { reactive: 0.66, plan: 0.34, noise: Self::NOISE };
    /// 34:66, mostly plan.
    pub const MOSTLY_PLAN: Self = Self { reactive: 0.34, plan: 0.66, noise: Self::NOISE };
    /// 0:100, the advice alone.
    pub const PLAN_ONLY: Self = Self { reactive: 0.0, plan: 1.0, noise: Self::NOISE };
}

/// How advice, goal and obstacles are combined.
///
/// With advice, attraction straight to the goal pulls the robot through obstacles that the advice
/// leads around. So the default leaves it to the advice where there is any.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Blend {
    /// The goal attracts only without advice. The advice points to the route some way ahead. Closed
    /// directions are left aside, and detours lead out of dead ends that the map does not show.
    Route,
    /// The paper's blend: goal and obstacles act beside the advice, which is one of eight
    /// directions (W, section 4).
    Paper,
}

/// When and how the layer of a parallel plan is chosen (W, section 2.3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Selection {
    /// The most constrained layer with a route, chosen once, in the first cell from which any layer
    /// has one.
    Static,
    /// The most constrained layer with a route, chosen every tick, so the robot may return to an
    /// earlier layer.
    Dynamic,
    /// The layer with the lowest cost times its gain, chosen every tick.
    Gains(LayerGains),
}

/// What a metre of each layer counts when layers are compared (W, section 5: "cost functions ... with
/// tunable gains").
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct LayerGains {
    /// The gains, by the layers' ranks.
    pub gains: [LayerGain; limits::MAX_LAYERS],
    /// Another layer takes over only if its weighted cost is lower by this share, 0 ..= 1: costs
    /// that are nearly equal must not make the robot waver.
    pub hysteresis: f32,
}

/// What a metre of one layer counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct LayerGain {
    /// The gain, 0 ..= 1000.
    pub gain: f32,
    /// The input channel whose value replaces the gain while it has one.
    pub channel: Option<u8>,
}

impl Default for LayerGains {
    fn default() -> Self {
        Self {
            gains: [LayerGain { gain: 1.0, channel: None }; limits::MAX_LAYERS],
            hysteresis: 0.02,
        }
    }
}

impl LayerGains {
    /// Highest gain.
    pub const MOST: f32 = 1_000.0;

    /// The gains of a tick, by the layers' ranks, from the values of the input channels.
    pub fn of_channels(&self, channels: &[Option<f32>]) -> [f32; limits::MAX_LAYERS] {
        self.gains.map(|LayerGain { gain, channel }| {
            let channel = channel.and_then(|channel| channels.get(usize::from(channel)));
            let value = channel.copied().flatten().filter(|value| value.is_finite());
            value.unwrap_or(gain).clamp(0.0, Self::MOST)
        })
    }

    /// The name and the range of the first value that is out of its range.
    fn check(&self) -> Option<(&'static str, f32, f32)> {
        let gains = self.gains.iter().map(|gain| ("layer_gains", gain.gain, 0.0, Self::MOST));
        let last = (limits::MAX_CHANNELS - 1) as f32;
        let channels = self.gains.iter().filter_map(|gain| gain.channel);
        let channels = channels.map(|channel| ("layer_gains", f32::from(channel), 0.0, last));
        let hysteresis = ("selection_hysteresis", self.hysteresis, 0.0, 1.0);
        let mut all = gains.chain(channels).chain([hysteresis]);
        all.find(|&(_, value, low, high)| !(low..=high).contains(&value))
            .map(|(name, _, low, high)| (name, low, high))
    }
}

/// How the vehicle turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Steering {
    /// Turns on the spot: differential drive or skid steer.
    Differential,
    /// Car-like: never turns tighter than the minimum radius.
    Ackermann,
    /// Turns only while it moves, and drifts: never stops to turn.
    Boat,
}

/// When a vehicle that cannot turn on the spot drives astern to make room for a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum BackOut {
    /// Never: it waits before the obstacle.
    Never,
    /// Once its range sensors have seen something astern since the start.
    Seen,
    /// Always: its range sensors look all around.
    Always,
}

/// The vehicle's size and limits. SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Vehicle {
    /// Kind of steering.
    pub steering: Steering,
    /// Radius of the circle about its centre that contains the body, metres.
    pub radius_m: f32,
    /// Speed for a blended vector of length 1, m/s.
    pub base_speed_mps: f32,
    /// Maximum speed, m/s.
    pub max_speed_mps: f32,
    /// Speed where obstacles repel strongly, m/s.
    pub cautious_speed_mps: f32,
    /// Maximum turn rate, rad/s.
    pub max_turn_rate_radps: f32,
    /// Minimum turning radius, metres; for Ackermann steering.
    pub min_turn_radius_m: f32,
    /// Deceleration that the brakes give at least, m/s^2.
    pub braking_mps2: f32,
    /// Longest time from a range reading to the effect of the brakes, microseconds.
    pub latency_us: u32,
    /// Distance at which the range sensors see obstacles reliably, metres.
    pub reach_m: f32,
    /// The robot keeps this distance between its body and what it sees ahead, metres.
    pub stop_distance_m: f32,
    /// Whether to creep straight ahead while the heading is unknown.
    pub may_creep: bool,
    /// When to back out of a place without room to turn; not for differential steering.
    pub back_out: BackOut,
}

/// Settings of the motor schemas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SchemaParameters {
    /// Gain of move-to-goal within the reactive part.
    pub goal_gain: f32,
    /// Gain of avoid-static-obstacle within the reactive part.
    pub avoid_gain: f32,
    /// Beyond the margin, an obstacle repels up to this distance, metres.
    pub avoid_sphere_m: f32,
    /// Up to this distance from the body, an obstacle repels at full strength, metres.
    pub avoid_margin_m: f32,
    /// Gain of avoid-past within the reactive part.
    pub past_gain: f32,
    /// Places where the robot has just been repel up to this distance, metres.
    pub past_sphere_m: f32,
    /// With [`Blend::Route`], the advice points to the route this far ahead, metres.
    pub look_ahead_m: f32,
    /// With [`Blend::Route`], a robot behind an obstacle begins a detour after this time without
    /// progress, microseconds.
    pub detour_after_us: u32,
    /// The goal is reached within this distance, metres.
    pub goal_tolerance_m: f32,
    /// Ticks for which the noise schema keeps a heading.
    pub noise_persistence_ticks: u16,
}

/// When a GPS fix is good enough to be used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FixPolicy {
    /// A fix older than this is stale, microseconds.
    pub stale_after_us: u32,
    /// A fix less accurate than this is refused, millimetres.
    pub max_accuracy_mm: u32,
    /// A fix that implies a jump faster than this is refused, m/s.
    pub max_jump_mps: f32,
}

/// What to do when a part of the controller's information is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum OnTrouble {
    /// Stop.
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

/// What an armed robot does when the operator's link is lost. A robot under manual control always
/// stops and disarms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum OnLinkLoss {
    /// Continue the mission: for plans that lead out of radio range.
    Continue,
    /// Stop and disarm.
    Disarm,
}

/// When the operator's link is lost, and what that does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LinkPolicy {
    /// The link is lost after this time without a packet, microseconds.
    pub timeout_us: u32,
    /// The robot's reaction.
    pub on_loss: OnLinkLoss,
}

/// When the range finder counts as silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct RangePolicy {
    /// A range finder that has worked is silent after this time without a scan, microseconds.
    pub stale_after_us: u32,
    /// A robot whose range finder has never reported stands still.
    pub is_required: bool,
}

/// What a robot does that makes no progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum OnNoProgress {
    /// Stop until the operator arms the robot anew.
    Stop,
    /// Drive on.
    Continue,
}

/// When the robot makes no progress, and what that does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ProgressPolicy {
    /// The robot makes no progress if it drives for this time within one circle, microseconds.
    pub after_us: u32,
    /// Radius of that circle, metres; the accuracy of the position enlarges it.
    pub within_m: f32,
    /// The robot's reaction.
    pub on_none: OnNoProgress,
}

/// Which checks must pass before the robot may be armed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ArmingChecks {
    /// All that the mission needs.
    All,
    /// None; failing checks are reported only.
    None,
}

/// What the robot needs before it may drive, and where it may drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct SafetyPolicy {
    /// Which checks must pass before the robot may be armed.
    pub checks: ArmingChecks,
    /// Radius of the fence around the place where the robot was armed, metres; 0 for none.
    pub fence_radius_m: f32,
    /// The robot stops if the first input channel, the battery's charge, is below this; 0 for
    /// never.
    pub battery_low: f32,
}

impl Vehicle {
    /// Least latency that counts, microseconds: a reading waits for the next tick, and a command holds
    /// until the one after it, at 20 ticks a second.
    pub const LEAST_LATENCY_US: u32 = 100_000;

    /// The vehicle with the latency that counts.
    pub fn with_least_latency(self) -> Self {
        Self { latency_us: self.latency_us.max(Self::LEAST_LATENCY_US), ..self }
    }

    /// Distance from a range reading to the stop, metres, at a speed in m/s: what the robot drives
    /// during the latency, and what it takes to brake.
    pub fn stopping_distance_m(&self, speed_mps: f32) -> f32 {
        let latency_s = self.latency_us as f32 * 1e-6;
        speed_mps * latency_s + speed_mps * speed_mps / (2.0 * self.braking_mps2)
    }
}

/// The parameters that follow from what a user can measure: radius, top speed, brakes, latency.
///
/// ```
/// use plan_format::parameters::{Derived, Vehicle};
/// let vehicle = Vehicle { radius_m: 0.25, max_speed_mps: 2.0, ..Vehicle::default() };
/// let derived = Derived::of(&vehicle);
/// assert_eq!(derived.max_turn_rate_radps, 4.0);
/// assert_eq!(derived.stop_distance_m, 0.02);
/// assert!((derived.avoid_sphere_m - 1.2).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derived {
    /// Speed for a blended vector of length 1, m/s: the top speed.
    pub base_speed_mps: f32,
    /// Speed where obstacles repel strongly, m/s: 0.3, or the top speed if that is lower.
    pub cautious_speed_mps: f32,
    /// Turn rate, rad/s: wheels at the rim that turn at half the top speed in opposite directions.
    pub max_turn_rate_radps: f32,
    /// Distance to keep from what is ahead, metres: 2 cm, the error of usual range finders, or
    /// more for a large body, whose position is less precise.
    pub stop_distance_m: f32,
    /// Margin of the repulsion, metres: the stop distance. Full repulsion from both sides of a
    /// gap would close it, so a larger margin closes gaps that the robot fits through.
    pub avoid_margin_m: f32,
    /// Sphere of the repulsion, metres: the stopping distance at top speed, so that obstacles turn
    /// the robot before they brake it.
    pub avoid_sphere_m: f32,
    /// How far the advice looks ahead, metres: 1.6 radii; 2 radii for a vehicle that needs a circle
    /// and so begins its turns earlier. Shorter makes the robot waver between eight directions,
    /// longer cuts corners.
    pub look_ahead_m: f32,
}

impl Derived {
    /// What follows from a vehicle's radius, top speed, brakes and latency.
    pub fn of(vehicle: &Vehicle) -> Self {
        let vehicle = vehicle.with_least_latency();
        let (radius_m, top_mps) = (vehicle.radius_m, vehicle.max_speed_mps);
        let stop_distance_m = (radius_m / 15.0).max(0.02);
        let look_ahead = if vehicle.steering == Steering::Differential { 1.6 } else { 2.0 };
        let turn_rate = if radius_m > 0.0 { top_mps / (2.0 * radius_m) } else { f32::INFINITY };
        Self {
            base_speed_mps: top_mps,
            cautious_speed_mps: top_mps.min(0.3),
            max_turn_rate_radps: turn_rate.clamp(0.2, 4.0),
            stop_distance_m,
            avoid_margin_m: stop_distance_m,
            avoid_sphere_m: vehicle.stopping_distance_m(top_mps),
            look_ahead_m: look_ahead * radius_m,
        }
    }
}

impl Default for Vehicle {
    /// A rover with a radius of 0.3 m and a top speed of 1.6 m/s; the rest follows.
    fn default() -> Self {
        let measured = Self {
            steering: Steering::Differential,
            radius_m: 0.3,
            base_speed_mps: 0.0,
            max_speed_mps: 1.6,
            cautious_speed_mps: 0.0,
            max_turn_rate_radps: 0.0,
            min_turn_radius_m: 0.0,
            braking_mps2: 2.0,
            latency_us: 100_000,
            reach_m: 10.0,
            stop_distance_m: 0.0,
            may_creep: true,
            back_out: BackOut::Seen,
        };
        let derived = Derived::of(&measured);
        Self {
            base_speed_mps: derived.base_speed_mps,
            cautious_speed_mps: derived.cautious_speed_mps,
            max_turn_rate_radps: derived.max_turn_rate_radps,
            stop_distance_m: derived.stop_distance_m,
            ..measured
        }
    }
}

impl Default for SchemaParameters {
    /// Those of the default vehicle.
    fn default() -> Self {
        let derived = Derived::of(&Vehicle::default());
        Self {
            goal_gain: 1.0,
            avoid_gain: 1.0,
            avoid_sphere_m: derived.avoid_sphere_m,
            avoid_margin_m: derived.avoid_margin_m,
            past_gain: 0.0,
            past_sphere_m: 8.0,
            look_ahead_m: derived.look_ahead_m,
            detour_after_us: 4_000_000,
            goal_tolerance_m: 1.0,
            noise_persistence_ticks: 10,
        }
    }
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            plan: 0,
            gains: Gains::ROUTE,
            blend: Blend::Route,
            selection: Selection::Static,
            vehicle: Vehicle::default(),
            schemas: SchemaParameters::default(),
            fixes: FixPolicy {
                stale_after_us: 2_000_000,
                max_accuracy_mm: 5_000,
                max_jump_mps: 15.0,
            },
            trouble: TroublePolicy { off_map: OnTrouble::Stop, no_route: OnTrouble::Stop },
            link: LinkPolicy { timeout_us: 1_000_000, on_loss: OnLinkLoss::Disarm },
            ranges: RangePolicy { stale_after_us: 500_000, is_required: false },
            progress: ProgressPolicy {
                after_us: 60_000_000,
                within_m: 1.0,
                on_none: OnNoProgress::Stop,
            },
            safety: SafetyPolicy {
                checks: ArmingChecks::All,
                fence_radius_m: 0.0,
                battery_low: 0.0,
            },
            team: TeamPolicy::default(),
            seed: 1,
        }
    }
}

impl Parameters {
    /// The default parameters of a robot with this vehicle: everything that [`Derived`] names follows
    /// from its radius, top speed, brakes and latency.
    pub fn of_vehicle(measured: Vehicle) -> Self {
        let derived = Derived::of(&measured);
        let defaults = Self::default();
        Self {
            vehicle: Vehicle {
                base_speed_mps: derived.base_speed_mps,
                cautious_speed_mps: derived.cautious_speed_mps,
                max_turn_rate_radps: derived.max_turn_rate_radps,
                stop_distance_m: derived.stop_distance_m,
                ..measured
            },
            schemas: SchemaParameters {
                avoid_sphere_m: derived.avoid_sphere_m,
                avoid_margin_m: derived.avoid_margin_m,
                look_ahead_m: derived.look_ahead_m,
                ..defaults.schemas
            },
            ..defaults
        }
    }

    /// The paper's blend and the values that go with it: MissionLab's speeds, margin and sphere,
    /// which fit wide outdoor maps.
    pub fn paper() -> Self {
        let defaults = Self::default();
        Self {
            gains: Gains::MOSTLY_PLAN,
            blend: Blend::Paper,
            vehicle: Vehicle {
                base_speed_mps: 1.4,
                max_turn_rate_radps: 1.0,
                stop_distance_m: 0.3,
                ..defaults.vehicle
            },
            schemas: SchemaParameters {
                avoid_sphere_m: 5.0,
                avoid_margin_m: 0.5,
                ..defaults.schemas
            },
            ..defaults
        }
    }

    /// The name and the range of the first parameter that is out of its range; `None` if all are
    /// within. One table serves the compiler's message and the reader's refusal.
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
            ("vehicle.braking", self.vehicle.braking_mps2, 0.05, 50.0),
            ("vehicle.latency", self.vehicle.latency_us as f32 / 1e6, 0.0, 2.0),
            ("vehicle.reach", self.vehicle.reach_m, 0.1, 1_000.0),
            ("vehicle.stop_distance", self.vehicle.stop_distance_m, 0.0, 100.0),
            ("schemas.goal_gain", self.schemas.goal_gain, 0.0, 100.0),
            ("schemas.avoid_gain", self.schemas.avoid_gain, 0.0, 100.0),
            ("schemas.avoid_sphere", self.schemas.avoid_sphere_m, 0.0, 1_000.0),
            ("schemas.avoid_margin", self.schemas.avoid_margin_m, 0.0, 1_000.0),
            ("schemas.past_gain", self.schemas.past_gain, 0.0, 100.0),
            ("schemas.past_sphere", self.schemas.past_sphere_m, 0.1, 1_000.0),
            ("schemas.look_ahead", self.schemas.look_ahead_m, 0.0, 100.0),
            ("schemas.detour_after", self.schemas.detour_after_us as f32 / 1e6, 0.1, 3_600.0),
            ("schemas.goal_tolerance", self.schemas.goal_tolerance_m, 0.01, 1_000.0),
            ("fixes.stale_after", self.fixes.stale_after_us as f32 / 1e6, 0.05, 3_600.0),
            ("fixes.max_accuracy", self.fixes.max_accuracy_mm as f32 / 1e3, 0.001, 1_000.0),
            ("fixes.max_jump", self.fixes.max_jump_mps, 0.1, 1_000.0),
            ("link.timeout", self.link.timeout_us as f32 / 1e6, 0.1, 3_600.0),
            ("ranges.stale_after", self.ranges.stale_after_us as f32 / 1e6, 0.05, 3_600.0),
            ("progress.after", self.progress.after_us as f32 / 1e6, 1.0, 3_600.0),
            ("progress.within", self.progress.within_m, 0.01, 1_000.0),
            ("fence.radius", self.safety.fence_radius_m, 0.0, 100_000.0),
            ("battery.low", self.safety.battery_low, 0.0, 1_000_000.0),
        ];
        table
            .into_iter()
            .find(|&(_, value, low, high)| !(low..=high).contains(&value))
            .map(|(name, _, low, high)| (name, low, high))
            .or_else(|| self.team.check())
            .or_else(|| match &self.selection {
                Selection::Gains(gains) => gains.check(),
                Selection::Static | Selection::Dynamic => None,
            })
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

    /// The limits are those of the mission file's keys.
    #[test]
    fn the_age_and_the_accuracy_of_fixes_have_ranges() {
        let stale = |us| FixPolicy { stale_after_us: us, ..Parameters::default().fixes };
        let coarse = |mm| FixPolicy { max_accuracy_mm: mm, ..Parameters::default().fixes };
        let check = |fixes| Parameters { fixes, ..Parameters::default() }.check();
        for us in [0, 49_999, 3_601_000_000, u32::MAX] {
            assert_eq!(check(stale(us)), Some(("fixes.stale_after", 0.05, 3_600.0)), "{us} us");
        }
        for mm in [0, 1_000_001, u32::MAX] {
            assert_eq!(check(coarse(mm)), Some(("fixes.max_accuracy", 0.001, 1_000.0)), "{mm} mm");
        }
        let fine = [stale(50_000), stale(3_600_000_000), coarse(1), coarse(1_000_000)];
        assert_eq!(fine.map(check), [None; 4]);
    }

    #[test]
    fn the_timeout_of_the_link_has_a_range() {
        for (timeout_us, is_fine) in
            [(99_999, false), (100_000, true), (3_600_000_000, true), (u32::MAX, false)]
        {
            let mut parameters = Parameters::default();
            parameters.link.timeout_us = timeout_us;
            assert_eq!(parameters.check().is_none(), is_fine, "{timeout_us}");
        }
    }
}
