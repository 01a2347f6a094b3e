//! Actuators that do not obey.

use super::{Fault, in_us};
use crate::{Chassis, Random, Stream};
use robot_io::Commands;
use std::collections::VecDeque;
use std::ops::Range;

/// Actuators with a fault: they follow other commands than the robot gives.
#[derive(Clone, Debug)]
pub struct Actuators {
    fault: Fault,
    window_us: Range<u64>,
    random: Random,
    /// The commands of the last ticks, the newest at the back.
    past: VecDeque<Commands>,
    /// The commands that a freeze repeats.
    frozen: Option<Commands>,
}

impl Actuators {
    /// Actuators that fail within a window, in seconds since the start.
    pub fn new(fault: Fault, window_s: Range<f64>, seed: u64) -> Self {
        Self {
            fault,
            window_us: in_us(&window_s),
            random: Random::new(seed, Stream::Actuators),
            past: VecDeque::new(),
            frozen: None,
        }
    }

    /// The commands that the motors follow in the tick that ends at `time_us`.
    pub fn obey(&mut self, commands: Commands, chassis: &Chassis, time_us: u64) -> Commands {
        if let Fault::Delay { ticks } = self.fault {
            self.past.push_back(commands);
            let kept = if self.window_us.contains(&time_us) { ticks } else { 0 };
            let mut late = Commands::stop(commands.reason);
            while self.past.len() > kept {
                late = self.past.pop_front().unwrap_or(late);
            }
            return late;
        }
        if !self.window_us.contains(&time_us) {
            return commands;
        }
        let stop = Commands { speed_mps: 0.0, turn_rate_radps: 0.0, ..commands };
        match self.fault {
            Fault::Drop { chance } if self.random.chance(chance) => stop,
            Fault::Freeze => *self.frozen.get_or_insert(commands),
            Fault::Jump { offset: [speed, turn] } => Commands {
                speed_mps: commands.speed_mps + speed as f32,
                turn_rate_radps: commands.turn_rate_radps + turn as f32,
                ..commands
            },
            Fault::Garble { chance } if self.random.chance(chance) => {
                let mut within = |most: f64| self.random.between(-most, most) as f32;
                Commands {
                    speed_mps: within(chassis.max_speed_mps),
                    turn_rate_radps: within(chassis.max_turn_rate_radps),
                    ..commands
                }
            }
            // Handled above, or for receivers only.
            Fault::Drop { .. } | Fault::Garble { .. } | Fault::Delay { .. } | Fault::Mode(_) => {
                commands
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robot_io::Reason;

    /// The robot asks for 1, 2, 3 and so on m/s, one second each; the fourth to the eighth fail.
    #[test]
    fn actuators_obey_other_commands_while_they_fail() {
        let chassis = Chassis { max_speed_mps: 0.5, ..Chassis::default() };
        let speeds = |fault| -> Vec<f32> {
            let mut actuators = Actuators::new(fault, 3.0..8.0, 1);
            let ticks = 0..10_u8;
            ticks
                .map(|i| {
                    let speed_mps = f32::from(i) + 1.0;
                    let wanted = Commands { speed_mps, ..Commands::stop(Reason::Driving) };
                    actuators.obey(wanted, &chassis, u64::from(i) * 1_000_000).speed_mps
                })
                .collect()
        };
        let lost = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0, 10.0];
        assert_eq!(speeds(Fault::Drop { chance: 1.0 }), lost);
        let stuck = [1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0, 4.0, 9.0, 10.0];
        assert_eq!(speeds(Fault::Freeze), stuck);
        let faster = [1.0, 2.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 10.0];
        assert_eq!(speeds(Fault::Jump { offset: [1.0, 0.0] }), faster);
        let late = [1.0, 2.0, 3.0, 0.0, 0.0, 4.0, 5.0, 6.0, 9.0, 10.0];
        assert_eq!(speeds(Fault::Delay { ticks: 2 }), late);
        let wild = speeds(Fault::Garble { chance: 1.0 });
        assert!(wild[3..8].iter().all(|speed| speed.abs() <= 0.5) && wild[8] == 9.0, "{wild:?}");
    }
}
