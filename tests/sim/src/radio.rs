//! The radio between the robots of a team: what one robot tells reaches another only through the
//! air, and late, and not always.
//!
//! Each robot sends its news a few times per second. A packet arrives if the air carries it over
//! the positions of both robots at the moment of sending, and if it is not lost by chance. All
//! draws follow from one seed and the numbers of the two robots, so the order of the robots does
//! not matter.

use std::fmt;

use crate::network::Links;
use crate::{Point, Random, Stream, TICK_US};
use maps::radio::{Model, Sight};
use robot_io::limits::MAX_MATES;
use robot_io::{Heard, News};

/// Heard news as a record holds them.
type Arrivals = heapless::Vec<Heard, MAX_MATES>;

/// What carries radio between two points.
pub trait Air {
    /// Quality of the link between two points, 0 to 1; `None` if nothing arrives.
    fn quality(&self, a: Point, b: Point) -> Option<f64>;
}

/// The rule of the paper's experiments (W, section 4): a link is up or it is not.
impl Air for Sight {
    fn quality(&self, a: Point, b: Point) -> Option<f64> {
        self.is_linked(a, b).then_some(1.0)
    }
}

/// Computed losses: the quality is that of the signal, 1 from [`GOOD_DB`] above the sensitivity on.
impl Air for Model {
    fn quality(&self, a: Point, b: Point) -> Option<f64> {
        let margin_db = self.margin_db(a, b);
        (margin_db >= 0.0).then_some((margin_db / GOOD_DB).min(1.0))
    }
}

/// A signal this far above the sensitivity of the receiver is as good as any, dB.
const GOOD_DB: f64 = 20.0;

/// How the robots of a team send.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioSettings {
    /// Packets of each robot per second.
    pub rate_hz: f64,
    /// Time from sending to arrival, seconds.
    pub delay_s: f64,
    /// Share of the packets that is lost although the air would carry them, 0 to 1.
    pub loss: f64,
    /// Share of every second in which the robots send at all, 0 to 1.
    pub duty: f64,
}

impl Default for RadioSettings {
    /// Five packets per second that arrive in the next tick, as boards send them.
    fn default() -> Self {
        Self { rate_hz: 5.0, delay_s: 0.0, loss: 0.0, duty: 1.0 }
    }
}

/// The radios of a team, and the packets on their way.
pub struct Radio<'w> {
    air: &'w dyn Air,
    settings: RadioSettings,
    seed: u64,
    /// A stream for each pair of a sender and a receiver, by their numbers in the team.
    draws: Vec<((u8, u8), Random)>,
    packets: Vec<Packet>,
}

struct Packet {
    due_tick: u64,
    to: usize,
    heard: Heard,
}

impl<'w> Radio<'w> {
    /// Radios before the first packet.
    pub fn new(air: &'w dyn Air, settings: RadioSettings, seed: u64) -> Self {
        Self { air, settings, seed, draws: Vec::new(), packets: Vec::new() }
    }

    /// Which robots reach each other now, apart from losses by chance.
    pub fn links(&self, at: &[Point]) -> Links {
        Links::new(at.len(), |a, b| self.air.quality(at[a], at[b]).is_some())
    }

    /// Sends what each robot has to tell at the end of a tick, if it is time to send. Both lists
    /// have the order of the robots.
    pub fn send(&mut self, tick: u64, at: &[Point], news: &[Option<News>]) {
        if !self.is_due(tick) {
            return;
        }
        let delay_ticks = (self.settings.delay_s * 1e6 / TICK_US as f64).round() as u64;
        for (from, told) in news.iter().enumerate() {
            let Some(told) = *told else { continue };
            for (to, heard_by) in news.iter().enumerate() {
                let Some(other) = heard_by.filter(|_| to != from) else { continue };
                // Drawn in any case, so that one loss does not change the next.
                let is_lost = self.draw(told.robot, other.robot) < self.settings.loss;
                let quality = self.air.quality(at[from], at[to]).filter(|_| !is_lost);
                if let Some(quality) = quality {
                    let heard = Heard { news: told, quality: quality as f32 };
                    self.packets.push(Packet { due_tick: tick + 1 + delay_ticks, to, heard });
                }
            }
        }
    }

    /// What arrives at a robot in a tick: of several packets of one mate, the last.
    pub fn deliver(&mut self, tick: u64, to: usize) -> Arrivals {
        let mut arrivals = Arrivals::new();
        self.packets.retain(|packet| {
            let is_due = packet.to == to && packet.due_tick <= tick;
            if is_due {
                let robot = packet.heard.news.robot;
                match arrivals.iter_mut().find(|known| known.news.robot == robot) {
                    Some(known) => *known = packet.heard,
                    // A robot listens to as many mates as a record holds.
                    None => drop(arrivals.push(packet.heard)),
                }
            }
            !is_due
        });
        arrivals
    }

