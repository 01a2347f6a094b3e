//! Finds obstacles that come closer by themselves, from earlier scans.
//!
//! A reading shows a moving obstacle if it lies where an earlier scan showed free space: that
//! scan's reading in the same direction was farther away, or it had none in a sector that has
//! reported before. What was hidden behind another obstacle was not shown free, so a post that comes
//! out from behind another one does not count as moving, and neither does a wall that the robot drives
//! along. The obstacle moved from the nearest place where the earlier scan showed something; the way
//! from there and the time between the scans give its velocity.
//!
//! The robot's own motion is taken out: its odometry relates the places of the two scans. What the
//! odometry does not measure, such as a boat's drift, appears as motion of the obstacles, and the
//! brakes count with it likewise.
//!
//! Memory is a fixed number of scans. Rings with fewer than eight sectors are not covered: a sector
//! wider than [`SECTOR_RAD`](crate::scan::SECTOR_RAD) to both sides of a reading may hide obstacles
//! that count as free space.

use math::{Vec2, scalar, vector};
use robot_io::limits::MAX_RANGES;
use robot_io::{Percepts, RangeReading};
use serde::{Deserialize, Serialize};

use crate::drive::Twist;
use crate::scan::{LEAST_DISTANCE_M, Points, free_m, in_direction, sector};

/// Scans that are kept.
const SCANS: usize = 5;
/// Time between two scans that are kept, microseconds.
const SPACING_US: u64 = 100_000;
/// Scans of these ages or older are compared, microseconds. An older one shows slow obstacles, a
/// younger one those that have just come into view.
const LEAST_AGES_US: [u64; 2] = [400_000, 200_000];
/// An older scan shows nothing about the present, microseconds.
const MOST_AGE_US: u64 = 1_000_000;

/// A sector without a reading, which has reported before, shows free space up to this distance,
/// metres: farther away, a post may lie between two beams.
const CLEAR_M: f32 = 2.5;

/// Nothing moves faster than this: an obstacle that seems to was not seen before, m/s.
pub const FASTEST_MPS: f32 = 2.0;

/// Earlier scans and where they were taken. Part of the controller's state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Closing {
    /// Where the odometry has carried the robot, metres and radians, from an arbitrary origin.
    position_m: [f32; 2],
    heading_rad: f32,
    /// Time of the last scan, kept or not.
    scan_us: Option<u64>,
    scans: [Scan; SCANS],
    /// Index of the scan that the next one replaces.
    next: u8,
    /// Sectors that have ever reported, one bit each: others may have no beam.
    reported: u16,
}

/// The readings of one moment, by sector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Scan {
    /// When it was taken; `None` before.
    time_us: Option<u64>,
    position_m: [f32; 2],
    heading_rad: f32,
    /// The nearest point of each sector, in the robot's axes of that moment, metres.
    seen_m: [[f32; 2]; MAX_RANGES],
    count: u8,
    /// What is nearer than the square root of this lies in free space, m^2, by sector; 0 without a
    /// reading. Squares save the roots.
    free_m2: [f32; MAX_RANGES],
}

