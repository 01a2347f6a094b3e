//! One scan of the range finder: its readings as points, by sector, and from where the robot is now.

use heapless::Vec;
use math::{Vec2, scalar, vector};
use robot_io::RangeReading;
use robot_io::limits::MAX_RANGES;
use serde::{Deserialize, Serialize};

/// Angle of a sector of the range finder, which reports its nearest obstacle only. The first one is
/// centred ahead.
pub(crate) const SECTOR_RAD: f32 = scalar::TAU / MAX_RANGES as f32;

/// A reading nearer than this counts as this far away, metres: at 0 it would have no direction.
pub(crate) const LEAST_DISTANCE_M: f32 = 0.01;

/// Readings as points in the robot's axes, metres: x straight ahead, y to the left.
pub type Points = Vec<Vec2, MAX_RANGES>;

/// The readings as points, in their order.
pub fn points(readings: &[RangeReading]) -> Points {
    let point = |reading: &RangeReading| {
        let distance_m = scalar::larger(reading.distance_m, LEAST_DISTANCE_M);
        vector::from_angle(reading.bearing_rad) * distance_m
    };
    readings.iter().take(MAX_RANGES).map(point).collect()
}

/// The sector of a bearing within half a turn to either side.
pub(crate) fn sector(bearing_rad: f32) -> usize {
    (bearing_rad / SECTOR_RAD + (MAX_RANGES as f32 + 0.5)) as usize % MAX_RANGES
}

/// Free space ends this much before a reading: noise, metres.
const BLUR_M: f32 = 0.06;
/// It also ends before it by this share of the distance: edges and corners between two beams.
const BLUR_SHARE: f32 = 0.03;

/// Where the sectors that cover a direction change, as tangents, in the eighth of a turn beside an
/// axis. The beams of a sector surely cover 0.3 of its angle to either side of its middle; beyond
/// that, the next sector may cover the direction too. The angles are 0.3, 0.7, 1.3 and 1.7 sectors.
const CHANGES: [f32; 4] = [0.118_358, 0.282_029, 0.560_027, 0.788_336];

/// The two sectors that may cover a direction, by its eighth of a turn (a bit each: steeper than
/// 45 degrees, behind, on the right) and the number of [`CHANGES`] between the axis and it.
const COVERING: [[[u8; 2]; CHANGES.len() + 1]; 8] = covering_sectors();

const fn covering_sectors() -> [[[u8; 2]; CHANGES.len() + 1]; 8] {
    const COUNT: usize = MAX_RANGES;
    let mut table = [[[0; 2]; CHANGES.len() + 1]; 8];
    let mut eighth = 0;
    while eighth < 8 {
        let mut changes = 0;
        while changes <= CHANGES.len() {
            // From the axis on: 0, 0 and 1, 1, 1 and 2, 2.
            let pair = [changes / 2, changes.div_ceil(2)];
            let mut index = 0;
            while index < 2 {
                let steep = if eighth & 1 == 0 { pair[index] } else { COUNT / 4 - pair[index] };
                let ahead = if eighth & 2 == 0 { steep } else { COUNT / 2 - steep };
                let sector = if eighth & 4 == 0 { ahead } else { COUNT - ahead };
                table[eighth][changes][index] = (sector % COUNT) as u8;
                index += 1;
            }
            changes += 1;
        }
        eighth += 1;
    }
    table
}

/// The readings of one scan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scan {
    readings: [RangeReading; MAX_RANGES],
    count: u8,
}

impl Default for Scan {
    fn default() -> Self {
        let nothing = RangeReading { bearing_rad: 0.0, distance_m: 0.0 };
        Self { readings: [nothing; MAX_RANGES], count: 0 }
    }
}

impl Scan {
    pub(crate) fn readings(&self) -> &[RangeReading] {
        self.readings.get(..usize::from(self.count)).unwrap_or_default()
    }

    pub(crate) fn take(&mut self, readings: &[RangeReading]) {
        // Never more than there is room for: percepts have the same limit.
        for (kept, reading) in self.readings.iter_mut().zip(readings) {
            *kept = *reading;
        }
        self.count = readings.len().min(MAX_RANGES) as u8;
    }
}

