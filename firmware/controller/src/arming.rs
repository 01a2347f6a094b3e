//! What the robot needs before it may drive: checks before arming, the fence, the battery.
//!
//! The operator orders the robot to be armed; it is armed once it passes the checks for its way of
//! driving. Driving by plan needs all of them, manual driving only clock, battery and fence: the
//! driver sees the rest. Each check has a bit in [`Checks`], which telemetry carries. An
//! armed robot stays armed until the order ends; later trouble stops it with its own reason.
//!
//! The fence is a circle around the place where the robot was armed. It is judged by the fixes as
//! they are, so it needs neither map nor blob. Between good fixes, and without any, the position counts:
//! dead reckoning and poses; where that is unknown, the last good fix counts until it is stale.

use math::{GeoPoint, Vec2, scalar, vector};
use plan_format::Blob;
use plan_format::parameters::{ArmingChecks, FixPolicy, Vehicle};
use robot_io::{Checks, Commands, Percepts, Reason, percepts::channel};
use serde::{Deserialize, Serialize};

use crate::sense::{Sensed, gives_course};

/// The battery is low once it has been below the threshold for this time, seconds: motors that
/// start pull it down for a moment.
const LOW_FOR_S: f32 = 2.0;

/// With a threshold, the check fails once the battery has not been read for this time, seconds.
const UNREAD_S: f32 = 5.0;

/// Metres in 1e-7 degrees of latitude. The fence ignores that this varies by 1 % over the globe.
const METRES_PER_E7: f32 = 0.011_132;
/// A turn of longitude, 1e-7 degrees.
const TURN_E7: i64 = 3_600_000_000;

/// Checks that manual driving needs.
const FOR_MANUAL: Checks = Checks::CLOCK.with(Checks::BATTERY, true).with(Checks::FENCE, true);

/// What the checks keep from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Arming {
    checks: Checks,
    /// The order is given and the checks have passed since.
    is_armed: bool,
    /// Where the robot was armed.
    home: Whereabouts,
    /// The last good fix, and its time, microseconds.
    last: Option<(GeoPoint, u64)>,
    /// The robot is outside the fence, or nothing shows where it is.
    is_outside: bool,
    /// Time for which the battery has been low, seconds.
    low_s: f32,
    /// Whether the battery has been read since the start, and the time since then, seconds.
    has_read: bool,
    unread_s: f32,
}

/// Where the robot is, as far as is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Whereabouts {
    /// By fixes, and whether the fix is a good one of now.
    place: Option<GeoPoint>,
    is_current: bool,
    /// The position, map metres.
    position_m: Option<[f32; 2]>,
}

impl Arming {
    /// The checks that fail.
    pub const fn checks(&self) -> Checks {
        self.checks
    }

    /// Whether the order to arm is given and the checks have passed since.
    pub const fn is_armed(&self) -> bool {
        self.is_armed
    }

    /// Takes over one tick.
    pub fn update(&mut self, blob: &Blob<'_>, percepts: &Percepts, sensed: &Sensed) {
        let parameters = blob.parameters();
        if !percepts.operator.is_armed {
            (self.is_armed, self.home) = (false, Whereabouts::default());
        }
        let battery_low = parameters.safety.battery_low;
        self.watch_battery(percepts, battery_low, sensed.elapsed_s);
        let here = self.whereabouts(percepts, sensed, &parameters.fixes);
        let radius_m = parameters.safety.fence_radius_m;
        let is_unread = battery_low > 0.0 && (!self.has_read || self.unread_s > UNREAD_S);
        let checks = failing(blob, percepts, sensed)
            .with(Checks::BATTERY, self.low_s > 0.0 || is_unread)
            .with(Checks::FENCE, radius_m > 0.0 && !here.is_known());
        let needed = if percepts.operator.manual.is_some() { FOR_MANUAL } else { Checks::all() };
        let passes = parameters.safety.checks == ArmingChecks::None || !checks.has(needed);
        if percepts.operator.is_armed && !self.is_armed && passes {
            (self.is_armed, self.home) = (true, here);
        }
        // Armed without checks and without a place, the robot has no fence to be inside of.
        let is_inside = || here.away_m(&self.home).is_some_and(|away_m| away_m <= radius_m);
        self.is_outside = radius_m > 0.0 && self.is_armed && !is_inside();
        self.checks = checks.with(Checks::FENCE, self.is_outside);
    }

    fn watch_battery(&mut self, percepts: &Percepts, low: f32, elapsed_s: f32) {
        let charge = percepts.inputs.get(usize::from(channel::BATTERY)).copied().flatten();
        // A reading that is missing says nothing.
        let Some(charge) = charge else {
            self.unread_s += elapsed_s;
            return;
        };
        (self.has_read, self.unread_s) = (true, 0.0);
        if charge < low {
            self.low_s += elapsed_s.max(f32::MIN_POSITIVE);
        } else if !self.is_low() || !percepts.operator.is_armed {
            self.low_s = 0.0;
        }
    }