    fn is_due(&self, tick: u64) -> bool {
        let ticks_per_second = 1e6 / TICK_US as f64;
        let period = (ticks_per_second / self.settings.rate_hz).round().max(1.0) as u64;
        let into_second = (tick * TICK_US % 1_000_000) as f64 * 1e-6;
        tick.is_multiple_of(period) && into_second < self.settings.duty
    }

    fn draw(&mut self, from: u8, to: u8) -> f64 {
        let pair = (from, to);
        let index = self.draws.iter().position(|(known, _)| *known == pair);
        let index = index.unwrap_or_else(|| {
            let seed = self.seed.wrapping_add(u64::from(from) << 8 | u64::from(to));
            self.draws.push((pair, Random::new(seed, Stream::Radio)));
            self.draws.len() - 1
        });
        self.draws[index].1.unit()
    }
}

impl fmt::Debug for Radio<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Radio").field("settings", &self.settings).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::radio::Settings;
    use maps::{Extent, Feature, Map, Role, Shape};

    /// A wall east of the first robot; the third is north of both.
    fn map() -> Map {
        let mut map = Map::empty(Extent { corner: [-20.0, -20.0], size: [60.0, 60.0] });
        let shape = Shape::Polyline(vec![[5.0, -4.0], [5.0, 4.0]]);
        let (role, name, height_m) = (Role::Obstacle, "wall".to_owned(), None);
        map.features = vec![Feature { shape, role, name, height_m, span: 0..0 }];
        map
    }

    fn air() -> Sight {
        Sight::of(&map(), &Settings::default())
    }

    const AT: [Point; 3] = [[0.0, 0.0], [10.0, 0.0], [5.0, 9.0]];

    /// In the open at 2.4 GHz the signal is far above the sensitivity; with a weak transmitter it
    /// comes near it, and behind the wall it is lost.
    #[test]
    fn computed_losses_make_the_quality() {
        let of = |power_dbm| Model::of(&map(), &Settings { power_dbm, ..Settings::default() });
        let far = [30.0, 30.0];
        assert_eq!(of(24.0).quality(AT[0], AT[2]), Some(1.0));
        let weak = of(-30.0).quality(AT[2], far).expect("there is nothing between");
        assert!((0.0..1.0).contains(&weak), "{weak}");
        assert_eq!(of(-42.0).quality(AT[0], AT[1]), None);
    }

    fn news() -> [Option<News>; 3] {
        [0, 1, 2].map(|robot| Some(News { robot, position_m: None, signal: 0 }))
    }

    /// What each robot hears in each of 40 ticks: the senders' numbers.
    fn heard(settings: RadioSettings, seed: u64) -> Vec<[Vec<u8>; 3]> {
        let air = air();
        let mut radio = Radio::new(&air, settings, seed);
        let ticks = (0..40).map(|tick| {
            let heard = [0, 1, 2].map(|robot| {
                radio.deliver(tick, robot).iter().map(|heard| heard.news.robot).collect()
            });
            radio.send(tick, &AT, &news());
            heard
        });
        ticks.collect()
    }

    fn count(heard: &[[Vec<u8>; 3]]) -> usize {
        heard.iter().flatten().map(Vec::len).sum()
    }

    #[test]
    fn terrain_ends_links_and_nothing_else_does() {
        let heard = heard(RadioSettings::default(), 1);
        for (tick, heard) in heard.iter().enumerate() {
            let expected: [Vec<u8>; 3] = match tick % 4 {
                1 => [vec![2], vec![2], vec![0, 1]],
                _ => Default::default(),
            };
            assert_eq!(*heard, expected, "{tick}");
        }
        let air = air();
        let links = Radio::new(&air, RadioSettings::default(), 1).links(&AT);
        assert!(!links.are_linked(0, 1) && links.is_one_network() && links.pairs() == 2);
    }

    #[test]
    fn packets_come_late_rarely_and_in_their_share_of_a_second() {
        let usual = RadioSettings::default();
        let late = heard(RadioSettings { delay_s: 0.5, ..usual }, 1);
        assert!(late[..11].iter().flatten().all(Vec::is_empty) && !late[11][0].is_empty());
        // The first two of the five packets in each of two seconds.
        let short = heard(RadioSettings { duty: 0.3, ..usual }, 1);
        assert_eq!((count(&heard(usual, 1)), count(&short)), (40, 16));
        let lossy = RadioSettings { loss: 0.5, ..usual };
        let lost = 40 - count(&heard(lossy, 1));
        assert!((10..=30).contains(&lost), "{lost}");
        assert_eq!(heard(lossy, 1), heard(lossy, 1));
        assert_ne!(heard(lossy, 1), heard(lossy, 2));
    }
}
