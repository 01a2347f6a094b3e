//! Links to mates, and what the robot tells them.

use behaviour::Mate;
use heapless::Vec;
use math::Vec2;
use plan_format::parameters::Parameters;
use plan_format::{TeamPolicy, limits::MAX_ROBOTS};
use robot_io::limits::MAX_MATES;
use robot_io::{Commands, Heard, News, Percepts};

const _: () = assert!(MAX_ROBOTS == robot_io::limits::MAX_ROBOTS);

/// What the robot knows of its mates in one tick.
pub type Mates = Vec<Mate, MAX_MATES>;

/// Links to mates, by their numbers, and the last news of the robot itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Team {
    /// The mates that have sent news without a silence, and since when, microseconds.
    steady_since_us: [Option<u64>; MAX_ROBOTS],
    /// The last time at which news were good enough, microseconds.
    heard_us: [Option<u64>; MAX_ROBOTS],
    /// What the robot has to say.
    news: News,
}

impl Team {
    /// What the robot tells its mates after the last tick; `None` without a team.
    pub fn news(&self, policy: &TeamPolicy) -> Option<News> {
        (policy.mates() != 0).then_some(self.news)
    }

    /// Notes the news in the percepts, and updates the links.
    ///
    /// News of the robot itself, which a shared channel may echo, and of robots outside the team
    /// are not used.
    pub fn listen(&mut self, policy: &TeamPolicy, percepts: &Percepts) -> Mates {
        let mut mates = Mates::new();
        for mate in &percepts.mates {
            let Heard { news, quality } = mate.heard;
            // News of the future are from before the clock was set back.
            let is_known = policy.mates() & 1_u8.wrapping_shl(news.robot.into()) != 0;
            if !is_known || mate.time_us > percepts.time_us {
                continue;
            }
            let is_good = quality >= policy.min_quality;
            let age_us = percepts.time_us.saturating_sub(mate.time_us);
            let known = Mate {
                robot: news.robot,
                is_linked: self.is_linked(policy, percepts.time_us, mate.time_us, is_good, news),
                quality,
                age_s: age_us as f32 / 1e6,
                position: news.position_m.map(Vec2::from),
                signal: news.signal,
            };
            // Never full: percepts hold at most as many mates.
            let _ = mates.push(known);
        }
        mates
    }

    /// Whether the link is up: news have arrived for a while, and none of the silences between
    /// them was too long.
    fn is_linked(
        &mut self,
        policy: &TeamPolicy,
        now_us: u64,
        arrived_us: u64,
        is_good: bool,
        news: News,
    ) -> bool {
        let index = usize::from(news.robot);
        let (Some(heard), Some(since)) =
            (self.heard_us.get_mut(index), self.steady_since_us.get_mut(index))
        else {
            return false;
        };
        if heard.is_some_and(|heard_us| heard_us > now_us) {
            (*heard, *since) = (None, None);
        }
        if is_good {
            *heard = Some(arrived_us);
        }
        let silence_us = heard.map(|heard_us| now_us.saturating_sub(heard_us));
        let is_silent = silence_us.is_none_or(|silence| silence >= policy.lost_after_us.into());
        *since = if is_silent { None } else { Some(since.unwrap_or(now_us)) };
        // A single packet makes no link: the span of the news counts, not the time since the first.
        since.zip(*heard).is_some_and(|(since_us, heard_us)| {
            heard_us.saturating_sub(since_us) >= policy.regained_after_us.into()
        })
    }

    /// Notes what the robot tells its mates: its position, and its last signal.
    pub fn speak(&mut self, policy: &TeamPolicy, position: Option<Vec2>, commands: &Commands) {
        let signal = if commands.signal == 0 { self.news.signal } else { commands.signal };
        self.news = News { robot: policy.robot, position_m: position.map(Into::into), signal };
    }
}