    /// Where the robot is, for the fence.
    fn whereabouts(
        &mut self,
        percepts: &Percepts,
        sensed: &Sensed,
        policy: &FixPolicy,
    ) -> Whereabouts {
        let is_fresh =
            |time_us: u64| percepts.time_us.abs_diff(time_us) <= u64::from(policy.stale_after_us);
        let fix = percepts.fix.filter(|fix| {
            fix.is_valid && fix.accuracy_mm <= policy.max_accuracy_mm && is_fresh(fix.time_us)
        });
        self.last = fix.map(|fix| (fix.place, fix.time_us)).or(self.last);
        let last = self.last.filter(|(_, time_us)| is_fresh(*time_us));
        Whereabouts {
            place: last.map(|(place, _)| place),
            is_current: fix.is_some(),
            position_m: sensed.position.ok().map(Into::into),
        }
    }

    /// An armed robot whose battery was low stays stopped: without load the battery recovers a
    /// little, and the robot would start again and again.
    fn is_low(&self) -> bool {
        self.low_s >= LOW_FOR_S
    }

    /// The limited commands with the reason that counts; until the robot is armed all outputs are
    /// off. A stop keeps its own reason, which says more than that a check fails; `wanted` are the
    /// commands before the limits.
    pub fn explained(&self, limited: Commands, wanted: &Commands, percepts: &Percepts) -> Commands {
        if self.is_armed {
            return limited;
        }
        let moves = wanted.speed_mps != 0.0 || wanted.turn_rate_radps != 0.0;
        let reason = match limited.reason {
            Reason::Disarmed if percepts.is_link_lost => Reason::LinkLost,
            Reason::Disarmed | Reason::EmergencyStop => limited.reason,
            Reason::Manual | Reason::Idle => Reason::NotReady,
            _ if moves => Reason::NotReady,
            reason => reason,
        };
        Commands { reason, outputs: 0, ..limited }
    }

    /// The reason for which a robot that drives by itself must stand still.
    pub fn reason(&self) -> Option<Reason> {
        if self.is_low() {
            Some(Reason::LowBattery)
        } else if self.is_outside {
            Some(Reason::OutsideFence)
        } else {
            None
        }
    }

    /// The vehicle's limits: 0 while the order to arm waits for the checks; outside the fence, a
    /// driver has the cautious speed at most.
    pub fn limited(&self, vehicle: &Vehicle) -> Vehicle {
        if !self.is_armed {
            return Vehicle { max_speed_mps: 0.0, max_turn_rate_radps: 0.0, ..*vehicle };
        }
        let most_mps =
            if self.is_outside { vehicle.cautious_speed_mps } else { vehicle.max_speed_mps };
        Vehicle { max_speed_mps: vehicle.max_speed_mps.min(most_mps), ..*vehicle }
    }
}

/// The checks that fail, without those of battery and fence.
fn failing(blob: &Blob<'_>, percepts: &Percepts, sensed: &Sensed) -> Checks {
    let vehicle = &blob.parameters().vehicle;
    let may_find_heading = vehicle.may_creep && sensed.may_creep && gives_course(percepts);
    let has_task = blob.goal().is_some() || !blob.mission().behaviours().is_empty();
    Checks::default()
        .with(Checks::POSITION, sensed.position.is_err())
        .with(
            Checks::HEADING,
            sensed.is_heading_wrong || sensed.heading_rad.is_none() && !may_find_heading,
        )
        .with(Checks::RANGES, sensed.ranges.reason().is_some())
        .with(Checks::PLAN, !has_task)
        .with(Checks::CLOCK, sensed.is_clock_stopped)
}

impl Whereabouts {
    fn is_known(&self) -> bool {
        self.place.is_some() || self.position_m.is_some()
    }

    /// The distance from another place, metres; `None` if nothing shows it.
    fn away_m(&self, home: &Self) -> Option<f32> {
        let by_place = self.place.zip(home.place).map(|(place, home)| {
            let north_e7 = i64::from(place.lat_e7) - i64::from(home.lat_e7);
            let east_e7 = i64::from(place.lon_e7) - i64::from(home.lon_e7);
            // The shorter way around the globe.
            let half_e7 = TURN_E7 / 2;
            let east_e7 = (east_e7 + half_e7).rem_euclid(TURN_E7) - half_e7;
            let cosine = scalar::cos((home.lat_e7 as f32 * 1e-7).to_radians());
            Vec2::new(east_e7 as f32 * cosine, north_e7 as f32) * METRES_PER_E7
        });
        let positions = self.position_m.zip(home.position_m);
        let by_position = positions.map(|(here, home)| Vec2::from(here) - Vec2::from(home));
        let away =
            if self.is_current { by_place.or(by_position) } else { by_position.or(by_place) };
        away.map(vector::length)
    }
}
