//! What the robot sees nearby, as points in its own axes, and which ways these points leave open.

use math::{Vec2, scalar, vector};
use robot_io::RangeReading;
use robot_io::limits::MAX_RANGES;

use crate::arc::{Arc, Body};
use crate::closing::Compared;
use crate::scan::{LEAST_DISTANCE_M, Points, SECTOR_RAD};

/// Places on the way of a moving obstacle that are looked at, at most.
const MOST_PLACES: f32 = 8.0;

/// Directions of the edges of the sectors 0 to 8 that are nearer to straight ahead, on the left.
const EDGES: [Vec2; MAX_RANGES / 2 + 1] = [
    Vec2::new(1.0, 0.0),
    Vec2::new(0.9807852, 0.1950903),
    Vec2::new(0.8314696, 0.5555702),
    Vec2::new(0.5555702, 0.8314696),
    Vec2::new(0.1950903, 0.9807852),
    Vec2::new(-0.1950903, 0.9807852),
    Vec2::new(-0.5555702, 0.8314696),
    Vec2::new(-0.8314696, 0.5555702),
    Vec2::new(-0.9807852, 0.1950903),
];

/// What limits the motion of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Obstacles {
    points: [Point; MAX_RANGES],
    count: usize,
}

/// A reading as points, metres, x straight ahead, y to the left.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// The obstacle that was read.
    seen: Vec2,
    /// Where the reading may hide another one: a sector reports its nearest obstacle, and one that
    /// is as near but closer to the way ahead stays unseen.
    hidden: Vec2,
    /// Their distance from the body's centre.
    distance_m: f32,
    /// The obstacle's own velocity, m/s, and its length.
    velocity: Vec2,
    speed_mps: f32,
}

impl Point {
    const NONE: Self = Self {
        seen: Vec2::new(0.0, 0.0),
        hidden: Vec2::new(0.0, 0.0),
        distance_m: 0.0,
        velocity: Vec2::new(0.0, 0.0),
        speed_mps: 0.0,
    };

    /// The reading of an obstacle that stands.
    fn of(reading: &RangeReading, seen: Vec2) -> Self {
        let distance_m = scalar::larger(reading.distance_m, LEAST_DISTANCE_M);
        let sector = from_ahead(reading.bearing_rad);
        Self { seen, hidden: hidden(seen, sector, distance_m), distance_m, ..Self::NONE }
    }

    /// The same in axes that are turned by half a turn.
    fn astern(&self) -> Self {
        let seen = -self.seen;
        let sector = from_ahead(vector::angle(seen));
        let hidden = hidden(seen, sector, self.distance_m);
        Self { seen, hidden, velocity: -self.velocity, ..*self }
    }
}

/// Sectors between straight ahead and a bearing.
fn from_ahead(bearing_rad: f32) -> usize {
    (bearing_rad.abs() / SECTOR_RAD + 0.5) as usize
}

/// The point at the edge of the sector of `seen` that is nearer to straight ahead.
fn hidden(seen: Vec2, sector: usize, distance_m: f32) -> Vec2 {
    let edge = EDGES.get(sector).copied().unwrap_or_default();
    Vec2::new(edge.x, if seen.y < 0.0 { -edge.y } else { edge.y }) * distance_m
}

/// Which points of the readings count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Obstacles that were read.
    Seen,
    /// Obstacles that the readings may hide.
    Hidden,
}

/// The directions that obstacles leave open.
#[derive(Clone, Copy, Debug)]
pub struct Openings {
    /// Directions to obstacles, of length 1, each with the squared cosine of the angle that it
    /// closes to either side; that angle is at most a quarter turn.
    closed: [(Vec2, f32); MAX_RANGES],
    count: usize,
}

impl Openings {
    /// Whether a direction of length 1 is open.
    pub fn contain(&self, direction: Vec2) -> bool {
        let closed = self.closed.get(..self.count).unwrap_or_default();
        closed.iter().all(|(obstacle, cosine2)| {
            let cosine = obstacle.dot(&direction);
            cosine <= 0.0 || cosine * cosine <= *cosine2
        })
    }
}

