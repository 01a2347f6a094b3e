//! Checks before arming: what the robot needs before it may drive.

use serde::{Deserialize, Serialize};

/// A set of checks that fail, one bit each. The bits are part of the wire format: append new ones.
///
/// ```
/// use robot_io::Checks;
/// let failing = Checks::default().with(Checks::POSITION, true).with(Checks::PLAN, false);
/// assert_eq!(failing.names().collect::<Vec<_>>(), ["position"]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Checks(u16);

impl Checks {
    /// The position is unknown: there is neither a good fix nor a good pose.
    pub const POSITION: Self = Self(1);
    /// The heading is unknown, and the robot cannot creep to find it.
    pub const HEADING: Self = Self(1 << 1);
    /// The range finder is silent or faulty, or the mission requires one and none reports.
    pub const RANGES: Self = Self(1 << 2);
    /// The battery's charge is below the mission's threshold.
    pub const BATTERY: Self = Self(1 << 3);
    /// There is neither a plan nor a goal nor a behaviour.
    pub const PLAN: Self = Self(1 << 4);
    /// The mission has a fence, and the place is unknown that it would be centred on.
    pub const FENCE: Self = Self(1 << 5);
    /// The robot's clock stands still.
    pub const CLOCK: Self = Self(1 << 6);

    /// Every check, with its name.
    const TABLE: [(Self, &'static str); 7] = [
        (Self::POSITION, "position"),
        (Self::HEADING, "heading"),
        (Self::RANGES, "ranges"),
        (Self::BATTERY, "battery"),
        (Self::PLAN, "plan"),
        (Self::FENCE, "fence"),
        (Self::CLOCK, "clock"),
    ];

    /// Every check.
    pub fn all() -> Self {
        Self::TABLE.into_iter().fold(Self::default(), |set, (check, _)| set.with(check, true))
    }

    /// The set with `check` added if it `fails`.
    #[must_use]
    pub const fn with(self, check: Self, fails: bool) -> Self {
        if fails { Self(self.0 | check.0) } else { self }
    }

    /// Whether any of `checks` is in the set.
    pub const fn has(self, checks: Self) -> bool {
        self.0 & checks.0 != 0
    }

    /// Whether no check fails.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The names of the checks in the set.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::TABLE.into_iter().filter(move |&(check, _)| self.has(check)).map(|(_, name)| name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_check_has_a_bit_and_a_name_of_its_own() {
        assert_eq!(Checks::all().names().count(), Checks::TABLE.len());
        assert_eq!(Checks::all().0, (1 << Checks::TABLE.len()) - 1);
        assert!(Checks::default().is_empty() && !Checks::FENCE.is_empty());
    }
}
