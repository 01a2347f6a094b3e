//! The latest news of each mate, and when they arrived.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;
use robot_io::limits::MAX_MATES;
use robot_io::{Heard, Mate};

/// The latest news of each mate, shared between tasks.
pub struct MateSlot<M: RawMutex>(Mutex<M, RefCell<Vec<Mate, MAX_MATES>>>);

impl<M: RawMutex> Default for MateSlot<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> MateSlot<M> {
    /// A slot without mates.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Vec::new())))
    }

    /// Stores news that arrived at `time_us` in place of that mate's last ones. If too many robots
    /// speak, the one that has been silent for longest is forgotten.
    pub fn hear(&self, time_us: u64, heard: Heard) {
        let mate = Mate { time_us, heard };
        self.0.lock(|cell| {
            let Ok(mut mates) = cell.try_borrow_mut() else { return };
            let robot = heard.news.robot;
            if let Some(known) = mates.iter_mut().find(|known| known.heard.news.robot == robot) {
                *known = mate;
            } else if let Err(mate) = mates.push(mate)
                && let Some(oldest) = mates.iter_mut().min_by_key(|known| known.time_us)
            {
                *oldest = mate;
            }
        });
    }

    /// The latest news of each mate.
    pub fn latest(&self) -> Vec<Mate, MAX_MATES> {
        self.0.lock(|cell| cell.try_borrow().map(|mates| mates.clone()).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use robot_io::News;

    #[test]
    fn the_latest_news_of_each_mate_are_kept_and_the_most_silent_mate_is_forgotten() {
        let slot = MateSlot::<NoopRawMutex>::new();
        let say = |time_us, robot, signal| {
            let news = News { robot, position_m: None, signal };
            slot.hear(time_us, Heard { news, quality: 1.0 });
        };
        (1..=MAX_MATES as u8).for_each(|robot| say(robot.into(), robot, 0));
        say(9, 1, 5);
        say(10, 7, 0);
        let known = slot.latest();
        let known: Vec<_, MAX_MATES> =
            known.iter().map(|mate| (mate.heard.news.robot, mate.time_us)).collect();
        assert_eq!(known, [(1, 9), (7, 10), (3, 3), (4, 4)]);
        assert_eq!(slot.latest()[0].heard.news.signal, 5);
    }
}
