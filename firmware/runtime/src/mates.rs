//! The latest news of each robot of the team, and when they arrived.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;
use robot_io::limits::{MAX_MATES, MAX_ROBOTS};
use robot_io::{Heard, Mate};

/// The latest news of each robot, shared between tasks.
///
/// There is room for every number that a team may have, so that neither the echo of the robot's own
/// news nor a robot of another team on the same channel displaces a mate.
pub struct MateSlot<M: RawMutex>(Mutex<M, RefCell<Vec<Mate, MAX_ROBOTS>>>);

impl<M: RawMutex> Default for MateSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> MateSlot<M> {
    /// A slot without news.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Vec::new())))
    }

    /// Stores news that arrived at `time_us` in place of that robot's last ones. News with a number
    /// that no team has are not stored.
    pub fn hear(&self, time_us: u64, heard: Heard) {
        let robot = heard.news.robot;
        if usize::from(robot) >= MAX_ROBOTS {
            return;
        }
        let mate = Mate { time_us, heard };
        self.0.lock(|cell| {
            let Ok(mut robots) = cell.try_borrow_mut() else { return };
            if let Some(known) = robots.iter_mut().find(|known| known.heard.news.robot == robot) {
                *known = mate;
            } else {
                // Never full: there is room for each number.
                let _ = robots.push(mate);
            }
        });
    }

    /// The latest news of each mate, in the order of their first arrival. `team` has a bit for the
    /// number of each mate, as [`plan_format::TeamPolicy::mates`].
    pub fn latest(&self, team: u8) -> Vec<Mate, MAX_MATES> {
        let is_mate = |mate: &&Mate| team & 1_u8.wrapping_shl(mate.heard.news.robot.into()) != 0;
        self.0.lock(|cell| {
            let mut mates = Vec::new();
            let Ok(robots) = cell.try_borrow() else { return mates };
            for mate in robots.iter().filter(is_mate) {
                // Never full: a robot is not its own mate.
                let _ = mates.push(*mate);
            }
            mates
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use robot_io::News;

    #[test]
    fn the_latest_news_of_each_mate_are_kept_in_the_order_of_their_first_arrival() {
        let slot = MateSlot::<NoopRawMutex>::new();
        let say = |time_us, robot, signal| {
            let news = News { robot, position_m: None, signal };
            slot.hear(time_us, Heard { news, quality: 1.0 });
        };
        let known = |team| {
            let mates = slot.latest(team).into_iter();
            mates.map(|mate| (mate.heard.news.robot, mate.time_us)).collect::<Vec<_, MAX_MATES>>()
        };
        assert_eq!(known(0b1_1110), []);
        [3, 0, 1, 4, 2].into_iter().zip(1..).for_each(|(robot, time_us)| say(time_us, robot, 0));
        say(9, 1, 5);
        (MAX_ROBOTS as u8..=u8::MAX).for_each(|robot| say(10, robot, 0));
        assert_eq!(known(0b1_1110), [(3, 1), (1, 9), (4, 4), (2, 5)]);
        assert_eq!(known(0b0_1011), [(3, 1), (0, 2), (1, 9)]);
        assert_eq!(known(0), [], "a robot without a team has no mates");
        assert_eq!(known(u8::MAX), [(3, 1), (0, 2), (1, 9), (4, 4)], "as many as percepts hold");
        assert_eq!(slot.latest(0b10)[0].heard.news.signal, 5);
    }
}