/// Vectors of avoid-robot and tether, with their gains. Only mates whose link is up count: a lost
/// mate is somewhere else by now.
pub fn steer(parameters: &Parameters, mates: &Mates, position: Vec2) -> Vec2 {
    let policy = &parameters.team;
    let linked = || mates.iter().filter(|mate| mate.is_linked);
    let away = schemas::avoid_robot(
        position,
        linked().filter_map(|mate| mate.position),
        parameters.vehicle.radius_m,
        parameters.schemas.avoid_margin_m,
        policy.avoid_sphere_m,
    );
    let tethered = linked().find(|mate| Some(mate.robot) == policy.tether_to);
    let pull = tethered
        .and_then(|mate| mate.position)
        .map_or(Vec2::zeros(), |mate| schemas::tether(position, mate, policy.tether_m));
    away * policy.avoid_gain + pull
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use plan_format::Parameters;
    use robot_io::Mate as Arrived;

    const POLICY: TeamPolicy = TeamPolicy {
        robot: 0,
        robots: 3,
        lost_after_us: 750_000,
        regained_after_us: 500_000,
        min_quality: 0.2,
        avoid_gain: 1.0,
        avoid_sphere_m: 2.0,
        tether_to: Some(2),
        tether_m: 10.0,
    };

    fn arrived(time_us: u64, robot: u8, quality: f32) -> Arrived {
        let news = News { robot, position_m: Some([4.0, 0.0]), signal: 3 };
        Arrived { time_us, heard: Heard { news, quality } }
    }

    /// Whether the link to mate 1 is up at each tick of 50 ms, if news of it arrive at `heard`.
    fn links(ticks: u64, quality: f32, heard: impl Fn(u64) -> bool) -> std::vec::Vec<bool> {
        let mut team = Team::default();
        let mut last = None;
        let tick = |tick: u64| {
            let time_us = tick * 50_000;
            if heard(tick) {
                last = Some(arrived(time_us, 1, quality));
            }
            let mates = last.into_iter().collect();
            let mates = team.listen(&POLICY, &Percepts { time_us, mates, ..Percepts::default() });
            mates.iter().any(|mate| mate.is_linked)
        };
        (0..ticks).map(tick).collect()
    }

    fn first(links: &[bool], state: bool, from: usize) -> Option<usize> {
        (from..links.len()).find(|&tick| links[tick] == state)
    }

    /// W32: a link is damped both ways, at the predicted ticks.
    #[test]
    fn w32_a_link_is_lost_and_regained_at_the_predicted_ticks() {
        // News until tick 40 and again from tick 100 on.
        let found = links(160, 1.0, |tick| !(41..100).contains(&tick));
        assert_eq!(first(&found, true, 0), Some(10), "0.5 s after the first news");
        assert_eq!(first(&found, false, 10), Some(55), "0.75 s after the last news");
        assert_eq!(first(&found, true, 55), Some(110), "0.5 s after they come again");
        // Silences of 14 ticks are not long enough.
        let found = links(200, 1.0, |tick| tick.is_multiple_of(14));
        assert_eq!(first(&found, false, 14), None);
        // Single news every 16 ticks never make a link, nor do news of a poor quality.
        assert_eq!(first(&links(200, 1.0, |tick| tick.is_multiple_of(16)), true, 0), None);
        assert_eq!(first(&links(200, 0.1, |_| true), true, 0), None);
    }

    /// After ten seconds the clock is set back by eight. The mate that is still heard is linked again
    /// as soon as at the start, and the one that has fallen silent is not.
    #[test]
    fn links_begin_anew_after_the_clock_was_set_back() {
        let mut team = Team::default();
        let links = (0..240_u64).map(|tick| {
            let set_us = |tick: u64| tick * 50_000 - if tick < 200 { 0 } else { 8_000_000 };
            let heard = [arrived(set_us(tick), 1, 1.0), arrived(set_us(tick.min(199)), 2, 1.0)];
            let (time_us, mates) = (set_us(tick), heard.into_iter().collect());
            let mates = team.listen(&POLICY, &Percepts { time_us, mates, ..Percepts::default() });
            [1, 2].map(|robot| mates.iter().any(|mate| mate.robot == robot && mate.is_linked))
        });
        let links: std::vec::Vec<_> = links.collect();
        assert_eq!((links[199], links[200]), ([true, true], [false, false]));
        let again = (200..240).find(|&tick| links[tick][0]);
        assert_eq!((again, links[239]), (Some(210), [true, false]));
    }

    #[test]
    fn an_echo_and_a_stranger_are_not_mates() {
        let strangers = [0, 3, 4].map(|robot| arrived(0, robot, 1.0));
        let percepts = Percepts { mates: strangers.into_iter().collect(), ..Percepts::default() };
        assert!(Team::default().listen(&POLICY, &percepts).is_empty());
    }

    #[test]
    fn linked_mates_repel_and_pull_and_lost_ones_do_not() {
        let parameters = Parameters { team: POLICY, ..Parameters::default() };
        let mate = |robot, is_linked, x| Mate {
            robot,
            is_linked,
            quality: 1.0,
            age_s: 0.0,
            position: Some(Vec2::new(x, 0.0)),
            signal: 0,
        };
        let at_origin =
            |mates: &[Mate]| steer(&parameters, &mates.iter().copied().collect(), Vec2::zeros()).x;
        assert_eq!(at_origin(&[mate(1, true, 0.5)]), -1.0);
        assert_eq!(at_origin(&[mate(1, false, 0.5)]), 0.0);
        assert_eq!(at_origin(&[mate(2, true, 15.0)]), 1.0, "the tether is to mate 2");
        assert_eq!(at_origin(&[mate(1, true, 15.0)]), 0.0);
        // The gain is for the mates that repel, not for the tether.
        let team = TeamPolicy { avoid_gain: 0.5, ..POLICY };
        let parameters = Parameters { team, ..Parameters::default() };
        let all: Mates = [mate(1, true, 0.5), mate(2, true, -15.0)].into_iter().collect();
        assert_eq!(steer(&parameters, &all, Vec2::zeros()).x, -1.5);
    }

    #[test]
    fn news_have_an_age_in_seconds() {
        let mates = [arrived(1_000_000, 1, 1.0)].into_iter().collect();
        let percepts = Percepts { time_us: 3_500_000, mates, ..Percepts::default() };
        assert_eq!(Team::default().listen(&POLICY, &percepts)[0].age_s, 2.5);
    }

    #[test]
    fn the_last_signal_stays_in_the_news() {
        let mut team = Team::default();
        let say = |team: &mut Team, signal| {
            let commands = Commands { signal, ..Commands::stop(robot_io::Reason::Idle) };
            team.speak(&POLICY, Some(Vec2::new(1.0, 2.0)), &commands);
            team.news(&POLICY)
        };
        let news = News { robot: 0, position_m: Some([1.0, 2.0]), signal: 9 };
        assert_eq!(say(&mut team, 9), Some(news));
        assert_eq!(say(&mut team, 0), Some(news));
        let alone = TeamPolicy { robots: 1, ..POLICY };
        assert_eq!(team.news(&alone), None);
    }
}
