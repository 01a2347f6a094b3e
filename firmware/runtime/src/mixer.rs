//! Turns speed and turn rate into the outputs of two motors. Pure; boards share it.

use robot_io::Commands;

/// Mixes speed and turn rate for a body on two driven wheels or tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    /// Distance between the wheels, metres.
    pub track_m: f32,
    /// Speed of a wheel at full output, m/s.
    pub full_speed_mps: f32,
}

impl Mixer {
    /// Output for the left and the right wheel, -1 ..= 1.
    ///
    /// If one wheel would exceed its full speed, both slow down by the same factor: the robot
    /// follows the commanded circle more slowly.
    pub fn mix(&self, commands: &Commands) -> [f32; 2] {
        let half_difference = commands.turn_rate_radps * self.track_m / 2.0;
        let left = commands.speed_mps - half_difference;
        let right = commands.speed_mps + half_difference;
        let fastest = left.abs().max(right.abs()).max(self.full_speed_mps);
        // Invalid settings or commands: stand still.
        if left.is_finite() && right.is_finite() && fastest > 0.0 {
            [left / fastest, right / fastest]
        } else {
            [0.0, 0.0]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robot_io::Reason;

    fn mix(speed_mps: f32, turn_rate_radps: f32) -> [f32; 2] {
        let body = Mixer { track_m: 0.5, full_speed_mps: 2.0 };
        body.mix(&Commands { speed_mps, turn_rate_radps, ..Commands::stop(Reason::Driving) })
    }

    #[test]
    fn straight_turning_and_both() {
        assert_eq!(mix(1.0, 0.0), [0.5, 0.5]);
        assert_eq!(mix(0.0, 4.0), [-0.5, 0.5], "counter-clockwise: the right wheel ahead");
        assert_eq!(mix(1.0, 2.0), [0.25, 0.75]);
    }

    #[test]
    fn too_fast_keeps_the_circle() {
        let [left, right] = mix(4.0, 8.0);
        assert_eq!([left, right], [1.0 / 3.0, 1.0]);
    }

    #[test]
    fn invalid_settings_and_commands_stand_still() {
        assert_eq!(mix(f32::NAN, f32::NAN), [0.0, 0.0]);
        assert_eq!(mix(f32::INFINITY, 0.0), [0.0, 0.0]);
        let broken = Mixer { track_m: 0.5, full_speed_mps: 0.0 };
        assert_eq!(broken.mix(&Commands::stop(Reason::AtGoal)), [0.0, 0.0]);
    }
}
