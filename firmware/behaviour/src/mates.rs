//! What is known of the robot's mates, and the facts and inputs about them.

use math::{Vec2, vector};
use plan_format::mission::FactKind;

/// What the robot knows of one mate in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mate {
    /// Its number in the team.
    pub robot: u8,
    /// Whether the link to it is up.
    pub is_linked: bool,
    /// Quality of the link at its last news, 0 ..= 1.
    pub quality: f32,
    /// Age of its last news, seconds.
    pub age_s: f32,
    /// Its position in these news, map metres, if it knew it.
    pub position: Option<Vec2>,
    /// Code of its last signal; 0 for none.
    pub signal: u16,
}

/// Whether a fact about mates holds; `None` for facts of other kinds.
///
/// News count while the link is up. Without them, the fact's own value for missing news counts.
pub(crate) fn holds(fact: FactKind, mates: &[Mate], position: Option<Vec2>) -> Option<bool> {
    let linked = |robot| mates.iter().find(|mate| mate.robot == robot && mate.is_linked);
    let distance_m = |robot, from: Vec2| {
        linked(robot).and_then(|mate| mate.position).map(|at| vector::length(at - from))
    };
    Some(match fact {
        FactKind::Linked(which) => which.hold(|robot| Some(linked(robot).is_some())),
        FactKind::MateNear { mates: which, radius_m } => which.hold(|robot| {
            position.and_then(|here| distance_m(robot, here)).map(|distance| distance <= radius_m)
        }),
        FactKind::MateAt { mates: which, x_m, y_m, radius_m } => which.hold(|robot| {
            distance_m(robot, Vec2::new(x_m, y_m)).map(|distance| distance <= radius_m)
        }),
        FactKind::MateSignals { mates: which, code } => {
            which.hold(|robot| linked(robot).map(|mate| mate.signal == code))
        }
        FactKind::Symbol { .. }
        | FactKind::Level { .. }
        | FactKind::Near { .. }
        | FactKind::Inside { .. }
        | FactKind::NoProgress { .. } => return None,
    })
}

/// Number of mates to which the link is up.
pub(crate) fn linked(mates: &[Mate]) -> f32 {
    mates.iter().filter(|mate| mate.is_linked).count() as f32
}

/// Age of the oldest news, seconds; `None` unless each of `robots`, one bit each, was heard.
pub(crate) fn oldest_news_s(mates: &[Mate], robots: u8) -> Option<f32> {
    let heard = mates.iter().fold(0, |heard, mate| heard | 1_u8.wrapping_shl(mate.robot.into()));
    let ages = mates.iter().map(|mate| mate.age_s);
    (robots != 0 && heard & robots == robots).then(|| ages.fold(0.0, f32::max))
}

/// Distance to the nearest of these mates, one bit each, to which the link is up, metres.
pub(crate) fn distance_m(mates: &[Mate], robots: u8, position: Option<Vec2>) -> Option<f32> {
    let here = position?;
    let among = |mate: &&Mate| mate.is_linked && robots >> mate.robot.min(7) & 1 == 1;
    let distances = mates.iter().filter(among).filter_map(|mate| mate.position);
    distances.map(|at| vector::length(at - here)).reduce(f32::min)
}

/// Quality of the link to a mate: 0 while it is lost.
pub(crate) fn quality(mates: &[Mate], robot: u8) -> f32 {
    let mate = mates.iter().find(|mate| mate.robot == robot && mate.is_linked);
    mate.map_or(0.0, |mate| mate.quality)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plan_format::mission::Mates;

    const fn mate(robot: u8, is_linked: bool, x: f32, signal: u16) -> Mate {
        let position = Some(Vec2::new(x, 0.0));
        Mate { robot, is_linked, quality: 0.5, age_s: robot as f32, position, signal }
    }

    /// Mate 1 is near and linked, mate 2 far and linked, mate 3 near and lost; mate 4 was never
    /// heard.
    const MATES: [Mate; 3] =
        [mate(1, true, 3.0, 7), mate(2, true, 40.0, 9), mate(3, false, 1.0, 7)];

    fn of(robots: u8, all: bool, missing: bool) -> Mates {
        Mates { robots, all, missing }
    }

    /// W32: "can talk to robot i", to all, to any.
    #[test]
    fn w32_links_to_one_to_all_and_to_any() {
        let linked =
            |robots, all| holds(FactKind::Linked(of(robots, all, false)), &MATES, None).unwrap();
        let table = [
            (0b0_0010, true, true),
            (0b0_1000, true, false),
            (0b0_0110, true, true),
            (0b1_0110, true, false),
            (0b1_1010, false, true),
            (0b1_1000, false, false),
        ];
        for (robots, all, expected) in table {
            assert_eq!(linked(robots, all), expected, "{robots:b} {all}");
        }
    }

    #[test]
    fn news_count_while_the_link_is_up_and_else_as_declared() {
        let here = Some(Vec2::zeros());
        let near = |robots, all, missing| {
            let mates = of(robots, all, missing);
            holds(FactKind::MateNear { mates, radius_m: 5.0 }, &MATES, here).unwrap()
        };
        assert!(near(0b0_0010, true, false), "near and linked");
        assert!(!near(0b0_0100, true, true), "far and linked");
        assert!(!near(0b0_1000, true, false) && near(0b0_1000, true, true), "near and lost");
        assert!(!near(0b1_0000, true, false) && near(0b1_0000, true, true), "never heard");
        assert!(near(0b0_0110, false, false) && !near(0b0_0110, true, false), "any and all");
        let signals = |robot: u8, code| {
            let mates = of(1 << robot, true, false);
            holds(FactKind::MateSignals { mates, code }, &MATES, here).unwrap()
        };
        assert!(signals(1, 7) && !signals(1, 9) && signals(2, 9) && !signals(3, 7));
        let at = |x_m| {
            let mates = of(0b0_0100, true, false);
            holds(FactKind::MateAt { mates, x_m, y_m: 0.0, radius_m: 2.0 }, &MATES, None).unwrap()
        };
        assert!(at(39.0) && !at(37.0));
    }

    #[test]
    fn inputs_about_mates() {
        assert_eq!(linked(&MATES), 2.0);
        assert_eq!(oldest_news_s(&MATES, 0b1110), Some(3.0));
        assert_eq!(oldest_news_s(&MATES, 0b1_1110), None, "mate 4 was never heard");
        assert_eq!(distance_m(&MATES, 0b1110, Some(Vec2::new(1.0, 0.0))), Some(2.0));
        assert_eq!(distance_m(&MATES, 0b1000, Some(Vec2::zeros())), None, "its link is lost");
        assert_eq!([quality(&MATES, 1), quality(&MATES, 3), quality(&MATES, 4)], [0.5, 0.0, 0.0]);
    }
}