impl Obstacles {
    /// The readings nearer than `within_m`, for motion ahead; `seen` are the same as points.
    /// `coming` compares them with earlier scans; those that move by themselves count up to
    /// `coming_m`.
    pub fn near(
        readings: &[RangeReading],
        seen: &Points,
        within_m: f32,
        coming: &[Option<Compared<'_>>],
        coming_m: f32,
    ) -> Self {
        let mut near = Self { points: [Point::NONE; MAX_RANGES], count: 0 };
        let most_m = within_m.max(coming_m);
        let close = readings.iter().zip(seen).filter(|(reading, _)| reading.distance_m < most_m);
        let points = close.map(|(reading, seen)| {
            let velocities = coming.iter().flatten().map(|scan| scan.velocity(*seen));
            let velocity = velocities.into_iter().find(|velocity| *velocity != Vec2::zeros());
            let velocity = velocity.unwrap_or_default();
            Point { velocity, speed_mps: vector::length(velocity), ..Point::of(reading, *seen) }
        });
        let count = points.filter(|point| point.distance_m < within_m || point.speed_mps > 0.0);
        for (slot, point) in near.points.iter_mut().zip(count) {
            *slot = point;
            near.count += 1;
        }
        near
    }

    /// The same for motion astern: the axes are turned by half a turn.
    pub fn astern(&self) -> Self {
        Self { points: self.points.map(|point| point.astern()), count: self.count }
    }

    /// Whether there is nothing near.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn points(&self, kind: Kind) -> impl Iterator<Item = (Vec2, f32)> {
        let points = self.points.get(..self.count).unwrap_or_default();
        points.iter().map(move |point| match kind {
            Kind::Seen => (point.seen, point.distance_m),
            Kind::Hidden => (point.hidden, point.distance_m),
        })
    }

    /// The directions in which a body can drive `length_m` without touching what was read.
    pub fn openings(&self, body: &Body, length_m: f32) -> Openings {
        let mut closed = [(Vec2::zeros(), 0.0); MAX_RANGES];
        let mut count = 0;
        let nearest_m = length_m + body.radius_m + body.aside_m;
        let close = self.points(Kind::Seen).filter(|(_, distance_m)| *distance_m < nearest_m);
        for (slot, (point, distance_m)) in closed.iter_mut().zip(close) {
            let reach_m = body.reach_m(distance_m);
            // The body comes nearest to the point beside it, or at the end of its way.
            let (far, end) = (distance_m * distance_m, length_m * length_m);
            let along = far - reach_m * reach_m;
            let cosine2 = if along <= end {
                along / far
            } else {
                let cosine = (along + end) / (2.0 * distance_m * length_m);
                cosine * cosine
            };
            *slot = (point / distance_m, cosine2);
            count += 1;
        }
        Openings { closed, count }
    }

    /// Whether a body that drives along `arc` touches none of these points.
    pub fn leave_free(&self, kind: Kind, body: &Body, arc: &Arc) -> bool {
        self.points(kind).all(|(point, distance_m)| arc.is_clear_of(body, point, distance_m))
    }

