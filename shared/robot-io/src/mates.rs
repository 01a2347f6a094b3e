//! What the robots of a team send to each other.

use crate::limits::MAX_ROBOTS;
use serde::{Deserialize, Serialize};

/// What a robot sends to its mates: the whole state that they may use, so the next news make up for
/// lost ones. Source: W, "robots share only positions and link reports".
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct News {
    /// The sender's number in its team, below [`MAX_ROBOTS`].
    pub robot: u8,
    /// The sender's position, map metres; `None` while it does not know it.
    pub position_m: Option<[f32; 2]>,
    /// Code of the sender's last `signal` action; 0 before the first.
    pub signal: u16,
}

/// News that arrived over a radio.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Heard {
    /// The news.
    pub news: News,
    /// Quality of the link, 0 to 1, as the radio reports it; 1 if it does not.
    pub quality: f32,
}

/// The latest news of one mate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mate {
    /// Arrival of the news, on the clock of [`crate::Percepts::time_us`].
    pub time_us: u64,
    /// The news, with the quality of the link.
    pub heard: Heard,
}

impl Mate {
    /// The mate without values that are not finite; `None` if the number is not one of a team.
    pub(crate) fn sanitised(self) -> Option<Self> {
        let Heard { news, quality } = self.heard;
        let is_finite = |metres: &[f32; 2]| metres.iter().all(|metres| metres.is_finite());
        let news = News { position_m: news.position_m.filter(is_finite), ..news };
        let quality = if quality.is_finite() { quality.clamp(0.0, 1.0) } else { 0.0 };
        let is_robot = usize::from(news.robot) < MAX_ROBOTS;
        is_robot.then_some(Self { heard: Heard { news, quality }, ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn news_become_finite_and_need_a_number_of_the_team() {
        let heard = |robot, x, quality| {
            let news = News { robot, position_m: Some([x, 1.0]), signal: 3 };
            Mate { time_us: 7, heard: Heard { news, quality } }.sanitised()
        };
        assert_eq!(heard(MAX_ROBOTS as u8, 0.0, 1.0), None);
        let odd = heard(4, f32::NAN, f32::INFINITY).unwrap();
        assert_eq!((odd.time_us, odd.heard.quality), (7, 0.0));
        assert_eq!(odd.heard.news, News { robot: 4, position_m: None, signal: 3 });
        assert_eq!(heard(0, 2.0, 9.0).unwrap().heard.quality, 1.0);
    }
}
