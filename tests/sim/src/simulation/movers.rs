//! Keeps robots and discs apart within a tick.

use crate::Point;
use crate::geometry;

/// Something that moves within a tick: a robot or a disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mover {
    pub(super) before: Point,
    pub(super) after: Point,
    pub(super) radius_m: f64,
    pub(super) is_disc: bool,
}

impl Mover {
    /// Smallest gap to another mover during the tick, if both move on straight lines, metres;
    /// negative if they overlap.
    pub(super) fn gap_m(&self, other: &Self) -> f64 {
        let at = |here: Point, there: Point| [0, 1].map(|axis| here[axis] - there[axis]);
        let (from, to) = (at(self.before, other.before), at(self.after, other.after));
        let between = geometry::distance_from_segment([0.0; 2], from, to);
        between - self.radius_m - other.radius_m
    }

    /// The same at rest.
    pub(super) fn standing(&self) -> Self {
        Self { after: self.before, ..*self }
    }

    /// Whether this mover moves towards where the other one was.
    pub(super) fn approaches(&self, other: &Self) -> bool {
        let along = |axis: usize| {
            (self.after[axis] - self.before[axis]) * (other.before[axis] - self.before[axis])
        };
        along(0) + along(1) > 0.0
    }

    /// Whether they would overlap. Discs pass through each other.
    pub(super) fn clashes(&self, other: &Self) -> bool {
        !(self.is_disc && other.is_disc) && self.gap_m(other) < 0.0
    }
}

/// What happened between a mover and the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Contact {
    /// It moved towards what it touched, and is to blame.
    pub(super) has_touched: bool,
    /// Something touched it that it did not move towards, or could not stop for.
    pub(super) was_struck: bool,
}

/// Puts robots and discs that would overlap back to where they were before the tick, and returns
/// the contacts of each mover. Of two that clash, those go back that move towards the other: none
/// has precedence. A mover that goes back may block another one, which then goes back too.
/// `is_at_fault` tells of a robot and what it moves towards whether the robot is to blame.
pub(super) fn keep_apart(
    movers: &mut [Mover],
    is_at_fault: &dyn Fn(usize, usize) -> bool,
) -> Vec<Contact> {
    let mut contacts = vec![Contact::default(); movers.len()];
    loop {
        let seen: Vec<Mover> = movers.to_vec();
        let mut is_changed = false;
        for (index, mover) in movers.iter_mut().enumerate() {
            let others = seen.iter().enumerate().filter(|&(other, _)| other != index);
            let clashing = others.filter(|(_, other)| seen[index].clashes(other));
            for (other_index, other) in clashing {
                let approaches = seen[index].approaches(other);
                let is_to_blame = approaches && (mover.is_disc || is_at_fault(index, other_index));
                contacts[index].has_touched |= is_to_blame;
                contacts[index].was_struck |= !is_to_blame;
                // A disc waits where it would overlap a robot, which goes on if that suffices.
                let suffices = other.is_disc && !seen[index].clashes(&other.standing());
                if approaches && !(suffices && other.approaches(&seen[index])) {
                    mover.after = mover.before;
                    is_changed = true;
                }
            }
        }
        if !is_changed {
            return contacts;
        }
    }
}
