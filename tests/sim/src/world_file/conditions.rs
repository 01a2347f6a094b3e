//! The conditions of a world file: sensors, wheels, body, moving discs and faults.

use super::reader::{FARTHEST_M, Reader, Section, number_of, point_of};
use super::work::LONGEST_S;
use crate::conditions::{CompassChanges, GpsChanges, RangeChanges};
use crate::sensors::PoseSettings;
use crate::{Channel, Conditions, Disc, Fault, PlannedFault, Point, Repeat, TICK_US};
use robot_io::limits::MAX_RANGES;

/// How something fails, as a file names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Lost,
    Frozen,
    Offset,
    Delayed,
    Garbled,
    Intermittent,
}

/// How it can fail.
const KINDS: [(&str, Kind); 6] = [
    ("lost", Kind::Lost),
    ("frozen", Kind::Frozen),
    ("offset", Kind::Offset),
    ("delayed", Kind::Delayed),
    ("garbled", Kind::Garbled),
    ("intermittent", Kind::Intermittent),
];

impl Reader<'_> {
    /// Everything that differs from the usual conditions.
    pub(super) fn conditions(&mut self, top: &Section<'_>) -> Conditions {
        let gps = self.table(top, "gps", Self::gps).unwrap_or_default();
        let compass = self.table(top, "compass", Self::compass).unwrap_or_default();
        let ranges = self.table(top, "ranges", Self::ranges).unwrap_or_default();
        let pose = self.table(top, "pose", Self::pose);
        let wheels = self.table(top, "wheels", |reader, wheels| {
            reader.unknown_keys(wheels, &["unequal", "slip"]);
            let unequal = reader.number(wheels, "unequal", (-1.0, 1.0), "0.03");
            (unequal, reader.number(wheels, "slip", (0.0, 0.99), "0.1"))
        });
        let body = self.table(top, "body", |reader, body| {
            reader.unknown_keys(body, &["acceleration", "turn_acceleration"]);
            let ahead = reader.number(body, "acceleration", (0.01, 100.0), "1.5");
            (ahead, reader.number(body, "turn_acceleration", (0.01, 1_000.0), "6.0"))
        });
        self.one_sigma(top);
        let (unequal, slip) = wheels.unwrap_or_default();
        let (acceleration_mps2, turn_acceleration_radps2) = body.unwrap_or_default();
        Conditions {
            gps,
            compass,
            ranges,
            pose,
            unequal_radps: unequal.unwrap_or(0.0),
            slip: slip.unwrap_or(0.0),
            acceleration_mps2,
            turn_acceleration_radps2,
            discs: self.list(top, "discs", Self::disc),
            faults: self.list(top, "faults", Self::fault),
        }
    }

    /// Reports a GPS sigma that is given twice.
    fn one_sigma(&mut self, top: &Section<'_>) {
        let gps = top.get("gps").and_then(|(item, _)| item.as_table_like());
        if let (Some((_, at)), true) =
            (top.get("gps_sigma"), gps.is_some_and(|gps| gps.contains_key("sigma")))
        {
            let help = "remove one of them; `gps_sigma` is short for `sigma` in [gps]";
            self.error("`gps_sigma` and `gps.sigma` are the same", at, "the second one", help);
        }
    }

    fn gps(&mut self, gps: &Section<'_>) -> GpsChanges {
        self.unknown_keys(gps, &["sigma", "rate", "delay", "correlation", "multipath"]);
        GpsChanges {
            sigma_m: self.number(gps, "sigma", (0.0, 1_000.0), "0.02"),
            rate_hz: self.number(gps, "rate", (0.0, 20.0), "5.0"),
            delay_s: self.number(gps, "delay", (0.0, 60.0), "0.1"),
            correlation_s: self.number(gps, "correlation", (0.0, 3_600.0), "20.0"),
            multipath_m: self.number(gps, "multipath", (0.0, 1_000.0), "3.0"),
        }
    }

    fn compass(&mut self, compass: &Section<'_>) -> CompassChanges {
        self.unknown_keys(compass, &["sigma", "offset"]);
        CompassChanges {
            sigma_rad: self.number(compass, "sigma", (0.0, 3.2), "0.02"),
            offset_rad: self.number(compass, "offset", (-3.2, 3.2), "0.1"),
        }
    }

    fn ranges(&mut self, ranges: &Section<'_>) -> RangeChanges {
        self.unknown_keys(ranges, &["sectors", "beams", "reach", "sigma"]);
        let sectors = self.whole(ranges, "sectors", 0, MAX_RANGES as i64);
        let beams = self.whole(ranges, "beams", 1, 360);
        RangeChanges {
            sectors: sectors.map(|count| count as usize),
            beams: beams.map(|count| count as usize),
            reach_m: self.number(ranges, "reach", (0.1, 1_000.0), "10.0"),
            sigma_m: self.number(ranges, "sigma", (0.0, 100.0), "0.02"),
        }
    }

    fn pose(&mut self, pose: &Section<'_>) -> PoseSettings {
        self.unknown_keys(pose, &["rate", "sigma", "heading_sigma"]);
        PoseSettings {
            rate_hz: self.number(pose, "rate", (0.1, 20.0), "10.0").unwrap_or(10.0),
            sigma_m: self.number(pose, "sigma", (0.0, 1_000.0), "0.02").unwrap_or(0.02),
            heading_sigma_rad: self.number(pose, "heading_sigma", (0.0, 3.2), "0.02"),
        }
    }

    fn disc(&mut self, disc: &Section<'_>) -> Option<Disc> {
        self.unknown_keys(disc, &["radius", "path", "speed", "loop", "start"]);
        let radius = self.needed_number(disc, "radius", (0.01, 1_000.0), "0.3");
        let speed = self.needed_number(disc, "speed", (0.0, 50.0), "1.0");
        if disc.get("path").is_none() {
            self.missing(disc, "path", "write path = [[10, 0], [10, 20]]");
        }
        let path = self.points(disc, "path", 1);
        let repeats = [("back", Repeat::Back), ("around", Repeat::Around), ("once", Repeat::Once)];
        let repeat = self.word(disc, "loop", &repeats).unwrap_or_default();
        let start_m = self.number(disc, "start", (0.0, FARTHEST_M), "3.0").unwrap_or(0.0);
        Some(Disc { radius_m: radius?, path: path?, speed_mps: speed?, repeat, start_m })
    }

    fn fault(&mut self, fault: &Section<'_>) -> Option<PlannedFault> {
        self.unknown_keys(fault, &["sensor", "kind", "from", "to", "value"]);
        for (key, example) in [("sensor", "\"gps\""), ("kind", "\"lost\"")] {
            if fault.get(key).is_none() {
                self.missing(fault, key, &format!("write {key} = {example}"));
            }
        }
        let channel = self.word(fault, "sensor", &Channel::ALL);
        let kind = self.word(fault, "kind", &KINDS);
        let from = self.number(fault, "from", (0.0, LONGEST_S), "20.0").unwrap_or(0.0);
        let to = self.number(fault, "to", (0.0, LONGEST_S), "30.0").unwrap_or(f64::INFINITY);
        if to <= from {
            let at = fault.get("to").map_or_else(|| fault.at.clone(), |(_, at)| at);
            let help = "`to` is later than `from`; without it the fault lasts to the end";
            self.error(format!("`{}` ends before it begins", fault.path), at, "too early", help);
        }
        let (channel, kind) = (channel?, kind?);
        let fault = self.failure(fault, channel, kind)?;
        Some(PlannedFault { channel, fault, window_s: from..to })
    }

    /// What a kind of fault does to a channel, with its `value`.
    fn failure(&mut self, fault: &Section<'_>, channel: Channel, kind: Kind) -> Option<Fault> {
        if (channel, kind) == (Channel::Link, Kind::Offset) {
            let help = "a link can be lost, frozen, delayed, garbled or intermittent";
            let at = fault.get("kind").map_or_else(|| fault.at.clone(), |(_, at)| at);
            self.error("a link has no offset", at, "not for a link", help);
            return None;
        }
        if matches!(kind, Kind::Lost | Kind::Frozen)
            && let Some((_, at)) = fault.get("value")
        {
            let message = format!("{} has no meaning here", fault.key("value"));
            let help = "remove it: what is lost or frozen has no value";
            self.error(message, at, "not used", help);
            return None;
        }
        Some(match kind {
            Kind::Lost => Fault::Drop { chance: 1.0 },
            Kind::Frozen => Fault::Freeze,
            Kind::Offset => Fault::Jump { offset: self.offset(fault, channel)? },
            Kind::Delayed => {
                let seconds = self.needed_number(fault, "value", (0.05, 600.0), "1.0")?;
                Fault::Delay { ticks: (seconds * 1e6 / TICK_US as f64).round() as usize }
            }
            Kind::Garbled => Fault::Garble { chance: self.chance(fault, 1.0)? },
            Kind::Intermittent => Fault::Drop { chance: self.chance(fault, 0.5)? },
        })
    }

    fn chance(&mut self, fault: &Section<'_>, usual: f64) -> Option<f64> {
        match fault.get("value") {
            None => Some(usual),
            Some(_) => self.number(fault, "value", (0.0, 1.0), "0.5"),
        }
    }

    /// An offset: a number in the unit of the reading, or two where the reading has two.
    fn offset(&mut self, fault: &Section<'_>, channel: Channel) -> Option<Point> {
        let help = match channel {
            Channel::Gps | Channel::Pose => "write value = [50, 0]: metres east and north",
            Channel::Actuators => "write value = [0.3, 0.2]: m/s and rad/s",
            Channel::Heading
            | Channel::Odometry
            | Channel::Ranges
            | Channel::Link
            | Channel::Battery
            | Channel::Clock => "write value = 0.5: one number, in the unit of the reading",
        };
        let Some((item, at)) = fault.get("value") else {
            self.missing(fault, "value", help);
            return None;
        };
        let has_two = channel.has_two_numbers();
        let is_within = |number: &f64| number.abs() <= FARTHEST_M;
        let number = item.as_value().and_then(number_of).filter(is_within);
        let pair = item.as_value().and_then(point_of);
        let offset = if has_two { pair } else { number.map(|number| [number, 0.0]) };
        if offset.is_none() {
            let what = if has_two { "two numbers, each" } else { "a number" };
            let name = fault.key("value");
            let message = format!("{name} must be {what} from -{FARTHEST_M} to {FARTHEST_M}");
            self.error(message, at, "not an offset of this sensor", help);
        }
        offset
    }
}