    /// Whether a body that drives along `arc` touches nothing that moves, wherever these obstacles
    /// are within `time_s`.
    pub fn let_pass(&self, body: &Body, arc: &Arc, time_s: f32) -> bool {
        let points = self.points.get(..self.count).unwrap_or_default();
        // So close together that the body does not pass between two of them.
        let wide_m = body.radius_m + body.aside_m;
        let spacing_m = scalar::larger(wide_m, LEAST_DISTANCE_M);
        let nearest_m = arc.length_m + wide_m;
        points.iter().filter(|point| point.speed_mps > 0.0).all(|point| {
            let run_m = point.speed_mps * time_s;
            // It does not come near enough in that time.
            if point.distance_m - run_m >= nearest_m {
                return true;
            }
            let count = scalar::smaller((run_m / spacing_m) as u32 as f32 + 1.0, MOST_PLACES);
            // The nearest place that was seen before may be that of another obstacle: then only the
            // speed is right.
            let here_m = scalar::smaller(run_m, point.distance_m);
            let straight_here = point.seen * (-here_m / point.distance_m);
            let own = point.velocity * time_s;
            let was_behind = arc.leaves_behind(point.seen);
            let is_free = |run: Vec2| {
                // The robot drives away from it.
                let is_behind = was_behind && arc.leaves_behind(point.seen + run);
                let step = run / count;
                is_behind
                    || (1..=count as u32)
                        .all(|place| arc.is_clear_of_place(body, point.seen + step * place as f32))
            };
            is_free(straight_here) && is_free(own)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arc::KEPT;
    use crate::scan::points;
    use proptest::prelude::*;

    fn at(places: &[(f32, f32)]) -> Obstacles {
        let reading = |&(x, y): &(f32, f32)| RangeReading {
            bearing_rad: vector::angle(Vec2::new(x, y)),
            distance_m: vector::length(Vec2::new(x, y)),
        };
        let readings: [RangeReading; 2] =
            [0, 1].map(|i| reading(places.get(i).unwrap_or(&(9.0, 9.0))));
        Obstacles::near(&readings, &points(&readings), 5.0, &[], 0.0)
    }

    fn body(radius_m: f32) -> Body {
        Body { radius_m, aside_m: 0.0 }
    }

    #[test]
    fn a_straight_way_is_as_wide_as_the_body() {
        // Point, length of the way, whether it is open for a body with a radius of 0.5 m.
        for (point, length_m, is_open) in [
            ((2.0, 0.0), 1.4, true),
            ((2.0, 0.0), 1.6, false),
            ((2.0, 0.52), 3.0, true),
            ((2.0, 0.48), 3.0, false),
            ((2.0, -0.48), 3.0, false),
            ((-1.0, 0.0), 3.0, true),
            // Beside the body and nearer than its radius: it may pass, not approach.
            ((0.0, 0.45), 3.0, true),
            ((0.3, 0.35), 3.0, false),
        ] {
            let obstacles = at(&[point]);
            assert_eq!(
                obstacles.leave_free(Kind::Seen, &body(0.5), &Arc::new(length_m, 0.0)),
                is_open,
                "{point:?} {length_m}"
            );
        }
    }

    #[test]
    fn an_arc_passes_what_a_straight_way_meets() {
        // An obstacle straight ahead, and one where the arc leads.
        assert!(!at(&[(1.5, 0.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(1.5, 0.0)));
        assert!(at(&[(1.5, 0.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(1.5, 1.0)));
        assert!(!at(&[(1.0, 1.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(1.5, 1.0)));
        assert!(at(&[(1.0, 1.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(1.5, -1.0)));
        assert!(!at(&[(1.0, -1.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(1.5, -1.0)));
        // A turn on the spot meets nothing outside the body.
        assert!(at(&[(0.4, 0.0), (0.0, 0.4)]).leave_free(
            Kind::Seen,
            &body(0.3),
            &Arc::new(0.0, 1e3)
        ));
        // A tight arc turns towards what is abreast, farther aside than the arc's centre.
        let abreast = at(&[(0.0, -0.6133)]);
        assert!(!abreast.leave_free(Kind::Seen, &body(0.594), &Arc::new(0.5226, -2.829)));
        assert!(abreast.leave_free(Kind::Seen, &body(0.594), &Arc::new(0.5226, 2.829)));
        assert!(abreast.leave_free(Kind::Seen, &body(0.594), &Arc::new(0.5226, -1.5)));
        // A circle meets what lies behind.
        assert!(!at(&[(0.0, 2.0)]).leave_free(Kind::Seen, &body(0.3), &Arc::new(6.3, 1.0)));
    }

    /// An obstacle crosses the way in the middle of its run and is beyond it at the end. A robot with
    /// a radius of 0.3 m drives 3 m.
    #[test]
    fn what_crosses_the_way_is_met_between_its_places() {
        let let_pass = |time_s: f32| {
            let mut near = at(&[(2.5, 0.45)]);
            near.points[0].velocity = Vec2::new(0.0, -1.0);
            near.points[0].speed_mps = 1.0;
            near.let_pass(&body(0.3), &Arc::new(3.0, 0.0), time_s)
        };
        // It comes to the way after 0.15 s, and is past it after 0.75 s.
        assert!(let_pass(0.1) && !let_pass(0.3) && !let_pass(0.8));
    }

    /// Whether a robot with a radius of 0.3 m may drive straight on past an obstacle that moves.
    fn lets_pass(place: (f32, f32), velocity: Vec2, length_m: f32, time_s: f32) -> bool {
        let mut near = at(&[place]);
        near.points[0].velocity = velocity;
        near.points[0].speed_mps = vector::length(velocity);
        near.let_pass(&body(0.3), &Arc::new(length_m, 0.0), time_s)
    }

    /// What moves counts on its own way and straight towards the robot, up to where it is at the end.
    #[test]
    fn what_moves_is_met_where_it_may_be() {
        let (towards, across, away) =
            (Vec2::new(-1.0, 0.0), Vec2::new(0.0, -1.0), Vec2::new(0.0, 1.0));
        for (place, velocity, length_m, time_s, passes) in [
            ((1.0, 0.0), Vec2::zeros(), 1.0, 0.5, true),
            ((1.5, 0.0), towards, 1.0, 0.1, true),
            ((1.5, 0.0), towards, 1.0, 0.5, false),
            ((1.4, 0.0), towards, 1.0, 0.2, false),
            // It may turn towards the robot.
            ((1.5, 0.0), across, 1.0, 0.5, false),
            ((0.0, 1.7), away, 1.0, 1.0, true),
            // It crosses the way ahead, or does not reach it.
            ((2.5, 1.0), across, 3.0, 0.8, false),
            ((2.5, 1.2), across, 3.0, 0.8, true),
            // It overtakes the robot, or stays behind.
            ((-0.5, 0.0), Vec2::new(2.0, 0.0), 1.0, 0.5, false),
            ((-0.9, 0.0), Vec2::new(1.0, 0.0), 1.0, 0.4, true),
        ] {
            assert_eq!(
                lets_pass(place, velocity, length_m, time_s),
                passes,
                "{place:?} {velocity}"
            );
        }
    }

    /// Seen from behind, what is ahead and what moves ahead are behind.
    #[test]
    fn half_a_turn_turns_places_and_velocities() {
        let mut near = at(&[(1.5, 0.5)]);
        near.points[0].velocity = Vec2::new(0.3, -0.2);
        let astern = near.astern().points[0];
        assert_eq!((astern.seen, astern.velocity), (-near.points[0].seen, Vec2::new(-0.3, 0.2)));
        assert!(at(&[]).is_empty() && !near.is_empty());
    }

    /// An obstacle 3 m ahead was 3.4 m away 0.4 s before: it counts beyond 1 m because it moves.
    #[test]
    fn an_obstacle_that_moves_counts_farther_away() {
        let scan = |distance_m: f32| [RangeReading { bearing_rad: 0.0, distance_m }];
        for (before_m, speed_mps) in [(3.4, 1.0), (3.0, 0.0)] {
            let mut closing = crate::closing::Closing::default();
            let still = crate::drive::Twist { speed_mps: 0.0, turn_rate_radps: 0.0 };
            for (scan_us, distance_m) in [(0, before_m), (400_000, 3.0)] {
                let percepts = robot_io::Percepts {
                    scan_us: Some(scan_us),
                    ranges: scan(distance_m).into_iter().collect(),
                    ..robot_io::Percepts::default()
                };
                closing.update(&percepts, &points(&percepts.ranges), &still, 0.4);
            }
            let readings = scan(3.0);
            let near =
                Obstacles::near(&readings, &points(&readings), 1.0, &closing.compared(), 5.0);
            assert_eq!(near.is_empty(), speed_mps == 0.0);
            let [point, ..] = near.points;
            assert!((point.speed_mps - speed_mps).abs() < 1e-3, "{point:?}");
            assert!((point.velocity.x + speed_mps).abs() < 1e-3, "{point:?}");
        }
    }

    /// An obstacle 2 m ahead closes 13.9 degrees to either side of a way of 1.8 m, and 14.5 degrees of
    /// a way that passes it.
    #[test]
    fn an_obstacle_closes_the_directions_that_meet_it() {
        let opens = |length_m: f32, degrees: f32| {
            let openings = at(&[(2.0, 0.0)]).openings(&body(0.5), length_m);
            openings.contain(vector::from_angle(degrees.to_radians()))
        };
        for (length_m, closed, open) in [(1.6, 9.0, 10.2), (1.8, 13.4, 14.3), (3.0, 14.0, 15.0)] {
            assert!(!opens(length_m, closed) && !opens(length_m, -closed), "{length_m}");
            assert!(opens(length_m, open) && opens(length_m, -open), "{length_m}");
        }
        assert!(opens(1.4, 0.0), "it ends before the obstacle");
    }

    #[test]
    fn a_hidden_obstacle_is_at_the_edge_of_the_sector_towards_the_way() {
        let reading =
            |degrees: f32| RangeReading { bearing_rad: degrees.to_radians(), distance_m: 1.0 };
        for (degrees, edge) in [
            (5.0, 0.0),
            (30.0, 11.25),
            (-30.0, -11.25),
            (80.0, 78.75),
            (120.0, 101.25),
            (140.0, 123.75),
            (165.0, 146.25),
            (-175.0, -168.75),
        ] {
            let readings = [RangeReading { distance_m: 1.5, ..reading(degrees) }];
            let near = Obstacles::near(&readings, &points(&readings), 2.0, &[], 0.0);
            let hidden = near.points[0].hidden;
            let found = vector::angle(hidden).to_degrees();
            assert!((found - edge).abs() < 0.2, "{degrees}: {found}");
            assert!((vector::length(hidden) - 1.5).abs() < 1e-3, "{degrees}: {hidden}");
        }
        let readings = [reading(150.0)];
        let astern = Obstacles::near(&readings, &points(&readings), 2.0, &[], 0.0).astern();
        let found = vector::angle(astern.points[0].hidden).to_degrees();
        assert!((found + 11.25).abs() < 0.2, "{found}");
    }

    proptest! {
        /// The body's centre, moved along a free arc in small steps, stays out of reach of the
        /// point.
        #[test]
        fn a_free_arc_touches_nothing(
            x in -2.0_f32..2.0, y in -2.0_f32..2.0, radius_m in 0.1_f32..0.6,
            length_m in 0.0_f32..2.5, curvature in -4.0_f32..4.0,
        ) {
            let point = Vec2::new(x, y);
            prop_assume!(vector::length(point) > radius_m + 0.01);
            let is_free = at(&[(x, y)]).leave_free(Kind::Seen, &body(radius_m), &Arc::new(length_m, curvature));
            let mut nearest = f32::INFINITY;
            for step in 0..=200 {
                let turn = length_m * step as f32 / 200.0 * curvature;
                let centre = if curvature.abs() < 1e-3 {
                    Vec2::new(length_m * step as f32 / 200.0, 0.0)
                } else {
                    Vec2::new(scalar::sin(turn), 1.0 - scalar::cos(turn)) / curvature
                };
                nearest = nearest.min(vector::length(point - centre));
            }
            let reach = radius_m.min(KEPT * vector::length(point));
            // Sines and cosines are good to 1e-3, about the arc's radius.
            let slack = 0.01 + 2e-3 / curvature.abs().max(0.01);
            prop_assert!(!is_free || nearest >= reach - slack, "{nearest} {reach}");
            let turned = (length_m * curvature).abs();
            prop_assert!(is_free || turned >= scalar::PI || nearest <= reach + slack || x <= 0.0);
        }
    }
}