impl Closing {
    /// Takes over the scan of this tick's percepts, if it is a new one; `seen` are its readings as
    /// points. `twist` is the robot's motion in the `elapsed_s` since the last tick.
    pub fn update(&mut self, percepts: &Percepts, seen: &Points, twist: &Twist, elapsed_s: f32) {
        let turned_rad = twist.turn_rate_radps * elapsed_s;
        let chord = vector::from_angle(self.heading_rad + 0.5 * turned_rad);
        let position = Vec2::from(self.position_m) + chord * (twist.speed_mps * elapsed_s);
        self.position_m = position.into();
        self.heading_rad = scalar::wrap_angle(self.heading_rad + turned_rad);
        let Some(scan_us) = percepts.scan_us.filter(|_| percepts.scan_us != self.scan_us) else {
            return;
        };
        self.scan_us = Some(scan_us);
        let last = (usize::from(self.next) + SCANS - 1) % SCANS;
        let last_us = self.scans.get(last).and_then(|scan| scan.time_us);
        if last_us.is_some_and(|last_us| scan_us > last_us && scan_us - last_us < SPACING_US) {
            return;
        }
        for reading in &percepts.ranges {
            self.reported |= sector_bit(sector(reading.bearing_rad));
        }
        if let Some(scan) = self.scans.get_mut(usize::from(self.next)) {
            let of_scan = Scan {
                time_us: Some(scan_us),
                position_m: self.position_m,
                heading_rad: self.heading_rad,
                ..Scan::default()
            };
            *scan = of_scan.with(&percepts.ranges, seen, self.reported);
            self.next = (self.next + 1) % SCANS as u8;
        }
    }

    /// What earlier scans show about the present one.
    pub fn compared(&self) -> [Option<Compared<'_>>; 2] {
        LEAST_AGES_US.map(|least_us| self.compared_after(least_us))
    }

    fn compared_after(&self, least_us: u64) -> Option<Compared<'_>> {
        let now_us = self.scan_us?;
        let old_enough = self.scans.iter().filter_map(|scan| {
            let age_us = now_us.checked_sub(scan.time_us?)?;
            (least_us..=MOST_AGE_US).contains(&age_us).then_some((age_us, scan))
        });
        let (age_us, scan) = old_enough.min_by_key(|(age_us, _)| *age_us)?;
        let moved = Vec2::from(self.position_m) - Vec2::from(scan.position_m);
        Some(Compared {
            scan,
            age_s: age_us as u32 as f32 * 1e-6,
            moved: vector::rotated(moved, -scan.heading_rad),
            turned: vector::from_angle(self.heading_rad - scan.heading_rad),
        })
    }
}

impl Scan {
    /// This scan with its readings. `reported` are the sectors that have ever had one.
    fn with(mut self, readings: &[RangeReading], seen: &Points, reported: u16) -> Self {
        let mut nearest = [Vec2::zeros(); MAX_RANGES];
        for (reading, point) in readings.iter().zip(seen) {
            let free_m = free_m(scalar::larger(reading.distance_m, LEAST_DISTANCE_M));
            let sector = sector(reading.bearing_rad);
            let slots = nearest.get_mut(sector).zip(self.free_m2.get_mut(sector));
            let Some((nearest, free_m2)) = slots else { continue };
            if *nearest == Vec2::zeros() || *free_m2 > free_m * free_m {
                (*nearest, *free_m2) = (*point, free_m * free_m);
            }
        }
        let sectors = nearest.iter().zip(&mut self.free_m2).enumerate();
        for (sector, (nearest, free_m2)) in sectors {
            if *nearest == Vec2::zeros() && reported & sector_bit(sector) != 0 {
                *free_m2 = CLEAR_M * CLEAR_M;
            }
        }
        let nearest = nearest.iter().filter(|point| **point != Vec2::zeros());
        for (slot, point) in self.seen_m.iter_mut().zip(nearest) {
            *slot = (*point).into();
            self.count += 1;
        }
        self
    }

    fn seen(&self) -> impl Iterator<Item = Vec2> {
        let seen = self.seen_m.get(..usize::from(self.count)).unwrap_or_default();
        seen.iter().map(|&point| Vec2::from(point))
    }

    /// How far the space in the direction of `point` was free, m^2; 0 if that is unknown. An
    /// obstacle at the edge of a sector may fall between the beams of two.
    fn free_m2(&self, point: Vec2) -> f32 {
        in_direction(&self.free_m2, point)
    }
}

/// The bit of a sector.
fn sector_bit(sector: usize) -> u16 {
    const { assert!(MAX_RANGES <= u16::BITS as usize, "sets of sectors are u16") };
    1_u16.checked_shl(sector as u32).unwrap_or(0)
}

