//! The network of a team (W, section 3): who reaches whom, and for how long.

/// The links of one moment: `[a][b]` says whether robots a and b reach each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Links {
    robots: usize,
    linked: Vec<bool>,
}

impl Links {
    /// The links of a team; `are_linked` is asked once for each pair, the lower number first.
    pub fn new(robots: usize, mut are_linked: impl FnMut(usize, usize) -> bool) -> Self {
        let mut linked = vec![false; robots * robots];
        for a in 0..robots {
            for b in a + 1..robots {
                let is_linked = are_linked(a, b);
                linked[a * robots + b] = is_linked;
                linked[b * robots + a] = is_linked;
            }
        }
        Self { robots, linked }
    }

    /// Whether two robots reach each other without a relay.
    pub fn are_linked(&self, a: usize, b: usize) -> bool {
        self.linked[a * self.robots + b]
    }

    /// Whether a robot reaches any other one.
    pub fn is_connected(&self, robot: usize) -> bool {
        (0..self.robots).any(|other| self.are_linked(robot, other))
    }

    /// Whether every robot reaches every other one, if robots relay.
    pub fn is_one_network(&self) -> bool {
        let (mut reached, mut next) = (vec![false; self.robots], vec![0]);
        while let Some(robot) = next.pop() {
            if robot < self.robots && !std::mem::replace(&mut reached[robot], true) {
                next.extend((0..self.robots).filter(|&other| self.are_linked(robot, other)));
            }
        }
        reached.into_iter().all(|is_reached| is_reached)
    }

    /// Number of pairs that reach each other without a relay.
    pub fn pairs(&self) -> usize {
        self.linked.iter().filter(|is_linked| **is_linked).count() / 2
    }
}

/// How well a team was connected so far, in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Connection {
    ticks: u64,
    robots: u64,
    as_one_network: u64,
    connected: u64,
    pairs: u64,
}

impl Connection {
    /// Counts the links of a tick.
    pub fn note(&mut self, links: &Links) {
        self.ticks += 1;
        self.robots = links.robots as u64;
        self.as_one_network += u64::from(links.is_one_network());
        let connected = (0..links.robots).filter(|&robot| links.is_connected(robot));
        self.connected += connected.count() as u64;
        self.pairs += links.pairs() as u64;
    }

    /// Share of the time in which the team was one network, 0 to 1.
    pub fn one_network_share(&self) -> f64 {
        share(self.as_one_network, self.ticks)
    }

    /// Time that robots were connected to at least one other, the sum over the robots, in ticks.
    pub fn connected_ticks(&self) -> u64 {
        self.connected
    }

    /// Mean share of the pairs that reached each other without a relay, 0 to 1.
    pub fn connectivity(&self) -> f64 {
        let pairs = self.robots * self.robots.saturating_sub(1) / 2;
        share(self.pairs, self.ticks * pairs)
    }
}

fn share(part: u64, all: u64) -> f64 {
    if all == 0 { 1.0 } else { part as f64 / all as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_robots_are_one_network_with_two_links() {
        for (pairs, is_one, connected, count) in [
            (&[][..], false, 0, 0),
            (&[(0, 2)], false, 2, 1),
            (&[(0, 2), (1, 2)], true, 3, 2),
            (&[(0, 1), (0, 2), (1, 2)], true, 3, 3),
        ] {
            let links = Links::new(3, |a, b| pairs.contains(&(a, b)));
            assert_eq!(links.is_one_network(), is_one, "{pairs:?}");
            let found = (0..3).filter(|&robot| links.is_connected(robot)).count();
            assert_eq!((found, links.pairs()), (connected, count), "{pairs:?}");
        }
        assert!(Links::new(1, |_, _| false).is_one_network());
    }

    /// Two ticks as one network, one with a single link, one without any.
    #[test]
    fn shares_are_those_of_the_ticks() {
        let mut counted = Connection::default();
        for pairs in [&[(0, 1), (0, 2), (1, 2)][..], &[(0, 1), (0, 2)], &[(0, 1)], &[]] {
            counted.note(&Links::new(3, |a, b| pairs.contains(&(a, b))));
        }
        assert_eq!(counted.one_network_share(), 0.5);
        assert_eq!(counted.connected_ticks(), 3 + 3 + 2);
        assert_eq!(counted.connectivity(), 0.5);
    }
}