/// How far the space before a reading at this distance is surely free, metres.
pub(crate) fn free_m(distance_m: f32) -> f32 {
    scalar::larger((distance_m - BLUR_M) / (1.0 + BLUR_SHARE), 0.0)
}

/// The sectors that may cover the direction of a point: one, or two at their common edge.
pub(crate) fn covering(point: Vec2) -> (usize, usize) {
    let (x, y) = (point.x.abs(), point.y.abs());
    let is_steep = y > x;
    let (longer, shorter) = if is_steep { (y, x) } else { (x, y) };
    let eighth =
        usize::from(is_steep) | usize::from(point.x < 0.0) << 1 | usize::from(point.y < 0.0) << 2;
    let changes: usize =
        CHANGES.iter().map(|tangent| usize::from(shorter > tangent * longer)).sum();
    let pair = COVERING.get(eighth).and_then(|by_changes| by_changes.get(changes));
    let [one, other] = pair.copied().unwrap_or_default();
    (one.into(), other.into())
}

/// The smaller one of what the sectors that may cover the direction of a point hold; 0 stands for
/// nothing.
pub(crate) fn in_direction(by_sector: &[f32; MAX_RANGES], point: Vec2) -> f32 {
    let (one, other) = covering(point);
    let of = |sector: usize| by_sector.get(sector).copied().unwrap_or_default();
    match (of(one), of(other)) {
        (0.0, held) | (held, 0.0) => held,
        (one, other) => scalar::smaller(one, other),
    }
}

/// The nearest distance of each sector, metres; 0 without a reading.
pub(crate) fn by_sector(readings: impl Iterator<Item = RangeReading>) -> [f32; MAX_RANGES] {
    let mut nearest_m = [0.0; MAX_RANGES];
    for reading in readings {
        let Some(slot) = nearest_m.get_mut(sector(reading.bearing_rad)) else { continue };
        if *slot == 0.0 || reading.distance_m < *slot {
            *slot = reading.distance_m;
        }
    }
    nearest_m
}

/// How the robot has moved since a scan, in its axes of then, metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moved {
    pub(crate) by_m: [f32; 2],
    pub(crate) turned_rad: f32,
}

impl Moved {
    /// Adds a step.
    pub(crate) fn advance(&mut self, moved_m: f32, turned_rad: f32) {
        let step = vector::from_angle(self.turned_rad + 0.5 * turned_rad) * moved_m;
        self.by_m = (Vec2::from(self.by_m) + step).into();
        self.turned_rad += turned_rad;
    }

    /// Where the obstacle of a reading is now, if it stands.
    pub(crate) fn carried(&self, reading: &RangeReading) -> RangeReading {
        let then = vector::from_angle(reading.bearing_rad) * reading.distance_m;
        let now = then - Vec2::from(self.by_m);
        RangeReading {
            bearing_rad: scalar::wrap_angle(vector::angle(now) - self.turned_rad),
            distance_m: vector::length(now),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Around the robot, the sector of a direction is one of those that cover it, and the other one
    /// is next to it, at the edge.
    #[test]
    fn a_direction_is_covered_by_its_sector_and_at_its_edge_by_the_next() {
        for step in 0..720_u16 {
            let angle_rad = scalar::wrap_angle(f32::from(step) * scalar::TAU / 720.0 + 1e-3);
            let (one, other) = covering(vector::from_angle(angle_rad) * 3.0);
            let own = sector(angle_rad);
            assert!(one == own || other == own, "{angle_rad}: {own} {one} {other}");
            let offset = angle_rad / SECTOR_RAD - scalar::floor(angle_rad / SECTOR_RAD + 0.5);
            let is_at_edge = offset.abs() > 0.3;
            // The sine is good to 1e-3.
            assert!(one.abs_diff(other) % 14 <= 1, "{angle_rad}: {one} {other}");
            let is_near_change = (offset.abs() - 0.3).abs() < 0.02;
            assert!(is_near_change || (one != other) == is_at_edge, "{angle_rad}: {one} {other}");
        }
    }
}