/// An earlier scan and how the robot has moved since.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'s> {
    scan: &'s Scan,
    /// Time between the scans, seconds.
    age_s: f32,
    /// Where the robot is now, in its axes of then, metres.
    moved: Vec2,
    /// Its heading now in its axes of then, as a vector of length 1.
    turned: Vec2,
}

impl Compared<'_> {
    /// The velocity of the obstacle at `point`, m/s in the robot's axes; zero if it stands or if
    /// nothing shows that it moves.
    pub fn velocity(&self, point: Vec2) -> Vec2 {
        let (cos, sin) = (self.turned.x, self.turned.y);
        let then =
            self.moved + Vec2::new(cos * point.x - sin * point.y, sin * point.x + cos * point.y);
        if then.norm_squared() >= self.scan.free_m2(then) {
            return Vec2::zeros();
        }
        let longest_m = FASTEST_MPS * self.age_s;
        let (mut way, mut shortest_m2) = (Vec2::zeros(), longest_m * longest_m);
        for seen in self.scan.seen() {
            let from = then - seen;
            let length_m2 = from.norm_squared();
            if length_m2 < shortest_m2 {
                (way, shortest_m2) = (from, length_m2);
            }
        }
        let velocity = way / self.age_s;
        Vec2::new(cos * velocity.x + sin * velocity.y, cos * velocity.y - sin * velocity.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::{SECTOR_RAD, points};

    /// A post of this radius.
    type Post = ([f32; 2], f32);

    /// What a ring of 16 sectors with 4 beams each reports of these posts.
    fn ring(robot: [f32; 2], heading_rad: f32, posts: &[Post], noise_m: f32) -> Percepts {
        let mut percepts = Percepts::default();
        for sector in 0..16 {
            let beams = (0..4).map(|beam| {
                let bearing_rad = ((4 * sector + beam) as f32 - 1.5) * scalar::TAU / 64.0;
                let along = vector::from_angle(heading_rad + bearing_rad);
                let hits = posts.iter().filter_map(|&(centre, radius_m)| {
                    let to = Vec2::from(centre) - Vec2::from(robot);
                    let (ahead, aside) = (to.dot(&along), to.x * along.y - to.y * along.x);
                    let half = radius_m * radius_m - aside * aside;
                    (half >= 0.0 && ahead > 0.0).then(|| ahead - scalar::sqrt(half))
                });
                (bearing_rad, hits.fold(10.0, f32::min))
            });
            let (bearing_rad, distance_m) =
                beams.reduce(|a, b| if b.1 < a.1 { b } else { a }).unwrap();
            if distance_m < 10.0 {
                let bearing_rad = scalar::wrap_angle(bearing_rad);
                let distance_m = distance_m + noise_m * if sector % 2 == 0 { 1.0 } else { -1.0 };
                percepts.ranges.push(RangeReading { bearing_rad, distance_m }).unwrap();
            }
        }
        percepts
    }

    /// Drives for a second and reports the fastest velocity of a reading nearer than 3 m that
    /// appeared at its end. `posts` gives the posts of a tick.
    fn fastest(twist: Twist, noise_m: f32, posts: impl Fn(f32) -> [Post; 3]) -> Vec2 {
        let mut closing = Closing::default();
        let (mut robot, mut heading_rad) = (Vec2::zeros(), 0.0);
        let mut fastest = Vec2::zeros();
        for tick in 0..=20_u8 {
            let elapsed_s = if tick == 0 { 0.0 } else { 0.05 };
            let turned_rad = twist.turn_rate_radps * elapsed_s;
            robot +=
                vector::from_angle(heading_rad + 0.5 * turned_rad) * (twist.speed_mps * elapsed_s);
            heading_rad += turned_rad;
            let noise_m = if tick % 3 == 0 { noise_m } else { -noise_m };
            let seen = ring(robot.into(), heading_rad, &posts(f32::from(tick) * 0.05), noise_m);
            let percepts = Percepts { scan_us: Some(u64::from(tick) * 50_000), ..seen };
            closing.update(&percepts, &points(&percepts.ranges), &twist, elapsed_s);
            for reading in percepts.ranges.iter().filter(|reading| reading.distance_m < 3.0) {
                let point = vector::from_angle(reading.bearing_rad) * reading.distance_m;
                for compared in closing.compared().iter().flatten() {
                    let velocity = compared.velocity(point);
                    if velocity.norm_squared() > fastest.norm_squared() {
                        fastest = velocity;
                    }
                }
            }
        }
        fastest
    }

    const STANDING: Twist = Twist { speed_mps: 0.0, turn_rate_radps: 0.0 };
    const FAR: Post = ([0.0, -9.0], 0.3);

    #[test]
    fn an_obstacle_that_comes_has_its_speed_and_direction() {
        let driving = Twist { speed_mps: 1.0, turn_rate_radps: 0.0 };
        let turning = Twist { speed_mps: 0.8, turn_rate_radps: 1.0 };
        for (twist, noise_m) in [(STANDING, 0.0), (STANDING, 0.02), (driving, 0.0), (driving, 0.02)]
        {
            let velocity = fastest(twist, noise_m, |s| [([3.5 - s, 0.0], 0.25), FAR, FAR]);
            let error = velocity - Vec2::new(-1.0, 0.0);
            let most_mps = 0.15 + 12.0 * noise_m;
            assert!(vector::length(error) < most_mps, "{twist:?} {noise_m}: {velocity:?}");
        }
        let velocity = fastest(turning, 0.0, |s| [([2.5 - s, 0.3], 0.25), FAR, FAR]);
        assert!((vector::length(velocity) - 1.0).abs() < 0.4, "{velocity:?}");
    }

    /// A wall of posts, a post that comes into view from behind another one, and posts beside a
    /// robot that turns.
    #[test]
    fn what_stands_has_no_velocity() {
        let driving = Twist { speed_mps: 1.5, turn_rate_radps: 0.0 };
        let turning = Twist { speed_mps: 0.7, turn_rate_radps: 1.5 };
        let hidden: [Post; 3] = [([1.5, -0.6], 0.2), ([2.3, -0.95], 0.2), FAR];
        let wall: [Post; 3] = [([4.0, 3.0], 2.0), ([8.0, 3.0], 2.0), ([3.2, -0.5], 0.25)];
        for noise_m in [0.0, 0.02] {
            for (twist, posts) in
                [(driving, hidden), (driving, wall), (turning, hidden), (turning, wall)]
            {
                let velocity = fastest(twist, noise_m, |_| posts);
                assert_eq!(velocity, Vec2::zeros(), "{noise_m} {twist:?} {posts:?}");
            }
        }
    }

    /// The velocity of an obstacle that stands at `then` for a while and is at `now` 0.4 s later.
    /// `before` are the readings of a second before.
    fn velocity(before: &[Vec2], then: Vec2, now: Vec2) -> Vec2 {
        let mut closing = Closing::default();
        for tick in 0..=28_u64 {
            let at = match tick {
                0..8 => before,
                8..28 => &[then],
                _ => &[now],
            };
            let reading = |at: &Vec2| RangeReading {
                bearing_rad: vector::angle(*at),
                distance_m: vector::length(*at),
            };
            let ranges = at.iter().map(reading).collect();
            let percepts = Percepts { scan_us: Some(tick * 50_000), ranges, ..Percepts::default() };
            closing.update(&percepts, &points(&percepts.ranges), &STANDING, 0.05);
        }
        let [older, _] = closing.compared();
        older.expect("it has been seen for a while").velocity(now)
    }

    /// In a direction in which nothing was, although its sector reports, an obstacle has moved.
    #[test]
    fn a_sector_without_a_reading_shows_free_space() {
        let (then, now) = (Vec2::new(1.5, 0.0), Vec2::new(1.4, 0.5));
        let around: [Vec2; 16] =
            core::array::from_fn(|sector| vector::from_angle(sector as f32 * SECTOR_RAD) * 4.0);
        let moved = velocity(&around, then, now);
        assert!(vector::length(moved - (now - then) / 0.4) < 0.01, "{moved:?}");
        // A sector that has never reported may have no beam.
        assert_eq!(velocity(&[], then, now), Vec2::zeros());
        assert_eq!(velocity(&around[8..9], then, now), Vec2::zeros());
        assert!(velocity(&around[1..2], then, now) != Vec2::zeros());
        // Farther away than 2.5 m, a post may lie between two beams.
        let aside = Vec2::new(0.0, 0.5);
        let (near, far) = (Vec2::new(2.3, 0.2), Vec2::new(2.5, 0.3));
        assert!(velocity(&around, near, near + aside) != Vec2::zeros());
        assert_eq!(velocity(&around, far, far + aside), Vec2::zeros());
        // Before a reading that is very near, nothing is free.
        assert_eq!(velocity(&around, Vec2::new(0.05, 0.0), Vec2::new(0.1, 0.0)), Vec2::zeros());
    }

    #[test]
    fn what_leaps_was_not_seen_before() {
        // A post that appears 1.6 m nearer within a tick.
        let velocity =
            fastest(STANDING, 0.0, |s| [([if s < 0.7 { 3.8 } else { 2.2 }, 0.0], 0.3), FAR, FAR]);
        assert_eq!(velocity, Vec2::zeros());
    }

    /// Times in milliseconds of the scans that come, and of those that are kept, the oldest first.
    #[test]
    fn a_scan_is_kept_every_tenth_of_a_second() {
        for (come_ms, kept_ms) in [
            (&[0, 50, 100, 150, 200][..], &[0, 100, 200][..]),
            (&[30, 129, 130, 229, 231], &[30, 130, 231]),
            // Only five are kept.
            (&[0, 100, 200, 300, 400, 450, 500, 550, 600], &[200, 300, 400, 500, 600]),
            // The clock was set back: the new times say nothing about the old ones.
            (&[500, 100, 150, 200], &[500, 100, 200]),
            (&[100, 150, 100], &[100, 100]),
            // The same scan again is not a new one.
            (&[100, 100], &[100]),
        ] {
            let mut closing = Closing::default();
            for come_ms in come_ms {
                let percepts = Percepts { scan_us: Some(come_ms * 1_000), ..Percepts::default() };
                closing.update(&percepts, &Points::new(), &STANDING, 0.05);
            }
            let from_oldest = closing.scans.iter().cycle().skip(closing.next.into()).take(SCANS);
            let kept_us = from_oldest.filter_map(|scan| scan.time_us);
            assert!(kept_us.eq(kept_ms.iter().map(|ms| ms * 1_000)), "{come_ms:?}: {closing:?}");
        }
    }

    /// The robot drives 1 m ahead and turns to the left on the spot. There a scan is kept. Then it
    /// drives a quarter of a circle within a second: at 1 m/s the circle has a circumference of 4 m
    /// and a radius of 0.637 m, so it is this far ahead and to the left of where it was.
    #[test]
    fn an_earlier_scan_is_compared_from_where_the_robot_was() {
        let quarter_rad = 0.5 * scalar::PI;
        let ahead = Twist { speed_mps: 1.0, turn_rate_radps: 0.0 };
        let turning = Twist { speed_mps: 0.0, turn_rate_radps: quarter_rad };
        let arc = Twist { speed_mps: 1.0, turn_rate_radps: quarter_rad };
        let mut closing = Closing::default();
        for (twist, scan_us) in [(ahead, None), (turning, Some(2_000_000)), (arc, Some(3_000_000))]
        {
            for tick in 1..=20 {
                let percepts =
                    Percepts { scan_us: scan_us.filter(|_| tick == 20), ..<_>::default() };
                closing.update(&percepts, &Points::new(), &twist, 0.05);
            }
        }
        for compared in closing.compared() {
            let compared = compared.expect("the scan is a second old");
            assert!((compared.age_s - 1.0).abs() < 1e-6, "{compared:?}");
            assert!((compared.moved - Vec2::new(0.637, 0.637)).norm() < 3e-3, "{compared:?}");
            assert!((compared.turned - Vec2::new(0.0, 1.0)).norm() < 3e-3, "{compared:?}");
        }
    }

    /// Before a reading, 6 cm are blurred and 3 percent of the rest: at 1 m, 0.913 m are free, at
    /// 3 m 2.854 m.
    #[test]
    fn the_nearest_reading_of_a_sector_counts() {
        for (near_m, far_m, expected_m) in [(1.0, 1.2, 0.913), (1.0, 3.0, 0.913), (3.0, 4.0, 2.854)]
        {
            let near = RangeReading { bearing_rad: 0.1, distance_m: near_m };
            let far = RangeReading { bearing_rad: -0.1, distance_m: far_m };
            for readings in [[near, far], [far, near]] {
                let scan = Scan::default().with(&readings, &points(&readings), 0);
                assert!(scan.seen().eq(points(&[near])), "{scan:?}");
                let free_m = scalar::sqrt(scan.free_m2(Vec2::new(2.0, 0.0)));
                assert!((free_m - expected_m).abs() < 1e-3, "{near_m} {far_m}: {free_m}");
            }
        }
    }

    /// What a robot that has turned meanwhile reads in its scans of two moments, 0.4 s apart, of an
    /// obstacle that was ahead.
    fn velocity_after(turned_rad: f32, before: Vec2, now: Vec2) -> Vec2 {
        let mut closing = Closing::default();
        let turn = Twist { speed_mps: 0.0, turn_rate_radps: turned_rad / 0.4 };
        let seen = vector::rotated(now, -turned_rad);
        for (scan_us, elapsed_s, point) in [(0, 0.0, before), (400_000, 0.4, seen)] {
            let bearing_rad = vector::angle(point);
            let reading = RangeReading { bearing_rad, distance_m: vector::length(point) };
            let ranges = [reading].into_iter().collect();
            let percepts = Percepts { scan_us: Some(scan_us), ranges, ..Percepts::default() };
            closing.update(&percepts, &points(&percepts.ranges), &turn, elapsed_s);
        }
        let [Some(compared), _] = closing.compared() else { panic!("the first scan is 0.4 s old") };
        compared.velocity(seen)
    }

    /// The obstacle moves to the left and back at 0.7 m/s each. For a robot that has turned to the left
    /// by an eighth, it moves to the left.
    #[test]
    fn velocities_are_in_the_axes_of_the_robot_as_it_is_now() {
        let (before, now) = (Vec2::new(3.4, 0.0), Vec2::new(3.12, 0.28));
        for (turned_rad, expected) in [(0.0, (-0.7, 0.7)), (0.25 * scalar::PI, (0.0, 0.99))] {
            let found = velocity_after(turned_rad, before, now);
            let off = found - Vec2::new(expected.0, expected.1);
            assert!(vector::length(off) < 0.02, "{turned_rad}: {found}");
        }
    }

    /// In 0.4 s nothing moves by more than 0.8 m: an obstacle that seems to was not seen before.
    #[test]
    fn what_would_be_too_fast_does_not_move() {
        let now = Vec2::new(3.0, 0.0);
        let found = velocity_after(0.0, Vec2::new(3.75, 0.0), now);
        assert!((found.x + 1.875).abs() < 0.01, "{found}");
        assert_eq!(velocity_after(0.0, Vec2::new(3.9, 0.0), now), Vec2::zeros());
    }
}
