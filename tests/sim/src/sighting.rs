//! Who is to blame when a robot and a moving disc touch.
//!
//! A robot is to blame if it moves towards the disc as they touch and could have stopped: its
//! sensors had reported the disc for the time of reaction and for as long as braking takes from the
//! speed that the robot had when the reports began. A disc that turns aside has to be seen anew,
//! because nothing shows beforehand where it will go. A disc that hits a robot which stands or moves
//! away, or that appears too late, is to blame itself, and counts as seen from then on. It may go on
//! to press against the robot; then the robot is only to blame if its own motion alone touches the
//! disc.

use crate::{Body, Point, TICK_US};
use math::scalar::wide;

/// Time from the first report of a disc until a robot that decides well begins to brake, seconds:
/// several scans show the motion, and the vehicle's latency passes.
pub const REACTION_S: f64 = 0.5;
/// A disc that is not reported for more than this time has to be seen anew, ticks.
const GAP_TICKS: u64 = 3;
/// A disc that has hit the robot presses against it until it is farther away than this, metres.
const PRESSING_M: f64 = 0.1;

/// A disc that changes its direction by more than this turns aside: the cosine of 30 degrees.
const ASIDE_COSINE: f64 = 0.866;

/// Since when a robot's sensors have reported a disc, and whether it presses against the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sighting {
    /// First and last tick of the reports, and the robot's speed in the first, m/s.
    reports: Option<(u64, u64, f64)>,
    /// The way of the disc in the last tick in which it moved, metres.
    way: Point,
    is_pressing: bool,
}

impl Sighting {
    /// Takes note of the way of the disc in this tick.
    pub(crate) fn moved(&mut self, way: Point) {
        let length_m = wide::hypot(way[0], way[1]);
        if length_m == 0.0 {
            return;
        }
        let along = way[0] * self.way[0] + way[1] * self.way[1];
        if along < ASIDE_COSINE * length_m * wide::hypot(self.way[0], self.way[1]) {
            self.reports = None;
        }
        self.way = way;
    }

    /// Takes note that the robot's sensors report the disc in this tick.
    pub(crate) fn reported(&mut self, tick: u64, body: &Body) {
        let under_way = self.reports.filter(|(_, last, _)| tick - last <= GAP_TICKS);
        let (first, _, first_mps) = under_way.unwrap_or((tick, tick, body.speed_mps));
        self.reports = Some((first, tick, first_mps));
    }

    /// Whether a robot that moves towards the disc as they touch is to blame. `touches_alone`: its
    /// motion would touch the disc even if that stood.
    pub(crate) fn blames(&self, tick: u64, body: &Body, touches_alone: bool) -> bool {
        let was_in_time = self.reports.is_some_and(|(first, last, first_mps)| {
            let seen_s = (tick - first) as f64 * TICK_US as f64 * 1e-6;
            let needed_s = REACTION_S + first_mps.abs() / body.chassis.braking_mps2;
            tick - last <= GAP_TICKS && seen_s >= needed_s
        });
        was_in_time && (touches_alone || !self.is_pressing)
    }

    /// Takes note of how a tick ended: whether the disc ran into the robot, which is not to blame,
    /// and the gap between them, metres.
    pub(crate) fn ended(&mut self, tick: u64, body: &Body, is_struck: bool, gap_m: f64) {
        if is_struck && !self.is_pressing {
            self.reports = Some((tick, tick, body.speed_mps));
        }
        self.is_pressing = is_struck || self.is_pressing && gap_m <= PRESSING_M;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Chassis;

    /// From 1 m/s and with brakes of 2 m/s^2 a robot stops in half a second, after half a second of
    /// reaction: 20 ticks.
    #[test]
    fn a_robot_that_could_stop_is_to_blame() {
        let chassis = Chassis { braking_mps2: 2.0, ..Chassis::default() };
        let body = Body { speed_mps: 1.0, ..Body::new(chassis, [0.0; 2], 0.0) };
        let seen_in = |ticks: &[u64]| {
            let mut sighting = Sighting::default();
            ticks.iter().for_each(|&tick| sighting.reported(tick, &body));
            sighting
        };
        let always: Vec<u64> = (100..=130).collect();
        let often: Vec<u64> = always.iter().copied().filter(|tick| tick % 3 == 0).collect();
        let gap: Vec<u64> =
            always.iter().copied().filter(|tick| !(108..113).contains(tick)).collect();
        for (ticks, tick, is_blamed) in [
            (&always, 119, false),
            (&always, 120, true),
            (&often, 124, true),
            (&gap, 130, false),
            (&vec![], 120, false),
        ] {
            let until: Vec<u64> = ticks.iter().copied().filter(|&seen| seen <= tick).collect();
            assert_eq!(seen_in(&until).blames(tick, &body, false), is_blamed, "{tick} {until:?}");
        }
        // The same disc has pressed against the robot since it hit it.
        let mut pressing = seen_in(&always);
        pressing.ended(119, &body, true, 0.02);
        assert!(!pressing.blames(125, &body, true));
        (120..=140).for_each(|tick| pressing.reported(tick, &body));
        pressing.ended(140, &body, false, 0.09);
        assert!(!pressing.blames(140, &body, false) && pressing.blames(140, &body, true));
        pressing.ended(140, &body, false, 0.11);
        assert!(pressing.blames(140, &body, false));
    }

    #[test]
    fn a_disc_that_turns_round_has_to_be_seen_anew() {
        let body = Body::new(Chassis::default(), [0.0; 2], 0.0);
        for (ways, is_blamed) in [
            ([[0.05, 0.0], [0.05, 0.0], [0.045, 0.02]], true),
            ([[0.05, 0.0], [0.0, 0.0], [0.05, 0.0]], true),
            ([[0.05, 0.0], [0.05, 0.0], [-0.05, 0.0]], false),
            ([[0.05, 0.0], [0.05, 0.0], [0.0, 0.05]], false),
        ] {
            let mut sighting = Sighting::default();
            for tick in 0..=20 {
                sighting.moved(ways[(tick / 7) as usize]);
                sighting.reported(tick, &body);
            }
            assert_eq!(sighting.blames(20, &body, true), is_blamed, "{ways:?}");
        }
    }
}
